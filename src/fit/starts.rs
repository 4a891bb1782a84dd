//! Where solvers begin: the job's own start, then a low-discrepancy sequence over the box.

use super::mapping::{FreeParameter, Mapping};
use crate::parameter::Spread;

/// The job's start and `count − 1` points of a scrambled Sobol sequence (Burley 2020).
pub(super) fn spread(mapping: &Mapping, count: usize, seed: u64) -> Vec<Vec<f64>> {
    // Both halves of the seed take part.
    let seed = u32::try_from((seed ^ (seed >> 32)) & u64::from(u32::MAX)).unwrap_or(0);
    let others = (0..).take(count.saturating_sub(1)).map(|item: u32| {
        let coordinate = |(dimension, parameter): (u32, &FreeParameter)| {
            // The sequence has 256 dimensions and 65,536 points; beyond those another scramble begins.
            let scramble = seed.wrapping_add(dimension / 256).wrapping_add((item >> 16).wrapping_mul(0x9E37_79B9));
            place(parameter, f64::from(sobol_burley::sample(item & 0xFFFF, dimension % 256, scramble)))
        };
        (0..).zip(&mapping.free).map(coordinate).collect()
    });
    std::iter::once(mapping.start()).chain(others).collect()
}

/// The value at share `unit` of the range in which a parameter's starts lie.
fn place(parameter: &FreeParameter, unit: f64) -> f64 {
    let (lower, upper) = range(parameter);
    let value = match parameter.spread {
        Spread::Linear => lower + unit * (upper - lower),
        Spread::Logarithmic => (lower.ln() + unit * (upper.ln() - lower.ln())).exp(),
    };
    value.clamp(parameter.lower, parameter.upper)
}

/// The bounds, or where they are infinite some sizes around the start.
pub(super) fn range(parameter: &FreeParameter) -> (f64, f64) {
    let reach = 10.0 * parameter.scale;
    let lower = if parameter.lower.is_finite() { parameter.lower } else { parameter.start - reach };
    let upper = if parameter.upper.is_finite() { parameter.upper } else { parameter.start.max(lower) + reach };
    (lower, upper)
}
