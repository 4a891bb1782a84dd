//! Measured tables end to end: a film whose order can be checked, a control without a film, and a feather that one film
//! cannot explain.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use barbule::fit::Control;
use barbule::job::{self, Case, CaseData, Job};

fn main_case(name: &str) -> Case {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fits").join(name);
    let job = Job::read(&folder).unwrap();
    let outcome =
        job::run(&job, &Control { interrupt: &AtomicBool::new(false), progress: &|_, _| (), checkpoint: None })
            .unwrap();
    outcome.cases.into_iter().next().unwrap()
}

fn value(case: &Case, name: &str) -> f64 {
    case.fit.estimates.iter().find(|estimate| estimate.name == name).unwrap().value
}

/// At θi 50°, θo 32.86° on the mirror side the table's own maxima near 442 and 670 nm are neighbouring orders, which gives
/// a path 2 n d cosθt of 1/(1/442 − 1/670) = 1299 nm whatever the model; 5 % is what reading two broad maxima allows.
#[test]
#[cfg_attr(not(barbule_data), ignore = "set BARBULE_DATA to the folder of measurements")]
fn a_flake_has_the_order_that_its_maxima_give() {
    let case = main_case("mystique-paint");
    let support = case.support.as_ref().unwrap();
    assert!(support.supported, "{}", support.text);
    // The flake's normal is the half-vector inside the coat; light meets it at half the angle between the two rays.
    let inside = |theta_deg: f64| (theta_deg.to_radians().sin() / 1.5).asin();
    let tilt = 0.5 * (inside(50.0) + inside(32.86));
    let sine = 1.5 * tilt.sin() / 1.38;
    let path_nm = 2.0 * 1.38 * value(&case, "spacer.thickness_nm") * (1.0 - sine * sine).sqrt();
    assert!((path_nm / 1299.0 - 1.0).abs() < 0.05, "path {path_nm} nm");
}

#[test]
#[cfg_attr(not(barbule_data), ignore = "set BARBULE_DATA to the folder of measurements")]
fn no_film_is_found_in_a_pigment_paint() {
    let case = main_case("garnet-red");
    let support = case.support.as_ref().unwrap();
    assert!(!support.supported, "{}", support.text);
    assert!(case.answer.contains("do not support a film"), "{}", case.answer);
}

/// The reading at the peak falls from 64 % to 3.5 % over the angles, which no flat film does: with one gain for all, the
/// misfit must be plain, and with a gain for each spectrum the gains must show it.
#[test]
#[cfg_attr(not(barbule_data), ignore = "set BARBULE_DATA to the folder of measurements")]
fn one_film_misfits_the_teal_and_says_so() {
    let case = main_case("teal-table");
    assert!(value(&case, "gain.teal-01") > 5.0 * value(&case, "gain.teal-12"));
    let CaseData::Spectra { spectra, .. } = &case.data else { panic!("the table holds spectra") };
    let (mut squares, mut total) = (0.0, 0.0);
    for spectrum in spectra {
        for (measured, model) in spectrum.measured.iter().zip(&spectrum.model) {
            squares += (measured - model).powi(2);
            total += measured * measured;
        }
    }
    let misfit = (squares / total).sqrt();
    assert!(misfit > 0.1, "a film of constant index cannot follow the whole spectrum: {misfit}");
    assert!(case.answer.contains("Neighbouring residuals err together"), "{}", case.answer);
}
