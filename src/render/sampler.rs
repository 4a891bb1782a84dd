//! Numbers in [0, 1) for each sample of each pixel.
//!
//! They belong to the pixel: the same scene seed, pixel, sample and dimension give the same number on any thread. Sobol's
//! sequence (1967; Kuo and Joe's directions) with Owen's scrambling by hashing (Burley 2020) spreads the samples of a
//! pixel evenly over all that is drawn; pixels are scrambled apart. Independent numbers are the control against which its
//! gain is measured.
//!
//! Dimensions come in groups of four. Those of the camera and of a path's first event stay together as the sequence has
//! them; later groups are shuffled against them and each other, since far dimensions of few points lie on lines. Burley
//! shuffles anew in each pixel; here the order is the picture's, so that a sample's points before scrambling are the same
//! in all pixels and are made once. Scrambling alone makes pixels independent of each other.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sobol_burley::parts::{hash, owen_scramble_rev, sobol_rev};

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

/// Groups of four dimensions that the sequence has; beyond them it begins anew in another order, scrambled otherwise.
const GROUPS: u32 = sobol_burley::NUM_DIMENSION_SETS_4D;

/// Groups that are made beforehand: those of 15 events of a path.
const MADE: usize = 32;

/// Groups that are not shuffled: the camera's and those of the first event.
const TOGETHER: u32 = 3;

/// One number for each of the four dimensions of a group, which tells their scramblings apart.
const DIMENSIONS: [u32; 4] = [0x912F_69BA, 0x174F_18AB, 0x691E_72CA, 0xB40C_C1B8];

/// What the numbers of one sample have in common in all pixels.
#[derive(Debug)]
pub(super) struct SampleNumbers {
    sampler: Sampler,
    scene_seed: u64,
    index: u32,
    /// Points of the sequence in the first groups, their bits reversed as scrambling wants them.
    points: [[u32; 4]; MADE],
}

/// What tells the numbers of one pixel from those of the others.
#[derive(Debug, Clone, Copy)]
pub(super) struct PixelSeed(u64);

impl SampleNumbers {
    /// For the sample `index` of all pixels in a picture with this seed.
    pub(super) fn new(sampler: Sampler, scene_seed: u64, index: u32) -> Self {
        let mut points = [[0; 4]; MADE];
        if sampler == Sampler::Sobol {
            for (point, group) in points.iter_mut().zip(0..) {
                *point = sobol_point(scene_seed, index, group);
            }
        }
        Self { sampler, scene_seed, index, points }
    }

    /// The pixel with this number.
    #[inline(always)]
    pub(super) fn pixel(&self, number: u64) -> PixelSeed {
        PixelSeed(mixed(self.scene_seed ^ mixed(number)))
    }

    /// Four numbers of a pixel, those of this group of dimensions.
    #[inline(always)]
    pub(super) fn four(&self, pixel: PixelSeed, group: u32) -> [f64; 4] {
        match self.sampler {
            Sampler::Sobol => {
                let point = match self.points.get(group as usize) {
                    Some(point) => *point,
                    None => sobol_point(self.scene_seed, self.index, group),
                };
                let seed = (pixel.0 >> 32) as u32 ^ group.wrapping_mul(0x9E37_79B9);
                std::array::from_fn(|lane| {
                    let scrambled = owen_scramble_rev(point[lane], hash(seed ^ DIMENSIONS[lane]));
                    f64::from(scrambled.reverse_bits()) * (1.0 / (1u64 << 32) as f64)
                })
            }
            Sampler::Independent => {
                let place = (u64::from(self.index) << 32) | u64::from(group);
                let state = mixed(pixel.0 ^ mixed(place));
                std::array::from_fn(|lane| unit(mixed(state.wrapping_add((lane as u64).wrapping_mul(GOLDEN)))))
            }
        }
    }
}

/// The point of the sequence that a sample takes in a group of dimensions. Where the sample's number is shuffled, it is within
/// its aligned runs of 2^k, all of them, which leaves each of these as evenly spread as it was.
fn sobol_point(scene_seed: u64, index: u32, group: u32) -> [u32; 4] {
    let in_order = index.reverse_bits();
    let place = if group < TOGETHER {
        in_order
    } else {
        let order = (mixed(scene_seed ^ mixed(!u64::from(group))) >> 32) as u32;
        owen_scramble_rev(in_order, order)
    };
    [0, 1, 2, 3].map(|dimension| sobol_rev(place, 4 * (group % GROUPS) + dimension))
}

/// 2⁶⁴ over the golden ratio, the step of `SplitMix64` (Steele, Lea and Flood 2014).
const GOLDEN: u64 = 0x9E37_79B9_7F4A_7C15;

/// The finaliser of `SplitMix64` after one of its steps: every bit of the answer hangs on every bit of the question.
#[inline]
pub(crate) fn mixed(value: u64) -> u64 {
    let mut z = value.wrapping_add(GOLDEN);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

/// The upper 53 bits as a number in [0, 1).
#[expect(clippy::cast_precision_loss, reason = "53 bits are held exactly")]
pub(crate) fn unit(bits: u64) -> f64 {
    (bits >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(sampler: Sampler, scene_seed: u64, pixel: u64, index: u32, group: u32) -> [f64; 4] {
        let sample = SampleNumbers::new(sampler, scene_seed, index);
        sample.four(sample.pixel(pixel), group)
    }

    /// Of Sobol's points every aligned run of 2^k holds one point in each of 2^k equal cells of any one dimension.
    #[test]
    fn a_pixels_samples_are_spread_evenly_in_each_dimension() {
        for group in [0, 1, 17, GROUPS, 3 * GROUPS + 5] {
            for dimension in 0..4 {
                let mut cells = [0; 64];
                for index in 0..64 {
                    let number = numbers(Sampler::Sobol, 7, 123, index, group)[dimension];
                    #[expect(clippy::cast_possible_truncation, reason = "a cell's number")]
                    #[expect(clippy::cast_sign_loss, reason = "never negative")]
                    let cell = (number * 64.0) as usize;
                    cells[cell] += 1;
                }
                assert_eq!(cells, [1; 64], "group {group}, dimension {dimension}");
            }
        }
    }

    /// Mean ½, variance 1/12 and no correlation between neighbours, each within 4 standard errors: of independent numbers,
    /// and of one sample of Sobol's sequence over many pixels, which only scrambling tells apart.
    #[test]
    fn numbers_of_many_pixels_are_uniform_and_unrelated() {
        for (sampler, index, group) in [(Sampler::Independent, 0, 0), (Sampler::Sobol, 0, 0), (Sampler::Sobol, 9, 5)] {
            let numbers: Vec<f64> = (0..20_000).flat_map(|pixel| numbers(sampler, 1, pixel, index, group)).collect();
            assert_unrelated(&numbers);
        }
    }

    fn assert_unrelated(numbers: &[f64]) {
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
