//! The kept species: what must hold for each of them.

use std::fs;
use std::path::PathBuf;

use barbule::bsdf::{BarbDesign, BarbuleDesign, Direction, Feather, FeatherDesign, Model};
use barbule::measure::colour::{LinearRgb, Xyz};
use barbule::pigment::PigmentDesign;
use barbule::scene::{PIXELS_PER_BARB, SceneFile, SpeciesFile, View, picture_wavelengths_nm, studio};
use serde_json::Value;

use super::super::desk::{Desk, shipped};
use super::super::directions::{RGB_NM, evaluate};

fn entries() -> Vec<(PathBuf, SpeciesFile)> {
    let files = fs::read_dir(shipped("species")).unwrap().map(|file| file.unwrap().path());
    let mut entries: Vec<_> = files.map(|path| (path.clone(), SpeciesFile::read(&path).unwrap())).collect();
    entries.sort_by(|a, b| a.0.cmp(&b.0));
    entries
}

/// Colours come from named absorbers and bands, barbs are many, and each entry says where it comes from.
#[test]
fn species_are_composed_of_named_absorbers() {
    let entries = entries();
    assert!(entries.len() >= 5);
    for (path, entry) in entries {
        let name = path.display();
        assert_eq!(entry.status.word(), "composed", "{name}");
        assert!(entry.sources.len() >= 3 && entry.geometry.barbs.count_per_vane >= 300, "{name}");
        let typed: Value = serde_json::from_str(&fs::read_to_string(&path).unwrap()).unwrap();
        let text = typed.to_string();
        for colour in ["rgb", "per_channel", "colour\":", "\"color", "sigma_a", "albedo", "_r\"", "_g\"", "_b\""] {
            assert!(!text.contains(colour), "{name} holds {colour}");
        }
        // Every colour's parameter is one of an absorber or of a sponge.
        for layer in &entry.paint {
            for key in layer.set.keys() {
                let known = ["amount", "strength", "peak_nm", "width_nm"];
                assert!(known.iter().any(|end| key.ends_with(end)), "{name} paints {key}");
            }
        }
    }
}

fn design(entry: &SpeciesFile) -> FeatherDesign {
    let model = serde_json::to_value(&entry.vane.model).unwrap();
    serde_json::from_value(without_kind(model)).unwrap()
}

fn without_kind(mut model: Value) -> Value {
    model.as_object_mut().unwrap().remove("kind");
    model
}

/// Values of the vane with one layer at full strength, or with none.
fn coats(entry: &SpeciesFile, model: &dyn Model) -> Vec<Vec<f64>> {
    let base = |name: &str, default: f64| entry.vane.parameters.get(name).copied().unwrap_or(default);
    let none = std::collections::BTreeMap::new();
    let sets = std::iter::once(&none).chain(entry.paint.iter().map(|layer| &layer.set));
    let of_set = |set: &std::collections::BTreeMap<String, f64>| {
        let value = |p: &barbule::parameter::Parameter| {
            let value = set.get(&p.name).copied().unwrap_or_else(|| base(&p.name, p.default));
            // As the picture shows them: half barbs, half barbules.
            if p.name == "barb_share" { 0.5 } else { value }
        };
        model.parameters().iter().map(value).collect()
    };
    sets.map(of_set).collect()
}

/// Why pictures of species are made of a spectrum: three wavelengths miss the colour by more than is just noticed, seventeen do not.
/// The reflectance is that towards the zenith, of light from 40° across the barbs, times π.
#[test]
fn a_spectrum_of_seventeen_gives_the_colours_of_eighty_one() {
    let fine: Vec<f64> = (0..81).map(|k| 380.0 + 5.0 * f64::from(k)).collect();
    let coarse = picture_wavelengths_nm();
    let (incoming, outgoing) =
        (Direction::new(0.1, 0.63, 0.77).normalize(), Direction::new(0.05, 0.1, 1.0).normalize());
    let (mut worst_of_spectrum, mut worst_of_three, mut listed) = (0.0f64, 0.0f64, Vec::new());
    for (path, entry) in entries() {
        let design = design(&entry);
        let [fine_model, coarse_model, three] =
            [&fine[..], &coarse, &RGB_NM].map(|nm| Feather::new(&design, nm).unwrap());
        let coats = coats(&entry, &fine_model);
        let mut of_entry = (0.0f64, 0.0f64);
        for values in &coats {
            let reflectance = |model: &Feather| -> Vec<f64> {
                let f = evaluate(model, values, &incoming, &outgoing);
                f.into_iter().map(|f| f * std::f64::consts::PI).collect()
            };
            let lab = Xyz::of_reflectance(&fine, &reflectance(&fine_model)).unwrap().to_lab();
            let of_spectrum = Xyz::of_reflectance(&coarse, &reflectance(&coarse_model)).unwrap().to_lab();
            let rgb = reflectance(&three);
            let of_three = LinearRgb([rgb[0], rgb[1], rgb[2]]).to_lab();
            of_entry.0 = of_entry.0.max(lab.delta_e_2000(of_spectrum));
            of_entry.1 = of_entry.1.max(lab.delta_e_2000(of_three));
        }
        listed.push(format!("{}: {:.2}, {:.1}", path.file_stem().unwrap().display(), of_entry.0, of_entry.1));
        worst_of_spectrum = worst_of_spectrum.max(of_entry.0);
        worst_of_three = worst_of_three.max(of_entry.1);
    }
    println!("largest ΔE2000 of 17 wavelengths, of 3:\n{}", listed.join("\n"));
    assert!(worst_of_spectrum < 0.5, "{worst_of_spectrum}");
    // What is just noticed is about 2.
    assert!(worst_of_three > 2.0, "three wavelengths would do: {worst_of_three}");
}

/// The three views are scenes that can be read again; the closest one has the pixels that it promises.
#[test]
fn views_are_scenes() {
    for (path, entry) in entries() {
        let feather = barbule::geometry::Feather::new(&entry.geometry).unwrap();
        for view in [View::Flat, View::Angle, View::CloseUp] {
            let scene = studio(&entry, &path, view).unwrap();
            assert!(scene.title.contains("composed, not fitted"), "{}", scene.title);
            let typed = serde_json::to_value(&scene).unwrap();
            let read: SceneFile = serde_json::from_value(typed.clone()).unwrap();
            assert_eq!(read, scene);
            if view == View::CloseUp {
                let pixels_per_mm = f64::from(scene.image.height) / typed["camera"]["height_mm"].as_f64().unwrap();
                for vane in &feather.vanes {
                    let pixels = pixels_per_mm * feather.barb_pitch_mm(vane);
                    assert!(pixels >= PIXELS_PER_BARB - 1e-9 && PIXELS_PER_BARB >= 6.0, "{pixels} pixels a barb");
                }
            }
        }
    }
}

/// The program takes an entry by its file, and says of the picture how its values were found.
#[test]
fn a_species_is_rendered_by_its_file() {
    let text = fs::read_to_string(format!("{}/green-parakeet-tail.json", shipped("species"))).unwrap();
    let mut small: Value = serde_json::from_str(&text).unwrap();
    // One hard layer is painted in a moment.
    small["paint"] = serde_json::json!([{
        "set": { "barb.psittacofulvin_yellow.amount": 0 }, "where": { "vane": "left" }
    }]);
    small["geometry"]["barbs"]["count_per_vane"] = serde_json::json!(60);
    let desk = Desk::with("parakeet.json", small.to_string());
    desk.barbule("render parakeet.json --view flat --samples 1 --out out").succeeds().prints("composed, not fitted");
    assert!(fs::exists(desk.path("out/composed-flat.png")).unwrap());
    desk.barbule("render no-such-bird --view flat").complains(&["no-such-bird.json", "there is no such file"]);
    let slip = small.to_string().replacen("\"composed\"", "\"measured\"", 1);
    Desk::with("bird.json", slip)
        .barbule("render bird.json --view flat")
        .complains(&["status", "measured", "composed"]);
}

/// What barbs and barbules hold is told by spectra or bands.
#[test]
fn pigments_of_species_have_spectra() {
    for (path, entry) in entries() {
        let design = design(&entry);
        let (BarbDesign::Cylinder(barb) | BarbDesign::SpongyBarb(barb)) = &design.barb;
        let BarbuleDesign::Cylinder(barbule) = &design.barbule else { panic!("{} has other barbules", path.display()) };
        for pigment in barb.pigments.iter().chain(&barbule.pigments) {
            let spectral = matches!(
                pigment,
                PigmentDesign::Eumelanin { .. }
                    | PigmentDesign::Pheomelanin { .. }
                    | PigmentDesign::Carotenoid { .. }
                    | PigmentDesign::Bands { .. }
            );
            assert!(spectral, "{}: {pigment:?}", path.display());
        }
    }
}
