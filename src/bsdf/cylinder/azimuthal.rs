//! How roughness blurs the direction in which a path leaves the fibre: two densities of the azimuth on a circle.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use std::f64::consts::{PI, TAU};

use crate::optics::elementary::quick_exp_of_negative;

/// The density D by which a lobe Nₚ is blurred around the circle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum AzimuthalLobe {
    /// Logistic density of scale s = √(π/8) (0.265 β + 1.194 β² + 5.372 β²²), cut off at ±π and normalised again (Chiang
    /// et al. 2016, eqs. 8 and 12). It has a kink opposite its peak.
    #[default]
    TrimmedLogistic,
    /// Normal density of standard deviation β radians, wound around the circle (d'Eon et al. 2011, section 4.4).
    WrappedGaussian,
}

/// A density of the azimuth, even and of period 2π.
pub(super) trait Density: Copy {
    /// The density at a distance from its peak, 0 to π.
    fn at(self, distance: f64) -> f64;

    /// What [`Density::both`] needs to know of an azimuth `x` between 0 and π: plain numbers, so that those of many azimuths
    /// lie in lists of their own.
    fn seen_from(self, x: f64) -> [f64; 2];

    /// D(x − ψ) + D(x + ψ) at |ψ| between 0 and π: the two halves of a fibre turn light to opposite sides.
    fn both(self, seen_from: [f64; 2], turn: f64) -> f64;

    /// Distance beyond which the density is below e^−32 of its peak.
    fn reach(self) -> f64;

    /// Distance from the real axis at which a singularity stops a Gauss rule, in radians of the azimuth.
    fn analytic_height(self) -> f64;

    /// Whether the kink opposite the peak is too weak to disturb a Gauss rule that crosses it.
    fn is_smooth_at_pi(self) -> bool;
}

/// Distance on the circle between two azimuths less than a turn apart.
#[inline(always)]
pub(super) fn distance_around(difference: f64) -> f64 {
    let distance = difference.abs();
    distance.min(TAU - distance)
}

/// See [`AzimuthalLobe::TrimmedLogistic`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct TrimmedLogistic {
    inverse_scale: f64,
    normalisation: f64,
    /// C = e^{−π/s}.
    half_turn: f64,
}

impl TrimmedLogistic {
    /// Of roughness βₙ.
    pub(super) fn new(beta_n: f64) -> Self {
        let scale = (PI / 8.0).sqrt() * (0.265 * beta_n + 1.194 * beta_n.powi(2) + 5.372 * beta_n.powi(22));
        Self {
            inverse_scale: 1.0 / scale,
            normalisation: 1.0 / (scale * (0.5 * PI / scale).tanh()),
            half_turn: (-PI / scale).exp(),
        }
    }

    /// Whether [`Density::both`] stays in the range of numbers: e^{2π/s} must.
    pub(super) fn is_wide(self) -> bool {
        2.0 * PI * self.inverse_scale < 700.0
    }
}

/// A trimmed logistic so narrow that its own [`Density::both`] would leave the range of numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct NarrowLogistic(pub(super) TrimmedLogistic);

impl Density for NarrowLogistic {
    #[inline(always)]
    fn at(self, distance: f64) -> f64 {
        self.0.at(distance)
    }

    #[inline(always)]
    fn seen_from(self, x: f64) -> [f64; 2] {
        [x, 0.0]
    }

    #[inline(always)]
    fn both(self, [x, _]: [f64; 2], turn: f64) -> f64 {
        one_and_other(self, x, turn)
    }

    fn reach(self) -> f64 {
        self.0.reach()
    }

    fn analytic_height(self) -> f64 {
        self.0.analytic_height()
    }

    fn is_smooth_at_pi(self) -> bool {
        self.0.is_smooth_at_pi()
    }
}

/// [`Density::both`] as two densities, one after the other.
#[inline(always)]
fn one_and_other(density: impl Density, x: f64, turn: f64) -> f64 {
    density.at((x - turn).abs()) + density.at(distance_around(x + turn))
}

impl Density for TrimmedLogistic {
    #[inline(always)]
    fn at(self, distance: f64) -> f64 {
        let z = quick_exp_of_negative(-distance * self.inverse_scale);
        let denominator = 1.0 + z;
        self.normalisation * z / (denominator * denominator)
    }

    /// A = e^{−x/s}, and A/C = e^{(π−x)/s}.
    #[inline(always)]
    fn seen_from(self, x: f64) -> [f64; 2] {
        [quick_exp_of_negative(-x * self.inverse_scale), 1.0 / quick_exp_of_negative((x - PI) * self.inverse_scale)]
    }

    /// Two densities for one exponential and one division.
    ///
    /// In D ∝ z/(1 + z)², z may be e^{x/s} as well as e^{−x/s}. With A = e^{−x/s}, B = e^{−|ψ|/s} and C = e^{−π/s} the one term
    /// is AB/(A + B)². The other is AB/(1 + AB)², or, where x + |ψ| passes π and is taken from 2π, C²AB/(AB + C²)².
    /// With p = AB/C both have the numerator AB, over (1 + Cp)² and (p + C)²; the smaller denominator is the right one.
    #[inline(always)]
    fn both(self, [to_peak, from_opposite]: [f64; 2], turn: f64) -> f64 {
        let b = quick_exp_of_negative(-turn * self.inverse_scale);
        let p = from_opposite * b;
        let first = to_peak + b;
        let (beyond, before) = (p + self.half_turn, 1.0 + self.half_turn * p);
        let second = if beyond < before { beyond } else { before };
        // Neither product is squared, which would leave the range of numbers for narrow lobes.
        let inverse = 1.0 / (first * second);
        self.normalisation * (to_peak * b * inverse) * ((first * first + second * second) * inverse)
    }

    /// D(x) is below 4 e^{−x/s} D(0).
    fn reach(self) -> f64 {
        (32.0 + 4.0_f64.ln()) / self.inverse_scale
    }

    /// The logistic density has its poles at odd multiples of iπs.
    fn analytic_height(self) -> f64 {
        PI / self.inverse_scale
    }

    /// D(π) ≤ 2e-11 D(0). The kink then costs less than 2e-13 of the peak: the slope jumps by 2 D(π)/s, and a rule whose
    /// nodes are a distance w apart misses at most w²/12 of a jump, w ≤ 0.05.
    fn is_smooth_at_pi(self) -> bool {
        4.0 * (-PI * self.inverse_scale).exp() <= 2e-11
    }
}

/// See [`AzimuthalLobe::WrappedGaussian`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct WrappedGaussian {
    half_inverse_variance: f64,
    normalisation: f64,
}

impl WrappedGaussian {
    /// Of standard deviation βₙ.
    pub(super) fn new(beta_n: f64) -> Self {
        Self { half_inverse_variance: 0.5 / (beta_n * beta_n), normalisation: 1.0 / (TAU.sqrt() * beta_n) }
    }
}

impl Density for WrappedGaussian {
    #[inline(always)]
    fn seen_from(self, x: f64) -> [f64; 2] {
        [x, 0.0]
    }

    #[inline(always)]
    fn both(self, [x, _]: [f64; 2], turn: f64) -> f64 {
        one_and_other(self, x, turn)
    }

    /// The nearest three images; at β = 1 and π from the peak the next one is 5e-20.
    #[inline(always)]
    fn at(self, distance: f64) -> f64 {
        let image = |shift: f64| {
            let x = distance - shift;
            quick_exp_of_negative(-x * x * self.half_inverse_variance)
        };
        self.normalisation * (image(0.0) + image(TAU) + image(-TAU))
    }

    /// e^{−x²/2β²} at 8 β.
    fn reach(self) -> f64 {
        8.0 / (2.0 * self.half_inverse_variance).sqrt()
    }

    /// The density is entire, but grows as e^{y²/2β²} away from the axis. A pole at 2 β asks for as many nodes as
    /// that growth does, at the accuracy of this quadrature.
    fn analytic_height(self) -> f64 {
        2.0 / (2.0 * self.half_inverse_variance).sqrt()
    }

    fn is_smooth_at_pi(self) -> bool {
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ∫ D = 1 for the whole range of roughness, by a midpoint rule fine enough for the narrowest lobe.
    #[test]
    fn densities_are_normalised() {
        let integral = |density: &dyn Fn(f64) -> f64| {
            let count = 200_000;
            let step = PI / f64::from(count);
            2.0 * step * (0..count).map(|k| density((f64::from(k) + 0.5) * step)).sum::<f64>()
        };
        for beta in [0.01, 0.05, 0.1, 0.3, 0.7, 1.0] {
            let logistic = TrimmedLogistic::new(beta);
            let gaussian = WrappedGaussian::new(beta);
            for found in [integral(&|x| logistic.at(x)), integral(&|x| gaussian.at(x))] {
                // The midpoint rule sees the kinks at 0 … π with an error of step²/s² / 24.
                assert!((found - 1.0).abs() < 1e-6, "β = {beta}: {found}");
            }
        }
    }
}
