//! A rough interface between two clear media, which reflects and transmits (Walter, Marschner, Li and Torrance 2007).
//!
//! ```text
//! f_r = F D G1 G1 / (4 |cosθi| |cosθo|)                                       both directions on one side
//! f_t = |i·m| |o·m| (1 − F) D G1 G1 η_o² / (|cosθi| |cosθo| |η_i i + η_o o|²)  one on each side
//! ```
//!
//! (equations 20 and 21, without the cosine). i is the direction of the light, o of the viewer, `η_i` and `η_o` the
//! indices on their sides; m is the microfacet's normal, along i + o or along `η_i i + η_o o`, turned so that m·n > 0,
//! and `(η_i i·m + η_o o·m)² = |η_i i + η_o o|²`. F is Fresnel's unpolarised reflectance at i·m, D the density of
//! normals and G1 Smith's masking, of Beckmann's distribution in the exact form with the error function, or of GGX.
//!
//! | parameter | symbol | unit | default | range |
//! | --- | --- | --- | --- | --- |
//! | `roughness` | α | | 0.1 | 0.005 to 1 |
//! | `eta`, shared or per channel: index below over index above | η | | 1.56 (keratin in air) | 1.01 to 3 |
//!
//! `f_r(i, o) = f_r(o, i)` and `f_t(i → o)/η_o² = f_t(o → i)/η_i²`. With Beckmann's distribution α is √2 times the
//! standard deviation of the slopes; GGX's slopes have no standard deviation. Left out: what a second microfacet would
//! catch, absorption, polarisation.

mod sampling;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::channel_parameters::{ChannelParameter, Declarations};
use super::{Bsdf, Direction, Model, ModelError, Sample};
use crate::optics::fresnel;
use crate::optics::microfacet::{Beckmann, Ggx};
use crate::parameter::{Parameter, Spread};

/// How the slopes of the microfacets are distributed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Distribution {
    /// Gaussian slopes.
    #[default]
    Beckmann,
    /// Long tails.
    Ggx,
}

/// A microfacet interface as typed in a job.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct MicrofacetDesign {
    /// Distribution of slopes.
    pub distribution: Distribution,
    /// Parameters that have one value in each channel: `eta`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub per_channel: Vec<String>,
}

/// A rough dielectric interface for a list of wavelengths.
#[derive(Debug, Clone)]
pub struct MicrofacetInterface {
    distribution: Distribution,
    parameters: Vec<Parameter>,
    roughness: usize,
    eta: ChannelParameter,
    channel_count: usize,
}

impl MicrofacetInterface {
    /// The model at these wavelengths (nm, one a channel).
    ///
    /// # Errors
    /// No wavelengths, senseless ones, or a wrong name in `per_channel`.
    pub fn new(design: &MicrofacetDesign, wavelengths_nm: &[f64]) -> Result<Self, ModelError> {
        let mut declarations = Declarations::new(wavelengths_nm, &design.per_channel)?;
        let roughness = declarations.number(Parameter {
            name: "roughness".to_owned(),
            symbol: "α".to_owned(),
            unit: "",
            default: 0.1,
            lower: 0.005,
            upper: 1.0,
            spread: Spread::Logarithmic,
            scan_step: None,
            text: "roughness of the interface".to_owned(),
        });
        let eta = declarations.spectral(Parameter {
            name: "eta".to_owned(),
            symbol: "η".to_owned(),
            unit: "",
            default: 1.56,
            lower: 1.01,
            upper: 3.0,
            spread: Spread::Linear,
            scan_step: None,
            text: "refractive index below the interface, relative to that above it".to_owned(),
        });
        Ok(Self {
            distribution: design.distribution,
            parameters: declarations.finish()?,
            roughness,
            eta,
            channel_count: wavelengths_nm.len(),
        })
    }
}

impl Model for MicrofacetInterface {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn channel_count(&self) -> usize {
        self.channel_count
    }

    fn bind(&self, values: &[f64]) -> Box<dyn Bsdf + '_> {
        let roughness = values[self.roughness];
        Box::new(BoundInterface {
            surface: match self.distribution {
                Distribution::Beckmann => Surface::Beckmann(Beckmann::new(roughness)),
                Distribution::Ggx => Surface::Ggx(Ggx::new(roughness)),
            },
            eta: (0..self.channel_count).map(|channel| self.eta.value(values, channel)).collect(),
        })
    }
}

/// The microfacets of a surface.
#[derive(Debug, Clone, Copy)]
enum Surface {
    Beckmann(Beckmann),
    Ggx(Ggx),
}

impl Surface {
    fn density(&self, cos_theta: f64) -> f64 {
        match self {
            Self::Beckmann(microfacets) => microfacets.density(cos_theta),
            Self::Ggx(microfacets) => microfacets.density(cos_theta),
        }
    }

    fn visible_share(&self, cos_theta: f64) -> f64 {
        match self {
            Self::Beckmann(microfacets) => microfacets.visible_share(cos_theta),
            Self::Ggx(microfacets) => microfacets.visible_share(cos_theta),
        }
    }

    fn visible_normal(&self, viewer: &Direction, random: [f64; 2]) -> Direction {
        match self {
            Self::Beckmann(microfacets) => microfacets.visible_normal(viewer, random),
            Self::Ggx(microfacets) => microfacets.visible_normal(viewer, random),
        }
    }
}

/// An interface with its parameters given.
#[derive(Debug)]
struct BoundInterface {
    surface: Surface,
    /// Index below over index above, of each channel.
    eta: Vec<f64>,
}

impl Bsdf for BoundInterface {
    fn evaluate(&self, incoming: &Direction, outgoing: &Direction, values: &mut [f64]) {
        let cosines = incoming.z * outgoing.z;
        if cosines == 0.0 {
            values.fill(0.0);
            return;
        }
        let visible = self.surface.visible_share(incoming.z) * self.surface.visible_share(outgoing.z);
        if cosines > 0.0 {
            self.reflect(incoming, outgoing, visible / cosines, values);
        } else {
            self.transmit(incoming, outgoing, visible / -cosines, values);
        }
    }

    fn sample(&self, outgoing: &Direction, random: [f64; 3]) -> Option<Sample> {
        sampling::sample(self, outgoing, random)
    }

    fn density(&self, incoming: &Direction, outgoing: &Direction) -> f64 {
        sampling::density(self, incoming, outgoing)
    }
}

impl BoundInterface {
    /// `f_r`, `visible` being G1 G1/(|cosθi| |cosθo|). The half vector is the same in every channel.
    fn reflect(&self, incoming: &Direction, outgoing: &Direction, visible: f64, values: &mut [f64]) {
        let sum = incoming + outgoing;
        let length = sum.norm();
        let lobe = 0.25 * self.surface.density(sum.z.abs() / length) * visible;
        // For unit vectors i·m = |i + o|/2. From below the interface is met from its denser side.
        let cos_facet = (0.5 * length).min(1.0) * incoming.z.signum();
        for (value, &eta) in values.iter_mut().zip(&self.eta) {
            *value = lobe * fresnel::dielectric(cos_facet, eta).unpolarised();
        }
    }

    /// `f_t`, `visible` being G1 G1/(|cosθi| |cosθo|).
    fn transmit(&self, incoming: &Direction, outgoing: &Direction, visible: f64, values: &mut [f64]) {
        let light_above = incoming.z > 0.0;
        for (value, &eta) in values.iter_mut().zip(&self.eta) {
            // With the index above as the unit.
            let (eta_i, eta_o) = if light_above { (1.0, eta) } else { (eta, 1.0) };
            let sum = incoming * eta_i + outgoing * eta_o;
            let squared = sum.norm_squared();
            let m = sum * (sum.z.signum() / squared.sqrt());
            let (cos_i, cos_o) = (incoming.dot(&m), outgoing.dot(&m));
            // Each direction must see the front of the microfacet from its own side of the surface.
            if cos_i * incoming.z <= 0.0 || cos_o * outgoing.z <= 0.0 {
                *value = 0.0;
                continue;
            }
            let passed = 1.0 - fresnel::dielectric(cos_i, eta).unpolarised();
            *value = (cos_i * cos_o).abs() * passed * self.surface.density(m.z) * visible * eta_o * eta_o / squared;
        }
    }
}
