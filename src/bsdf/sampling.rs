//! Drawing where light comes from, for a path that starts at the viewer: what the models share.
//!
//! A model draws from a mixture of lobes. One random number chooses the lobe and is then stretched over the part that it
//! fell into, so that it serves again; the density is the sum of all lobes' densities, each times the probability of its
//! choice, never that of the chosen lobe alone (the second thesis's equations 3.13 and 3.30 leave the weights out).

use std::f64::consts::{FRAC_1_PI, FRAC_PI_4};

use super::Direction;
use crate::optics::elementary::sin_cos;

/// A direction that a scattering function drew for a viewer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Where the light comes from; points away from the surface.
    pub incoming: Direction,
    /// Density of the draw, 1/sr, as [`Bsdf::density`](super::Bsdf::density) gives it; 0 for a straight-through one,
    /// which has no density.
    pub density: f64,
    /// Whether the light comes straight through from behind, `incoming` = −ωo, without meeting anything. It is drawn with the
    /// probability [`Bsdf::straight_through`](super::Bsdf::straight_through), so that it counts with the weight 1.
    pub straight_through: bool,
}

impl Sample {
    /// A draw from the continuous part.
    pub(super) fn scattered(incoming: Direction, density: f64) -> Self {
        Self { incoming, density, straight_through: false }
    }
}

/// A point of the unit disk for a point of the unit square, areas kept and neighbours near: the concentric map (Shirley
/// and Chiu 1997). The second thesis's equation 3.9 has one of its four sectors only.
#[inline]
pub(super) fn on_disk(random: [f64; 2]) -> (f64, f64) {
    let [a, b] = random.map(|number| 2.0 * number - 1.0);
    if a == 0.0 && b == 0.0 {
        return (0.0, 0.0);
    }
    let (radius, azimuth) = if a.abs() > b.abs() { (a, FRAC_PI_4 * (b / a)) } else { (b, FRAC_PI_4 * (2.0 - a / b)) };
    let (sine, cosine) = sin_cos(azimuth);
    (radius * cosine, radius * sine)
}

/// A direction above the horizon, drawn with [`cosine_density`]: the disk lifted to the hemisphere (Malley), z = √(1 − r²),
/// where the second thesis's equation 3.10 has another root.
#[inline]
pub(super) fn cosine_lobe(random: [f64; 2]) -> Direction {
    let (x, y) = on_disk(random);
    Direction::new(x, y, (1.0 - x * x - y * y).max(0.0).sqrt())
}

/// cosθ/π above the horizon, 0 below, 1/sr.
#[inline]
pub(super) fn cosine_density(direction: &Direction) -> f64 {
    direction.z.max(0.0) * FRAC_1_PI
}

/// A uniform number in [0, 1) that makes several choices, one after the other.
#[derive(Debug, Clone, Copy)]
pub(super) struct Choice(pub(super) f64);

impl Choice {
    /// Whether something of this probability, 0 to 1, happens; what is left of the number is uniform again. It loses as
    /// many bits as the choice was unlikely.
    pub(super) fn takes(&mut self, probability: f64) -> bool {
        let taken = self.0 < probability;
        self.0 = if taken { self.0 / probability } else { (self.0 - probability) / (1.0 - probability) };
        // The quotient may round up to 1.
        self.0 = self.0.min(LARGEST_BELOW_1);
        taken
    }

    /// The position of one of several things by their probabilities, which sum to 1.
    pub(super) fn index(&mut self, probabilities: &[f64]) -> usize {
        let mut remaining = 1.0;
        let last = probabilities.len() - 1;
        for (position, probability) in probabilities[..last].iter().enumerate() {
            if self.takes(probability / remaining) {
                return position;
            }
            remaining -= probability;
        }
        last
    }
}

/// The largest number that a uniform draw in [0, 1) can give.
const LARGEST_BELOW_1: f64 = 1.0 - 0.5 * f64::EPSILON;

/// The direction at an angle to an axis whose cosine is given, and at an azimuth about it.
pub(super) fn about(axis: &Direction, cosine: f64, azimuth: f64) -> Direction {
    let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
    let (sin_azimuth, cos_azimuth) = azimuth.sin_cos();
    // Two axes across the first, without a square root (Duff et al. 2017, *Building an orthonormal basis, revisited*).
    let sign = 1.0_f64.copysign(axis.z);
    let a = -1.0 / (sign + axis.z);
    let b = axis.x * axis.y * a;
    let first = Direction::new(1.0 + sign * axis.x * axis.x * a, sign * b, -sign * axis.x);
    let second = Direction::new(b, sign + axis.y * axis.y * a, -axis.y);
    sine * cos_azimuth * first + sine * sin_azimuth * second + cosine * axis
}
