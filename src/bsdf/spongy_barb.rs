//! Spongy barb: a cylinder whose inside scatters a band of colour, the blue of feathers that are not iridescent.
//!
//! **Model.** S = S₀ + (1 − b) Σ_{p≥1} Sₚ + b Ā(θo) (1 + cosφ)/4π, b = strength · exp(−(λ − λ0)²/2w²). Of the light that has entered
//! a [`Cylinder`] and would leave it, the share b is scattered by the spongy keratin instead, preferring the way back
//! (φ = 0 is backwards). Ā(θo) = ½ ∫ Σ_{p≥1} Aₚ dh is what would have left, so the barb stays exactly as white as its cylinder:
//! ∫ S dωi is the cylinder's albedo for any band. Pigment under and in the sponge acts through Ā.
//!
//! The form is this project's own, a phenomenological stand-in for coherent scattering by a quasi-ordered medium (Prum
//! et al. 1998, *Coherent light scattering by blue feather barbs*); its band is what a peak in the medium's power
//! spectrum gives, its angular form a guess that keeps energy.
//!
//! **Parameters.** Those of the cylinder, then `strength` (0 to 1), `peak_nm` λ0 (300 to 800), `width_nm` w (5 to 200; the full
//! width at half maximum is 2.355 w).
//!
//! **What it leaves out.** The shift of the band with the angle between light and viewer, more than one band, and whatever
//! the cylinder leaves out.

use std::f64::consts::PI;

use super::cylinder::{
    AzimuthalSource, Cylinder, CylinderDesign, CylinderLobes, CylinderModel, FibreAngles, FibreSampler, LazySampler,
    PictureFibre, for_picture, over_cosine,
};
use super::{Bsdf, ChannelMix, Direction, Model, ModelError, Sample};
use crate::parameter::{Parameter, Spread};

/// A band that cannot be.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SpongyBarbError {
    /// A share above 1, or below 0.
    #[error("the strength of a spongy barb must be between 0 and 1, but {0} was given")]
    Strength(f64),
    /// No wavelength.
    #[error(
        "the band of a spongy barb needs a positive peak and width in nm, but peak {peak_nm} and width {width_nm} were given"
    )]
    Band {
        /// λ0.
        peak_nm: f64,
        /// w.
        width_nm: f64,
    },
    /// Not as many wavelengths as channels.
    #[error(
        "a spongy barb needs one wavelength for each channel of its cylinder, but {wavelengths} wavelengths and {channels} channels were given"
    )]
    ChannelCount {
        /// Wavelengths given.
        wavelengths: usize,
        /// Channels of the cylinder.
        channels: usize,
    },
}

/// The light that the sponge scatters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpongeBand {
    /// Largest share scattered, 0 to 1.
    pub strength: f64,
    /// λ0, nm.
    pub peak_nm: f64,
    /// w, standard deviation, nm.
    pub width_nm: f64,
}

impl SpongeBand {
    fn check(&self) -> Result<(), SpongyBarbError> {
        if !(0.0..=1.0).contains(&self.strength) {
            return Err(SpongyBarbError::Strength(self.strength));
        }
        let Self { peak_nm, width_nm, .. } = *self;
        if !(peak_nm > 0.0 && width_nm > 0.0 && peak_nm.is_finite() && width_nm.is_finite()) {
            return Err(SpongyBarbError::Band { peak_nm, width_nm });
        }
        Ok(())
    }

    fn share(&self, wavelength_nm: f64) -> f64 {
        let x = (wavelength_nm - self.peak_nm) / self.width_nm;
        self.strength * (-0.5 * x * x).exp()
    }
}

/// A spongy barb with all its numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct SpongyBarb {
    cylinder: Cylinder,
    /// b of each channel.
    shares: Vec<f64>,
    sampler: LazySampler,
}

impl SpongyBarb {
    /// Puts a sponge into a cylinder, with the wavelength of each of its channels.
    ///
    /// # Errors
    /// If the band is out of range, or the wavelengths are not one a channel.
    pub fn new(cylinder: Cylinder, wavelengths_nm: &[f64], band: SpongeBand) -> Result<Self, SpongyBarbError> {
        band.check()?;
        let (wavelengths, channels) = (wavelengths_nm.len(), cylinder.channel_count());
        if wavelengths != channels {
            return Err(SpongyBarbError::ChannelCount { wavelengths, channels });
        }
        Ok(Self::from_checked(cylinder, wavelengths_nm, band))
    }

    fn from_checked(cylinder: Cylinder, wavelengths_nm: &[f64], band: SpongeBand) -> Self {
        Self {
            cylinder,
            shares: wavelengths_nm.iter().map(|&wavelength| band.share(wavelength)).collect(),
            sampler: LazySampler::default(),
        }
    }

    /// Far-field scattering function S, 1/sr, one value a channel.
    ///
    /// # Panics
    /// If `values` is not one number a channel.
    pub fn far_field(&self, angles: &FibreAngles, values: &mut [f64]) {
        self.cylinder.far_field(angles, values);
        let scattering = (1.0 + angles.phi.cos()) / (4.0 * PI);
        self.cylinder.outside_and_inside(angles, |channel, reflected, transmitted| {
            values[channel] += self.shares[channel] * (reflected - values[channel] + transmitted * scattering);
        });
    }
}

impl SpongyBarb {
    fn sampler(&self) -> &FibreSampler {
        self.sampler.get(|| self.cylinder.sampler_of(Lobes { lobes: CylinderLobes::new(&self.cylinder), barb: self }))
    }
}

/// The lobes of a spongy barb, for its sampler.
struct Lobes<'a> {
    lobes: CylinderLobes<'a>,
    barb: &'a SpongyBarb,
}

impl AzimuthalSource for Lobes<'_> {
    fn lobe(&mut self, angles: &FibreAngles, path: usize) -> f64 {
        let values = self.lobes.channels(angles, path);
        let unscattered = |share: &f64| if path == 0 { 1.0 } else { 1.0 - share };
        let sum: f64 = values.iter().zip(&self.barb.shares).map(|(value, share)| unscattered(share) * value).sum();
        sum / values.len() as f64
    }

    fn sponge(&mut self, angles: &FibreAngles) -> f64 {
        let mut sum = 0.0;
        self.barb.cylinder.outside_and_inside(angles, |channel, _, transmitted| {
            sum += self.barb.shares[channel] * transmitted;
        });
        sum / self.barb.shares.len() as f64
    }
}

impl Bsdf for SpongyBarb {
    /// f = S/|n·ωi|, as for the cylinder.
    fn evaluate(&self, incoming: &Direction, outgoing: &Direction, values: &mut [f64]) {
        self.far_field(&FibreAngles::between(incoming, outgoing), values);
        over_cosine(incoming, values);
    }

    fn sample(&self, outgoing: &Direction, random: [f64; 3]) -> Option<Sample> {
        self.sampler().sample(outgoing, random)
    }

    fn density(&self, incoming: &Direction, outgoing: &Direction) -> f64 {
        self.sampler().density(incoming, outgoing)
    }
}

/// The spongy barb as a model to be fitted.
#[derive(Debug, Clone)]
pub struct SpongyBarbModel {
    cylinder: CylinderModel,
    wavelengths_nm: Vec<f64>,
    parameters: Vec<Parameter>,
}

impl SpongyBarbModel {
    /// A sponge inside this cylinder, at these wavelengths (nm, one a channel).
    ///
    /// # Errors
    /// As [`CylinderModel::new`].
    pub fn new(design: &CylinderDesign, wavelengths_nm: &[f64]) -> Result<Self, ModelError> {
        let cylinder = CylinderModel::new(design, wavelengths_nm)?;
        let mut parameters = cylinder.parameters().to_vec();
        parameters.extend([
            band_parameter(
                "strength",
                "b",
                "",
                [0.5, 0.0, 1.0],
                "Largest share of the light inside that the sponge scatters",
            ),
            band_parameter("peak_nm", "λ₀", "nm", [450.0, 300.0, 800.0], "Wavelength that the sponge scatters most"),
            band_parameter(
                "width_nm",
                "w",
                "nm",
                [50.0, 5.0, 200.0],
                "Standard deviation of the band that the sponge scatters",
            ),
        ]);
        Ok(Self { cylinder, wavelengths_nm: wavelengths_nm.to_vec(), parameters })
    }
}

impl Model for SpongyBarbModel {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn channel_count(&self) -> usize {
        self.wavelengths_nm.len()
    }

    fn bind(&self, values: &[f64]) -> Box<dyn Bsdf + '_> {
        Box::new(self.barb(values))
    }

    fn bind_for_picture(&self, shades: &[Vec<f64>], mix: Option<&ChannelMix>) -> Vec<Box<dyn Bsdf + '_>> {
        let barbs: Vec<SpongyBarb> = shades.iter().map(|values| self.barb(values)).collect();
        let fibre = |barb: &SpongyBarb| PictureFibre { cylinder: barb.cylinder.clone(), sponge: barb.shares.clone() };
        let fibres: Vec<PictureFibre> = barbs.iter().map(fibre).collect();
        for_picture(&fibres, mix, |number| Box::new(barbs[number].clone()))
    }
}

impl SpongyBarbModel {
    fn barb(&self, values: &[f64]) -> SpongyBarb {
        let (cylinder, band) = values.split_at(self.cylinder.parameters().len());
        let band = SpongeBand { strength: band[0], peak_nm: band[1], width_nm: band[2] };
        SpongyBarb::from_checked(self.cylinder.cylinder(cylinder), &self.wavelengths_nm, band)
    }
}

fn band_parameter(
    name: &str,
    symbol: &str,
    unit: &'static str,
    [default, lower, upper]: [f64; 3],
    text: &str,
) -> Parameter {
    Parameter {
        name: name.to_owned(),
        symbol: symbol.to_owned(),
        unit,
        default,
        lower,
        upper,
        spread: Spread::Linear,
        scan_step: None,
        text: text.to_owned(),
    }
}
