//! The few functions of statistics that an uncertainty needs.

use statrs::distribution::{ContinuousCDF, StudentsT};

/// 97.5 % quantile of the normal distribution (Abramowitz & Stegun 1964, table 26.1).
const NORMAL_975: f64 = 1.959_963_984_540_054;

/// Half the width of a central 95 % interval in standard errors: Student's where σ is estimated with these degrees of
/// freedom, the normal one where it is known.
pub(super) fn central_95(estimated_with: Option<f64>) -> f64 {
    let student = estimated_with.and_then(|freedom| StudentsT::new(0.0, 1.0, freedom).ok());
    student.map_or(NORMAL_975, |student| student.inverse_cdf(0.975))
}

/// ln of exp(x²)·erfc(x) for x ≥ 0.
pub(super) fn ln_erfcx(x: f64) -> f64 {
    if x < 20.0 {
        return x * x + libm::erfc(x).ln();
    }
    // Abramowitz & Stegun 1964, 7.1.23, three terms: the next is below 1e-9 from here on.
    let inverse = 0.5 / (x * x);
    (1.0 - inverse * (1.0 - 3.0 * inverse * (1.0 - 5.0 * inverse))).ln() - (x * std::f64::consts::PI.sqrt()).ln()
}

/// 95 % quantile of the density ∝ exp(−slope·x − x²/(2·width²)) on x ≥ 0: how far from its bound a parameter may be whose
/// likelihood still rises towards it.
pub(super) fn one_sided_95(slope: f64, width: f64) -> f64 {
    // The share above x is exp(−s·x − x²/2w²) erfcx(z + x/(w√2)) / erfcx(z), z = s·w/√2, which falls from 1 to 0.
    let root = width * std::f64::consts::SQRT_2;
    let z = slope.max(0.0) * root / 2.0;
    let ln_above = |x: f64| {
        let u = x / root;
        -2.0 * z * u - u * u + ln_erfcx(z + u) - ln_erfcx(z)
    };
    let (mut low, mut high) = (0.0, 8.0 * width);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if ln_above(middle) > 0.05_f64.ln() {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

/// How many independent residuals carry the information of these, by the correlation of each with the next one: N (1 − r)/
/// (1 + r), at least 1. Within two standard errors of zero the correlation is taken as none.
pub fn effective_readings(residuals: &[f64]) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "numbers of readings are far below 2^53")]
    let count = residuals.len() as f64;
    let correlation = lag_one(residuals);
    let significant = correlation > 2.0 / count.sqrt();
    if significant { count * (1.0 - correlation) / (1.0 + correlation) } else { count }.max(1.0)
}

/// Correlation of each value with the next one.
fn lag_one(values: &[f64]) -> f64 {
    let square: f64 = values.iter().map(|r| r * r).sum();
    let product: f64 = values.windows(2).map(|pair| pair[0] * pair[1]).sum();
    if square > 0.0 { product / square } else { 0.0 }
}
