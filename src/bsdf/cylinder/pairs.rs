//! Angles of many pairs of directions at a time, in lists of their own: lanes are pairs.
//!
//! Loops over all [`PAIRS`] have a fixed length and plain arithmetic inside, which the compiler turns into the widest
//! vectors that the processor has. A block that is not full is filled up with its last pair.

use std::f64::consts::PI;

use crate::bsdf::Direction;
use crate::optics::elementary::acute_angle;

/// Pairs that are worked on together.
pub(super) const PAIRS: usize = 64;

/// With fewer pairs than this a block is not worth its trouble.
pub(super) const FEWEST: usize = 24;

/// One number for each pair.
pub(super) type Lanes = [f64; PAIRS];

/// [`super::FibreAngles`] of a block of pairs.
#[derive(Debug)]
pub(super) struct PairAngles {
    /// sinθi + sinθo.
    pub(super) sine_sum: Lanes,
    pub(super) sin_theta_o: Lanes,
    pub(super) cos_theta_i: Lanes,
    pub(super) cos_theta_o: Lanes,
    /// cosθi cosθo.
    pub(super) cosine_product: Lanes,
    /// Distance of the azimuths of light and viewer, 0 to π, with an absolute error below 1e-11.
    pub(super) phi: Lanes,
    /// 1/|n·ωi|, or 0 for light in the surface.
    pub(super) inverse_cosine: Lanes,
}

impl PairAngles {
    /// From 1 to [`PAIRS`] pairs.
    #[inline(always)]
    pub(super) fn new(incoming: &[Direction], outgoing: &[Direction]) -> Self {
        let mut coordinates = [[0.0; PAIRS]; 6];
        for pair in 0..PAIRS {
            let (i, o) = (&incoming[pair.min(incoming.len() - 1)], &outgoing[pair.min(outgoing.len() - 1)]);
            for (list, coordinate) in coordinates.iter_mut().zip([i.x, i.y, i.z, o.x, o.y, o.z]) {
                list[pair] = coordinate;
            }
        }
        let [x_i, y_i, z_i, x_o, y_o, z_o] = &coordinates;
        let nothing = [0.0; PAIRS];
        let mut angles = Self {
            sine_sum: nothing,
            sin_theta_o: *x_o,
            cos_theta_i: nothing,
            cos_theta_o: nothing,
            cosine_product: nothing,
            phi: nothing,
            inverse_cosine: nothing,
        };
        for pair in 0..PAIRS {
            angles.sine_sum[pair] = x_i[pair] + x_o[pair];
            let cos_theta_i = (y_i[pair] * y_i[pair] + z_i[pair] * z_i[pair]).sqrt();
            let cos_theta_o = (y_o[pair] * y_o[pair] + z_o[pair] * z_o[pair]).sqrt();
            let product = cos_theta_i * cos_theta_o;
            angles.cos_theta_i[pair] = cos_theta_i;
            angles.cos_theta_o[pair] = cos_theta_o;
            angles.cosine_product[pair] = product;

            // Along the fibre sine and cosine of φ are 0/0; there φ does not matter.
            let inverse = 1.0 / (product + f64::MIN_POSITIVE);
            let sine = (z_i[pair] * y_o[pair] - y_i[pair] * z_o[pair]).abs() * inverse;
            let cosine = (y_i[pair] * y_o[pair] + z_i[pair] * z_o[pair]) * inverse;
            let acute = acute_angle(sine, cosine.abs());
            angles.phi[pair] = if cosine < 0.0 { PI - acute } else { acute };

            let cosine = z_i[pair].abs();
            angles.inverse_cosine[pair] = if cosine > 0.0 { 1.0 / cosine } else { 0.0 };
        }
        angles
    }
}
