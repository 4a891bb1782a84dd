//! Numbers in [0, 1) for each sample of each pixel.
//!
//! They belong to the pixel: the same scene seed, pixel, sample and dimension give the same number on any thread. Sobol's
//! sequence (1967; Kuo and Joe's directions) with Owen's scrambling by hashing (Burley 2020) spreads the samples of a
//! pixel evenly over all that is drawn; pixels are scrambled apart. Independent numbers are the control against which its
//! gain is measured.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How the samples of a pixel are spread.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Sampler {
    /// Evenly: Sobol's sequence with Owen's scrambling. Samples in powers of two serve it best.
    #[default]
    Sobol,
    /// Each on its own.
    Independent,
}

/// Most samples of a pixel: as many as the sequence has.
pub(crate) const MOST_SAMPLES: u32 = 1 << 16;

/// Groups of four dimensions that stay spread evenly together; beyond them a new scrambling begins.
const GROUPS: u32 = sobol_burley::NUM_DIMENSION_SETS_4D;

/// The numbers of one sample of one pixel.
#[derive(Debug, Clone, Copy)]
pub(super) struct PixelSampler {
    sampler: Sampler,
    seed: u64,
    index: u32,
}

impl PixelSampler {
    /// For the sample `index` of the pixel with this number, in a picture with this seed.
    #[inline]
    pub(super) fn new(sampler: Sampler, scene_seed: u64, pixel: u64, index: u32) -> Self {
        Self { sampler, seed: mixed(scene_seed ^ mixed(pixel)), index }
    }

    /// Four numbers, those of this group of dimensions.
    #[inline]
    pub(super) fn four(&self, group: u32) -> [f64; 4] {
        match self.sampler {
            Sampler::Sobol => {
                let seed = (self.seed >> 32) as u32 ^ (group / GROUPS).wrapping_mul(0x9E37_79B9);
                sobol_burley::sample_4d(self.index, group % GROUPS, seed).map(f64::from)
            }
            Sampler::Independent => {
                let place = (u64::from(self.index) << 32) | u64::from(group);
                let state = mixed(self.seed ^ mixed(place));
                std::array::from_fn(|lane| unit(mixed(state.wrapping_add((lane as u64).wrapping_mul(GOLDEN)))))
            }
        }
    }
}

/// 2⁶⁴ over the golden ratio, the step of `SplitMix64` (Steele, Lea and Flood 2014).
const GOLDEN: u64 = 0x9E37_79B9_7F4A_7C15;

/// The finaliser of `SplitMix64` after one of its steps: every bit of the answer hangs on every bit of the question.
#[inline]
fn mixed(value: u64) -> u64 {
    let mut z = value.wrapping_add(GOLDEN);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

/// The upper 53 bits as a number in [0, 1).
#[expect(clippy::cast_precision_loss, reason = "53 bits are held exactly")]
fn unit(bits: u64) -> f64 {
    (bits >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of Sobol's points every aligned run of 2^k holds one point in each of 2^k equal cells of any one dimension.
    #[test]
    fn a_pixels_samples_are_spread_evenly_in_each_dimension() {
        for group in [0, 1, 17, GROUPS, 3 * GROUPS + 5] {
            for dimension in 0..4 {
                let mut cells = [0; 64];
                for index in 0..64 {
                    let number = PixelSampler::new(Sampler::Sobol, 7, 123, index).four(group)[dimension];
                    #[expect(clippy::cast_possible_truncation, reason = "a cell's number")]
                    #[expect(clippy::cast_sign_loss, reason = "never negative")]
                    let cell = (number * 64.0) as usize;
                    cells[cell] += 1;
                }
                assert_eq!(cells, [1; 64], "group {group}, dimension {dimension}");
            }
        }
    }

    /// Mean ½, variance 1/12 and no correlation between neighbours, each within 4 standard errors.
    #[test]
    fn independent_numbers_are_uniform_and_unrelated() {
        let numbers: Vec<f64> =
            (0..20_000u64).flat_map(|pixel| PixelSampler::new(Sampler::Independent, 1, pixel, 0).four(0)).collect();
        #[expect(clippy::cast_precision_loss, reason = "a small count")]
        let count = numbers.len() as f64;
        let mean = numbers.iter().sum::<f64>() / count;
        let variance = numbers.iter().map(|x| (x - 0.5).powi(2)).sum::<f64>() / count;
        let neighbours = numbers.windows(2).map(|pair| (pair[0] - 0.5) * (pair[1] - 0.5)).sum::<f64>() / count;
        let standard_error = (1.0 / 12.0 / count).sqrt();
        assert!((mean - 0.5).abs() < 4.0 * standard_error, "mean {mean}");
        // The variance of (x − ½)² is 1/180, that of a product of two is 1/144.
        assert!((variance - 1.0 / 12.0).abs() < 4.0 * (1.0 / 180.0 / count).sqrt(), "variance {variance}");
        assert!(neighbours.abs() < 4.0 * (1.0 / 144.0 / count).sqrt(), "covariance {neighbours}");
    }
}
