//! Scattering models: one file a model.
//!
//! A [`Model`] is a description with declared parameters, made for a fixed list of wavelengths (its *channels*). Bound
//! to parameter values it becomes a [`Bsdf`], which is evaluated for pairs of directions. Work that depends on the
//! wavelengths alone is done when the model is made, work that depends on the parameters when it is bound, and only
//! the rest for each pair of directions. The loop over channels is the innermost one and runs over contiguous memory.

mod absorbers;
mod beckmann_lobe;
mod channel_mix;
mod channel_parameters;
mod coat_sampling;
mod coated_base;
pub mod cylinder;
mod feather;
mod film_at_unknown_angle;
mod granier;
mod interference;
mod iridescent_plastic;
mod lambertian;
mod microfacet;
mod model_error;
mod oriented;
mod pigmented_base;
mod rough_plastic;
mod sampling;
pub mod spongy_barb;

pub use channel_mix::ChannelMix;
pub(crate) use channel_mix::PICTURE_CHANNELS;
pub(crate) use channel_parameters::channel_suffix;
pub use coated_base::{
    CoatedBase, Description, Design, DesignEntry, DesignLayer, DesignPeriod, MaterialChoice, OwnMaterial,
};
pub use feather::{BarbDesign, BarbSpecies, BarbuleDesign, Feather, FeatherDesign};
pub use film_at_unknown_angle::{FilmAtUnknownAngle, FilmAtUnknownAngleDesign};
pub use granier::{GranierHeidrich, GranierHeidrichDesign, NormalSource, Site, normal_from_rgb};
pub use interference::Interference;
pub use iridescent_plastic::{IridescentPlastic, IridescentPlasticDesign};
pub use lambertian::{Lambertian, LambertianDesign};
pub use microfacet::{Distribution, MicrofacetDesign, MicrofacetInterface};
pub use model_error::ModelError;
pub use oriented::Oriented;
pub use pigmented_base::{PigmentedBase, PigmentedBaseDesign, layer_reflectance};
pub use rough_plastic::{InternalReflection, RoughPlastic, RoughPlasticDesign};
pub use sampling::Sample;

use nalgebra::Vector3;

use crate::parameter::Parameter;

/// A unit vector that points away from the surface, in the local frame: z is the normal, x the tangent.
pub type Direction = Vector3<f64>;

/// How much values may differ that are meant for a picture, as a share of themselves: a twentieth of the step between two
/// shades of an 8-bit screen.
pub const PICTURE_TOLERANCE: f64 = 1e-4;

/// A scattering model for a fixed list of channels, with its parameters not yet given.
pub trait Model: Send + Sync + std::fmt::Debug {
    /// The parameters, in the order in which [`Model::bind`] takes their values.
    fn parameters(&self) -> &[Parameter];

    /// Number of channels (wavelengths) that an evaluation fills.
    fn channel_count(&self) -> usize;

    /// The model with these parameter values, one for each declared parameter.
    ///
    /// Values inside the declared bounds always give finite results.
    fn bind(&self, values: &[f64]) -> Box<dyn Bsdf + '_>;

    /// [`Model::bind`] for a picture: millions of pairs of directions, for each of several lists of values, which share what
    /// they can. The channels are the model's own, or those that a mix makes of them. A model may tabulate what it would
    /// else compute anew: alone to [`PICTURE_TOLERANCE`], several of them as its documentation says.
    fn bind_for_picture(&self, shades: &[Vec<f64>], mix: Option<&ChannelMix>) -> Vec<Box<dyn Bsdf + '_>> {
        shades.iter().map(|values| channel_mix::mixed(self.bind(values), mix)).collect()
    }

    /// Whether these values can be bound: one for each parameter, each a number inside its bounds.
    ///
    /// # Errors
    /// A sentence that names the first parameter whose value is wrong, what was found and what was expected.
    fn check(&self, values: &[f64]) -> Result<(), ModelError> {
        let parameters = self.parameters();
        if values.len() != parameters.len() {
            return Err(ModelError::WrongCount { found: values.len(), expected: parameters.len() });
        }
        match parameters.iter().zip(values).find(|(parameter, value)| !parameter.allows(**value)) {
            Some((parameter, &found)) => Err(ModelError::BadValue {
                name: parameter.name.clone(),
                found,
                lower: parameter.lower,
                upper: parameter.upper,
                unit: if parameter.unit.is_empty() { String::new() } else { format!(" {}", parameter.unit) },
                text: parameter.text.clone(),
            }),
            None => Ok(()),
        }
    }
}

/// A scattering function, ready to be evaluated, and to be drawn from by a renderer whose paths start at the viewer.
pub trait Bsdf: Send + Sync {
    /// Writes the scattering function in 1/sr, without the cosine, one value a channel, for light from `incoming`
    /// seen from `outgoing`. Directions below the surface (z < 0) are legal; a model that only reflects gives 0 there.
    fn evaluate(&self, incoming: &Direction, outgoing: &Direction, values: &mut [f64]);

    /// Share of the light from `incoming` that goes straight through without meeting anything, 0 to 1. As a function of
    /// directions it is `share · δ(ωo, −ωi)/|n·ωi|`, which [`Bsdf::evaluate`] cannot show.
    fn straight_through(&self, _incoming: &Direction) -> f64 {
        0.0
    }

    /// Draws where light comes from, for a viewer, from three uniform numbers in [0, 1), so that f · |n·ωi| over the density
    /// varies little. Allocates nothing.
    ///
    /// None: the draw is rejected, because its direction lies where no light comes from; it counts as no light.
    fn sample(&self, outgoing: &Direction, random: [f64; 3]) -> Option<Sample>;

    /// [`Bsdf::sample`] for many viewers at a time; its densities may be less exact, as those of [`Bsdf::density_many`].
    ///
    /// # Panics
    /// If the lengths do not fit each other: that is the caller's slip, not a user's.
    fn sample_many(&self, outgoing: &[Direction], random: &[[f64; 3]], samples: &mut [Option<Sample>]) {
        assert!(outgoing.len() == random.len() && outgoing.len() == samples.len(), "one sample a viewer");
        for ((outgoing, random), sample) in outgoing.iter().zip(random).zip(samples) {
            *sample = self.sample(outgoing, *random);
        }
    }

    /// The density with which [`Bsdf::sample`] draws `incoming`, 1/sr. Its integral over the sphere, the share of rejected
    /// draws and that of straight-through ones sum to 1. Above 0 wherever [`Bsdf::evaluate`] is. Allocates nothing.
    fn density(&self, incoming: &Direction, outgoing: &Direction) -> f64;

    /// [`Bsdf::density`] for many pairs of directions at a time; like [`Bsdf::evaluate_many`] it may be less exact than one
    /// at a time, as the model says.
    ///
    /// # Panics
    /// If the lengths do not fit each other: that is the caller's slip, not a user's.
    fn density_many(&self, incoming: &[Direction], outgoing: &[Direction], densities: &mut [f64]) {
        assert!(incoming.len() == outgoing.len() && incoming.len() == densities.len(), "one density a pair");
        for ((incoming, outgoing), density) in incoming.iter().zip(outgoing).zip(densities) {
            *density = self.density(incoming, outgoing);
        }
    }

    /// [`Bsdf::evaluate`] for many pairs of directions at a time: all channels of the first pair, then of the second.
    ///
    /// For renderers and sweeps; a model that is faster over many pairs says how much its values may then differ.
    ///
    /// # Panics
    /// If the lengths do not fit each other: that is the caller's slip, not a user's.
    fn evaluate_many(&self, incoming: &[Direction], outgoing: &[Direction], values: &mut [f64]) {
        one_at_a_time(self, incoming, outgoing, values);
    }
}

/// [`Bsdf::evaluate_many`] by [`Bsdf::evaluate`].
fn one_at_a_time<B: Bsdf + ?Sized>(bsdf: &B, incoming: &[Direction], outgoing: &[Direction], values: &mut [f64]) {
    assert_eq!(incoming.len(), outgoing.len(), "directions come in pairs");
    let channels = (values.len() / incoming.len().max(1)).max(1);
    assert_eq!(values.len(), incoming.len() * channels, "one value a pair and channel");
    for ((incoming, outgoing), values) in incoming.iter().zip(outgoing).zip(values.chunks_exact_mut(channels)) {
        bsdf.evaluate(incoming, outgoing, values);
    }
}
