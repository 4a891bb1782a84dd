//! Whole jobs, from the table to the answer.

use std::fs;

use serde_json::Value;

use super::desk::{Desk, film_with, replaced, shipped};

/// Free parameters of a case: name, value, standard error (NaN, which passes no comparison, where there is none).
fn free(case: &Value) -> Vec<(&str, f64, f64)> {
    let estimates = case["fit"]["estimates"].as_array().unwrap().iter();
    let free = estimates.filter(|estimate| estimate["role"] == "free");
    free.map(|e| (e["name"].as_str().unwrap(), number(&e["value"]), e["standard_error"].as_f64().unwrap_or(f64::NAN)))
        .collect()
}

fn estimate(case: &Value, name: &str) -> (f64, f64) {
    let (_, value, error) = free(case).into_iter().find(|(found, _, _)| *found == name).unwrap();
    (value, error)
}

#[track_caller]
fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("found {value} where a number was expected"))
}

/// Every free parameter lies within three standard errors of its truth: so does a right one in 997 of 1000 cases, and
/// the seeds are fixed.
#[track_caller]
fn assert_recovers(case: &Value, truth: &[(&str, f64)]) {
    let mut names: Vec<&str> = free(case).iter().map(|(name, _, _)| *name).collect();
    names.sort_unstable();
    let mut expected: Vec<&str> = truth.iter().map(|(name, _)| *name).collect();
    expected.sort_unstable();
    assert_eq!(names, expected);
    for (name, truth) in truth {
        let (value, error) = estimate(case, name);
        assert!((value - truth).abs() <= 3.0 * error, "{name}: found {value} ± {error}, made from {truth}");
    }
}

const DUCK: [(&str, f64); 4] =
    [("cortex.thickness_nm", 210.0), ("rods.thickness_nm", 105.0), ("spacing.thickness_nm", 80.0), ("gain", 0.05)];

#[test]
fn the_duck_is_found_and_named_synthetic_everywhere() {
    let desk = Desk::empty();
    desk.barbule(&format!("fit {} --out duck", shipped("duck-synthetic"))).succeeds().prints("Synthetic readings");
    let result = desk.result("duck");
    assert_recovers(&result["cases"][0], &DUCK);
    assert_eq!(result["synthetic"]["values"]["cortex.thickness_nm"], 210.0);
    assert!(result["answer"].as_str().unwrap().starts_with("Synthetic readings"));
    let page = desk.read("duck/index.html").to_lowercase();
    assert!(page.find("synthetic").is_some_and(|place| place < page.find("<body").unwrap() + 2000), "named at the top");
}

#[test]
fn a_simulated_table_is_fitted_back() {
    let desk = Desk::empty();
    let settings: Vec<String> = DUCK.iter().map(|(name, value)| format!("--set {name}={value}")).collect();
    let simulate = format!("simulate {} {} --out table.csv", shipped("duck-synthetic"), settings.join(" "));
    desk.barbule(&format!("{simulate} --noise 0.01 --seed 3")).succeeds();

    let job = fs::read_to_string(shipped("duck-synthetic/job.toml")).unwrap();
    let (before, rest) = job.split_once("[data.synthetic]").unwrap();
    let (_, after) = rest.split_once("[instrument]").unwrap();
    let data = "[data]\nfile = \"table.csv\"\n[data.layout.spectra]\nquantity = \"reflectance\"\nsigma = { column = \"sigma\" }\n\
                [data.layout.spectra.columns.long]\nwavelength = \"wavelength_nm\"\nvalue = \"reflectance\"\nid = \"id\"\n\
                angles = { four = { theta_i = \"theta_i_deg\", phi_i = \"phi_i_deg\", theta_o = \"theta_o_deg\", phi_o = \"phi_o_deg\" } }\n";
    let desk = desk.and("job.toml", format!("{before}{data}\n[instrument]{after}"));
    let run = desk.barbule("fit job.toml --out back").succeeds();
    assert!(!run.out.contains("Synthetic"), "this table could be anyone's:\n{}", run.out);
    assert_recovers(&desk.result("back")["cases"][0], &DUCK);

    // A job that `new` guesses for the table reads it as it is: σ, four angles and all.
    desk.barbule("new table.csv").succeeds().prints("barbule check table.toml");
    desk.barbule("check table.toml").succeeds().prints("6 of 6 spectra, 462 readings; σ known");
}

/// A name with a comma was written bare, and shifted the cells of its row.
#[test]
fn simulated_peaks_can_be_read_whatever_their_names() {
    let table = "id,angle,peak_nm\n\"teal, left\",15,560\n\"teal \"\"B\"\"\",30,548\n";
    let desk = Desk::with("peaks.csv", table);
    desk.barbule("new peaks.csv").succeeds();
    desk.barbule("simulate peaks.toml --noise 0.01 --seed 2 --out again.csv").succeeds();
    assert!(desk.read("again.csv").contains("\n\"teal, left\",15,0,15,180,"), "{}", desk.read("again.csv"));
    desk.barbule("new again.csv").succeeds();
    desk.barbule("check again.toml").succeeds().prints("2 of 2 peak wavelengths; σ known");
}

/// The fits without a film refused a tie to its thickness, after the fit with one had succeeded.
#[test]
fn a_tie_to_the_film_does_not_keep_it_from_being_judged() {
    let tied = film_with("upper = 800 }", "upper = 800 }\nroughness = \"0.0003 * film.thickness_nm\"");
    let desk = Desk::with("film.toml", tied);
    desk.barbule("fit film.toml --out film").succeeds();
    assert!(desk.result("film")["cases"][0]["support"]["supported"].is_boolean());
}

/// Materials were described at 500 nm: never beyond what is known of them, and not at all where a table ends before.
#[test]
fn a_material_is_described_where_it_is_used() {
    let red = film_with("[400, 700]", "[620, 700]");
    let red = replaced(&red, "\"bird_melanin\"", "{ name = \"own\", table = [[620, 1.7, 0.1], [700, 1.7, 0.1]] }");
    let desk = Desk::with("film.toml", red);
    desk.barbule("fit film.toml --out film").succeeds();
    let keratin = desk.result("film")["cases"][0]["model"]["materials"][0].clone();
    assert_eq!(keratin["name"], "keratin");
    assert!(keratin["text"].as_str().unwrap().contains("beyond it, an extrapolation"), "{keratin}");
}

#[test]
fn a_new_job_for_peaks_passes_its_check() {
    let peaks = fs::read_to_string(shipped("teal-peaks/peaks.csv")).unwrap();
    let desk = Desk::with("peaks.csv", peaks);
    desk.barbule("new peaks.csv").succeeds().prints("Wrote peaks.toml");
    assert!(desk.read("peaks.toml").contains("# guess"), "guesses are marked");
    desk.barbule("check peaks.toml").succeeds().prints("12 of 12 peak wavelengths");
    desk.barbule("new peaks.csv").complains(&["peaks.toml is there already", "--out"]);
}

#[test]
fn a_new_job_for_a_table_of_pavo_asks_for_its_angles() {
    let mut table = String::from("\"wl\",\"blue.1\",\"blue.2\"\n");
    for nm in (400..=700).step_by(10) {
        let x = f64::from(nm) / 50.0;
        table += &format!("{nm},{:.4},{:.4}\n", 20.0 + 5.0 * x.sin(), 18.0 + 5.0 * (x + 0.5).sin());
    }
    let desk = Desk::with("blue.csv", table);
    desk.barbule("new blue.csv").succeeds();
    desk.barbule("check blue.toml").succeeds().prints("2 specimens");
    let job = desk.read("blue.toml");
    assert!(job.contains("FILL IN") && job.contains("percent = true"), "{job}");
    let with_angles = replaced(&job, "angles = \"not_recorded\"", "angles = { mirror = [15, 40] }");
    let desk = desk.and("blue.toml", with_angles);
    desk.barbule("check blue.toml").succeeds().prints("2 of 2 spectra, 62 readings");
}

#[test]
fn the_peaks_of_a_teal_give_a_film_of_every_order() {
    let desk = Desk::empty();
    desk.barbule(&format!("fit {} --out teal", shipped("teal-peaks"))).succeeds();
    let result = desk.result("teal");
    assert_eq!(result["cases"].as_array().unwrap().len(), 4);
    let law = &result["cases"][0];

    // Fitted to the first nine angles, the law misses them by 0.6 nm at most, and n is about 1.72.
    let best = &law["fit"]["minima"][0];
    assert!(number(&best["rms"]) <= 0.6, "rms {} nm", best["rms"]);
    let (n, error) = estimate(law, "film.index");
    assert!((n - 1.72).abs() <= 0.02, "n = {n} ± {error}");

    // The law bends too little at grazing angles: the last three peaks lie below it.
    let peaks = law["data"]["peaks"]["peaks"].as_array().unwrap();
    let held_out: Vec<&Value> = peaks.iter().filter(|peak| peak["fitted"] == false).collect();
    assert_eq!(held_out.len(), 3);
    for (peak, expected_nm) in held_out.iter().zip([-2.0, -6.0, -11.0]) {
        let missed_nm = number(&peak["measured_nm"]) - number(&peak["model_nm"]);
        assert!((missed_nm - expected_nm).abs() <= 1.0, "{}: measured − model = {missed_nm} nm", peak["id"]);
    }

    // The order is not in the peaks. With m λ = 2 d √(n² − sin²θ), d is a multiple of the first order's.
    let orders = law["orders"].as_array().unwrap();
    let first_nm = number(&orders[0]["thickness_nm"]);
    let expected: Vec<usize> = (1..).take_while(|order| *order as f64 * first_nm < 1000.0).collect();
    assert_eq!(orders.len(), expected.len(), "{orders:#?}");
    for (order, m) in orders.iter().zip(expected) {
        let d_nm = number(&order["thickness_nm"]);
        assert!((d_nm / first_nm - m as f64).abs() < 1e-3, "order {m}: {d_nm} nm beside {first_nm} nm");
        assert!(number(&order["rms_nm"]) <= 0.6 && (number(&order["index"]) - n).abs() < 1e-3);
        assert!(law["answer"].as_str().unwrap().contains(&format!("{d_nm:.0}")), "{} names {d_nm:.0}", law["answer"]);
    }

    // A film in air turns the phase once: its orders are odd multiples of half a step, and its index is the same.
    let film = &result["cases"][2];
    assert!((estimate(film, "film.index").0 - n).abs() < 1e-3);
    for order in film["orders"].as_array().unwrap() {
        let halves = number(&order["thickness_nm"]) / (0.5 * first_nm);
        assert!((halves % 2.0 - 1.0).abs() < 1e-2, "{halves} half steps");
    }
}

#[test]
#[cfg_attr(not(barbule_data), ignore = "set BARBULE_DATA to the folder of measurements")]
fn a_long_and_a_wide_table_of_the_same_readings_give_the_same_film() {
    let desk = Desk::empty();
    for name in ["teal-table", "teal-wide"] {
        desk.barbule(&format!("fit {} --out {name}", shipped(name))).succeeds();
    }
    let (long, wide) = (desk.result("teal-table"), desk.result("teal-wide"));
    let (long, wide) = (&long["cases"][0], &wide["cases"][0]);
    for name in ["film.thickness_nm", "film.index"] {
        let (from_long, from_wide) = (estimate(long, name).0, estimate(wide, name).0);
        // The readings differ in their last digit at most; the minimum follows them.
        assert!((from_long / from_wide - 1.0).abs() < 1e-6, "{name}: {from_long} long, {from_wide} wide");
    }
    let cost = |case: &Value| number(&case["fit"]["minima"][0]["cost"]);
    assert!((cost(long) / cost(wide) - 1.0).abs() < 1e-6);
}
