//! Mean and spread over individuals against a published example, a closed form, and drawn populations.

use barbule::fit::{RandomEffects, random_effects};
use proptest::prelude::*;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Colditz et al. 1994, Efficacy of BCG vaccine in the prevention of tuberculosis (JAMA 271): tuberculosis and none among
/// the vaccinated, and among the others, in 13 trials.
const TRIALS: [[f64; 4]; 13] = [
    [4.0, 119.0, 11.0, 128.0],
    [6.0, 300.0, 29.0, 274.0],
    [3.0, 228.0, 11.0, 209.0],
    [62.0, 13_536.0, 248.0, 12_619.0],
    [33.0, 5_036.0, 47.0, 5_761.0],
    [180.0, 1_361.0, 372.0, 1_079.0],
    [8.0, 2_537.0, 10.0, 619.0],
    [505.0, 87_886.0, 499.0, 87_892.0],
    [29.0, 7_470.0, 45.0, 7_232.0],
    [17.0, 1_699.0, 65.0, 1_600.0],
    [186.0, 50_448.0, 141.0, 27_197.0],
    [5.0, 2_493.0, 3.0, 2_338.0],
    [27.0, 16_886.0, 29.0, 17_825.0],
];

#[track_caller]
fn assert_digits(found: f64, printed: f64) {
    // Four decimals are printed.
    assert!((found - printed).abs() < 5.5e-5, "found {found}, printed {printed}");
}

/// Logarithms of the relative risks: the standard example of the R package metafor (Viechtbauer 2010, Journal of
/// Statistical Software 36, 3), which prints these numbers for restricted maximum likelihood.
#[test]
fn the_vaccine_trials_are_as_published() {
    let estimates: Vec<[f64; 2]> = TRIALS
        .iter()
        .map(|[a, b, c, d]| {
            let logarithm = (a / (a + b) / (c / (c + d))).ln();
            [logarithm, (1.0 / a - 1.0 / (a + b) + 1.0 / c - 1.0 / (c + d)).sqrt()]
        })
        .collect();
    let (values, errors): (Vec<f64>, Vec<f64>) = estimates.iter().map(|[value, error]| (*value, *error)).unzip();
    let found = random_effects(&values, &errors).unwrap();
    assert_eq!(found.count, 13);
    assert_digits(found.mean, -0.7145);
    assert_digits(found.variance, 0.3132);
    assert_digits(found.variance_standard_error, 0.1664);
    assert_digits(found.q, 152.2330);
    assert_digits(found.variance_interval_95[0], 0.1197);
    assert_digits(found.variance_interval_95[1], 1.1115);
    // Knapp and Hartung's error of the mean, printed with `test = "knha"`.
    assert_digits(found.mean_standard_error, 0.1808);
}

/// Logarithms of the odds ratios of the same trials: the Q profile that van Houwelingen, Arends and Stijnen 2002 (Statistics
/// in Medicine 21, 589–624) are compared with on metafor's pages, 0.1302 to 1.1812.
#[test]
fn the_profile_of_q_is_as_published() {
    let values: Vec<f64> = TRIALS.iter().map(|[a, b, c, d]| (a * d / (b * c)).ln()).collect();
    let errors: Vec<f64> = TRIALS.iter().map(|t| t.iter().map(|count| 1.0 / count).sum::<f64>().sqrt()).collect();
    let [low, high] = random_effects(&values, &errors).unwrap().variance_interval_95;
    assert_digits(low, 0.1302);
    assert_digits(high, 1.1812);
}

/// With equal errors all has a closed form: τ² = s² − v, the mean's error √(s²/k) and its interval Student's.
#[test]
fn equal_errors_have_a_closed_form() {
    let values = [1.0, 2.0, 4.0, 7.0];
    let (mean, variance) = (3.5, 7.0); // sum of squares 21 over 3
    let RandomEffects { mean: found, variance: between, mean_standard_error: error, mean_interval_95, .. } =
        random_effects(&values, &[0.5; 4]).unwrap();
    assert!((found - mean).abs() < 1e-12);
    assert!((between - (variance - 0.25)).abs() < 1e-9, "{between}");
    assert!((error - (variance / 4.0_f64).sqrt()).abs() < 1e-9);
    // Student's 97.5 % quantile for three degrees of freedom is 3.182446 (Abramowitz & Stegun 1964, table 26.10).
    assert!((mean_interval_95[1] - mean - 3.182_446 * error).abs() < 1e-5);
    // Errors larger than the scatter leave nothing between individuals.
    let alike = random_effects(&values, &[5.0; 4]).unwrap();
    assert!(alike.variance.abs() < 1e-12 && alike.variance_interval_95[0].abs() < 1e-12);
    assert!((alike.mean_standard_error - 2.5).abs() < 1e-9, "Knapp and Hartung's factor is not below 1");
}

#[test]
fn what_is_no_sample_is_refused() {
    assert_eq!(random_effects(&[1.0], &[0.1]), None);
    assert_eq!(random_effects(&[1.0, 2.0], &[0.1]), None);
    assert_eq!(random_effects(&[1.0, 2.0], &[0.1, 0.0]), None);
    assert_eq!(random_effects(&[1.0, f64::NAN], &[0.1, 0.1]), None);
}

/// Populations of seven with unequal errors, mean 2 and τ = 0.5: both intervals hold their truth in 95 % of the cases. Of 1000,
/// 950 are expected, with a standard deviation of 6.9; five of them are allowed on the side of too few, since Knapp and
/// Hartung's interval errs towards too wide.
#[test]
fn intervals_hold_their_truth() {
    let (mut mean_held, mut variance_held) = (0, 0);
    for case in 0..1000 {
        let mut random = ChaCha8Rng::seed_from_u64(11);
        random.set_stream(case);
        let errors: Vec<f64> = (0..7).map(|k| 0.1 + 0.1 * f64::from(k)).collect();
        let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
        let values: Vec<f64> = errors.iter().map(|error| 2.0 + 0.5 * normal() + error * normal()).collect();
        let found = random_effects(&values, &errors).unwrap();
        let [low, high] = found.mean_interval_95;
        mean_held += i32::from(low <= 2.0 && 2.0 <= high);
        let [low, high] = found.variance_interval_95;
        variance_held += i32::from(low <= 0.25 && 0.25 <= high);
    }
    assert!(mean_held >= 915, "{mean_held} of 1000 means");
    assert!((915..=985).contains(&variance_held), "{variance_held} of 1000 variances");
}

proptest! {
    /// Moved and scaled values give the moved and scaled answer.
    #[test]
    fn units_do_not_matter(
        sample in prop::collection::vec((-3.0..3.0_f64, 0.05..2.0_f64), 3..12),
        shift in -10.0..10.0_f64,
        factor in 0.1..10.0_f64,
    ) {
        let (values, errors): (Vec<f64>, Vec<f64>) = sample.into_iter().unzip();
        let plain = random_effects(&values, &errors).unwrap();
        let moved: Vec<f64> = values.iter().map(|value| shift + factor * value).collect();
        let scaled: Vec<f64> = errors.iter().map(|error| factor * error).collect();
        let moved = random_effects(&moved, &scaled).unwrap();
        // Halving ends at neighbouring numbers, but a flat likelihood has its maximum to the root of rounding only.
        let size = 1e-6 * (plain.variance + plain.mean_standard_error.powi(2));
        prop_assert!((moved.variance / factor / factor - plain.variance).abs() <= size, "{} {}", moved.variance, plain.variance);
        prop_assert!(((moved.mean - shift) / factor - plain.mean).abs() < 1e-6);
        let [low, high] = plain.variance_interval_95;
        prop_assert!(low <= high);
        prop_assert!(plain.variance >= 0.0 && plain.mean_standard_error > 0.0);
    }
}
