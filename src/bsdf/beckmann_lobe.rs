//! The mirror lobe of a rough surface without its reflectance: what all coats have in common.

use super::Direction;
use crate::optics::microfacet::Beckmann;

/// What a lobe needs of the direction half-way between light and viewer. For unit vectors h = sum/|sum| meets both at
/// the cosine |sum|/2; only operations in which the two commute are used, so that reciprocity is exact.
#[derive(Debug, Clone, Copy)]
pub(super) struct HalfVector {
    /// Cosine to the surface's normal.
    pub(super) cos_theta: f64,
    /// Cosine to light and viewer.
    pub(super) cos_facet: f64,
}

impl HalfVector {
    pub(super) fn between(incoming: &Direction, outgoing: &Direction) -> Self {
        let sum = incoming + outgoing;
        let length = sum.norm();
        Self { cos_theta: sum.z / length, cos_facet: (0.5 * length).min(1.0) }
    }
}

/// D G1 G1/(4 cosθi cosθo), for directions above the horizon (Walter et al. 2007, equation 20).
pub(super) fn lobe(coat: &Beckmann, half: &HalfVector, incoming: &Direction, outgoing: &Direction) -> f64 {
    let visible = coat.visible_share(incoming.z) * coat.visible_share(outgoing.z);
    coat.density(half.cos_theta) * visible / (4.0 * (incoming.z * outgoing.z))
}
