//! One film seen at an angle that nobody wrote down: only the product of index, thickness and cosine can be told.
//!
//! **Model.** The film's phase is δ = 2π P(λ)/λ, P(λ) = n(λ) d cosθ (Born and Wolf 1999, section 7.6), and P at 550 nm is the
//! parameter `optical_path_nm`; its change with wavelength is that of n. Amplitudes of the two surfaces are those at normal
//! incidence, r = (r₀₁ + r₁₂ e^{2iδ})/(1 + r₀₁ r₁₂ e^{2iδ}): at another angle they are larger or smaller, which scales contrast and
//! level, and for that a fit frees the instrument's gain and offset.
//!
//! | parameter | symbol | unit | default | range |
//! | --- | --- | --- | --- | --- |
//! | `optical_path_nm`: n d cosθ at 550 nm, θ the angle inside the film | P | nm | 450 | 20 to 5000 |
//! | `path_spread`: standard deviation of P within the reading, over P | s | | 0 | 0 to 0.3 |
//!
//! A probe sees many barbules at many angles, and not all films are alike: the reading is the mean of R over a normal
//! distribution of P, which damps fringes the more the higher their order. It is taken at 15 points from −3 to 3 standard
//! deviations; the sum is right to 0.3 % of a fringe's height as long as a step of it, 0.43 s · 4πP/λ, is below π.
//!
//! A path of λ/4 more or less, with other gain and offset, is often nearly as good: the fit lists these twins as rivals. At
//! the mean of several angles P is a mean. To get d, divide by n and by the cosine, if you come to know it:
//! cosθ = √(1 − sin²θ₀/n²), θ₀ the angle in air.
//!
//! **What it leaves out.** Roughness, several layers, and how θ changes the surfaces' reflectance and, for polarised light, their phase.

use num_complex::Complex64;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::channel_parameters::Declarations;
use super::lambertian::BoundLambertian;
use super::{Bsdf, MaterialChoice, Model, ModelError};
use crate::optics::Dispersion;
use crate::optics::stack::{Layer, transfer};
use crate::parameter::{Parameter, Spread};

/// Wavelength at which the optical path is given, nm: the middle of the visible range.
const REFERENCE_NM: f64 = 550.0;

/// A film without an angle, as typed in a job.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FilmAtUnknownAngleDesign {
    /// What the film is made of.
    pub film: MaterialChoice,
    /// What lies below it.
    pub substrate: MaterialChoice,
}

/// The film for a list of wavelengths.
#[derive(Debug, Clone)]
pub struct FilmAtUnknownAngle {
    /// Wavelength and the indices of film and substrate in each channel.
    channels: Vec<(f64, Complex64, Complex64)>,
    /// n of the film at the reference.
    reference_index: f64,
    parameters: Vec<Parameter>,
}

impl FilmAtUnknownAngle {
    /// The model at these wavelengths (nm, one a channel).
    ///
    /// # Errors
    /// No wavelengths, senseless ones, or a material that is unknown or has no index there.
    pub fn new(design: &FilmAtUnknownAngleDesign, wavelengths_nm: &[f64]) -> Result<Self, ModelError> {
        let mut declarations = Declarations::new(wavelengths_nm, &[])?;
        let film = checked(&design.film, wavelengths_nm)?;
        let substrate = checked(&design.substrate, wavelengths_nm)?;
        // A table of the film may end before the reference: then its end stands for it.
        let reference_nm = match film.check(&[REFERENCE_NM]) {
            Ok(()) => REFERENCE_NM,
            Err(_) => wavelengths_nm[wavelengths_nm.len() / 2],
        };
        let shortest_nm = wavelengths_nm.iter().copied().fold(f64::INFINITY, f64::min);
        declarations.number(Parameter {
            name: "optical_path_nm".to_owned(),
            symbol: "n d cosθ".to_owned(),
            unit: "nm",
            default: 450.0,
            lower: 20.0,
            upper: 5000.0,
            spread: Spread::Logarithmic,
            // A reflectance repeats with half a wavelength, a misfit in places with a quarter; four points a valley.
            scan_step: Some(shortest_nm / 16.0),
            text: "optical path in the film: index × thickness × cosine of the unknown angle inside it, at 550 nm"
                .to_owned(),
        });
        declarations.number(Parameter {
            name: "path_spread".to_owned(),
            symbol: "s".to_owned(),
            unit: "",
            default: 0.0,
            lower: 0.0,
            upper: 0.3,
            spread: Spread::Linear,
            scan_step: None,
            text: "standard deviation of the optical path within one reading, as a share of it".to_owned(),
        });
        Ok(Self {
            channels: wavelengths_nm.iter().map(|&nm| (nm, film.at(nm), substrate.at(nm))).collect(),
            reference_index: film.at(reference_nm).re,
            parameters: declarations.finish()?,
        })
    }
}

fn checked(choice: &MaterialChoice, wavelengths_nm: &[f64]) -> Result<Dispersion, ModelError> {
    let (name, dispersion) = choice.resolve()?;
    dispersion
        .check(wavelengths_nm)
        .map_err(|problem| ModelError::Material { what: format!("material {name:?}"), problem })?;
    Ok(dispersion)
}

impl Model for FilmAtUnknownAngle {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn channel_count(&self) -> usize {
        self.channels.len()
    }

    fn bind(&self, values: &[f64]) -> Box<dyn Bsdf + '_> {
        let paths = paths(values[0], values[1]);
        let reflectance = self.channels.iter().map(|&(wavelength_nm, index, substrate)| {
            let of = |path_nm: f64| {
                let layer = Layer { index, thickness_nm: path_nm / self.reference_index };
                transfer(1.0, &[layer], substrate, 1.0, wavelength_nm).reflectance.unpolarised()
            };
            paths.iter().map(|(path_nm, weight)| weight * of(*path_nm)).sum()
        });
        Box::new(BoundLambertian::of_albedo(reflectance))
    }
}

/// Optical paths and their weights, which sum to one: a normal distribution of this relative standard deviation.
fn paths(path_nm: f64, spread: f64) -> Vec<(f64, f64)> {
    if spread <= 0.0 {
        return vec![(path_nm, 1.0)];
    }
    let deviations = (-7..=7).map(|k| 3.0 * f64::from(k) / 7.0);
    let density = |x: f64| (-0.5 * x * x).exp();
    let whole: f64 = deviations.clone().map(density).sum();
    deviations.map(|x| (path_nm * (1.0 + spread * x), density(x) / whole)).collect()
}
