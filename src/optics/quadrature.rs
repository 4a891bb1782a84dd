//! The rule by which integrals over directions are taken.

/// Nodes and weights on [0, 1], by Newton's method on the Legendre polynomial (Abramowitz & Stegun 1964, 25.4.30).
pub(crate) fn gauss_legendre(count: usize) -> Vec<(f64, f64)> {
    let n = as_f64(count);
    (0..count)
        .map(|index| {
            let mut x = (std::f64::consts::PI * (as_f64(index) + 0.75) / (n + 0.5)).cos();
            let mut slope = 1.0;
            // Newton from this start converges quadratically: eight steps are past double precision for any count.
            for _ in 0..8 {
                let (mut previous, mut value) = (1.0, x);
                for degree in 2..=count {
                    let k = as_f64(degree);
                    (previous, value) = (value, ((2.0 * k - 1.0) * x * value - (k - 1.0) * previous) / k);
                }
                slope = n * (x * value - previous) / (x * x - 1.0);
                x -= value / slope;
            }
            (0.5 * (1.0 + x), 1.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

#[expect(clippy::cast_precision_loss, reason = "numbers of nodes are far below 2^53")]
fn as_f64(count: usize) -> f64 {
    count as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gauss_legendre_is_exact_for_its_degree() {
        for count in 1..=8 {
            let power = 2 * i32::try_from(count).unwrap() - 1;
            let sum: f64 = gauss_legendre(count).iter().map(|(x, weight)| weight * x.powi(power)).sum();
            approx::assert_relative_eq!(sum, 1.0 / f64::from(power + 1), max_relative = 1e-14);
        }
    }
}
