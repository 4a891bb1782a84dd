//! Real plumage: the jobs on plain spectra that come with the project. Each bird is predicted from the others, beside what needs
//! no model: the mean spectrum of the others and the spread between birds.

use serde_json::Value;

use super::desk::{Desk, shipped};

fn cases(job: &str) -> Vec<Value> {
    let desk = Desk::empty();
    desk.barbule(&format!("fit {} --out report", shipped(job))).succeeds();
    desk.result("report")["cases"].as_array().unwrap().clone()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("found {value} where a number was expected"))
}

/// Every specimen's own fit misses less than `own`, and a left-out one is missed by at most `excess` times what the mean
/// spectrum of the others misses it by. The mean is hard to beat: a model with the very shape of the birds and their common
/// parameters equals it. Prints the numbers.
fn assert_predicts(job: &str, specimens: usize, own: f64, excess: f64) {
    for case in cases(job) {
        let population = &case["population"];
        let left_out = &population["left_out"];
        let [model, mean, spread] = ["model", "mean", "spread"].map(|key| number(&left_out[key]));
        let all = population["specimens"].as_array().unwrap();
        let worst = all.iter().map(|one| number(&one["rms"])).fold(0.0, f64::max);
        println!(
            "{job} {}: model {model:.4}, mean of the others {mean:.4}, spread {spread:.4}, σ {}, own fits up to {worst:.4}",
            case["name"], left_out["sigma"]
        );
        assert_eq!(all.len(), specimens, "{job} {}", case["name"]);
        assert!(worst < own, "{job} {}: own fits miss by up to {worst}", case["name"]);
        assert!(model < excess * mean, "{job} {}: {model} against {mean}", case["name"]);
        // The mean of k others is off by √(1 + 1/k) of the spread, and by no less than the spread without its own.
        assert!((0.9..1.3).contains(&(mean / spread)), "{job} {}: {mean} {spread}", case["name"]);
    }
}

#[test]
#[cfg_attr(not(barbule_data), ignore = "set BARBULE_DATA to the folder of measurements")]
fn yellow_finches_are_predicted_from_each_other() {
    assert_predicts("sicalis-yellow", 7, 0.008, 1.1);
}

/// A green parrot needs the sponge: its peak lies in the green, and without the yellow a left-out bird is predicted worse.
#[test]
#[cfg_attr(not(barbule_data), ignore = "set BARBULE_DATA to the folder of measurements")]
fn green_parakeets_are_predicted_from_each_other() {
    assert_predicts("parakeet-green", 13, 0.01, 1.25);
}

#[test]
#[ignore = "long: run by .ci/long"]
fn cardinals_jacanas_and_orioles_are_predicted_from_each_other() {
    assert_predicts("cardinal-red", 12, 0.015, 1.15);
    assert_predicts("oriole-orange", 9, 0.017, 1.1);
    assert_predicts("jacana-yellow", 9, 0.01, 1.1);
}

/// One film follows a starling's fringe and not its whole shape; what is asked is that each place of eight birds has one
/// optical path, and that the fit says which others the spectra allow.
#[test]
#[ignore = "long: run by .ci/long"]
fn starlings_have_an_optical_path_by_place() {
    let cases = cases("starling-iridescence");
    assert_eq!(cases.len(), 22);
    for case in &cases {
        let population = &case["population"];
        let path = &population["parameters"][0];
        assert_eq!(path["name"], "optical_path_nm");
        let effects = &path["effects"];
        println!(
            "{}: {} of 8, {:.0} ± {:.0} nm, between birds {:.0} nm; minima {}",
            case["name"],
            path["count"],
            number(&effects["mean"]),
            number(&effects["mean_standard_error"]),
            number(&effects["between"]),
            case["fit"]["minima"].as_array().unwrap().len()
        );
        assert_eq!(population["specimens"].as_array().unwrap().len(), 8);
        assert!(case["fit"]["minima"].as_array().unwrap().len() > 1, "a fringe without an order has twins");
    }
}
