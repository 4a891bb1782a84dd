//! Tables with all four angles and few channels: parameters written once for all channels, readings held out by their
//! place, cube roots, and cases judged by what they did not see.

use std::fmt::Write as _;
use std::fs;

use serde_json::Value;

use super::data::data_file;
use super::desk::{Desk, replaced, shipped};

/// Directions in and out of the plane of incidence, three channels each; the readings stand for nothing yet.
fn directions() -> String {
    let mut text = "theta_i,phi_i,theta_o,phi_o,nm,brdf\n".to_owned();
    for theta_i in [10, 40, 65] {
        for (theta_o, phi_o) in [(0, 0), (25, 60), (40, 180), (65, 180), (50, 240)] {
            for nm in [645, 525, 445] {
                writeln!(text, "{theta_i},0,{theta_o},{phi_o},{nm},0.1").unwrap();
            }
        }
    }
    text
}

/// A job for [`directions`]; wavelengths rise in a spectrum, so that `_r` is the channel of the shortest one.
const PLASTIC: &str = r#"title = "A plastic in three channels"

[data]
file = "table.csv"

[data.layout.spectra]
quantity = "brdf"

[data.layout.spectra.columns.long]
angles = { four = { theta_i = "theta_i", phi_i = "phi_i", theta_o = "theta_o", phi_o = "phi_o" } }
wavelength = "nm"
value = "brdf"

[model]
kind = "rough-plastic"
per_channel = ["diffuse", "specular"]

[parameters]
roughness = { lower = 0.1, upper = 0.8 }
diffuse = { lower = 0.01, upper = 0.99 }
specular = "0.5 + 0.5 * diffuse"

[fit]
starts = 2
"#;

fn desk(job: &str) -> Desk {
    Desk::with("plastic.toml", job).and("table.csv", directions())
}

fn estimate<'a>(case: &'a Value, name: &str) -> &'a Value {
    let estimates = case["fit"]["estimates"].as_array().unwrap();
    estimates.iter().find(|estimate| estimate["name"] == name).unwrap_or_else(|| panic!("no {name}"))
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("found {value} where a number was expected"))
}

/// `diffuse` frees three parameters and `specular` ties three, each to its own channel; an exact table gives them back.
/// 1e-5 is what the solver's stopping test leaves of a value.
#[test]
fn what_is_written_once_holds_for_every_channel() {
    let desk = desk(PLASTIC);
    desk.barbule("check plastic.toml")
        .succeeds()
        .prints("diffuse_r                      free from 0.01 to 0.99")
        .prints("diffuse_b                      free from 0.01 to 0.99")
        .prints("specular_g                     tied: 0.5 + 0.5 × diffuse_g");

    // The ties hold for what is simulated too, so that only the free ones are set, one of them by channel.
    let set = "--set diffuse=0.3 --set diffuse_b=0.7 --set roughness=0.25";
    let set = format!("{set} --set specular_r=0.65 --set specular_g=0.65 --set specular_b=0.85");
    desk.barbule(&format!("simulate plastic.toml {set} --out made.csv")).succeeds();
    let made = desk.read("made.csv").replacen(
        "theta_i_deg,phi_i_deg,theta_o_deg,phi_o_deg,wavelength_nm,brdf_per_sr",
        "theta_i,phi_i,theta_o,phi_o,nm,brdf",
        1,
    );
    fs::write(desk.path("table.csv"), made).unwrap();
    desk.barbule("fit plastic.toml --out found").succeeds();
    let case = &desk.result("found")["cases"][0];
    for (name, truth) in [
        ("diffuse_r", 0.3),
        ("diffuse_g", 0.3),
        ("diffuse_b", 0.7),
        ("specular_g", 0.65),
        ("specular_b", 0.85),
        ("roughness", 0.25),
    ] {
        let found = number(&estimate(case, name)["value"]);
        assert!((found - truth).abs() < 1e-5, "{name}: found {found}, made from {truth}");
    }
    assert_eq!(estimate(case, "specular_g")["role"], "tied");
}

#[test]
fn a_channel_of_its_own_goes_before_all_channels() {
    let one_fixed = replaced(PLASTIC, "specular =", "diffuse_g = 0.2\nspecular =");
    desk(&one_fixed)
        .barbule("check plastic.toml")
        .succeeds()
        .prints("diffuse_r                      free")
        .prints("diffuse_g                      fixed at 0.2");
}

#[test]
fn slips_in_channels_and_held_out_readings_get_a_sentence() {
    for (piece, slip, parts) in [
        ("diffuse = {", "difuse = {", ["parameters.\"difuse\"", "no such parameter", "did you mean `diffuse_"]),
        ("upper = 0.99", "upper = 1.99", ["parameters.\"diffuse_b\"", "found 1.99", "from 0 to 1"]),
        ("0.5 * diffuse", "0.5 * difuse", ["parameters.\"specular_b\"", "difuse", ""]),
        ("[data.layout.spectra]", "hold_out_every = 1\n[data.layout.spectra]", ["hold_out_every", "found 1", "2"]),
        ("[data.layout.spectra]", "compare = \"roots\"\n[data.layout.spectra]", ["compare", "roots", "cube-roots"]),
    ] {
        desk(&replaced(PLASTIC, piece, slip)).barbule("check plastic.toml").complains(&parts);
    }
    // The cube root of 0 rises without end, and with it any σ.
    let roots = replaced(PLASTIC, "[data.layout.spectra]", "compare = \"cube-roots\"\n[data.layout.spectra]");
    let roots = replaced(&roots, "quantity = \"brdf\"", "quantity = \"brdf\"\nsigma = { absolute = 0.01 }");
    let dark = directions().replacen(",0.1\n", ",0\n", 1);
    let desk = Desk::with("plastic.toml", roots).and("table.csv", dark);
    desk.barbule("check plastic.toml").complains(&["data.compare", "reads 0", "leave `sigma` out"]);
}

/// Every second reading held out, by its place in the table; two cases, so that they are compared. What the comparison
/// says is computed anew from the readings themselves.
#[test]
fn cases_are_judged_by_the_readings_held_out() {
    let job = replaced(
        PLASTIC,
        "[data.layout.spectra]",
        "hold_out_every = 2\ncompare = \"cube-roots\"\n[data.layout.spectra]",
    );
    let job = replaced(
        &job,
        "[model]",
        "[[alternative]]\ncase = \"grey\"\nmodel = { kind = \"lambertian\" }\nparameters = { albedo = {} }\n\n[model]",
    );
    let desk = desk(&job);
    desk.barbule("simulate plastic.toml --set diffuse=0.3 --noise 0.02 --seed 4 --out made.csv").succeeds();
    let made = desk.read("made.csv").replacen(
        "theta_i_deg,phi_i_deg,theta_o_deg,phi_o_deg,wavelength_nm,brdf_per_sr",
        "theta_i,phi_i,theta_o,phi_o,nm,brdf",
        1,
    );
    fs::write(desk.path("table.csv"), made).unwrap();
    desk.barbule("fit plastic.toml --out found")
        .succeeds()
        .prints("Of 2 cases, main predicts the 24 readings held out best");
    let result = desk.result("found");
    for (case, row) in result["cases"].as_array().unwrap().iter().zip(result["comparison"]["rows"].as_array().unwrap())
    {
        let spectra = case["data"]["spectra"]["spectra"].as_array().unwrap();
        let (mut count, mut squares, mut root_squares) = (0.0, 0.0, 0.0);
        for (place, spectrum) in spectra.iter().enumerate() {
            assert_eq!(spectrum["fitted"], place % 2 != 0, "the first, the third and so on are held out");
            let list = |key: &str| spectrum[key].as_array().unwrap().iter().map(number).collect::<Vec<_>>();
            for (model, measured) in list("model").iter().zip(list("measured")).filter(|_| place % 2 == 0) {
                count += 1.0;
                squares += (model - measured).powi(2);
                root_squares += (model.cbrt() - measured.cbrt()).powi(2);
            }
        }
        let found = &row["held_out"];
        assert!((number(&found["readings"]) - count).abs() < 0.5);
        for (key, sum) in [("rms", squares), ("rms_of_cube_roots", root_squares)] {
            let expected = f64::sqrt(sum / count);
            assert!((number(&found[key]) / expected - 1.0).abs() < 1e-12, "{key}: {found}, expected {expected}");
        }
        // Hurvich and Tsai's formula, σ being one parameter more.
        let goodness = &case["fit"]["goodness"];
        let (n, k) = (number(&result["comparison"]["effective_readings"]), number(&goodness["free_parameters"]) + 1.0);
        let misfit = number(&goodness["chi_squared"]) / number(&goodness["readings"]);
        let aicc = n * misfit.ln() + 2.0 * k * n / (n - k - 1.0);
        assert!((number(&row["aicc"]) - aicc).abs() < 1e-9 * aicc.abs(), "{row}, expected {aicc}");
    }
    let page = desk.read("found/index.html");
    assert!(page.contains("cube roots<br>held out") && page.contains("24 readings that no case was fitted to"));
    assert!(
        desk.path("found/plots/case-1-readings.png").is_file() && !desk.path("found/plots/case-1-spectra.png").exists()
    );
}

/// The fit sees the rows of the file whose index, from 0, three does not divide. The feather tells a third of what the next
/// best leaves untold, and the Lambertian surface, which knows no lobe, is worst.
#[test]
#[cfg_attr(not(barbule_data), ignore = "set BARBULE_DATA to the folder of measurements")]
fn a_peacock_feather_is_predicted_best_by_a_feather() {
    let desk = Desk::empty();
    desk.barbule(&format!("fit {} --out peacock", shipped("peacock-curet")))
        .succeeds()
        .prints("feather predicts the 46");
    let result = desk.result("peacock");
    let table = fs::read_to_string(data_file("gonio/peacock_feather_curet.csv")).unwrap();
    let cases = result["cases"].as_array().unwrap();
    for (index, line) in table.lines().skip(1).enumerate() {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        for case in cases {
            let spectrum = &case["data"]["spectra"]["spectra"][index];
            assert_eq!(spectrum["fitted"], index % 3 != 0);
            let angles =
                ["theta_i_deg", "phi_i_deg", "theta_o_deg", "phi_o_deg"].map(|key| number(&spectrum["geometry"][key]));
            assert_eq!((&angles[..], number(&spectrum["measured"][0])), (&cells[1..5], cells[5]));
        }
    }
    let roots = |name: &str| {
        let rows = result["comparison"]["rows"].as_array().unwrap();
        let row = rows.iter().find(|row| row["case"] == name).unwrap();
        (number(&row["held_out"]["rms_of_cube_roots"]), number(&row["aicc"]))
    };
    let (feather, plastic, lambertian) = (roots("feather"), roots("rough plastic"), roots("Lambertian"));
    assert!(feather.0 < 0.8 * plastic.0 && feather.1 < plastic.1 - 20.0, "{feather:?} {plastic:?}");
    assert!(plastic.0 < 0.6 * lambertian.0, "{plastic:?} {lambertian:?}");
}
