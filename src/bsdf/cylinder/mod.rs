//! Dielectric cylinder: a barb, a barbule or a hair, as a rough, clear or absorbing circular fibre.
//!
//! **Model.** S = Σₚ Mₚ Nₚ (d'Eon et al. 2011, *An energy-conserving hair reflectance model*; Chiang et al. 2016, *A
//! practical and controllable hair and fur model for production path tracing*; the exact form of the formulas as in Pharr 2016,
//! *The implementation of a hair scattering model*). Light that is reflected (R, p = 0), passes through (TT, 1) or
//! is reflected once inside (TRT, 2) has a lobe of its own; everything later shares one that is uniform around the
//! fibre. Mₚ spreads along the fibre, see [`LongitudinalMapping`]; Nₚ spreads around it, see [`AzimuthalLobe`].
//! S is energy per light and solid angle: ∫ S dωi at a fixed viewer is the [`Attenuation::total`], 1 without absorption.
//! As a [`Bsdf`] the fibre is f = S/|n·ωi|, so that f times the cosine integrates to the same.
//!
//! **Frame.** The fibre lies along x, the tangent. θ is the inclination from the plane across the fibre, sinθ = x; φ is the
//! azimuth around the fibre. Light comes from below the surface too: a fibre shines through.
//!
//! **Parameters.** `eta` index relative to the outside (1.05 to 3); `beta_m` and `beta_n` roughness along and around the
//! fibre (0.02 to 1); `sigma_a` absorption, 1/radius of the fibre (0 to 20 in a fit, any in a call).
//! `eta` and `sigma_a` have one value for all channels, or one for each where the design says so.
//!
//! **What it leaves out.** Scales tilted against the axis, a medulla or pores ([`crate::bsdf::spongy_barb`] has them),
//! elliptical and conical sections, coherence between paths, polarisation.
//!
//! **It is not reciprocal.** Aₚ and the refraction hang on one direction alone. Here it is the viewer's. A white fibre sends
//! exactly all light on its way for each viewer; ∫ S dωo for a fixed light runs, for η 1.55 and βₘ 0.1 to 0.6, from 1.05
//! (βₘ 0.6, light across the fibre) to 0.72 (βₘ 0.3, light at 87° of inclination).

mod attenuation;
mod azimuth_table;
mod azimuthal;
mod batch;
mod far_field;
mod filmed;
mod longitudinal;
mod model;
mod near_field;
mod pairs;
mod panels;
mod quadrature;
mod sampling;
mod shades;
mod surface;
mod tabulated;

use super::{Bsdf, Direction, Sample, one_at_a_time};
use crate::pigment::{InversionError, solve_decreasing};

pub use attenuation::Attenuation;
pub use azimuthal::AzimuthalLobe;
pub use filmed::{FilmedCylinderDesign, FilmedCylinderModel};
pub use longitudinal::LongitudinalMapping;
pub use model::{CylinderDesign, CylinderModel};
pub use near_field::NearFieldCylinderModel;
pub use tabulated::TabulatedCylinder;

use azimuthal::{NarrowLogistic, TrimmedLogistic, WrappedGaussian};
use far_field::{FarField, Refraction};
use longitudinal::Longitudinal;
use pairs::FEWEST;
use quadrature::{Analyticity, PanelLengths};
pub(super) use sampling::{AzimuthalSource, FibreSampler, LazySampler};
pub(super) use shades::{PictureFibre, for_picture};
use surface::{BareSurface, Surface};

/// Light and viewer as the fibre sees them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FibreAngles {
    /// Sine of the light's inclination from the plane across the fibre.
    pub sin_theta_i: f64,
    /// Its cosine, never negative.
    pub cos_theta_i: f64,
    /// Sine of the viewer's inclination.
    pub sin_theta_o: f64,
    /// Its cosine, never negative.
    pub cos_theta_o: f64,
    /// Azimuth of the light minus that of the viewer, radians.
    pub phi: f64,
}

impl FibreAngles {
    /// From the inclinations of light and viewer, −π/2 to π/2, and the light's azimuth minus the viewer's.
    pub fn new(theta_i: f64, theta_o: f64, phi: f64) -> Self {
        let (sin_theta_i, cos_theta_i) = theta_i.sin_cos();
        let (sin_theta_o, cos_theta_o) = theta_o.sin_cos();
        Self { sin_theta_i, cos_theta_i: cos_theta_i.max(0.0), sin_theta_o, cos_theta_o: cos_theta_o.max(0.0), phi }
    }

    /// From directions in the local frame, the fibre along x.
    pub fn between(incoming: &Direction, outgoing: &Direction) -> Self {
        Self {
            sin_theta_i: incoming.x,
            cos_theta_i: (incoming.y * incoming.y + incoming.z * incoming.z).sqrt(),
            sin_theta_o: outgoing.x,
            cos_theta_o: (outgoing.y * outgoing.y + outgoing.z * outgoing.z).sqrt(),
            phi: (incoming.z * outgoing.y - incoming.y * outgoing.z)
                .atan2(incoming.y * outgoing.y + incoming.z * outgoing.z),
        }
    }
}

/// A parameter that no fibre can have.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CylinderError {
    /// A fibre of index 1 or less.
    #[error(
        "the refractive index of a fibre must be above 1 and at most {MOST_INDEX}, relative to what surrounds it, but {0} was given; keratin in air has 1.55"
    )]
    Index(f64),
    /// A roughness out of range.
    #[error("the roughness {name} of a fibre must be between {LEAST_ROUGHNESS} and 1, but {value} was given")]
    Roughness {
        /// `beta_m` or `beta_n`.
        name: &'static str,
        /// What was given.
        value: f64,
    },
    /// A negative absorption, or one that is no number.
    #[error(
        "the absorption sigma_a of channel {channel} must be a finite number, 0 or more, in 1/radius of the fibre, but {value} was given"
    )]
    Absorption {
        /// Number of the channel, from 0.
        channel: usize,
        /// What was given.
        value: f64,
    },
    /// Lists of different length.
    #[error(
        "a fibre needs one refractive index and one absorption for each channel, but {eta} indices and {sigma_a} absorptions were given"
    )]
    ChannelCount {
        /// Number of indices.
        eta: usize,
        /// Number of absorptions.
        sigma_a: usize,
    },
}

const MOST_INDEX: f64 = 5.0;

/// Below this the lobes are narrower than half a degree and the quadrature costs in proportion.
const LEAST_ROUGHNESS: f64 = 0.01;

/// What a fibre is made of.
#[derive(Debug, Clone, PartialEq)]
pub struct CylinderParameters {
    /// Refractive index relative to the outside, one a channel, above 1.
    pub eta: Vec<f64>,
    /// Absorption, one a channel, 1/radius.
    pub sigma_a: Vec<f64>,
    /// Roughness along the fibre, 0.01 to 1.
    pub beta_m: f64,
    /// Roughness around the fibre, 0.01 to 1.
    pub beta_n: f64,
    /// How `beta_m` becomes the width of the lobes.
    pub mapping: LongitudinalMapping,
    /// Shape of the lobes around the fibre, and how `beta_n` becomes their width.
    pub lobe: AzimuthalLobe,
}

impl CylinderParameters {
    fn check(&self) -> Result<(), CylinderError> {
        if self.eta.len() != self.sigma_a.len() {
            return Err(CylinderError::ChannelCount { eta: self.eta.len(), sigma_a: self.sigma_a.len() });
        }
        if let Some(&eta) = self.eta.iter().find(|&&eta| !(eta > 1.0 && eta <= MOST_INDEX)) {
            return Err(CylinderError::Index(eta));
        }
        for (name, value) in [("beta_m", self.beta_m), ("beta_n", self.beta_n)] {
            if !(LEAST_ROUGHNESS..=1.0).contains(&value) {
                return Err(CylinderError::Roughness { name, value });
            }
        }
        match self.sigma_a.iter().position(|&sigma_a| !(sigma_a >= 0.0 && sigma_a.is_finite())) {
            Some(channel) => Err(CylinderError::Absorption { channel, value: self.sigma_a[channel] }),
            None => Ok(()),
        }
    }
}

/// A fibre with all its numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Cylinder {
    groups: Vec<Group>,
    longitudinal: Longitudinal,
    lobe: Lobe,
    sampler: LazySampler,
}

/// Neighbouring channels of one index: they share all angles and reflectances.
#[derive(Debug, Clone, PartialEq)]
struct Group {
    eta: f64,
    sigma_a: Vec<f64>,
    panel_lengths: PanelLengths,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Lobe {
    Logistic(TrimmedLogistic),
    Narrow(NarrowLogistic),
    Gaussian(WrappedGaussian),
}

impl Lobe {
    fn analytic_height(self) -> f64 {
        use azimuthal::Density;
        match self {
            Self::Logistic(density) => density.analytic_height(),
            Self::Narrow(density) => density.analytic_height(),
            Self::Gaussian(density) => density.analytic_height(),
        }
    }
}

impl Cylinder {
    /// Checks the parameters and prepares what no direction changes.
    ///
    /// # Errors
    /// If a parameter is out of its range or no number.
    pub fn new(parameters: &CylinderParameters) -> Result<Self, CylinderError> {
        parameters.check()?;
        Ok(Self::from_checked(parameters))
    }

    fn from_checked(parameters: &CylinderParameters) -> Self {
        let lobe = match parameters.lobe {
            AzimuthalLobe::TrimmedLogistic => {
                let density = TrimmedLogistic::new(parameters.beta_n);
                if density.is_wide() { Lobe::Logistic(density) } else { Lobe::Narrow(NarrowLogistic(density)) }
            }
            AzimuthalLobe::WrappedGaussian => Lobe::Gaussian(WrappedGaussian::new(parameters.beta_n)),
        };
        let mut groups: Vec<Group> = Vec::new();
        for (&eta, &sigma_a) in parameters.eta.iter().zip(&parameters.sigma_a) {
            match groups.last_mut() {
                Some(group) if group.eta.to_bits() == eta.to_bits() => group.sigma_a.push(sigma_a),
                _ => {
                    // No exit azimuth turns faster than 2 for a step of γ.
                    let analyticity = Analyticity { beside: 0.5 * lobe.analytic_height(), at_end: eta.acosh() };
                    groups.push(Group { eta, sigma_a: vec![sigma_a], panel_lengths: PanelLengths::new(analyticity) });
                }
            }
        }
        Self {
            groups,
            longitudinal: Longitudinal::new(parameters.mapping.variance(parameters.beta_m)),
            lobe,
            sampler: LazySampler::default(),
        }
    }

    /// Number of channels.
    pub fn channel_count(&self) -> usize {
        self.groups.iter().map(|group| group.sigma_a.len()).sum()
    }

    /// Index and absorption of each channel.
    fn channels(&self) -> impl Iterator<Item = (f64, f64)> {
        self.groups.iter().flat_map(|group| group.sigma_a.iter().map(|&sigma_a| (group.eta, sigma_a)))
    }

    /// Far-field scattering function S, 1/sr, one value a channel: the mean over the fibre's width.
    ///
    /// Error below 1e-6 of the larger of S and 1e-6 of its peak over azimuths, for βₙ from 0.05 to 1.
    ///
    /// # Panics
    /// If `values` is not one number a channel.
    pub fn far_field(&self, angles: &FibreAngles, values: &mut [f64]) {
        assert_eq!(values.len(), self.channel_count(), "one value a channel");
        let [reflected, once, twice] = self.longitudinal.evaluate(angles);
        self.sum_lobes(angles, [reflected, once, twice, twice], values);
    }

    /// What the fibre is drawn from, a source of lobes given.
    pub(super) fn sampler_of(&self, source: impl AzimuthalSource) -> FibreSampler {
        FibreSampler::new(self.longitudinal.clone(), self.lobe.analytic_height(), source)
    }

    fn sampler(&self) -> &FibreSampler {
        self.sampler.get(|| self.sampler_of(CylinderLobes::new(self)))
    }

    /// Σ Mₚ Nₚ for given Mₚ, the fourth for all paths after TRT.
    fn sum_lobes(&self, angles: &FibreAngles, longitudinal: [f64; 4], values: &mut [f64]) {
        let mut rest = values;
        for group in &self.groups {
            let (values, others) = rest.split_at_mut(group.sigma_a.len());
            rest = others;
            self.sum_group(group, BareSurface, &group.sigma_a, angles, longitudinal, values);
        }
    }

    /// Σ Mₚ Nₚ for fibres of one index.
    fn sum_group(
        &self,
        group: &Group,
        surface: impl Surface,
        sigma_a: &[f64],
        angles: &FibreAngles,
        longitudinal: [f64; 4],
        values: &mut [f64],
    ) {
        let arch = pulp::Arch::new();
        let panel_lengths = &group.panel_lengths;
        let (refraction, phi) = (Refraction::new(group.eta, angles.sin_theta_o, angles.cos_theta_o), angles.phi);
        match self.lobe {
            Lobe::Logistic(density) => {
                arch.dispatch(FarField {
                    density,
                    surface,
                    panel_lengths,
                    refraction,
                    phi,
                    longitudinal,
                    sigma_a,
                    values,
                });
            }
            Lobe::Narrow(density) => {
                arch.dispatch(FarField {
                    density,
                    surface,
                    panel_lengths,
                    refraction,
                    phi,
                    longitudinal,
                    sigma_a,
                    values,
                });
            }
            Lobe::Gaussian(density) => {
                arch.dispatch(FarField {
                    density,
                    surface,
                    panel_lengths,
                    refraction,
                    phi,
                    longitudinal,
                    sigma_a,
                    values,
                });
            }
        }
    }

    /// For each channel, what the surface reflects in these directions, M₀ N₀, and what leaves the fibre otherwise, ½ ∫ Σ_{p≥1}
    /// Aₚ dh.
    pub(super) fn outside_and_inside(&self, angles: &FibreAngles, mut each: impl FnMut(usize, f64, f64)) {
        let [reflected, ..] = self.longitudinal.evaluate(angles);
        let mut channel = 0;
        for group in &self.groups {
            let mut value = [0.0];
            self.sum_group(group, BareSurface, &[0.0], angles, [reflected, 0.0, 0.0, 0.0], &mut value);
            for &sigma_a in &group.sigma_a {
                let mean =
                    Attenuation::mean(&Refraction::new(group.eta, angles.sin_theta_o, angles.cos_theta_o), sigma_a);
                each(channel, value[0], mean.total() - mean.direct[0]);
                channel += 1;
            }
        }
    }

    /// Near-field scattering function, 1/sr, one value a channel, at the position h across the fibre (−1 to 1, in radii).
    /// The [far field](Self::far_field) is its mean over h.
    ///
    /// # Panics
    /// If `values` is not one number a channel.
    pub fn near_field(&self, angles: &FibreAngles, h: f64, values: &mut [f64]) {
        assert_eq!(values.len(), self.channel_count(), "one value a channel");
        let longitudinal = self.longitudinal.evaluate(angles);
        for (value, (eta, sigma_a)) in values.iter_mut().zip(self.channels()) {
            let refraction = Refraction::new(eta, angles.sin_theta_o, angles.cos_theta_o);
            *value = match self.lobe {
                Lobe::Logistic(density) => {
                    near_field::near_field(density, &refraction, angles.phi, longitudinal, h, sigma_a)
                }
                Lobe::Narrow(density) => {
                    near_field::near_field(density, &refraction, angles.phi, longitudinal, h, sigma_a)
                }
                Lobe::Gaussian(density) => {
                    near_field::near_field(density, &refraction, angles.phi, longitudinal, h, sigma_a)
                }
            };
        }
    }
}

/// Mean attenuation over the width of a fibre of index `eta` and absorption `sigma_a` in 1/radius, for a viewer at the
/// inclination whose sine is `sin_theta_o`. Its total is the directional albedo of the far field, whatever the roughness.
pub fn mean_attenuation(eta: f64, sigma_a: f64, sin_theta_o: f64) -> Attenuation {
    let cos_theta_o = (1.0 - sin_theta_o * sin_theta_o).max(0.0).sqrt();
    Attenuation::mean(&Refraction::new(eta, sin_theta_o, cos_theta_o), sigma_a)
}

/// The absorption, 1/radius, at which a fibre of index `eta` has this directional albedo for a viewer at the inclination
/// whose sine is `sin_theta_o`: the exact inverse of [`mean_attenuation`], whatever the roughness.
///
/// # Errors
/// If the albedo is above 1, which no fibre reaches, or not above what the surface alone reflects, which no pigment takes
/// away (0.07 for η = 1.55 seen across the fibre).
pub fn absorption_for_albedo(eta: f64, sin_theta_o: f64, albedo: f64) -> Result<f64, InversionError> {
    let surface = mean_attenuation(eta, 0.0, sin_theta_o).direct[0];
    solve_decreasing(|sigma_a| mean_attenuation(eta, sigma_a, sin_theta_o).total(), surface, albedo)
}

impl Bsdf for Cylinder {
    /// f = S/|n·ωi|. Light that lies exactly in the surface brings no irradiance; for it f is given as 0.
    fn evaluate(&self, incoming: &Direction, outgoing: &Direction, values: &mut [f64]) {
        self.far_field(&FibreAngles::between(incoming, outgoing), values);
        over_cosine(incoming, values);
    }

    /// Differs from [`Bsdf::evaluate`] by less than 1e-8 of the value.
    fn evaluate_many(&self, incoming: &[Direction], outgoing: &[Direction], values: &mut [f64]) {
        if incoming.len() < FEWEST {
            return one_at_a_time(self, incoming, outgoing, values);
        }
        batch::evaluate(self, incoming, outgoing, values);
    }

    fn sample(&self, outgoing: &Direction, random: [f64; 3]) -> Option<Sample> {
        self.sampler().sample(outgoing, random)
    }

    fn density(&self, incoming: &Direction, outgoing: &Direction) -> f64 {
        self.sampler().density(incoming, outgoing)
    }
}

/// The lobes around a fibre, for its sampler.
pub(super) struct CylinderLobes<'a> {
    cylinder: &'a Cylinder,
    values: Vec<f64>,
}

impl<'a> CylinderLobes<'a> {
    pub(super) fn new(cylinder: &'a Cylinder) -> Self {
        Self { cylinder, values: vec![0.0; cylinder.channel_count()] }
    }

    /// Nₚ, one a channel.
    pub(super) fn channels(&mut self, angles: &FibreAngles, path: usize) -> &[f64] {
        self.cylinder.sum_lobes(angles, only(path), &mut self.values);
        &self.values
    }
}

impl AzimuthalSource for CylinderLobes<'_> {
    fn lobe(&mut self, angles: &FibreAngles, path: usize) -> f64 {
        let channels = self.channels(angles, path);
        channels.iter().sum::<f64>() / channels.len() as f64
    }
}

/// Mₚ = 1 for one path and 0 for the others.
fn only(path: usize) -> [f64; 4] {
    std::array::from_fn(|other| if other == path { 1.0 } else { 0.0 })
}

/// Turns a scattering function into a BSDF.
pub(super) fn over_cosine(incoming: &Direction, values: &mut [f64]) {
    let cosine = incoming.z.abs();
    let factor = if cosine > 0.0 { 1.0 / cosine } else { 0.0 };
    for value in values {
        *value *= factor;
    }
}
