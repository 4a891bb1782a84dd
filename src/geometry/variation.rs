//! Random variation of barbs, from a seed.
//!
//! Every barb of either vane has its own stream of random numbers, so that nothing hangs on the order in which barbs are
//! made, nor on how many there are.

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

use super::barb::Side;
use super::bezier::as_f64;
use super::file::VariationFile;

/// A root stays within its own share of the rachis, so that it never passes its neighbour.
const FARTHEST_ROOT: f64 = 0.45;

/// Standard deviations of the kernel beyond which its weight is below 4e-4 of its peak.
const KERNEL_REACH: f64 = 4.0;

/// How one barb differs from the plan.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Deviation {
    /// Shift of the root towards the tip, in spacings.
    pub(super) root: f64,
    /// Addition to the angle, degrees.
    pub(super) angle_deg: f64,
}

/// The deviations of a vane's barbs, whose roots are `spacing_mm` apart.
///
/// Angles are independent normal numbers of the barbs, smoothed by a Gaussian of standard deviation h along the rachis and
/// scaled to the standard deviation asked for: two barbs at a distance x then correlate by exp(−x²/4h²).
pub(super) fn deviations(plan: &VariationFile, side: Side, count: usize, spacing_mm: f64) -> Vec<Deviation> {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a reach is at most some thousand barbs"
    )]
    let reach = (KERNEL_REACH * plan.angle_reach_mm / spacing_mm).ceil() as usize;
    let kernel: Vec<f64> = (0..=2 * reach)
        .map(|index| {
            let distance = (as_f64(index) - as_f64(reach)) * spacing_mm;
            // Without a reach the only distance is 0.
            if reach == 0 { 1.0 } else { (-0.5 * (distance / plan.angle_reach_mm).powi(2)).exp() }
        })
        .collect();
    let scale = plan.angle_deg / kernel.iter().map(|weight| weight * weight).sum::<f64>().sqrt();

    // Barbs beyond both ends are drawn too, so that those at the ends vary as much as any.
    let drawn: Vec<[f64; 2]> = (0..count + 2 * reach)
        .map(|index| {
            let mut random = ChaCha8Rng::seed_from_u64(plan.seed);
            // Streams of barbs before the first wrap around to the far end of the numbers.
            let barb = (index as u64).wrapping_sub(reach as u64);
            random.set_stream(barb.wrapping_mul(2).wrapping_add(u64::from(side == Side::Right)));
            [random.sample(StandardNormal), random.sample(StandardNormal)]
        })
        .collect();
    (0..count)
        .map(|index| {
            let [root, _] = drawn[index + reach];
            let smooth: f64 = kernel.iter().zip(&drawn[index..]).map(|(weight, [_, angle])| weight * angle).sum();
            Deviation { root: (plan.root * root).clamp(-FARTHEST_ROOT, FARTHEST_ROOT), angle_deg: scale * smooth }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(angle_reach_mm: f64) -> VariationFile {
        VariationFile { seed: 5, root: 0.2, angle_deg: 2.0, angle_reach_mm }
    }

    /// Over some 40,000 barbs that reach over 4 each there are about 10⁴ independent numbers, so that a standard deviation is
    /// good to 1 % and a correlation to 0.01; the bars are four times as wide.
    #[test]
    fn angles_vary_and_correlate_as_documented() {
        for reach_mm in [0.0, 0.4] {
            let angles: Vec<f64> =
                deviations(&plan(reach_mm), Side::Left, 40_000, 0.2).iter().map(|d| d.angle_deg).collect();
            let mean_product = |lag: usize| {
                angles.iter().zip(&angles[lag..]).map(|(a, b)| a * b).sum::<f64>() / as_f64(angles.len() - lag)
            };
            approx::assert_relative_eq!(mean_product(0).sqrt(), 2.0, max_relative = 0.04);
            for lag in [1, 2, 4] {
                let distance = 0.2 * as_f64(lag);
                let expected = if reach_mm > 0.0 { (-0.25 * (distance / reach_mm).powi(2)).exp() } else { 0.0 };
                approx::assert_abs_diff_eq!(mean_product(lag) / mean_product(0), expected, epsilon = 0.04);
            }
        }
    }

    #[test]
    fn a_barb_keeps_its_numbers_whatever_else_there_is() {
        let few = deviations(&plan(0.4), Side::Right, 10, 0.2);
        let many = deviations(&plan(0.4), Side::Right, 100, 0.2);
        assert_eq!(few, many[..10]);
        assert_ne!(few, deviations(&plan(0.4), Side::Left, 10, 0.2));
        assert!(few.iter().all(|deviation| deviation.root.abs() <= FARTHEST_ROOT));
    }
}
