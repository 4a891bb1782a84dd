//! Drawing through a rough interface: a microfacet among those that the viewer sees, then its reflection or its refraction,
//! by Fresnel's reflectance of that microfacet.
//!
//! Channels differ in their index: one of them is drawn, each as likely as the other, and its index decides. The density is
//! the mean over channels,
//!
//! ```text
//! reflection      mean F(o·m) · D(m) G1(o) / (4 |cosθo|)
//! transmission    mean (1 − F(o·m)) |o·m| D(m) G1(o) / |cosθo| · η_i² |i·m| / |η_i i + η_o o|²
//! ```
//!
//! with the Jacobians of Walter et al. 2007 (equations 14 and 17); in transmission m differs between channels. The second
//! thesis's equation 3.26 has no density of reflected directions but a weight.

use super::{BoundInterface, fresnel};
use crate::bsdf::Direction;
use crate::bsdf::sampling::{Choice, Sample};

pub(super) fn sample(interface: &BoundInterface, outgoing: &Direction, random: [f64; 3]) -> Option<Sample> {
    if outgoing.z == 0.0 {
        return None;
    }
    // From below the surface looks as it does from above, turned over.
    let side = outgoing.z.signum();
    let turned = |direction: Direction| Direction::new(direction.x, direction.y, direction.z * side);
    let viewer = turned(*outgoing);
    let m = interface.surface.visible_normal(&viewer, [random[0], random[1]]);
    let cosine = viewer.dot(&m);

    let mut choice = Choice(random[2]);
    let eta = drawn_index(&interface.eta, &mut choice);
    let incoming = if choice.takes(fresnel::dielectric(cosine * side, eta).unpolarised()) {
        Some(2.0 * cosine * m - viewer).filter(|reflected| reflected.z > 0.0)
    } else {
        // Index on the viewer's side over that on the other.
        let ratio = if side > 0.0 { 1.0 / eta } else { eta };
        // The reflectance is 1 where nothing is refracted, so that the root is real but for rounding.
        let cosine_beyond = (1.0 - ratio * ratio * (1.0 - cosine * cosine)).max(0.0).sqrt();
        Some((ratio * cosine - cosine_beyond) * m - ratio * viewer).filter(|refracted| refracted.z < 0.0)
    }?;
    let incoming = turned(incoming);
    Some(Sample::scattered(incoming, density(interface, &incoming, outgoing)))
}

/// The index of a channel, all channels alike.
fn drawn_index(eta: &[f64], choice: &mut Choice) -> f64 {
    let mut remaining = eta.len();
    for group in same(eta) {
        if choice.takes(group.len() as f64 / remaining as f64) {
            return group[0];
        }
        remaining -= group.len();
    }
    eta[eta.len() - 1]
}

/// Neighbouring channels of one index: most often these are all.
fn same(eta: &[f64]) -> impl Iterator<Item = &[f64]> {
    eta.chunk_by(|a, b| a.to_bits() == b.to_bits())
}

pub(super) fn density(interface: &BoundInterface, incoming: &Direction, outgoing: &Direction) -> f64 {
    let cosines = incoming.z * outgoing.z;
    if cosines == 0.0 {
        return 0.0;
    }
    let seen = interface.surface.visible_share(outgoing.z) / outgoing.z.abs();
    let of_index = |eta| {
        if cosines > 0.0 {
            reflected(interface, incoming, outgoing, eta)
        } else {
            refracted(interface, incoming, outgoing, eta)
        }
    };
    let sum: f64 = same(&interface.eta).map(|group| group.len() as f64 * of_index(group[0])).sum();
    seen * sum / interface.eta.len() as f64
}

/// F D/4.
fn reflected(interface: &BoundInterface, incoming: &Direction, outgoing: &Direction, eta: f64) -> f64 {
    let sum = incoming + outgoing;
    let length = sum.norm();
    let cos_facet = (0.5 * length).min(1.0) * incoming.z.signum();
    0.25 * fresnel::dielectric(cos_facet, eta).unpolarised() * interface.surface.density(sum.z.abs() / length)
}

/// `(1 − F) |o·m| D η_i² |i·m|/|η_i i + η_o o|²`; 0 where the two directions see no microfacet that refracts one into the other.
fn refracted(interface: &BoundInterface, incoming: &Direction, outgoing: &Direction, eta: f64) -> f64 {
    let (eta_i, eta_o) = if incoming.z > 0.0 { (1.0, eta) } else { (eta, 1.0) };
    let sum = incoming * eta_i + outgoing * eta_o;
    let squared = sum.norm_squared();
    let m = sum * (sum.z.signum() / squared.sqrt());
    let (cos_i, cos_o) = (incoming.dot(&m), outgoing.dot(&m));
    if cos_i * incoming.z <= 0.0 || cos_o * outgoing.z <= 0.0 {
        return 0.0;
    }
    let passed = 1.0 - fresnel::dielectric(cos_o, eta).unpolarised();
    passed * (cos_i * cos_o).abs() * interface.surface.density(m.z) * eta_i * eta_i / squared
}
