//! Drawing from a Granier–Heidrich film: its outer lobe, its inner lobe, or diffuse light.
//!
//! The viewer is given, the light drawn. Mirrors work both ways, so that both lobes have their axis on the viewer's side:
//!
//! ```text
//! ω_ri·ωo = ωi·ω_ro              ω_ro = −ωo + 2 (ωo·n0) n0
//! ω_rti·(−ω_to) = ω_ti·r         r = −ω_to + 2 (ω_to·n1) n1
//! ```
//!
//! A direction about an axis has cosθ = (1 − ξ)^{1/(e+1)}, φ = 2πξ' and the density (e + 1)/2π cosᵉθ; the second thesis's
//! equation 3.5 takes cosθ and sinθ from different numbers, and its lobe stands about z instead of `ω_ro`. `ω_ti` is drawn inside
//! the film and refracted out, which multiplies its density by `dω_ti/dωi = cosθi/(η² cosθ_ti)`. The diffuse part is drawn about the
//! shading normal (3.10, 3.11), and the density is the mixture's (3.13 lacks the weights).

use std::f64::consts::{PI, TAU};

use super::{BoundGranierHeidrich, Channel, phong, schlick};
use crate::bsdf::Direction;
use crate::bsdf::sampling::{Choice, Sample, about, cosine_density, cosine_lobe};

/// Probabilities of the three parts; they sum to 1.
struct Parts {
    outer: f64,
    inner: f64,
    diffuse: f64,
}

/// The viewer inside the film of one index.
struct Inside {
    eta: f64,
    /// Axis of the inner lobe, r.
    axis: Direction,
}

impl Inside {
    fn new(film: &BoundGranierHeidrich, channel: &Channel, outgoing: &Direction) -> Self {
        let (n0, n1, a) = (&film.outer_normal, &film.inner_normal, channel.inverse_eta);
        let cosine = outgoing.dot(n0);
        let refracted = (a * cosine - cosine_inside(cosine, a)) * n0 - a * outgoing;
        Self { eta: 1.0 / a, axis: 2.0 * refracted.dot(n1) * n1 - refracted }
    }

    /// The direction outside of a direction inside the film, if light gets out.
    fn leave(&self, film: &BoundGranierHeidrich, inside: &Direction) -> Option<Direction> {
        let n0 = &film.outer_normal;
        let cosine_inside = -inside.dot(n0);
        let cosine_squared = 1.0 - self.eta * self.eta * (1.0 - cosine_inside * cosine_inside);
        (cosine_inside > 0.0 && cosine_squared > 0.0)
            .then(|| cosine_squared.sqrt() * n0 - self.eta * (inside + cosine_inside * n0))
    }

    /// Density outside of the inner lobe's draws.
    fn density(&self, film: &BoundGranierHeidrich, incoming: &Direction) -> f64 {
        let (n0, a) = (&film.outer_normal, 1.0 / self.eta);
        let cosine = incoming.dot(n0);
        if cosine <= 0.0 {
            return 0.0;
        }
        let cosine_inside = cosine_inside(cosine, a);
        let refracted = (a * cosine - cosine_inside) * n0 - a * incoming;
        lobe_density(refracted.dot(&self.axis), film.inner_exponent) * cosine * a * a / cosine_inside
    }
}

/// Cosine of a refracted direction, `a` being 1/η.
fn cosine_inside(cosine: f64, a: f64) -> f64 {
    (1.0 - (1.0 - cosine * cosine).max(0.0) * a * a).sqrt()
}

/// (e + 1)/2π cosᵉθ.
fn lobe_density(cosine: f64, exponent: f64) -> f64 {
    (exponent + 1.0) / TAU * phong(cosine, exponent)
}

/// A direction of that density about an axis.
fn lobe(axis: &Direction, exponent: f64, [first, second]: [f64; 2]) -> Direction {
    let cosine = (1.0 - first).powf(1.0 / (exponent + 1.0));
    about(axis, cosine, TAU * second)
}

/// What each part sends to the viewer, about: a lobe's integral is 2π/(e + 1), but with the cosine never more than π.
fn parts(film: &BoundGranierHeidrich, outgoing: &Direction) -> Parts {
    let cosine = outgoing.dot(&film.outer_normal);
    let only_diffuse = Parts { outer: 0.0, inner: 0.0, diffuse: 1.0 };
    if cosine <= 0.0 {
        // The film is seen from behind.
        return only_diffuse;
    }
    let outer_size = film.outer_scale * (TAU / (film.outer_exponent + 1.0)).min(PI);
    let (mut outer, mut inner, mut diffuse) = (0.0, 0.0, 0.0);
    for channel in &film.channels {
        let a = channel.inverse_eta;
        let passed = 1.0 - schlick(channel.normal_reflectance, cosine);
        let left = 1.0 - schlick(channel.normal_reflectance, cosine_inside(cosine, a));
        let inner_size = film.inner_scale * (TAU / ((film.inner_exponent + 1.0) * a * a)).min(PI);
        outer += channel.specular * (1.0 - passed) * outer_size;
        inner += channel.specular * passed * left * inner_size;
        diffuse += channel.diffuse * PI;
    }
    let sum = outer + inner + diffuse;
    if sum > 0.0 { Parts { outer: outer / sum, inner: inner / sum, diffuse: diffuse / sum } } else { only_diffuse }
}

pub(super) fn sample(film: &BoundGranierHeidrich, outgoing: &Direction, random: [f64; 3]) -> Option<Sample> {
    if outgoing.z <= 0.0 {
        return None;
    }
    let (random, mut choice) = ([random[0], random[1]], Choice(random[2]));
    let parts = parts(film, outgoing);
    let incoming = if choice.takes(parts.diffuse) {
        cosine_lobe(random)
    } else if choice.takes(parts.outer / (parts.outer + parts.inner)) {
        let n0 = &film.outer_normal;
        lobe(&(2.0 * outgoing.dot(n0) * n0 - outgoing), film.outer_exponent, random)
    } else {
        let inside = Inside::new(film, drawn_channel(&film.channels, &mut choice), outgoing);
        inside.leave(film, &lobe(&inside.axis, film.inner_exponent, random))?
    };
    (incoming.z > 0.0).then(|| Sample::scattered(incoming, density(film, &incoming, outgoing)))
}

/// A channel, all alike.
fn drawn_channel<'a>(channels: &'a [Channel], choice: &mut Choice) -> &'a Channel {
    let mut remaining = channels.len();
    for group in same(channels) {
        if choice.takes(group.len() as f64 / remaining as f64) {
            return &group[0];
        }
        remaining -= group.len();
    }
    &channels[channels.len() - 1]
}

/// Neighbouring channels of one index.
fn same(channels: &[Channel]) -> impl Iterator<Item = &[Channel]> {
    channels.chunk_by(|a, b| a.inverse_eta.to_bits() == b.inverse_eta.to_bits())
}

pub(super) fn density(film: &BoundGranierHeidrich, incoming: &Direction, outgoing: &Direction) -> f64 {
    if incoming.z <= 0.0 || outgoing.z <= 0.0 {
        return 0.0;
    }
    let parts = parts(film, outgoing);
    let mut density = parts.diffuse * cosine_density(incoming);
    if parts.outer > 0.0 {
        let (n0, cos_o) = (&film.outer_normal, outgoing.dot(&film.outer_normal));
        let cosine = 2.0 * incoming.dot(n0) * cos_o - incoming.dot(outgoing);
        density += parts.outer * lobe_density(cosine, film.outer_exponent);
    }
    if parts.inner > 0.0 {
        let of_group =
            |group: &[Channel]| group.len() as f64 * Inside::new(film, &group[0], outgoing).density(film, incoming);
        density += parts.inner * same(&film.channels).map(of_group).sum::<f64>() / film.channels.len() as f64;
    }
    density
}
