//! Slopes and Sobol indices against functions whose answers are known in closed form.

use std::f64::consts::PI;

use barbule::sensitivity::{DerivativeError, Estimate, Indices, Range, Side, SobolSettings, derivative, sobol_indices};
use proptest::prelude::*;

/// A name, a function, and two numbers that are known of it.
type Known = (&'static str, fn(f64) -> f64, f64, f64);

/// The only output, as a group.
fn alone() -> Vec<std::ops::Range<usize>> {
    std::iter::once(0..1).collect()
}

/// The function as one that never fails.
fn sure(function: impl Fn(f64) -> f64) -> impl Fn(f64) -> Result<Vec<f64>, String> {
    move |x| Ok(vec![function(x)])
}

#[test]
fn slopes_of_known_functions() {
    let wide = Range { lower: -10.0, upper: 10.0, size: 1.0 };
    let cases: [Known; 5] = [
        ("exp", f64::exp, 1.0, 1f64.exp()),
        ("sin 20x", |x| (20.0 * x).sin(), 0.3, 20.0 * 6f64.cos()),
        ("1/(1 + x²)", |x| 1.0 / (1.0 + x * x), 0.5, -0.64),
        ("a constant", |_| 3.0, 0.5, 0.0),
        ("a line", |x| 2.0 * x - 7.0, 3.5, 2.0),
    ];
    for (name, function, at, expected) in cases {
        let found = derivative(sure(function), at, wide).unwrap();
        let (off, error) = ((found.slopes[0] - expected).abs(), found.errors[0]);
        assert_eq!((found.side, found.kinks[0]), (Side::Both, false), "{name}");
        // The error is an estimate; and it is small where the function is smooth on the scale of its parameter.
        assert!(off <= 10.0 * error + 1e-13, "{name}: off by {off:e}, said to be {error:e}");
        assert!(error <= 1e-8 * (1.0 + expected.abs()), "{name}: error {error:e}");
    }
}

/// What a clamped parameter does: no step may leave the range, and the slope is that of the side that is there.
#[test]
fn at_an_end_of_the_range_differences_go_inwards() {
    let range = Range { lower: 0.0, upper: 1.0, size: 1.0 };
    let inside = |x: f64| {
        assert!((0.0..=1.0).contains(&x), "asked for {x}");
        Ok::<_, String>(vec![(2.0 * x).exp()])
    };
    for (at, side, expected) in [(0.0, Side::Above, 2.0), (1.0, Side::Below, 2.0 * 2f64.exp())] {
        let found = derivative(inside, at, range).unwrap();
        assert_eq!(found.side, side);
        let off = (found.slopes[0] - expected).abs();
        assert!(off <= 10.0 * found.errors[0] && off < 1e-8 * expected, "{off:e}, said to be {:e}", found.errors[0]);
    }
}

/// Differences to both sides of |x| at 0 are 0 at every step, which no extrapolation can see to be wrong.
#[test]
fn a_kink_is_seen_and_its_error_reaches_over_both_slopes() {
    let range = Range { lower: -1.0, upper: 1.0, size: 1.0 };
    let cases: [Known; 3] = [
        ("|x|", f64::abs, 0.0, 1.0),
        ("max(x, 0)", |x| x.max(0.0), 0.5, 0.5),
        ("sines of two slopes", |x| if x > 0.0 { x.sin() } else { 3.0 * x.sin() }, 2.0, 1.0),
    ];
    for (name, function, mean, half_gap) in cases {
        let found = derivative(sure(function), 0.0, range).unwrap();
        assert!(found.kinks[0], "{name}");
        approx::assert_abs_diff_eq!(found.slopes[0], mean, epsilon = 1e-9); // extrapolated sines
        approx::assert_abs_diff_eq!(found.errors[0], half_gap, epsilon = 1e-9);
    }
}

#[test]
fn where_there_is_no_slope_there_is_an_error() {
    let empty = Range { lower: 2.0, upper: 2.0, size: 2.0 };
    assert!(matches!(derivative(sure(f64::exp), 2.0, empty), Err(DerivativeError::NoRoom { .. })));
    let range = Range { lower: 0.0, upper: 1.0, size: 1.0 };
    let refuses = |x: f64| if x > 0.52 { Err("too much".to_owned()) } else { Ok(vec![x]) };
    assert_eq!(derivative(refuses, 0.5, range), Err(DerivativeError::Function("too much".to_owned())));
}

proptest! {
    /// Sums of fringes, as spectra over thickness are: the slope is right within ten times the error that it is said to
    /// have, and that error is small beside the slope that the fringes can have.
    #[test]
    fn slopes_of_fringes(
        fringes in prop::collection::vec((0.1..1.0f64, 1.0..30.0f64, 0.0..6.3f64), 1..5),
        at in 0.5..2.0f64,
    ) {
        let function = |x: f64| fringes.iter().map(|(size, rate, phase)| size * (rate * x + phase).sin()).sum::<f64>();
        let exact: f64 = fringes.iter().map(|(size, rate, phase)| size * rate * (rate * at + phase).cos()).sum();
        let steepest: f64 = fringes.iter().map(|(size, rate, _)| size * rate).sum();
        let found = derivative(sure(function), at, Range { lower: 0.0, upper: 5.0, size: at }).unwrap();
        prop_assert!(!found.kinks[0]);
        let off = (found.slopes[0] - exact).abs();
        // Sines of arguments up to 60 are good to about 1e-14, which differences over steps of 1e-3 turn into 1e-11.
        prop_assert!(off <= 10.0 * found.errors[0] + 1e-11 * steepest, "off by {off:e}, said {:e}", found.errors[0]);
        prop_assert!(found.errors[0] <= 1e-7 * steepest, "{:e}", found.errors[0]);
    }
}

const A: f64 = 7.0;
const B: f64 = 0.1;

/// The function of Ishigami and Homma (1990) on the unit cube.
fn ishigami(point: &[f64]) -> Result<Vec<f64>, String> {
    let [x, y, z] = [point[0], point[1], point[2]].map(|share| PI * (2.0 * share - 1.0));
    Ok(vec![x.sin() + A * y.sin().powi(2) + B * z.powi(4) * x.sin()])
}

/// First-order and total indices of Ishigami's function, from its variance's parts (Saltelli et al. 2008, Global
/// Sensitivity Analysis, section 4.6).
fn ishigami_truth() -> ([f64; 3], [f64; 3]) {
    let first = 0.5 * (1.0 + B * PI.powi(4) / 5.0).powi(2);
    let second = A * A / 8.0;
    let first_and_third = 8.0 * B * B * PI.powi(8) / 225.0;
    let whole = first + second + first_and_third;
    (
        [first, second, 0.0].map(|part| part / whole),
        [first + first_and_third, second, first_and_third].map(|part| part / whole),
    )
}

#[track_caller]
fn assert_within(found: Estimate, expected: f64, most_error: f64, what: &str) {
    let Estimate { value, standard_error } = found;
    // Four standard errors: beyond them a right estimate falls once in 16,000 times, and the seeds are fixed.
    assert!(
        (value - expected).abs() <= 4.0 * standard_error,
        "{what}: {value} ± {standard_error}, expected {expected}"
    );
    assert!(standard_error <= most_error, "{what}: error {standard_error}, expected at most {most_error}");
}

#[test]
fn indices_of_ishigamis_function() {
    let (first_order, total) = ishigami_truth();
    // The values that papers print.
    for (found, printed) in first_order.iter().chain(&total).zip([0.3139, 0.4424, 0.0, 0.5576, 0.4424, 0.2437]) {
        approx::assert_abs_diff_eq!(*found, printed, epsilon = 5e-5); // four decimals
    }
    let settings = SobolSettings { samples: 4096, replicates: 16, seed: 20_261_126 };
    let shares = sobol_indices(3, 1, &alone(), settings, ishigami).unwrap().remove(0);
    // Mean a/2, variance as above.
    approx::assert_abs_diff_eq!(shares.mean, 3.5, epsilon = 1e-2);
    let variance = A * A / 8.0 + B * PI.powi(4) / 5.0 + B * B * PI.powi(8) / 18.0 + 0.5;
    approx::assert_relative_eq!(shares.standard_deviation, variance.sqrt(), max_relative = 1e-2);
    for (input, indices) in shares.indices.unwrap().into_iter().enumerate() {
        assert_within(indices.first_order, first_order[input], 5e-3, &format!("first order of {input}"));
        assert_within(indices.total, total[input], 5e-3, &format!("total of {input}"));
    }
}

/// Sobol's g function, a product of four factors of falling importance (Sobol 1993; Saltelli et al. 2010, eq. 28).
#[test]
fn indices_of_a_product() {
    let importance = [0.0, 1.0, 4.5, 9.0];
    let function = |point: &[f64]| {
        let factors = point.iter().zip(importance).map(|(x, a)| ((4.0 * x - 2.0).abs() + a) / (1.0 + a));
        Ok::<_, String>(vec![factors.product()])
    };
    let parts = importance.map(|a: f64| 1.0 / (3.0 * (1.0 + a).powi(2)));
    let all: f64 = parts.iter().map(|part| 1.0 + part).product();
    let settings = SobolSettings { samples: 2048, replicates: 16, seed: 7 };
    let shares = sobol_indices(4, 1, &alone(), settings, function).unwrap().remove(0);
    for ((part, indices), what) in parts.iter().zip(shares.indices.unwrap()).zip(["1", "2", "3", "4"]) {
        assert_within(indices.first_order, part / (all - 1.0), 1e-2, what);
        assert_within(indices.total, part * (all / (1.0 + part)) / (all - 1.0), 1e-2, what);
    }
}

/// Two additive outputs together: `Σ V_i / Σ V`. Of 3x and y the variances are 9/12 and 1/12.
#[test]
fn indices_of_several_outputs_together() {
    let function = |point: &[f64]| Ok::<_, String>(vec![5.0, 3.0 * point[0], point[1]]);
    let settings = SobolSettings { samples: 256, replicates: 8, seed: 1 };
    let shares = sobol_indices(2, 3, &[1..3, 1..2, 0..1], settings, function).unwrap();
    for (indices, expected) in shares[0].indices.as_ref().unwrap().iter().zip([0.9, 0.1]) {
        // Of an additive function both are the same, up to what eight sequences of 256 points leave.
        approx::assert_abs_diff_eq!(indices.first_order.value, expected, epsilon = 2e-2);
        approx::assert_abs_diff_eq!(indices.total.value, expected, epsilon = 2e-2);
    }
    approx::assert_abs_diff_eq!(shares[1].indices.as_ref().unwrap()[1].total.value, 0.0, epsilon = 1e-12);
    assert_eq!((shares[2].mean, shares[2].standard_deviation, &shares[2].indices), (5.0, 0.0, &None));
}

/// How often truth lies within the 95 % interval of the error that is stated, for six indices and 200 seeds.
#[test]
fn errors_are_as_large_as_they_say() {
    let (first_order, total) = ishigami_truth();
    let (seeds, replicates) = (200, 16);
    let mut inside = [0; 6];
    for seed in 0..seeds {
        let settings = SobolSettings { samples: 64, replicates, seed };
        let shares = sobol_indices(3, 1, &alone(), settings, ishigami).unwrap().remove(0);
        for (input, Indices { first_order: first, total: all }) in shares.indices.unwrap().into_iter().enumerate() {
            for (place, estimate, truth) in [(input, first, first_order[input]), (input + 3, all, total[input])] {
                // Student's t of 15 degrees of freedom at 97.5 %.
                inside[place] += usize::from((estimate.value - truth).abs() <= 2.131 * estimate.standard_error);
            }
        }
    }
    // 95 % of 200 are 190, give or take 3.1; the jackknife is asymptotic, so that four and a half of those are allowed below.
    assert!(inside.iter().all(|inside| (176..=200).contains(inside)), "{inside:?} of {seeds}");
}

#[test]
fn indices_do_not_depend_on_the_number_of_threads_but_on_the_seed() {
    let with = |threads: usize, seed: u64| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let settings = SobolSettings { samples: 128, replicates: 4, seed };
        pool.install(|| sobol_indices(3, 1, &alone(), settings, ishigami).unwrap())
    };
    assert_eq!(with(1, 5), with(3, 5));
    assert_ne!(with(1, 5), with(1, 6));
}

#[test]
fn a_function_that_refuses_a_point_says_so() {
    let settings = SobolSettings { samples: 16, replicates: 4, seed: 1 };
    let refuses = |point: &[f64]| if point[0] > 0.9 { Err("too much".to_owned()) } else { Ok(vec![point[0]]) };
    assert_eq!(sobol_indices(1, 1, &alone(), settings, refuses), Err("too much".to_owned()));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))] // each is 50,000 evaluations

    /// Of a sum of independent parts every index is that part's share of the variance, first order and total.
    #[test]
    fn indices_of_a_sum(weights in prop::collection::vec(0.1..5.0f64, 2..6), seed in 0..1000u64) {
        let function = |point: &[f64]| Ok::<_, String>(vec![point.iter().zip(&weights).map(|(x, w)| w * x).sum()]);
        let settings = SobolSettings { samples: 1024, replicates: 8, seed };
        let shares = sobol_indices(weights.len(), 1, &alone(), settings, function).unwrap().remove(0);
        let whole: f64 = weights.iter().map(|w| w * w).sum();
        for (weight, indices) in weights.iter().zip(shares.indices.unwrap()) {
            // Independent points would leave √(S/8192), a hundredth for S = 1; the sequence leaves less.
            prop_assert!((indices.first_order.value - weight * weight / whole).abs() < 2e-2);
            prop_assert!((indices.total.value - weight * weight / whole).abs() < 2e-2);
        }
    }
}
