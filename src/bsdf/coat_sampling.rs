//! Drawing from a rough coat over a diffuse base: the light that the coat mirrors, or diffuse light.
//!
//! Which of the two is chosen hangs on the viewer's inclination, by what each would send to it. The second thesis's equations
//! 3.12 and 3.29 compare a random number with the scattering function itself, which is no probability.

use super::Direction;
use super::sampling::{Choice, Sample, cosine_density, cosine_lobe};
use crate::optics::microfacet::Beckmann;

/// Intervals of the viewer's cosine between which the gloss's probability runs straight. It need not be exact, only the same in
/// draw and density.
const INTERVALS: usize = 32;

/// A direction above a clear medium of index `index` as it is inside it, still pointing away from the surface.
pub(super) fn refract(direction: &Direction, index: f64) -> Direction {
    Direction::new(direction.x / index, direction.y / index, refracted_cosine(direction.z, index))
}

/// Cosine of a direction to the normal below a surface of index `index`, from that above it.
pub(super) fn refracted_cosine(cosine: f64, index: f64) -> f64 {
    (1.0 - (1.0 - cosine * cosine).max(0.0) / (index * index)).sqrt()
}

/// The gloss's probability over the viewer's cosine.
#[derive(Debug)]
pub(super) struct CoatSampler {
    coat: Beckmann,
    /// Index of a clear medium over the coat, with a smooth surface.
    above: Option<f64>,
    gloss: [f64; INTERVALS + 1],
}

impl CoatSampler {
    /// From what gloss and base send to a viewer at a cosine from 0 to 1 under light from everywhere, channels averaged:
    /// any two numbers whose ratio is about right, none negative, that are 0 only where there is nothing to draw.
    pub(super) fn new(coat: Beckmann, above: Option<f64>, mut albedos: impl FnMut(f64) -> (f64, f64)) -> Self {
        let mut gloss = [0.0; INTERVALS + 1];
        for (step, probability) in gloss.iter_mut().enumerate() {
            let (gloss, diffuse) = albedos(step as f64 / INTERVALS as f64);
            // A black surface may be drawn from in any way.
            *probability = if gloss > 0.0 { gloss / (gloss + diffuse) } else { 0.0 };
        }
        Self { coat, above, gloss }
    }

    #[inline(always)]
    pub(super) fn gloss_probability(&self, cos_theta_o: f64) -> f64 {
        let position = cos_theta_o.clamp(0.0, 1.0) * INTERVALS as f64;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and INTERVALS")]
        let before = (position as usize).min(INTERVALS - 1);
        let share = position - before as f64;
        self.gloss[before] * (1.0 - share) + self.gloss[before + 1] * share
    }

    /// See [`Bsdf::sample`](super::Bsdf::sample).
    pub(super) fn sample(&self, outgoing: &Direction, random: [f64; 3]) -> Option<Sample> {
        let incoming = self.direction(outgoing, random)?;
        Some(Sample::scattered(incoming, self.density(&incoming, outgoing)))
    }

    /// The direction of a draw.
    pub(super) fn direction(&self, outgoing: &Direction, [first, second, choice]: [f64; 3]) -> Option<Direction> {
        if outgoing.z <= 0.0 {
            return None;
        }
        if Choice(choice).takes(self.gloss_probability(outgoing.z)) {
            self.mirrored(outgoing, [first, second])
        } else {
            Some(cosine_lobe([first, second]))
        }
    }

    /// See [`Bsdf::density`](super::Bsdf::density). A visible normal has the density D G1 (o·m)/cosθo, the direction that it
    /// mirrors 1/(4 o·m) of that (Walter et al. 2007, equation 14).
    pub(super) fn density(&self, incoming: &Direction, outgoing: &Direction) -> f64 {
        if incoming.z <= 0.0 || outgoing.z <= 0.0 {
            return 0.0;
        }
        let gloss = self.gloss_probability(outgoing.z);
        gloss * self.mirrored_density(incoming, outgoing) + (1.0 - gloss) * cosine_density(incoming)
    }

    /// Light that a microfacet mirrors, one of those that the viewer sees; refracted at what lies above the coat.
    fn mirrored(&self, outgoing: &Direction, random: [f64; 2]) -> Option<Direction> {
        let viewer = self.above.map_or(*outgoing, |index| refract(outgoing, index));
        let m = self.coat.visible_normal(&viewer, random);
        let light = 2.0 * viewer.dot(&m) * m - viewer;
        if light.z <= 0.0 {
            return None;
        }
        match self.above {
            None => Some(light),
            Some(index) => {
                let cosine_squared = 1.0 - index * index * (light.x * light.x + light.y * light.y);
                (cosine_squared > 0.0).then(|| Direction::new(index * light.x, index * light.y, cosine_squared.sqrt()))
            }
        }
    }

    fn mirrored_density(&self, incoming: &Direction, outgoing: &Direction) -> f64 {
        let of_coat = |incoming: &Direction, outgoing: &Direction| {
            let half = incoming + outgoing;
            self.coat.density(half.z / half.norm()) * self.coat.visible_share(outgoing.z) / (4.0 * outgoing.z)
        };
        match self.above {
            None => of_coat(incoming, outgoing),
            Some(index) => {
                let inside = refract(incoming, index);
                // The solid angle widens by n² cosθ_inside/cosθ on the way out.
                of_coat(&inside, &refract(outgoing, index)) * incoming.z / (index * index * inside.z)
            }
        }
    }
}
