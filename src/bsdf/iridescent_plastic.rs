//! Rough plastic whose gloss interferes with the light from below, channel by channel (the second thesis's own model,
//! section 3.2).
//!
//! ```text
//! f = f_r + f_t + 2 cos(2Φ) √(f_r f_t),      2Φ = (2π η d/λ) (cosθ_ti + cosθ_to)
//! ```
//!
//! `f_r` and `f_t` are the two terms of [`super::RoughPlastic`], weights included and without a cosine, in every
//! channel with its own index η and wavelength λ; `θ_ti` and `θ_to` are the inclinations inside the film (equations
//! 3.15 to 3.22; the medium outside has index 1, so that η is the film's). 0 where either direction is below the
//! horizon.
//!
//! | parameter | symbol | unit | default | range |
//! | --- | --- | --- | --- | --- |
//! | `thickness_nm` | d | nm | 330 | 0 to 5000 |
//! | `roughness` | α | | 0.1 | 0.005 to 1 |
//! | `eta`, shared or per channel | η | | 1.56 (keratin) | 1.05 to 2.5 |
//! | `specular`, shared or per channel | `w_s` | | 1 | 0 to 1 |
//! | `diffuse`, shared or per channel | `w_d` | | 0.5 | 0 to 1 |
//!
//! Reciprocal, but **energy is not conserved**: a beam is added to diffuse light as if the two were coherent. With unit
//! weights and η 1.5 the largest directional albedo, over inclinations of the light from 0 to 89°, is for cos 2Φ = 1
//! and −1:
//!
//! | α | cos 2Φ = 1 | cos 2Φ = −1 |
//! | --- | --- | --- |
//! | 0.1 | 1.14 | 0.90 |
//! | 0.3 | 1.22 | 0.70 |
//! | 0.5 | 1.08 | 0.47 |
//!
//! Where energy counts, use [`super::CoatedBase`]. `interference` may be `off` (then it is rough plastic to rounding; a
//! thickness of 0 is not, there the term is `+2√(f_r f_t)`), or one of its bounds. Left out besides: light that goes
//! round in the film more than once, absorption, polarisation.

use std::f64::consts::PI;
use std::sync::OnceLock;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::beckmann_lobe::{HalfVector, lobe};
use super::channel_parameters::{ChannelParameter, Declarations};
use super::coat_sampling::CoatSampler;
use super::interference::Interference;
use super::rough_plastic::{self, InternalReflection};
use super::{Bsdf, Direction, Model, ModelError, Sample};
use crate::optics::elementary::sin_cos;
use crate::optics::microfacet::Beckmann;
use crate::optics::{RoughTransmittance, TransmittanceCurves, fresnel};
use crate::parameter::{Parameter, Spread};

/// An iridescent rough plastic as typed in a job.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct IridescentPlasticDesign {
    /// The phase term.
    pub interference: Interference,
    /// How the bounces between coat and base are summed.
    pub internal_reflection: InternalReflection,
    /// Parameters that have one value in each channel: `eta`, `specular`, `diffuse`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub per_channel: Vec<String>,
}

/// An iridescent rough plastic for a list of wavelengths.
#[derive(Debug, Clone)]
pub struct IridescentPlastic {
    design: IridescentPlasticDesign,
    parameters: Vec<Parameter>,
    thickness_nm: usize,
    roughness: usize,
    eta: ChannelParameter,
    specular: ChannelParameter,
    diffuse: ChannelParameter,
    wavelengths_nm: Vec<f64>,
}

impl IridescentPlastic {
    /// The model at these wavelengths (nm, one a channel).
    ///
    /// # Errors
    /// No wavelengths, senseless ones, or a wrong name in `per_channel`.
    pub fn new(design: &IridescentPlasticDesign, wavelengths_nm: &[f64]) -> Result<Self, ModelError> {
        let mut declarations = Declarations::new(wavelengths_nm, &design.per_channel)?;
        let thickness_nm = declarations.number(thickness_nm(wavelengths_nm));
        let roughness = declarations.number(rough_plastic::roughness());
        let eta = declarations.spectral(rough_plastic::eta());
        let specular = declarations.spectral(rough_plastic::specular());
        let diffuse = declarations.spectral(rough_plastic::diffuse());
        Ok(Self {
            design: design.clone(),
            parameters: declarations.finish()?,
            thickness_nm,
            roughness,
            eta,
            specular,
            diffuse,
            wavelengths_nm: wavelengths_nm.to_vec(),
        })
    }
}

/// Thickness of a film that interferes. A misfit repeats in it with the period λ/(2η), in places with half of that; a
/// quarter of this half, at the shortest wavelength and an index of 2, steps over no minimum.
pub(super) fn thickness_nm(wavelengths_nm: &[f64]) -> Parameter {
    let shortest_nm = wavelengths_nm.iter().copied().fold(f64::INFINITY, f64::min);
    Parameter {
        name: "thickness_nm".to_owned(),
        symbol: "d".to_owned(),
        unit: "nm",
        default: 330.0,
        lower: 0.0,
        upper: 5000.0,
        spread: Spread::Linear,
        scan_step: Some(shortest_nm / 32.0),
        text: "thickness of the film".to_owned(),
    }
}

impl Model for IridescentPlastic {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn channel_count(&self) -> usize {
        self.wavelengths_nm.len()
    }

    fn bind(&self, values: &[f64]) -> Box<dyn Bsdf + '_> {
        let (thickness_nm, roughness) = (values[self.thickness_nm], values[self.roughness]);
        let of_channels = |parameter: ChannelParameter| {
            (0..self.wavelengths_nm.len()).map(move |channel| parameter.value(values, channel))
        };
        let eta: Vec<f64> = of_channels(self.eta).collect();
        let double_phase = |(&eta, &wavelength_nm)| 2.0 * PI * eta * thickness_nm / wavelength_nm;
        Box::new(BoundIridescentPlastic {
            interference: self.design.interference,
            roughness,
            coat: Beckmann::new(roughness),
            transmittances: RoughTransmittance::curves(&eta, roughness),
            specular: of_channels(self.specular).collect(),
            diffuse: self
                .design
                .internal_reflection
                .diffuse_factors(eta.iter().copied().zip(of_channels(self.diffuse)), roughness),
            double_phase: eta.iter().zip(&self.wavelengths_nm).map(double_phase).collect(),
            eta,
            sampler: OnceLock::new(),
        })
    }
}

/// An iridescent rough plastic with its parameters given; lists have one number a channel.
#[derive(Debug)]
struct BoundIridescentPlastic {
    interference: Interference,
    roughness: f64,
    coat: Beckmann,
    transmittances: TransmittanceCurves,
    eta: Vec<f64>,
    /// `w_s`.
    specular: Vec<f64>,
    /// `w_d/(π η² (1 − R_int))`.
    diffuse: Vec<f64>,
    /// 2Φ per unit of `cosθ_ti + cosθ_to`.
    double_phase: Vec<f64>,
    /// What it is drawn from, made at the first draw.
    sampler: OnceLock<CoatSampler>,
}

impl BoundIridescentPlastic {
    /// Gloss and base are weighed as if they did not interfere: `(√f_r ± √f_t)²` is at most twice their sum.
    fn sampler(&self) -> &CoatSampler {
        self.sampler.get_or_init(|| {
            let spread = |&eta: &f64| PI * RoughTransmittance::diffuse_transmittance(eta, self.roughness);
            let spread: Vec<f64> = self.eta.iter().map(spread).collect();
            let mut passed = vec![0.0; self.eta.len()];
            CoatSampler::new(self.coat, None, |cosine| {
                passed.fill(1.0);
                self.transmittances.multiply(cosine, &mut passed);
                let (mut gloss, mut diffuse) = (0.0, 0.0);
                for (channel, passed) in passed.iter().enumerate() {
                    let least = fresnel::dielectric(1.0, self.eta[channel]).unpolarised();
                    gloss += self.specular[channel] * (1.0 - passed).max(least);
                    diffuse += self.diffuse[channel] * passed * spread[channel];
                }
                (gloss, diffuse)
            })
        })
    }
}

impl Bsdf for BoundIridescentPlastic {
    fn evaluate(&self, incoming: &Direction, outgoing: &Direction, values: &mut [f64]) {
        if incoming.z <= 0.0 || outgoing.z <= 0.0 {
            values.fill(0.0);
            return;
        }
        let half = HalfVector::between(incoming, outgoing);
        let lobe = lobe(&self.coat, &half, incoming, outgoing);
        pulp::Arch::new().dispatch(Channels {
            film: self,
            incoming,
            outgoing,
            lobe,
            cos_facet: half.cos_facet,
            values,
        });
    }

    fn sample(&self, outgoing: &Direction, random: [f64; 3]) -> Option<Sample> {
        self.sampler().sample(outgoing, random)
    }

    fn density(&self, incoming: &Direction, outgoing: &Direction) -> f64 {
        self.sampler().density(incoming, outgoing)
    }
}

/// The loops over channels, in the form in which they are compiled once for each instruction set.
struct Channels<'a> {
    film: &'a BoundIridescentPlastic,
    incoming: &'a Direction,
    outgoing: &'a Direction,
    lobe: f64,
    cos_facet: f64,
    values: &'a mut [f64],
}

impl pulp::NullaryFnOnce for Channels<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        // One loop for each kind of interference, so that none has to choose inside.
        match self.film.interference {
            Interference::Film => self.evaluate(|phase| sin_cos(phase).1),
            Interference::Off => self.evaluate(|_| 0.0),
            Interference::Constructive => self.evaluate(|_| 1.0),
            Interference::Destructive => self.evaluate(|_| -1.0),
        }
    }
}

impl Channels<'_> {
    #[inline(always)]
    fn evaluate(self, cosine_of_phase: impl Fn(f64) -> f64) {
        let Self { film, incoming, outgoing, lobe, cos_facet, values } = self;
        // Until the last step the values hold T(θi) T(θo).
        values.fill(1.0);
        film.transmittances.multiply(incoming.z, values);
        film.transmittances.multiply(outgoing.z, values);

        let sine_squared = |cosine: f64| (1.0 - cosine * cosine).max(0.0);
        let (sine_squared_i, sine_squared_o) = (sine_squared(incoming.z), sine_squared(outgoing.z));
        let optics = film.eta.iter().zip(&film.double_phase);
        let weights = film.specular.iter().zip(&film.diffuse);
        for ((value, (&eta, double_phase)), (specular, diffuse)) in values.iter_mut().zip(optics).zip(weights) {
            let reflected = specular * lobe * fresnel::dielectric(cos_facet, eta).unpolarised();
            let transmitted = diffuse * *value;
            let inside = |sine_squared: f64| (1.0 - sine_squared / (eta * eta)).sqrt();
            let phase = double_phase * (inside(sine_squared_i) + inside(sine_squared_o));
            let interference = 2.0 * cosine_of_phase(phase) * (reflected * transmitted).sqrt();
            *value = reflected + transmitted + interference;
        }
    }
}
