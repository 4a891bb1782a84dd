//! A layer of feather that scatters and absorbs, over black: what a plain reflectance spectrum of pigmented plumage shows.
//!
//! **Model.** Two streams of diffuse light through a layer of thickness X that scatters S and absorbs K per length (Kubelka and
//! Munk 1931), nothing behind it (Kubelka 1948, R₀ = 1/(a + b coth bSX), a = 1 + K/S, b = √(a² − 1)). With k = KX and s = SX, which
//! is all that one spectrum can tell, and x = √(k (k + 2s)):
//!
//! R = s tanh(x)/x / (1 + (s + k) tanh(x)/x),   reading = g + (1 − g) R
//!
//! This form has no pole: R = s/(1 + s) at k = 0, 0 at s = 0, and 1 + k/s − √((k/s)² + 2k/s), the remission of an endless layer, as
//! s grows at a given k/s. g is light that the surface sends back before any pigment has seen it, the same at every wavelength.
//!
//! | parameter | symbol | unit | default | range |
//! | --- | --- | --- | --- | --- |
//! | those of each pigment; amounts are k at its reference | c | | 1 | 0 to 1000 |
//! | `scattering`: s at 500 nm | s | | 2 | 0.001 to 1000 |
//! | `scattering_exponent`: s ∝ λ^−b | b | | 0.5 | −2 to 4 |
//! | `gloss` | g | | 0 | 0 to 0.5 |
//! | with `sponge`: `sponge.strength`, times the rest at 500 nm | h | | 1 | 0 to 100 |
//! | with `sponge`: `sponge.peak_nm`, `sponge.width_nm` | λ₀, w | nm | 450, 50 | 200 to 900, 10 to 300 |
//!
//! An exponent of 4 is that of parts far smaller than the wavelength (Rayleigh), 0 that of parts far larger. The sponge adds
//! h exp(−(λ − λ₀)²/2w²) to λ^−b: scattering that is coherent over one band, as in feathers that are blue or green without iridescence.
//!
//! Lambertian: no direction of light or viewer enters, so it reads spectra whose geometry nobody wrote down.
//!
//! **What it is not.** k and s are those of diffuse light through the whole plumage: a concentration in mg/g does not follow from
//! them without the thickness and the path that light takes. Where s ≫ 1, k and s are known only as their ratio. Left out:
//! fluorescence, iridescence, the change of the surface's share with wavelength.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::absorbers::{Absorbers, AmountScale};
use super::channel_parameters::Declarations;
use super::lambertian::BoundLambertian;
use super::{Bsdf, Model, ModelError};
use crate::parameter::{Parameter, Spread};
use crate::pigment::PigmentDesign;

/// A scattering, absorbing layer as typed in a job.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct PigmentedBaseDesign {
    /// What absorbs in it; none is white plumage.
    pub pigments: Vec<PigmentDesign>,
    /// Whether a band of wavelengths is scattered more than the rest.
    pub sponge: bool,
}

/// A scattering, absorbing layer for a list of wavelengths.
#[derive(Debug, Clone)]
pub struct PigmentedBase {
    wavelengths_nm: Vec<f64>,
    absorbers: Absorbers,
    scattering: usize,
    exponent: usize,
    gloss: usize,
    /// Position of the sponge's strength, peak and width, one after the other.
    sponge: Option<usize>,
    parameters: Vec<Parameter>,
}

impl PigmentedBase {
    /// The model at these wavelengths (nm, one a channel).
    ///
    /// # Errors
    /// No wavelengths, senseless ones, or a pigment that cannot be.
    pub fn new(design: &PigmentedBaseDesign, wavelengths_nm: &[f64]) -> Result<Self, ModelError> {
        let mut declarations = Declarations::new(wavelengths_nm, &[])?;
        let scale = AmountScale { unit: "", default: 1.0, upper: 1000.0, fibre: false };
        let absorbers = Absorbers::declare(&design.pigments, wavelengths_nm, scale, &mut declarations)?;
        let mut number = |name: &str, symbol: &str, unit, [default, lower, upper]: [f64; 3], spread, text: &str| {
            declarations.number(Parameter {
                name: name.to_owned(),
                symbol: symbol.to_owned(),
                unit,
                default,
                lower,
                upper,
                spread,
                scan_step: None,
                text: text.to_owned(),
            })
        };
        let (linear, logarithmic) = (Spread::Linear, Spread::Logarithmic);
        let scattering = number(
            "scattering",
            "s",
            "",
            [2.0, 1e-3, 1e3],
            logarithmic,
            "scattering through the whole layer at 500 nm, over which amounts of pigment count",
        );
        let exponent = number(
            "scattering_exponent",
            "b",
            "",
            [0.5, -2.0, 4.0],
            linear,
            "scattering falls with this power of the wavelength",
        );
        let gloss = number(
            "gloss",
            "g",
            "",
            [0.0, 0.0, 0.5],
            linear,
            "share of the light that the surface sends back unchanged, at every wavelength",
        );
        let sponge = design.sponge.then(|| {
            let text = "scattering that the sponge adds at its peak, over the rest at 500 nm";
            let first = number("sponge.strength", "h", "", [1.0, 0.0, 100.0], linear, text);
            let text = "wavelength that the sponge scatters most";
            number("sponge.peak_nm", "λ₀", "nm", [450.0, 200.0, 900.0], linear, text);
            let text = "standard deviation of the band that the sponge scatters";
            number("sponge.width_nm", "w", "nm", [50.0, 10.0, 300.0], logarithmic, text);
            first
        });
        let parameters = declarations.finish()?;
        let wavelengths_nm = wavelengths_nm.to_vec();
        Ok(Self { wavelengths_nm, absorbers, scattering, exponent, gloss, sponge, parameters })
    }
}

impl Model for PigmentedBase {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn channel_count(&self) -> usize {
        self.wavelengths_nm.len()
    }

    fn bind(&self, values: &[f64]) -> Box<dyn Bsdf + '_> {
        let gloss = values[self.gloss];
        let absorption = self.absorbers.absorption(values);
        let reflectance = absorption.iter().zip(&self.wavelengths_nm).map(|(&absorption, &wavelength_nm)| {
            let mut relative = (wavelength_nm / 500.0).powf(-values[self.exponent]);
            if let Some(sponge) = self.sponge {
                let x = (wavelength_nm - values[sponge + 1]) / values[sponge + 2];
                relative += values[sponge] * (-0.5 * x * x).exp();
            }
            let below = layer_reflectance(absorption, values[self.scattering] * relative);
            gloss + (1.0 - gloss) * below
        });
        Box::new(BoundLambertian::of_albedo(reflectance))
    }
}

/// Diffuse reflectance over black of a layer of absorption k = KX and scattering s = SX, both 0 or more (Kubelka 1948).
///
/// Accurate to rounding everywhere: no difference of like numbers is taken.
pub fn layer_reflectance(absorption: f64, scattering: f64) -> f64 {
    let x = (absorption * (absorption + 2.0 * scattering)).sqrt();
    // tanh(x)/x → 1 as x → 0, with an error of x²/3.
    let t = if x < 1e-8 { 1.0 } else { x.tanh() / x };
    scattering * t / (1.0 + (scattering + absorption) * t)
}
