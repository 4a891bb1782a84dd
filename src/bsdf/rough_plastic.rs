//! A diffuse base under a rough clear coat: gloss from the coat, colour from below.
//!
//! ```text
//! f = w_s F D G1 G1 / (4 cosθi cosθo) + w_d T(θi) T(θo) / (π η² (1 − R_int))
//! ```
//!
//! 0 where either direction is below the horizon. The first term is the reflection of [`super::MicrofacetInterface`]
//! with Beckmann's distribution; in the second T is the rough interface's transmittance from outside and `R_int` the
//! share of diffuse light that it throws back inside (Jakob's rough plastic in Mitsuba, 2010; the second thesis,
//! section 2.5, with `R_int` as in [`RoughInterface`](crate::optics::RoughInterface)). `1/(1 − R_int)` is all that
//! bounces between coat and base; 1/η² is the solid angle that widens when light leaves.
//!
//! | parameter | symbol | unit | default | range |
//! | --- | --- | --- | --- | --- |
//! | `roughness` | α | | 0.1 | 0.005 to 1 |
//! | `eta`: index of the coat over that outside | η | | 1.56 (keratin in air) | 1.05 to 2.5 |
//! | `specular`, shared or per channel | `w_s` | | 1 | 0 to 1 |
//! | `diffuse`, shared or per channel: albedo of the base | `w_d` | | 0.5 | 0 to 1 |
//!
//! Reciprocal. Never more than arrives comes back; what is missing, single scattering loses. Directional albedo at
//! `w_s = w_d = 1` and η 1.5, over inclinations of the light from 0 to 89°:
//!
//! | α | least | largest |
//! | --- | --- | --- |
//! | 0.1 | 0.925 | 0.988 |
//! | 0.3 | 0.857 | 0.891 |
//! | 0.5 | 0.729 | 0.753 |
//!
//! T and `R_int` come from the table [`RoughTransmittance`], which keeps the second term within 0.5 % of exact.
//! [`Bsdf::evaluate_many`] and
//! [`Bsdf::density_many`] differ from one pair at a time by 1e-5 of the value at most. Left out: light that the coat
//! scatters twice, absorption in it, polarisation.

mod batch;
mod densities;

use std::f64::consts::PI;
use std::sync::OnceLock;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use self::batch::DirectionTable;
use super::beckmann_lobe::{HalfVector, lobe};
use super::channel_parameters::{ChannelParameter, Declarations};
use super::coat_sampling::CoatSampler;
use super::{Bsdf, Direction, Model, ModelError, Sample};
use crate::optics::microfacet::Beckmann;
use crate::optics::{RoughTransmittance, TransmittanceCurve, fresnel};
use crate::parameter::{Parameter, Spread};

/// How the bounces between coat and base are summed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum InternalReflection {
    /// `1 − R_int`: the base's colour acts once, whatever the number of bounces.
    #[default]
    Linear,
    /// `1 − w_d R_int`: the base's colour acts at every bounce, so that dark colours become darker and purer.
    Nonlinear,
    /// `1 − R_d` with `R_d = 1 − T_d`, `T_d` the diffuse transmittance from inside, as in the second thesis (equation
    /// 2.54): what single scattering loses counts as thrown back, and the base is brighter on rough coats.
    Thesis,
}

impl InternalReflection {
    /// What T(θi) T(θo) is multiplied by in each channel, `w_d/(π η² (1 − …))`, for a channel's index and `w_d`.
    pub(super) fn diffuse_factors(self, channels: impl Iterator<Item = (f64, f64)>, alpha: f64) -> Vec<f64> {
        // Most often all channels share their index; then the table is read once.
        let mut last = (f64::NAN, f64::NAN);
        let factor = |(eta, diffuse): (f64, f64)| {
            if eta.to_bits() != last.0.to_bits() {
                last = (eta, self.mean(eta, alpha));
            }
            let remaining = match self {
                Self::Linear => 1.0 - last.1,
                Self::Nonlinear => 1.0 - diffuse * last.1,
                Self::Thesis => last.1,
            };
            diffuse / (PI * eta * eta * remaining)
        };
        channels.map(factor).collect()
    }

    /// The mean over diffuse light from inside that the sum needs: `R_int` or `T_d`.
    fn mean(self, eta: f64, alpha: f64) -> f64 {
        match self {
            Self::Linear | Self::Nonlinear => RoughTransmittance::diffuse_reflectance(1.0 / eta, alpha),
            Self::Thesis => RoughTransmittance::diffuse_transmittance(1.0 / eta, alpha),
        }
    }
}

/// A rough plastic as typed in a job.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct RoughPlasticDesign {
    /// How the bounces between coat and base are summed.
    pub internal_reflection: InternalReflection,
    /// Parameters that have one value in each channel: `specular`, `diffuse`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub per_channel: Vec<String>,
}

/// A rough plastic for a list of wavelengths.
#[derive(Debug, Clone)]
pub struct RoughPlastic {
    internal_reflection: InternalReflection,
    parameters: Vec<Parameter>,
    roughness: usize,
    eta: usize,
    specular: ChannelParameter,
    diffuse: ChannelParameter,
    channel_count: usize,
}

impl RoughPlastic {
    /// The model at these wavelengths (nm, one a channel).
    ///
    /// # Errors
    /// No wavelengths, senseless ones, or a wrong name in `per_channel`.
    pub fn new(design: &RoughPlasticDesign, wavelengths_nm: &[f64]) -> Result<Self, ModelError> {
        let mut declarations = Declarations::new(wavelengths_nm, &design.per_channel)?;
        let roughness = declarations.number(roughness());
        let eta = declarations.number(eta());
        let specular = declarations.spectral(specular());
        let diffuse = declarations.spectral(diffuse());
        Ok(Self {
            internal_reflection: design.internal_reflection,
            parameters: declarations.finish()?,
            roughness,
            eta,
            specular,
            diffuse,
            channel_count: wavelengths_nm.len(),
        })
    }
}

pub(super) fn roughness() -> Parameter {
    Parameter {
        name: "roughness".to_owned(),
        symbol: "α".to_owned(),
        unit: "",
        default: 0.1,
        lower: *RoughTransmittance::ROUGHNESSES.start(),
        upper: *RoughTransmittance::ROUGHNESSES.end(),
        spread: Spread::Logarithmic,
        scan_step: None,
        text: "roughness of the coat, √2 times the standard deviation of its slopes (Beckmann)".to_owned(),
    }
}

pub(super) fn eta() -> Parameter {
    Parameter {
        name: "eta".to_owned(),
        symbol: "η".to_owned(),
        unit: "",
        default: 1.56,
        lower: *RoughTransmittance::INDICES.start(),
        upper: *RoughTransmittance::INDICES.end(),
        spread: Spread::Linear,
        scan_step: None,
        text: "refractive index of the coat, relative to that outside".to_owned(),
    }
}

pub(super) fn specular() -> Parameter {
    Parameter {
        name: "specular".to_owned(),
        symbol: "w_s".to_owned(),
        unit: "",
        default: 1.0,
        lower: 0.0,
        upper: 1.0,
        spread: Spread::Linear,
        scan_step: None,
        text: "weight of the gloss, 1 for a clear coat".to_owned(),
    }
}

pub(super) fn diffuse() -> Parameter {
    Parameter {
        name: "diffuse".to_owned(),
        symbol: "w_d".to_owned(),
        unit: "",
        default: 0.5,
        lower: 0.0,
        upper: 1.0,
        spread: Spread::Linear,
        scan_step: None,
        text: "albedo of the base".to_owned(),
    }
}

impl Model for RoughPlastic {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn channel_count(&self) -> usize {
        self.channel_count
    }

    fn bind(&self, values: &[f64]) -> Box<dyn Bsdf + '_> {
        let (roughness, eta) = (values[self.roughness], values[self.eta]);
        let of_channel =
            |parameter: ChannelParameter| (0..self.channel_count).map(move |channel| parameter.value(values, channel));
        Box::new(BoundRoughPlastic {
            roughness,
            eta,
            coat: Beckmann::new(roughness),
            transmittance: RoughTransmittance::curve(eta, roughness),
            specular: of_channel(self.specular).collect(),
            diffuse: self
                .internal_reflection
                .diffuse_factors(of_channel(self.diffuse).map(|diffuse| (eta, diffuse)), roughness),
            directions: OnceLock::new(),
            sampler: OnceLock::new(),
        })
    }
}

/// A rough plastic with its parameters given.
#[derive(Debug)]
struct BoundRoughPlastic {
    roughness: f64,
    eta: f64,
    coat: Beckmann,
    transmittance: TransmittanceCurve,
    /// `w_s` of each channel.
    specular: Vec<f64>,
    /// `w_d/(π η² (1 − R_int))` of each channel.
    diffuse: Vec<f64>,
    /// What many pairs at a time need, made at the first of them.
    directions: OnceLock<DirectionTable>,
    /// What it is drawn from, made at the first draw.
    sampler: OnceLock<CoatSampler>,
}

impl BoundRoughPlastic {
    fn directions(&self) -> &DirectionTable {
        self.directions.get_or_init(|| DirectionTable::new(&self.coat, &self.transmittance))
    }

    fn sampler(&self) -> &CoatSampler {
        self.sampler.get_or_init(|| {
            let of_mean = 1.0 / self.specular.len() as f64;
            let specular = self.specular.iter().sum::<f64>() * of_mean;
            // ∫ T(θi) cosθi dωi is π times the transmittance of diffuse light.
            let diffuse = self.diffuse.iter().sum::<f64>()
                * of_mean
                * PI
                * RoughTransmittance::diffuse_transmittance(self.eta, self.roughness);
            let least = fresnel::dielectric(1.0, self.eta).unpolarised();
            CoatSampler::new(self.coat, None, |cosine| {
                let passed = self.transmittance.at(cosine);
                (specular * (1.0 - passed).max(least), diffuse * passed)
            })
        })
    }
}

impl Bsdf for BoundRoughPlastic {
    fn evaluate(&self, incoming: &Direction, outgoing: &Direction, values: &mut [f64]) {
        if incoming.z <= 0.0 || outgoing.z <= 0.0 {
            values.fill(0.0);
            return;
        }
        let half = HalfVector::between(incoming, outgoing);
        let gloss =
            lobe(&self.coat, &half, incoming, outgoing) * fresnel::dielectric(half.cos_facet, self.eta).unpolarised();
        let passed = self.transmittance.at(incoming.z) * self.transmittance.at(outgoing.z);
        for ((value, specular), diffuse) in values.iter_mut().zip(&self.specular).zip(&self.diffuse) {
            *value = specular * gloss + diffuse * passed;
        }
    }

    fn evaluate_many(&self, incoming: &[Direction], outgoing: &[Direction], values: &mut [f64]) {
        batch::evaluate(self, self.directions(), incoming, outgoing, values);
    }

    fn sample(&self, outgoing: &Direction, random: [f64; 3]) -> Option<Sample> {
        self.sampler().sample(outgoing, random)
    }

    fn sample_many(&self, outgoing: &[Direction], random: &[[f64; 3]], samples: &mut [Option<Sample>]) {
        densities::sample(self, self.directions(), outgoing, random, samples);
    }

    fn density(&self, incoming: &Direction, outgoing: &Direction) -> f64 {
        self.sampler().density(incoming, outgoing)
    }

    fn density_many(&self, incoming: &[Direction], outgoing: &[Direction], densities: &mut [f64]) {
        densities::fill(self, self.directions(), incoming, outgoing, densities);
    }
}
