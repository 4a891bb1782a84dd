//! Which of the solvers' ends are one minimum, and how much each minimum weighs.
//!
//! Two ends are one minimum where they differ by less than one standard error: ‖J·Δ‖/σ < 1 with the Jacobian of the
//! better one. Neither units nor correlations matter to that measure.
//!
//! The weight is Laplace's approximation to the posterior mass of a minimum. With σ known, exp(−χ²/2) around a minimum is
//! a Gaussian of covariance C = (JᵀJ)⁻¹ and its mass is exp(−χ²/2)·(2π)^{p/2}·√det C; priors are rows of χ². With σ
//! unknown and its logarithm as likely anywhere as elsewhere (Jeffreys), integrating over σ leaves RSS^{−N/2}, whose own
//! Gaussian has C = (RSS/N)(JᵀJ)⁻¹ since ∂²(N/2 · ln RSS) = (N/RSS)·(Jᵀ·J). N is then the effective number of readings
//! of the best minimum where their correlation is significant: neighbouring readings that err together are not as many
//! witnesses. Where a width exceeds the box it is cut there. A parameter on a bound contributes the mass of the density
//! that falls from the bound inwards, exp(−g·x − h·x²/2), in place of a Gaussian's √(2π/h): half of it where the gradient g
//! vanishes, and next to nothing where it is steep.

use super::curvature::Curvature;
use super::outcome::StopReason;
use super::statistics::ln_erfcx;

/// A distinct minimum on the way to the result.
#[derive(Debug, Clone)]
pub(super) struct Found {
    pub(super) free: Vec<f64>,
    pub(super) cost: f64,
    pub(super) stop: StopReason,
    pub(super) hits: usize,
    pub(super) path: Vec<Vec<f64>>,
    pub(super) curvature: Option<Curvature>,
}

/// Whether `other` lies within one standard error of the minimum at `free` with this curvature and σ.
pub(super) fn same(free: &[f64], curvature: Option<&Curvature>, sigma: f64, other: &[f64]) -> bool {
    let close = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-6 * a.abs().max(b.abs());
    if free.iter().zip(other).all(close) {
        return true;
    }
    let Some(curvature) = curvature else { return false };
    let change: Vec<f64> = other.iter().zip(free).map(|(b, a)| b - a).collect();
    let moved = &curvature.triangle * nalgebra::DVector::from_vec(change);
    moved.norm() < sigma
}

/// How weights are made: what σ is, and what the readings count for.
#[derive(Debug, Clone, Copy)]
pub(super) enum Likelihood {
    /// σ is known.
    Known,
    /// σ is unknown; the effective number of readings.
    Unknown {
        /// Effective number of readings.
        readings: f64,
        /// Sums of squares below this are rounding.
        floor: f64,
    },
}

/// ln of the weight of a minimum under an even prior, up to a constant that all share.
pub(super) fn ln_weight(cost: f64, curvature: &Curvature, ranges: &[f64], likelihood: Likelihood) -> f64 {
    let (ln_height, sigma) = match likelihood {
        Likelihood::Known => (-0.5 * cost, 1.0),
        Likelihood::Unknown { readings, floor } => {
            let cost = cost.max(floor);
            (-0.5 * readings * cost.ln(), (cost / readings).sqrt())
        }
    };
    let inner: Vec<f64> = curvature.inner.iter().map(|&j| ranges[j]).collect();
    let volume = curvature.inverse(&curvature.inner).half_ln_det(sigma, &inner);
    let edges = (0..ranges.len()).filter(|&j| curvature.at_bound[j].is_some()).map(|j| {
        let length = curvature.triangle.column(j).norm() / sigma;
        let slope = curvature.gradient[j].abs() / (sigma * sigma);
        if length > 0.0 {
            ln_erfcx(slope / (length * std::f64::consts::SQRT_2)) - (2.0 * length).ln()
        } else if ranges[j].is_finite() {
            // Without any effect its mass is the width of its range.
            (ranges[j] / (2.0 * std::f64::consts::PI).sqrt()).ln()
        } else {
            0.0
        }
    });
    ln_height + volume + edges.sum::<f64>()
}

/// Weights from their logarithms, summing to 1 without overflow. What has no finite logarithm weighs nothing.
pub(super) fn normalised(ln_weights: &[f64]) -> Vec<f64> {
    let largest = ln_weights.iter().copied().filter(|w| w.is_finite()).fold(f64::NEG_INFINITY, f64::max);
    if largest == f64::NEG_INFINITY {
        return vec![0.0; ln_weights.len()];
    }
    let shares: Vec<f64> = ln_weights.iter().map(|w| if w.is_finite() { (w - largest).exp() } else { 0.0 }).collect();
    let sum: f64 = shares.iter().sum();
    shares.into_iter().map(|share| share / sum).collect()
}
