//! How a fibre spreads light along its axis: the lobe Mₚ of d'Eon et al. 2011 (eq. 7).
//!
//! M(θi, θo) = csch(1/v)/(2v) · exp(−sinθi sinθo / v) · I₀(cosθi cosθo / v), with ∫ M cosθo dθo = 1.
//!
//! The three factors over- and underflow as v → 0. Written with the scaled function e^{−x} I₀(x) they join into
//!
//! M = exp(−[(sinθi + sinθo)² + (cosθi − cosθo)²] / 2v) · e^{−x} I₀(x) / (v (1 − e^{−2/v})), x = cosθi cosθo / v,
//!
//! since 1 − cos(θi + θo) is half the bracket. Nothing here overflows or cancels for any v, so neither logarithms nor
//! a branch at small v are needed.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::FibreAngles;
use super::pairs::{Lanes, PAIRS, PairAngles};
use crate::optics::elementary::exp_of_negative;

/// How a roughness βₘ becomes the variance v of the lobe R.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LongitudinalMapping {
    /// v = (0.726 β + 0.812 β² + 3.7 β²⁰)², β between 0 and 1 (Chiang et al. 2016, eq. 7), chosen by its authors so
    /// that equal steps of β look equal.
    #[default]
    Chiang,
    /// v = β², β in radians.
    Plain,
}

impl LongitudinalMapping {
    /// Variance v of the lobe R.
    pub fn variance(self, beta_m: f64) -> f64 {
        match self {
            Self::Chiang => {
                let root = 0.726 * beta_m + 0.812 * beta_m.powi(2) + 3.7 * beta_m.powi(20);
                root * root
            }
            Self::Plain => beta_m * beta_m,
        }
    }
}

/// The lobes Mₚ for R, TT, and TRT with all that follow it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Longitudinal {
    inverse_variances: [f64; 3],
    normalisations: [f64; 3],
}

impl Longitudinal {
    /// TT is narrower and TRT wider than R: v, v/4, 4v (Marschner et al. 2003, after the number of refractions).
    pub(super) fn new(variance: f64) -> Self {
        let variances = [variance, 0.25 * variance, 4.0 * variance];
        Self {
            inverse_variances: variances.map(|v| 1.0 / v),
            normalisations: variances.map(|v| 1.0 / (v * -(-2.0 / v).exp_m1())),
        }
    }

    /// Mₚ for p = 0, 1, 2.
    #[inline]
    pub(super) fn evaluate(&self, angles: &FibreAngles) -> [f64; 3] {
        let sine_sum = angles.sin_theta_i + angles.sin_theta_o;
        let cosine_difference = angles.cos_theta_i - angles.cos_theta_o;
        let exponent = -0.5 * (sine_sum * sine_sum + cosine_difference * cosine_difference);
        let cosine_product = angles.cos_theta_i * angles.cos_theta_o;
        std::array::from_fn(|p| {
            let inverse_v = self.inverse_variances[p];
            self.normalisations[p] * (exponent * inverse_v).exp() * scaled_bessel_i0(cosine_product * inverse_v)
        })
    }

    /// Mₚ for p = 0, 1, 2 of many pairs.
    #[inline(always)]
    pub(super) fn of_pairs(&self, angles: &PairAngles) -> [Lanes; 3] {
        let mut lobes: [Lanes; 3] = [[0.0; PAIRS]; 3];
        for ((lobe, inverse_v), normalisation) in lobes.iter_mut().zip(self.inverse_variances).zip(self.normalisations)
        {
            for (pair, lobe) in lobe.iter_mut().enumerate() {
                let sine_sum = angles.sine_sum[pair];
                let cosine_difference = angles.cos_theta_i[pair] - angles.cos_theta_o[pair];
                let exponent = -0.5 * (sine_sum * sine_sum + cosine_difference * cosine_difference);
                let bessel = branch_free_scaled_bessel_i0(angles.cosine_product[pair] * inverse_v);
                *lobe = normalisation * exp_of_negative(exponent * inverse_v) * bessel;
            }
        }
        lobes
    }
}

impl Longitudinal {
    /// Draws the sine of the light's inclination with the density Mₚ, for the viewer's inclination, from two uniform numbers in
    /// [0, 1).
    ///
    /// Mₚ is what remains of a lobe e^{u/v} about a direction at −θo, u the cosine to it, when azimuths are summed over.
    /// u is drawn, and turned about that direction (d'Eon, Marschner and Hanika 2013); written as
    /// 1 − u = −v ln(ξ + (1 − ξ) e^{−2/v}), which loses no digits for small v.
    pub(super) fn draw(&self, p: usize, sin_theta_o: f64, cos_theta_o: f64, random: [f64; 2]) -> f64 {
        let inverse_v = self.inverse_variances[p];
        // In (0, 1], so that the logarithm is finite.
        let share = 1.0 - random[0];
        let from_peak = (-(share + (1.0 - share) * (-2.0 * inverse_v).exp()).ln() / inverse_v).min(2.0);
        let sine = (from_peak * (2.0 - from_peak)).sqrt();
        let turn = (std::f64::consts::TAU * random[1]).cos();
        (sine * turn * cos_theta_o - (1.0 - from_peak) * sin_theta_o).clamp(-1.0, 1.0)
    }
}

/// Number of terms of [`CHEBYSHEV`]; the first left out is 6e-20.
const CHEBYSHEV_TERMS: usize = 24;

/// Chebyshev coefficients of √x e^{−x} I₀(x) in 16/x − 1, for x ≥ 8. Computed for this file in 60 decimal digits from the
/// power series of I₀ at 40 Chebyshev points.
const CHEBYSHEV: [f64; CHEBYSHEV_TERMS] = [
    0.804_490_411_014_108_8,
    3.369_116_478_255_694e-3,
    6.889_758_346_916_825e-5,
    2.891_370_520_834_756_8e-6,
    2.048_918_589_469_063_8e-7,
    2.266_668_990_498_178e-8,
    3.396_232_025_708_386_5e-9,
    4.940_602_388_224_97e-10,
    1.188_914_710_784_643_9e-11,
    -3.149_916_527_963_241_6e-11,
    -1.321_581_184_044_771_3e-11,
    -1.794_178_153_150_681e-12,
    7.180_124_451_383_666e-13,
    3.852_778_382_742_142_6e-13,
    1.540_086_217_521_41e-14,
    -4.150_569_347_287_222e-14,
    -9.554_846_698_828_307e-15,
    3.811_680_669_352_621e-15,
    1.772_560_133_056_524_5e-15,
    -3.425_485_619_677_142e-16,
    -2.827_623_980_516_646e-16,
    3.461_222_867_695_658e-17,
    4.465_621_420_302_078e-17,
    -4.830_504_485_964_010_5e-18,
];

/// 1/k² for k = 1, 2, … 20.
const INVERSE_SQUARES: [f64; 20] = {
    let mut inverse_squares = [0.0; 20];
    let mut k = 0;
    while k < 20 {
        let number = (k + 1) as f64;
        inverse_squares[k] = 1.0 / (number * number);
        k += 1;
    }
    inverse_squares
};

/// Where [`scaled_bessel_i0`] changes its form.
const BESSEL_SWITCH: f64 = 8.0;

/// e^{−x} I₀(x) for x ≥ 0, relative error below 1e-15.
///
/// Up to 8 by the power series Σ (x²/4)^k / k!², whose terms are all positive and fall below 1e-17 of the sum at k = 21;
/// beyond by [`CHEBYSHEV`].
fn scaled_bessel_i0(x: f64) -> f64 {
    if x <= BESSEL_SWITCH { near_scaled_bessel_i0(x) } else { far_scaled_bessel_i0(x) }
}

/// [`scaled_bessel_i0`] without a branch, for loops over many x.
#[inline(always)]
fn branch_free_scaled_bessel_i0(x: f64) -> f64 {
    let is_near = x <= BESSEL_SWITCH;
    let near = near_scaled_bessel_i0(if is_near { x } else { BESSEL_SWITCH });
    let far = far_scaled_bessel_i0(if is_near { BESSEL_SWITCH } else { x });
    if is_near { near } else { far }
}

#[inline(always)]
fn near_scaled_bessel_i0(x: f64) -> f64 {
    let quarter_square = 0.25 * x * x;
    let series = INVERSE_SQUARES.iter().rev().fold(1.0, |series, factor| 1.0 + series * (quarter_square * factor));
    series * exp_of_negative(-x)
}

#[inline(always)]
fn far_scaled_bessel_i0(x: f64) -> f64 {
    // Clenshaw's recurrence.
    let u = 16.0 / x - 1.0;
    let (mut b1, mut b2) = (0.0, 0.0);
    for &coefficient in CHEBYSHEV[1..].iter().rev() {
        (b1, b2) = (2.0 * u * b1 - b2 + coefficient, b1);
    }
    (u * b1 - b2 + 0.5 * CHEBYSHEV[0]) / x.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// e^{−x} I₀(x) = (1/π) ∫₀^π e^{x (cos t − 1)} dt, by the trapezoidal rule, which converges faster than any power
    /// for a periodic integrand: 600 points leave 1e-32 for x up to 3000.
    #[test]
    fn scaled_bessel_function_agrees_with_its_integral() {
        for i in 0..2_000 {
            let x = 1e-3 * 1.0075_f64.powi(i);
            let integral = (0..600)
                .map(|k| {
                    let half_angle_sine = (std::f64::consts::PI * f64::from(k) / 600.0).sin();
                    (-2.0 * x * half_angle_sine * half_angle_sine).exp()
                })
                .sum::<f64>()
                / 600.0;
            let found = scaled_bessel_i0(x);
            assert!((found / integral - 1.0).abs() < 4e-15, "x = {x}: {found} instead of {integral}");
        }
    }

    /// Abramowitz and Stegun 1964, table 9.8: e^{−x} I₀(x) at 1, 5 and 10, ten decimals.
    #[test]
    fn scaled_bessel_function_agrees_with_the_printed_table() {
        for (x, printed) in [(1.0, 0.465_759_607_6), (5.0, 0.183_540_812_6), (10.0, 0.127_833_337_2)] {
            assert!((scaled_bessel_i0(x) - printed).abs() < 1e-10, "x = {x}: {}", scaled_bessel_i0(x));
        }
    }
}
