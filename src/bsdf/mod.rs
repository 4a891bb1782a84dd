//! Scattering models: one file a model.
//!
//! A [`Model`] is a description with declared parameters, made for a fixed list of wavelengths (its *channels*). Bound
//! to parameter values it becomes a [`Bsdf`], which is evaluated for pairs of directions. Work that depends on the
//! wavelengths alone is done when the model is made, work that depends on the parameters when it is bound, and only
//! the rest for each pair of directions. The loop over channels is the innermost one and runs over contiguous memory.

pub mod cylinder;
pub mod spongy_barb;

use nalgebra::Vector3;

use crate::parameter::Parameter;

/// A unit vector that points away from the surface, in the local frame: z is the normal, x the tangent.
pub type Direction = Vector3<f64>;

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
}

/// A scattering function, ready to be evaluated.
pub trait Bsdf: Send + Sync {
    /// Writes the scattering function in 1/sr, without the cosine, one value a channel, for light from `incoming`
    /// seen from `outgoing`. Directions below the surface (z < 0) are legal; a model that only reflects gives 0 there.
    fn evaluate(&self, incoming: &Direction, outgoing: &Direction, values: &mut [f64]);
}
