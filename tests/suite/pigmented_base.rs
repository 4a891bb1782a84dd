//! Pigments as parameters, the layer of Kubelka and Munk, and the film whose angle nobody wrote down.

use std::f64::consts::PI;

use barbule::bsdf::cylinder::{
    CylinderDesign, CylinderModel, FilmedCylinderDesign, FilmedCylinderModel, absorption_for_albedo,
};
use barbule::bsdf::{
    Direction, FilmAtUnknownAngle, FilmAtUnknownAngleDesign, Model, ModelError, PigmentedBase, PigmentedBaseDesign,
    layer_reflectance,
};
use barbule::pigment::{AbsorptionSpectrum, BandDesign, ColourRule, EUMELANIN_RGB, PigmentDesign, chiang_absorption};
use proptest::prelude::*;

const EUMELANIN: PigmentDesign = PigmentDesign::Eumelanin { name: None };
const CAROTENOID: PigmentDesign = PigmentDesign::Carotenoid { name: None };

/// Values of all parameters: those named, the default of the rest.
fn values(model: &dyn Model, named: &[(&str, f64)]) -> Vec<f64> {
    for (name, _) in named {
        assert!(model.parameters().iter().any(|parameter| parameter.name == *name), "no parameter {name}");
    }
    let value = |name: &str| named.iter().find(|(known, _)| *known == name).map(|(_, value)| *value);
    model.parameters().iter().map(|parameter| value(&parameter.name).unwrap_or(parameter.default)).collect()
}

/// Readings against a white standard, light and viewer at the normal.
fn readings(model: &dyn Model, named: &[(&str, f64)]) -> Vec<f64> {
    let values = values(model, named);
    model.check(&values).unwrap();
    let mut brdf = vec![0.0; model.channel_count()];
    let normal = Direction::new(0.0, 0.0, 1.0);
    model.bind(&values).evaluate(&normal, &normal, &mut brdf);
    brdf.iter().map(|value| PI * value).collect()
}

fn base(pigments: Vec<PigmentDesign>, sponge: bool, wavelengths_nm: &[f64]) -> PigmentedBase {
    PigmentedBase::new(&PigmentedBaseDesign { pigments, sponge }, wavelengths_nm).unwrap()
}

/// The equation that Kubelka and Munk 1931 set up, dR/dx = S − 2 (K + S) R + S R² from R = 0 at the black ground, by steps of
/// Runge and Kutta. With 4000 steps of at most 0.03 its error is some 1e-9.
#[test]
fn the_layer_solves_the_equation_of_two_streams() {
    for (k, s) in [(0.0, 0.3), (0.0, 30.0), (0.01, 2.0), (1.0, 1.0), (5.0, 2.0), (20.0, 0.5), (40.0, 20.0)] {
        let slope = |r: f64| s - 2.0 * (k + s) * r + s * r * r;
        let (steps, mut r) = (4000, 0.0);
        let h = 1.0 / f64::from(steps);
        for _ in 0..steps {
            let a = slope(r);
            let b = slope(r + 0.5 * h * a);
            let c = slope(r + 0.5 * h * b);
            let d = slope(r + h * c);
            r += h / 6.0 * (a + 2.0 * b + 2.0 * c + d);
        }
        let found = layer_reflectance(k, s);
        assert!((found - r).abs() < 1e-8, "k {k}, s {s}: found {found}, integrated {r}");
    }
}

/// Kubelka 1948: without absorption R = SX/(1 + SX); endless, R∞ = 1 + K/S − √((K/S)² + 2K/S).
#[test]
fn the_layer_has_its_closed_limits() {
    for s in [1e-3, 0.5, 7.0, 1e3] {
        let (found, expected): (f64, f64) = (layer_reflectance(0.0, s), s / (1.0 + s));
        assert!((found - expected).abs() < 1e-15, "{found} {expected}");
    }
    for ratio in [1e-3_f64, 0.1, 1.0, 20.0] {
        let expected = 1.0 + ratio - (ratio * ratio + 2.0 * ratio).sqrt();
        let found = layer_reflectance(1e4 * ratio, 1e4);
        // tanh(x) is 1 to 1e-15 from x = 18 on; the least x here is 447. The closed form itself cancels to some 1e-14.
        assert!((found - expected).abs() < 1e-13, "{ratio}: {found} {expected}");
    }
    assert!(layer_reflectance(3.0, 0.0).abs() < f64::MIN_POSITIVE);
}

/// The readings are made of the parts that stand in the model's header.
#[test]
fn the_base_is_the_sum_of_its_parts() {
    let wavelengths = [400.0, 500.0, 650.0];
    let model = base(vec![EUMELANIN], true, &wavelengths);
    let named = [
        ("eumelanin.amount", 0.7),
        ("scattering", 3.0),
        ("scattering_exponent", 1.5),
        ("gloss", 0.04),
        ("sponge.strength", 2.0),
        ("sponge.peak_nm", 450.0),
        ("sponge.width_nm", 40.0),
    ];
    for (found, nm) in readings(&model, &named).into_iter().zip(wavelengths) {
        let k = 0.7 * (nm / 500.0_f64).powf(-3.33);
        let s = 3.0 * ((nm / 500.0_f64).powf(-1.5) + 2.0 * (-0.5 * ((nm - 450.0) / 40.0_f64).powi(2)).exp());
        let expected = 0.04 + 0.96 * layer_reflectance(k, s);
        assert!((found - expected).abs() < 1e-14, "{nm} nm: {found} {expected}");
    }
}

/// A band's shift moves the minimum of the reflectance by as much, and its width widens it about the minimum.
#[test]
fn bands_move_and_widen() {
    let wavelengths: Vec<f64> = (0..401).map(|k| 300.0 + f64::from(k)).collect();
    let band = BandDesign { peak_nm: 450.0, width_nm: 30.0, height: 1.0 };
    let model = base(vec![PigmentDesign::Bands { name: "band".into(), bands: vec![band] }], false, &wavelengths);
    let minimum = |shift: f64, width: f64| {
        let named = [("band.shift_nm", shift), ("band.width", width), ("scattering_exponent", 0.0)];
        let readings = readings(&model, &named);
        let lowest = (0..401).min_by(|a, b| readings[*a].total_cmp(&readings[*b])).unwrap();
        // Without the band the layer of s = 2 sends back 2/3.
        let half = 0.5 * (2.0 / 3.0 + readings[lowest]);
        (lowest + 300, readings.iter().filter(|reading| **reading < half).count())
    };
    assert_eq!(minimum(0.0, 1.0).0, 450);
    assert_eq!(minimum(35.0, 1.0).0, 485);
    assert_eq!(minimum(-60.0, 1.0).0, 390);
    // Twice as wide at every depth.
    let ratio =
        f64::from(u32::try_from(minimum(0.0, 2.0).1).unwrap()) / f64::from(u32::try_from(minimum(0.0, 1.0).1).unwrap());
    assert!((ratio - 2.0).abs() < 0.05, "{ratio}");
    // A carotenoid of the default width is the shape that the pigments' own test holds against its fingers.
    let model = base(vec![CAROTENOID], false, &wavelengths);
    let shifted = readings(&model, &[("carotenoid.shift_per_cm", 900.0), ("carotenoid.amount", 2.0)]);
    let shape = AbsorptionSpectrum::carotenoid(900.0).sample(&wavelengths).unwrap();
    for ((found, shape), nm) in shifted.iter().zip(shape).zip(&wavelengths) {
        let expected = layer_reflectance(2.0 * shape, 2.0 * (nm / 500.0).powf(-0.5));
        assert!((found - expected).abs() < 1e-13);
    }
}

/// Pigments in a fibre give the σₐ that the same fibre takes as a parameter in each channel.
#[test]
fn pigments_are_the_absorption_of_a_fibre() {
    let wavelengths = [645.0, 525.0, 445.0];
    let (light, viewer) = (Direction::new(0.3, 0.2, 0.933).normalize(), Direction::new(-0.5, 0.1, 0.86).normalize());
    let evaluate = |model: &dyn Model, named: &[(&str, f64)]| {
        let mut found = [0.0; 3];
        model.bind(&values(model, named)).evaluate(&light, &viewer, &mut found);
        found
    };
    let colour = [0.6, 0.4, 0.25];
    let pigments = |by| {
        let colour = PigmentDesign::Colour { name: Some("dye".into()), colour, by, beta_n: Some(0.25), eta: None };
        vec![PigmentDesign::EumelaninRgb { name: None }, EUMELANIN, colour]
    };
    let named = [("melanin.amount", 0.3), ("eumelanin.amount", 0.2), ("dye.amount", 1.5)];
    for by in [ColourRule::Chiang, ColourRule::Albedo] {
        let mut pigments = pigments(by);
        pigments[0] = PigmentDesign::EumelaninRgb { name: Some("melanin".into()) };
        let with = CylinderModel::new(
            &CylinderDesign { pigments: pigments.clone(), ..CylinderDesign::default() },
            &wavelengths,
        )
        .unwrap();
        assert!(with.parameters().iter().all(|parameter| parameter.name != "sigma_a"));
        let dye = colour.map(|colour| match by {
            ColourRule::Chiang => chiang_absorption(colour, 0.25).unwrap(),
            ColourRule::Albedo => absorption_for_albedo(1.55, 0.0, colour).unwrap(),
        });
        let sigma_a: Vec<f64> = (0..3)
            .map(|c| 0.3 * EUMELANIN_RGB[c] + 0.2 * (wavelengths[c] / 500.0_f64).powf(-3.33) + 1.5 * dye[c])
            .collect();
        let each = CylinderDesign { per_channel: vec!["sigma_a".into()], ..CylinderDesign::default() };
        let each = CylinderModel::new(&each, &wavelengths).unwrap();
        let of_each = [("sigma_a_r", sigma_a[0]), ("sigma_a_g", sigma_a[1]), ("sigma_a_b", sigma_a[2])];
        for (found, expected) in evaluate(&with, &named).iter().zip(evaluate(&each, &of_each)) {
            assert!((found - expected).abs() <= 1e-13 * expected, "{found} {expected}");
        }
        // The filmed fibre takes the same list.
        let design = FilmedCylinderDesign {
            layers: Vec::new(),
            mapping: Default::default(),
            lobe: Default::default(),
            per_channel: Vec::new(),
            pigments,
        };
        let filmed = FilmedCylinderModel::new(&design, &wavelengths).unwrap();
        for (found, expected) in evaluate(&filmed, &named).iter().zip(evaluate(&with, &named)) {
            // Without layers a filmed fibre is a bare one but for the rows of its table.
            assert!((found - expected).abs() <= 1e-4 * expected, "{found} {expected}");
        }
    }
}

/// Channels may come by rising wavelength, as tables have them: the longest stays red.
#[test]
fn three_channels_are_red_green_and_blue_in_any_order() {
    let pigments = vec![PigmentDesign::EumelaninRgb { name: None }];
    let dark =
        |wavelengths: &[f64]| readings(&base(pigments.clone(), false, wavelengths), &[("scattering_exponent", 0.0)]);
    let (falling, rising) = (dark(&[645.0, 525.0, 445.0]), dark(&[445.0, 525.0, 645.0]));
    assert_eq!(falling.iter().rev().collect::<Vec<_>>(), rising.iter().collect::<Vec<_>>());
    assert!(falling[0] > falling[1] && falling[1] > falling[2]);
}

#[test]
fn pigments_that_cannot_be_are_refused_in_a_sentence() {
    let rgb = [645.0, 525.0, 445.0];
    let colour = |colour, by, eta| PigmentDesign::Colour { name: None, colour, by, beta_n: None, eta };
    let band = |peak_nm, width_nm| PigmentDesign::Bands {
        name: "band".into(),
        bands: vec![BandDesign { peak_nm, width_nm, height: 1.0 }],
    };
    let table = |rows: Vec<(f64, f64)>| PigmentDesign::Table {
        name: "dye".into(),
        file: "dye.csv".into(),
        wavelength: "nm".into(),
        absorption: "a".into(),
        rows,
    };
    let named = |name: &str| PigmentDesign::Eumelanin { name: Some(name.into()) };
    let cases: [(Vec<PigmentDesign>, &[f64], &str); 11] = [
        (vec![EUMELANIN, EUMELANIN], &rgb, "two pigments are named \"eumelanin\""),
        (vec![named("a b")], &rgb, "\"a b\" cannot be the name of a pigment"),
        (vec![PigmentDesign::EumelaninRgb { name: None }], &[500.0], "and the readings have 1 wavelengths"),
        (vec![colour([0.5, 0.5, 1.5], ColourRule::Chiang, None)], &rgb, "but 1.5 was given"),
        (vec![colour([0.5, 0.5, 0.01], ColourRule::Albedo, None)], &rgb, "no pigment takes that away"),
        (vec![colour([0.5; 3], ColourRule::Albedo, Some(f64::NAN))], &rgb, "between 1 and 3, but NaN was given"),
        (vec![band(450.0, 0.0)], &rgb, "needs a positive peak and width"),
        (vec![PigmentDesign::Bands { name: "none".into(), bands: Vec::new() }], &rgb, "the list of bands is empty"),
        (vec![table(vec![(400.0, 1.0), (600.0, 2.0)])], &rgb, "covers 400 to 600 nm, but 645 nm was asked for"),
        (vec![table(vec![(400.0, 1.0), (700.0, -2.0)])], &rgb, "expected 0 or more"),
        (vec![EUMELANIN], &[f64::NAN], "a wavelength is NaN"),
    ];
    for (pigments, wavelengths, text) in cases {
        let design = CylinderDesign { pigments, ..CylinderDesign::default() };
        let found = CylinderModel::new(&design, wavelengths).unwrap_err().to_string();
        assert!(found.contains(text), "{found}");
    }
    let both =
        CylinderDesign { pigments: vec![EUMELANIN], per_channel: vec!["sigma_a".into()], ..CylinderDesign::default() };
    assert_eq!(CylinderModel::new(&both, &rgb).unwrap_err(), ModelError::PigmentsAndAbsorption);
    let design = PigmentedBaseDesign { pigments: vec![colour([0.5; 3], ColourRule::Chiang, None)], sponge: false };
    assert!(PigmentedBase::new(&design, &rgb).unwrap_err().to_string().contains("has no fibre"));
}

fn film(film: &str, substrate: &str, wavelengths_nm: &[f64]) -> FilmAtUnknownAngle {
    let design: FilmAtUnknownAngleDesign = toml::from_str(&format!("film = {film}\nsubstrate = {substrate}")).unwrap();
    FilmAtUnknownAngle::new(&design, wavelengths_nm).unwrap()
}

/// Airy's sum at normal incidence, from the two surfaces' amplitudes.
#[test]
fn the_film_is_airys_sum_over_its_path() {
    let wavelengths: Vec<f64> = (0..81).map(|k| 300.0 + 5.0 * f64::from(k)).collect();
    let model = film("{ name = \"a\", index = 1.55 }", "{ name = \"b\", index = 1.8 }", &wavelengths);
    for path in [90.0, 450.0, 1300.0] {
        for (found, nm) in readings(&model, &[("optical_path_nm", path)]).iter().zip(&wavelengths) {
            let (r01, r12) = ((1.0 - 1.55) / (1.0 + 1.55), (1.55 - 1.8) / (1.55 + 1.8));
            let phase: f64 = 4.0 * PI * path / nm;
            let top = r01 * r01 + r12 * r12 + 2.0 * r01 * r12 * phase.cos();
            let bottom = 1.0 + (r01 * r12) * (r01 * r12) + 2.0 * r01 * r12 * phase.cos();
            assert!((found - top / bottom).abs() < 1e-12, "{path} {nm}: {found} {}", top / bottom);
        }
    }
    // A rising order of indices: maxima where 2P = mλ. Path 500: 500 nm is m = 2.
    let readings = readings(&model, &[("optical_path_nm", 500.0)]);
    let at = |nm: f64| readings[wavelengths.iter().position(|w| (w - nm).abs() < 1e-9).unwrap()];
    assert!(at(500.0) > at(490.0) && at(500.0) > at(510.0));
}

proptest! {
    /// No amount makes a layer brighter than white or darker than black, and more pigment never makes it brighter.
    #[test]
    fn a_layer_is_between_black_and_white(
        amounts in prop::array::uniform3(0.0..1000.0_f64),
        scattering in 1e-3..1e3_f64,
        exponent in -2.0..4.0_f64,
        gloss in 0.0..0.5_f64,
        shift in -1000.0..4000.0_f64,
        width in 0.3..5.0_f64,
        sponge in prop::array::uniform3(0.0..1.0_f64),
    ) {
        let wavelengths: Vec<f64> = (0..41).map(|k| 300.0 + 10.0 * f64::from(k)).collect();
        let pheomelanin = PigmentDesign::Pheomelanin { name: None };
        let model = base(vec![EUMELANIN, pheomelanin, CAROTENOID], true, &wavelengths);
        let named = |more: f64| [
            ("eumelanin.amount", (amounts[0] * more).min(1000.0)), ("pheomelanin.amount", amounts[1]), ("carotenoid.amount", amounts[2]),
            ("carotenoid.shift_per_cm", shift), ("carotenoid.width", width), ("scattering", scattering),
            ("scattering_exponent", exponent), ("gloss", gloss), ("sponge.strength", 100.0 * sponge[0]),
            ("sponge.peak_nm", 200.0 + 700.0 * sponge[1]), ("sponge.width_nm", 10.0 + 290.0 * sponge[2]),
        ];
        let (plain, darker) = (readings(&model, &named(1.0)), readings(&model, &named(1.2)));
        for (plain, darker) in plain.iter().zip(&darker) {
            prop_assert!((0.0..=1.0).contains(plain), "{plain}");
            prop_assert!(*darker <= plain + 1e-14);
        }
    }

    /// A film between clear media of any index, at any path, reflects a share.
    #[test]
    fn a_film_reflects_a_share(path in 20.0..5000.0_f64, index in 1.05..2.5_f64, below in 1.0..3.0_f64) {
        let wavelengths = [300.0, 444.0, 700.0];
        let model = film(&format!("{{ name = \"a\", index = {index} }}"), &format!("{{ name = \"b\", index = {below} }}"), &wavelengths);
        for found in readings(&model, &[("optical_path_nm", path)]) {
            prop_assert!((0.0..=1.0).contains(&found));
        }
    }
}
