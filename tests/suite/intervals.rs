//! 95 % intervals where the cost is no parabola, against closed forms of the profile.
#![expect(clippy::unwrap_used, reason = "a helper of a test fails by panicking")]

use std::sync::atomic::AtomicBool;

use barbule::fit::{Assignment, Bound, Control, Fit, Residuals, Role, Settings, fit};
use barbule::parameter::{Parameter, Spread};
use proptest::prelude::*;

/// 97.5 % quantile of the normal distribution.
const Q: f64 = 1.959_963_984_540_054;

/// A problem of known σ from its parameters' names and its rows.
struct Rows<'a> {
    parameters: Vec<Parameter>,
    count: usize,
    rows: &'a (dyn Fn(&[f64]) -> Vec<f64> + Sync),
}

impl Residuals for Rows<'_> {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn count(&self) -> usize {
        self.count
    }

    fn evaluate(&self, values: &[f64], residuals: &mut [f64]) {
        residuals.copy_from_slice(&(self.rows)(values));
    }

    fn sigma_known(&self) -> bool {
        true
    }
}

/// Fits rows from these starts inside these bounds.
fn fitted(free: &[(f64, f64, f64)], count: usize, rows: &(dyn Fn(&[f64]) -> Vec<f64> + Sync)) -> Fit {
    let parameter = |index: usize| Parameter {
        name: format!("p{index}"),
        symbol: String::new(),
        unit: "",
        default: 0.0,
        lower: f64::NEG_INFINITY,
        upper: f64::INFINITY,
        spread: Spread::Linear,
        scan_step: None,
        text: String::new(),
    };
    let parameters = (0..free.len()).map(parameter).collect();
    let role = |&(start, lower, upper)| Assignment { role: Role::Free { start, lower, upper }, prior: None };
    let control = Control { interrupt: &AtomicBool::new(false), progress: &|_, _| (), checkpoint: None };
    let settings = Settings { starts: 1, ..Settings::default() };
    fit(&Rows { parameters, count, rows }, &free.iter().map(role).collect::<Vec<_>>(), &settings, &control).unwrap()
}

/// At both ends of an interval the profile, known in closed form, must have risen by what 95 % ask for: its root by `Q`, to the
/// 2 % to which an end is looked for. At the lower bound it may have risen less.
fn assert_rises(fit: &Fit, index: usize, lower: f64, rise: impl Fn(f64) -> f64) {
    let estimate = &fit.estimates[index];
    let [low, high] = estimate.interval_95.unwrap();
    assert!(low < estimate.value && estimate.value < high, "{low} to {high} about {}", estimate.value);
    for end in [low, high] {
        let height = rise(end).max(0.0).sqrt();
        let near_enough = (height - Q).abs() <= 0.021 * Q || (end <= lower && height <= 1.021 * Q);
        assert!(near_enough, "{end} of {low} to {high} about {}: risen by the square of {height}", estimate.value);
    }
}

proptest! {
    /// One reading of exp(−k): every interval of exp(−k) is one of k, and that of the reading is known.
    #[test]
    fn an_interval_does_not_hang_on_how_a_parameter_is_written(reading in 0.2..0.9f64, share in 0.05..0.45f64) {
        let sigma = share * reading;
        let result = fitted(&[(1.0, 0.0, 50.0)], 1, &|k| vec![((-k[0]).exp() - reading) / sigma]);
        assert_rises(&result, 0, 0.0, |k| (((-k).exp() - reading) / sigma).powi(2));
    }

    /// A ratio of two readings: Fieller 1954, J. R. Statist. Soc. B 16, 175. The interval of y₁/y₂ is where
    /// (y₁ − a·y₂)² ≤ q²(σ₁² + a²σ₂²). At (0.70, σ₁ 0.14, σ₂ 0.33) the cost on the straight way to the Gaussian's upper end is
    /// a parabola's, and the interval reaches more than twice as far.
    #[test]
    fn a_ratio_has_fiellers_interval(first in 0.5..2.0f64, shares in (0.02..0.2f64, 0.02..0.4f64)) {
        let (second, sigmas) = (1.0, (shares.0 * first, shares.1));
        let result = fitted(&[(first * 1.05, -100.0, 100.0), (0.97, 0.01, 10.0)], 2, &|values| {
            vec![(values[0] * values[1] - first) / sigmas.0, (values[1] - second) / sigmas.1]
        });
        assert_rises(&result, 0, -100.0, |a| {
            (first - a * second).powi(2) / (sigmas.0.powi(2) + (a * sigmas.1).powi(2))
        });
    }
}

/// Two parameters that two readings tell apart poorly, one of them pushed against its bound: what the other one's interval
/// owes to that, by the closed form of the profile. Held on the bound, the other would be known to ± 0.190; it is known
/// so well only on the side to which the bound pushes.
#[test]
fn a_parameter_on_its_bound_widens_the_others_interval() {
    // a + b = 1 ± 0.1 and a − b/2 = 1.3 ± 0.4: b = −0.2 without its bound.
    let rows = |a: f64, b: f64| [(a + b - 1.0) / 0.1, (a - 0.5 * b - 1.3) / 0.4];
    let result = fitted(&[(0.5, -10.0, 10.0), (0.5, 0.0, 10.0)], 2, &|values| rows(values[0], values[1]).to_vec());
    assert_eq!(result.estimates[1].at_bound, Some(Bound::Lower));
    let profile = |a: f64| {
        // ∂/∂b of the sum of squares is 0 here.
        let b = ((1.0 - a) / 0.01 + 0.5 * (a - 1.3) / 0.16) / (1.0 / 0.01 + 0.25 / 0.16);
        rows(a, b.max(0.0)).iter().map(|row| row * row).sum::<f64>()
    };
    let (value, least) = (result.estimates[0].value, result.minima[0].cost);
    let end = |far: f64| {
        let (mut near, mut far) = (value, far);
        for _ in 0..100 {
            let middle = 0.5 * (near + far);
            if profile(middle) - least < Q * Q { near = middle } else { far = middle }
        }
        near
    };
    let expected = [end(-5.0), end(5.0)];
    assert!(value - expected[0] > 1.5 * (expected[1] - value), "{expected:?}");
    assert_rises(&result, 0, -10.0, |a| profile(a) - least);
}
