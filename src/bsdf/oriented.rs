//! Models that know a tangent, with the tangent turned about the normal.
//!
//! A fibre's scattering hangs on how it lies, and most tables of measured readings do not say how the barbs lay to their
//! φ = 0. [`Oriented`] gives any such model one parameter more, last in its list:
//!
//! | parameter | symbol | unit | default | range |
//! | --- | --- | --- | --- | --- |
//! | `tangent_deg`: azimuth of the tangent in the table's frame | ψ | ° | 0 | −180 to 180 |
//!
//! f(ωi, ωo) = `f_model(R ωi, R ωo)`, R the rotation by −ψ about the normal, which takes the tangent to x. Turned by 180° a
//! fibre looks the same, so a fit should bound ψ to half a turn; elsewhere it finds each minimum twice.

use super::{Bsdf, ChannelMix, Direction, Model, Sample};
use crate::parameter::{Parameter, Spread};

/// A model whose tangent lies at an azimuth of its own: `tangent_deg`.
#[derive(Debug)]
pub struct Oriented {
    model: Box<dyn Model>,
    parameters: Vec<Parameter>,
}

impl Oriented {
    /// The same model with the parameter `tangent_deg` after its own.
    pub fn new(model: Box<dyn Model>) -> Self {
        let mut parameters = model.parameters().to_vec();
        parameters.push(Parameter {
            name: "tangent_deg".to_owned(),
            symbol: "ψ".to_owned(),
            unit: "°",
            default: 0.0,
            lower: -180.0,
            upper: 180.0,
            spread: Spread::Linear,
            scan_step: None,
            text: "azimuth of the tangent (barb) in the table's frame, where nobody wrote down how the barbs lay; \
                   repeats every 180°, so free it over half a turn"
                .to_owned(),
        });
        Self { model, parameters }
    }
}

impl Model for Oriented {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn channel_count(&self) -> usize {
        self.model.channel_count()
    }

    fn bind(&self, values: &[f64]) -> Box<dyn Bsdf + '_> {
        let (values, tangent_deg) = values.split_at(self.parameters.len() - 1);
        Box::new(BoundOriented { bsdf: self.model.bind(values), tangent: Tangent::at_degrees(tangent_deg[0]) })
    }

    fn bind_for_picture(&self, shades: &[Vec<f64>], mix: Option<&ChannelMix>) -> Vec<Box<dyn Bsdf + '_>> {
        let split = self.parameters.len() - 1;
        let inner: Vec<Vec<f64>> = shades.iter().map(|values| values[..split].to_vec()).collect();
        let bound = self.model.bind_for_picture(&inner, mix).into_iter().zip(shades);
        let turned = bound.map(|(bsdf, values)| -> Box<dyn Bsdf + '_> {
            Box::new(BoundOriented { bsdf, tangent: Tangent::at_degrees(values[split]) })
        });
        turned.collect()
    }
}

/// An oriented model with its parameters given.
struct BoundOriented<'a> {
    bsdf: Box<dyn Bsdf + 'a>,
    tangent: Tangent,
}

impl Bsdf for BoundOriented<'_> {
    fn evaluate(&self, incoming: &Direction, outgoing: &Direction, values: &mut [f64]) {
        self.bsdf.evaluate(&self.tangent.to_frame(incoming), &self.tangent.to_frame(outgoing), values);
    }

    fn evaluate_many(&self, incoming: &[Direction], outgoing: &[Direction], values: &mut [f64]) {
        self.bsdf.evaluate_many(&self.tangent.all_to_frame(incoming), &self.tangent.all_to_frame(outgoing), values);
    }

    fn straight_through(&self, incoming: &Direction) -> f64 {
        self.bsdf.straight_through(&self.tangent.to_frame(incoming))
    }

    fn sample(&self, outgoing: &Direction, random: [f64; 3]) -> Option<Sample> {
        let sample = self.bsdf.sample(&self.tangent.to_frame(outgoing), random)?;
        Some(Sample { incoming: self.tangent.out_of_frame(&sample.incoming), ..sample })
    }

    fn density(&self, incoming: &Direction, outgoing: &Direction) -> f64 {
        self.bsdf.density(&self.tangent.to_frame(incoming), &self.tangent.to_frame(outgoing))
    }
}

/// A tangent in the surface, by its azimuth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Tangent {
    sin_azimuth: f64,
    cos_azimuth: f64,
}

impl Tangent {
    /// The tangent at this azimuth from x towards y, degrees.
    pub(super) fn at_degrees(azimuth_deg: f64) -> Self {
        let (sin_azimuth, cos_azimuth) = azimuth_deg.to_radians().sin_cos();
        Self { sin_azimuth, cos_azimuth }
    }

    /// The same direction in the frame whose x axis is this tangent and whose z axis is the normal.
    pub(super) fn to_frame(self, direction: &Direction) -> Direction {
        Direction::new(
            self.cos_azimuth * direction.x + self.sin_azimuth * direction.y,
            self.cos_azimuth * direction.y - self.sin_azimuth * direction.x,
            direction.z,
        )
    }

    /// The direction that [`Tangent::to_frame`] takes to this one.
    pub(super) fn out_of_frame(self, direction: &Direction) -> Direction {
        Self { sin_azimuth: -self.sin_azimuth, ..self }.to_frame(direction)
    }

    /// [`Tangent::to_frame`] of each direction.
    pub(super) fn all_to_frame(self, directions: &[Direction]) -> Vec<Direction> {
        directions.iter().map(|direction| self.to_frame(direction)).collect()
    }
}
