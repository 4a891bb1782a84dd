//! Values that no surface can have get a sentence from every model, never a number.

use barbule::bsdf::cylinder::{
    CylinderDesign, CylinderModel, FilmedCylinderDesign, FilmedCylinderModel, NearFieldCylinderModel,
};
use barbule::bsdf::spongy_barb::SpongyBarbModel;
use barbule::bsdf::{
    CoatedBase, Feather, FeatherDesign, GranierHeidrich, GranierHeidrichDesign, IridescentPlastic,
    IridescentPlasticDesign, Lambertian, LambertianDesign, MicrofacetDesign, MicrofacetInterface, Model, RoughPlastic,
    RoughPlasticDesign,
};

use super::directions::RGB_NM;

fn every_model() -> Vec<Box<dyn Model>> {
    let clear = r#"
        substrate = "keratin"
        layers = [{ name = "film", material = { name = "film", index = 1.7, extinction = 0.1 }, thickness_nm = 300 }]"#;
    let filmed: FilmedCylinderDesign =
        toml::from_str(r#"layers = [{ name = "film", material = "keratin", thickness_nm = 300 }]"#).unwrap();
    vec![
        Box::new(CoatedBase::new(&toml::from_str(clear).unwrap(), &RGB_NM).unwrap()),
        Box::new(CoatedBase::new(&toml::from_str("substrate = \"bird_melanin\"").unwrap(), &RGB_NM).unwrap()),
        Box::new(MicrofacetInterface::new(&MicrofacetDesign::default(), &RGB_NM).unwrap()),
        Box::new(RoughPlastic::new(&RoughPlasticDesign::default(), &RGB_NM).unwrap()),
        Box::new(IridescentPlastic::new(&IridescentPlasticDesign::default(), &RGB_NM).unwrap()),
        Box::new(GranierHeidrich::new(&GranierHeidrichDesign::default(), &RGB_NM).unwrap()),
        Box::new(Lambertian::new(&LambertianDesign::default(), &RGB_NM).unwrap()),
        Box::new(CylinderModel::new(&CylinderDesign::default(), &RGB_NM).unwrap()),
        Box::new(NearFieldCylinderModel::new(&CylinderDesign::default(), &RGB_NM).unwrap()),
        Box::new(FilmedCylinderModel::new(&filmed, &RGB_NM).unwrap()),
        Box::new(SpongyBarbModel::new(&CylinderDesign::default(), &RGB_NM).unwrap()),
        Box::new(Feather::new(&FeatherDesign::default(), &RGB_NM).unwrap()),
    ]
}

#[test]
fn every_parameter_of_every_model_refuses_what_cannot_be() {
    for model in every_model() {
        let parameters = model.parameters();
        let defaults: Vec<f64> = parameters.iter().map(|parameter| parameter.default).collect();
        model.check(&defaults).unwrap();
        for (position, parameter) in parameters.iter().enumerate() {
            let (below, above) = (parameter.lower - 1e-3, parameter.upper + 1e-3);
            for bad in [below, above, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                let mut values = defaults.clone();
                values[position] = bad;
                let message = model.check(&values).unwrap_err().to_string();
                let expected = format!("`{}` is {bad}; expected a number from", parameter.name);
                assert!(message.starts_with(&expected), "{message}");
            }
            // Roughness, absorption and shares stay physical whatever a model's bounds are.
            let name = parameter.name.rsplit('.').next().unwrap();
            match name {
                "roughness" | "beta_m" | "beta_n" => assert!(parameter.lower > 0.0 && parameter.upper <= 1.0),
                "eta" => assert!(parameter.lower > 1.0),
                "sigma_a" => assert!(parameter.lower >= 0.0),
                _ if name.contains("share") || name.contains("albedo") || ["specular", "diffuse"].contains(&name) => {
                    assert!(parameter.lower >= 0.0 && parameter.upper <= 1.0);
                }
                _ => {}
            }
        }
        assert!(model.check(&defaults[1..]).unwrap_err().to_string().contains("parameters, found"));
    }
}
