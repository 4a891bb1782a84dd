//! A surface that looks equally bright from everywhere (Lambert 1760): f = ρ/π above the horizon, 0 below.
//!
//! | parameter | symbol | unit | default | range |
//! | --- | --- | --- | --- | --- |
//! | `albedo`, shared or per channel | ρ | | 0.5 | 0 to 1 |
//!
//! The share ρ of the light comes back whatever its direction. Left out: everything else, gloss first.

use std::f64::consts::FRAC_1_PI;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::channel_parameters::{ChannelParameter, Declarations};
use super::sampling::{cosine_density, cosine_lobe};
use super::{Bsdf, Direction, Model, ModelError, Sample};
use crate::parameter::{Parameter, Spread};

/// A Lambertian surface as typed in a job.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct LambertianDesign {
    /// Parameters that have one value in each channel: `albedo`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub per_channel: Vec<String>,
}

/// A Lambertian surface for a list of wavelengths.
#[derive(Debug, Clone)]
pub struct Lambertian {
    parameters: Vec<Parameter>,
    albedo: ChannelParameter,
    channel_count: usize,
}

impl Lambertian {
    /// The model at these wavelengths (nm, one a channel).
    ///
    /// # Errors
    /// No wavelengths, senseless ones, or a wrong name in `per_channel`.
    pub fn new(design: &LambertianDesign, wavelengths_nm: &[f64]) -> Result<Self, ModelError> {
        let mut declarations = Declarations::new(wavelengths_nm, &design.per_channel)?;
        let albedo = declarations.spectral(Parameter {
            name: "albedo".to_owned(),
            symbol: "ρ".to_owned(),
            unit: "",
            default: 0.5,
            lower: 0.0,
            upper: 1.0,
            spread: Spread::Linear,
            scan_step: None,
            text: "share of the light that comes back".to_owned(),
        });
        Ok(Self { parameters: declarations.finish()?, albedo, channel_count: wavelengths_nm.len() })
    }
}

impl Model for Lambertian {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn channel_count(&self) -> usize {
        self.channel_count
    }

    fn bind(&self, values: &[f64]) -> Box<dyn Bsdf + '_> {
        let channels = 0..self.channel_count;
        Box::new(BoundLambertian::of_albedo(channels.map(|channel| self.albedo.value(values, channel))))
    }
}

/// A Lambertian surface with its parameters given.
#[derive(Debug)]
pub(super) struct BoundLambertian {
    /// ρ/π of each channel.
    reflectance: Vec<f64>,
}

impl BoundLambertian {
    /// The surface that sends back these shares of the light, one a channel.
    pub(super) fn of_albedo(albedo: impl Iterator<Item = f64>) -> Self {
        Self { reflectance: albedo.map(|albedo| albedo * FRAC_1_PI).collect() }
    }
}

impl Bsdf for BoundLambertian {
    fn evaluate(&self, incoming: &Direction, outgoing: &Direction, values: &mut [f64]) {
        if incoming.z > 0.0 && outgoing.z > 0.0 {
            values.copy_from_slice(&self.reflectance);
        } else {
            values.fill(0.0);
        }
    }

    fn sample(&self, outgoing: &Direction, [first, second, _]: [f64; 3]) -> Option<Sample> {
        (outgoing.z > 0.0).then(|| {
            let incoming = cosine_lobe([first, second]);
            Sample::scattered(incoming, cosine_density(&incoming))
        })
    }

    fn density(&self, incoming: &Direction, outgoing: &Direction) -> f64 {
        if outgoing.z > 0.0 { cosine_density(incoming) } else { 0.0 }
    }
}
