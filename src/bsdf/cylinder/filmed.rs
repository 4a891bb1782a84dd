//! Iridescent barbule: the dielectric cylinder with a film or a stack of layers on its surface.
//!
//! **Model.** That of the [cylinder](super), with other shares where light meets the surface: A₀ = `R_out`, Aₚ = t² `R_in`^{p−1} Tᵖ
//! for p ≥ 1. `R_out` and t are the unpolarised reflectance and transmittance of the layers between air and the fibre, met
//! at cosθo cosγ; `R_in` is the reflectance of the same layers from inside, at the refracted angle. Every internal
//! reflection of the layers carries its phase (Yeh 1988). Without absorption in the layers t = 1 − `R_out` and `R_in` =
//! `R_out`, and the fibre stays as white as a bare one. Light is taken as unpolarised again at each meeting.
//!
//! **Parameters.** `<layer>.thickness_nm` of each layer (5 to 5000), then those of the cylinder; `eta` is the index of the
//! fibre below the layers. The layers' materials are as the design says.
//!
//! **What it leaves out.** Barbules that are flat ([`CoatedBase`](crate::bsdf::CoatedBase) has them), coherence between paths
//! through the fibre, and the thickness of the layers against that of the fibre.
//!
//! The shares of each channel are tabulated over the cosine when the model is bound, some 130 to 1000 rows of two transfer
//! products; between rows they are cubic, with an error of some 1e-6.

use num_complex::Complex64;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::quadrature::{Analyticity, PanelLengths};
use super::surface::{Surface, SurfaceShares};
use super::{
    AzimuthalLobe, AzimuthalSource, Cylinder, CylinderDesign, CylinderModel, FibreAngles, FibreSampler, Group,
    LazySampler, LongitudinalMapping, only, over_cosine,
};
use crate::bsdf::coated_base::declare_thickness;
use crate::bsdf::{Bsdf, DesignLayer, Direction, Model, ModelError, Sample};
use crate::optics::stack::{Layer, transfer};
use crate::parameter::Parameter;
use crate::pigment::PigmentDesign;

/// A fibre with layers on it as typed in a job.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FilmedCylinderDesign {
    /// Layers on the fibre, from the outside in.
    pub layers: Vec<DesignLayer>,
    /// How `beta_m` becomes the width of the lobes.
    #[serde(default)]
    pub mapping: LongitudinalMapping,
    /// Shape of the lobes around the fibre, and how `beta_n` becomes their width.
    #[serde(default)]
    pub lobe: AzimuthalLobe,
    /// Parameters that have one value in each channel: `eta`, `sigma_a`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub per_channel: Vec<String>,
    /// What absorbs inside the fibre; their amounts then stand in the place of `sigma_a`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pigments: Vec<PigmentDesign>,
}

/// The filmed cylinder as a model to be fitted.
#[derive(Debug, Clone)]
pub struct FilmedCylinderModel {
    cylinder: CylinderModel,
    wavelengths_nm: Vec<f64>,
    /// n + ik of each layer, from the outside in, in each channel.
    indices: Vec<Vec<Complex64>>,
    parameters: Vec<Parameter>,
}

impl FilmedCylinderModel {
    /// The model at these wavelengths (nm, one a channel).
    ///
    /// # Errors
    /// As [`CylinderModel::new`], and for a layer whose name, thickness or material makes no sense.
    pub fn new(design: &FilmedCylinderDesign, wavelengths_nm: &[f64]) -> Result<Self, ModelError> {
        let bare = CylinderDesign {
            mapping: design.mapping,
            lobe: design.lobe,
            per_channel: design.per_channel.clone(),
            pigments: design.pigments.clone(),
        };
        let cylinder = CylinderModel::new(&bare, wavelengths_nm)?;
        let (mut indices, mut parameters) = (Vec::new(), Vec::new());
        for (position, layer) in design.layers.iter().enumerate() {
            parameters.push(declare_thickness(layer, wavelengths_nm, 1)?);
            if design.layers[..position].iter().any(|other| other.name == layer.name) {
                return Err(ModelError::TwoLayers { name: layer.name.clone() });
            }
            let (name, dispersion) = layer.material.resolve()?;
            dispersion
                .check(wavelengths_nm)
                .map_err(|problem| ModelError::Material { what: format!("material {name:?}"), problem })?;
            indices.push(wavelengths_nm.iter().map(|&wavelength| dispersion.at(wavelength)).collect());
        }
        parameters.extend_from_slice(cylinder.parameters());
        Ok(Self { cylinder, wavelengths_nm: wavelengths_nm.to_vec(), indices, parameters })
    }
}

impl Model for FilmedCylinderModel {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn channel_count(&self) -> usize {
        self.wavelengths_nm.len()
    }

    fn bind(&self, values: &[f64]) -> Box<dyn Bsdf + '_> {
        let (thicknesses_nm, values) = values.split_at(self.indices.len());
        let cylinder = self.cylinder.cylinder(values);
        let cores = cylinder.groups.iter().flat_map(|group| group.sigma_a.iter().map(|&sigma_a| (group.eta, sigma_a)));
        let channels =
            cores.zip(&self.wavelengths_nm).enumerate().map(|(channel, ((eta, sigma_a), &wavelength_nm))| {
                let layers: Vec<Layer> = (self.indices.iter().zip(thicknesses_nm))
                    .map(|(indices, &thickness_nm)| Layer { index: indices[channel], thickness_nm })
                    .collect();
                let film = FilmTable::new(&layers, eta, wavelength_nm);
                let analyticity = Analyticity {
                    beside: (0.5 * cylinder.lobe.analytic_height()).min(film.analytic_height()),
                    at_end: eta.acosh(),
                };
                (Group { eta, sigma_a: vec![sigma_a], panel_lengths: PanelLengths::new(analyticity) }, film)
            });
        let channels = channels.collect();
        Box::new(FilmedCylinder { channels, cylinder, sampler: LazySampler::default() })
    }
}

/// A filmed cylinder with its parameters given.
#[derive(Debug)]
struct FilmedCylinder {
    /// The same fibre without layers.
    cylinder: Cylinder,
    /// Every channel is a fibre of its own, since the layers tell wavelengths apart.
    channels: Vec<(Group, FilmTable)>,
    sampler: LazySampler,
}

impl FilmedCylinder {
    fn sampler(&self) -> &FibreSampler {
        self.sampler.get(|| self.cylinder.sampler_of(self))
    }

    /// Σ Mₚ Nₚ for given Mₚ, the fourth for all paths after TRT.
    fn sum_lobes(&self, angles: &FibreAngles, longitudinal: [f64; 4], values: &mut [f64]) {
        for ((group, film), value) in self.channels.iter().zip(values.chunks_exact_mut(1)) {
            self.cylinder.sum_group(group, film, &group.sigma_a, angles, longitudinal, value);
        }
    }
}

impl AzimuthalSource for &FilmedCylinder {
    fn lobe(&mut self, angles: &FibreAngles, path: usize) -> f64 {
        let mut values = vec![0.0; self.channels.len()];
        self.sum_lobes(angles, only(path), &mut values);
        values.iter().sum::<f64>() / values.len() as f64
    }
}

impl Bsdf for FilmedCylinder {
    /// f = S/|n·ωi|, as for the cylinder.
    fn evaluate(&self, incoming: &Direction, outgoing: &Direction, values: &mut [f64]) {
        let angles = FibreAngles::between(incoming, outgoing);
        let [reflected, once, twice] = self.cylinder.longitudinal.evaluate(&angles);
        self.sum_lobes(&angles, [reflected, once, twice, twice], values);
        over_cosine(incoming, values);
    }

    fn sample(&self, outgoing: &Direction, random: [f64; 3]) -> Option<Sample> {
        self.sampler().sample(outgoing, random)
    }

    fn density(&self, incoming: &Direction, outgoing: &Direction) -> f64 {
        self.sampler().density(incoming, outgoing)
    }
}

/// `R_out`, t and `R_in` of layers on a fibre at one wavelength, over the cosine outside.
#[derive(Debug)]
struct FilmTable {
    /// At evenly spaced cosines from 0 to 1.
    rows: Vec<[f64; 3]>,
    /// Largest derivative of a fringe's phase by the cosine.
    phase_rate: f64,
}

/// Rows that Fresnel's equations alone need: cubic interpolation is off by 2e-7 at most for indices up to 3.
const LEAST_INTERVALS: f64 = 128.0;

/// Spacing of the rows in a fringe's phase. A cosine is then off by 3/128 · 0.14⁴ = 1e-5 of its amplitude, which for a
/// film on keratin is some 0.1.
const PHASE_STEP: f64 = 0.14;

/// Imaginary part of a fringe's phase up to which the layers' response surely has no pole, and grows little.
const PHASE_HEIGHT: f64 = 2.0;

impl FilmTable {
    fn new(layers: &[Layer], eta: f64, wavelength_nm: f64) -> Self {
        // With 2δ = 4π d √(n² − 1 + c²)/λ, d(2δ)/dc is steepest at c = 1.
        let phase_rate: f64 = layers
            .iter()
            .map(|layer| 4.0 * std::f64::consts::PI * layer.thickness_nm / (layer.index.re * wavelength_nm))
            .sum();
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a positive whole number")]
        let intervals = LEAST_INTERVALS.max((phase_rate / PHASE_STEP).ceil()) as usize;
        let reversed: Vec<Layer> = layers.iter().rev().copied().collect();
        let row = |k: usize| {
            let cosine = k as f64 / intervals as f64;
            let cosine_inside = (1.0 - (1.0 - cosine * cosine) / (eta * eta)).sqrt();
            let outside = transfer(1.0, layers, Complex64::new(eta, 0.0), cosine, wavelength_nm);
            let inside = transfer(eta, &reversed, Complex64::new(1.0, 0.0), cosine_inside, wavelength_nm);
            [outside.reflectance, outside.transmittance, inside.reflectance].map(|share| share.unpolarised())
        };
        Self { rows: (0..=intervals).map(row).collect(), phase_rate }
    }

    /// Height above the real axis of γ up to which the shares are analytic: there the cosine is at most as far from the
    /// axis as γ is.
    fn analytic_height(&self) -> f64 {
        PHASE_HEIGHT / self.phase_rate.max(f64::MIN_POSITIVE)
    }
}

impl Surface for &FilmTable {
    /// Cubic through the four nearest rows.
    #[inline(always)]
    fn meet(&self, _eta: f64, cosine: f64, _cosine_inside: f64) -> SurfaceShares {
        let intervals = self.rows.len() - 1;
        let x = cosine * intervals as f64;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a cosine is between 0 and 1")]
        let second = (x as usize).clamp(1, intervals - 2);
        let x = x - second as f64;
        let weights = [
            -x * (x - 1.0) * (x - 2.0) / 6.0,
            (x + 1.0) * (x - 1.0) * (x - 2.0) / 2.0,
            -(x + 1.0) * x * (x - 2.0) / 2.0,
            (x + 1.0) * x * (x - 1.0) / 6.0,
        ];
        let mut shares = [0.0; 3];
        for (row, weight) in self.rows[second - 1..second + 3].iter().zip(weights) {
            for (share, value) in shares.iter_mut().zip(row) {
                *share += weight * value;
            }
        }
        let [reflectance, transmittance, back] = shares;
        SurfaceShares { reflectance, transmittance, back, not_back: 1.0 - back }
    }
}
