//! What was measured, after it has been read and checked: spectra at given angles, or peak wavelengths at given angles.

use std::f64::consts::PI;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Geometry;

/// What the numbers of a table mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// BRDF, 1/sr.
    Brdf,
    /// BRDF times the cosine of the viewer's inclination, 1/sr.
    BsdfCos,
    /// Ratio to a white Lambertian standard in the same instrument: 1 = as bright as the standard.
    Reflectance,
}

impl Quantity {
    /// Name of a column that holds it, with its unit.
    pub fn column(self) -> &'static str {
        match self {
            Self::Brdf => "brdf_per_sr",
            Self::BsdfCos => "bsdf_cos_per_sr",
            Self::Reflectance => "reflectance",
        }
    }

    /// The reading as a ratio to a white Lambertian standard, whose BRDF is 1/π in all directions.
    pub fn reflectance_factor(self, reading: f64, geometry: &Geometry) -> f64 {
        match self {
            Self::Brdf => PI * reading,
            Self::BsdfCos => PI * reading / geometry.theta_o_deg.to_radians().cos(),
            Self::Reflectance => reading,
        }
    }
}

/// One geometry's readings over wavelength. Wavelengths rise strictly, every number is finite, every σ positive.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum {
    /// Name in the table, or its angles where the table has none.
    pub id: String,
    /// Angles of light and viewer.
    pub geometry: Geometry,
    /// Whose it is.
    pub origin: Origin,
    /// Wavelengths, nm.
    pub wavelengths_nm: Vec<f64>,
    /// Readings; a reflectance in percent has been divided by 100.
    pub values: Vec<f64>,
    /// Standard deviation of each reading, where the table gives one.
    pub sigmas: Option<Vec<f64>>,
}

/// Whose spectrum it is, as far as the table says.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Origin {
    /// The individual; None where the table names none: then each spectrum is a specimen of its own.
    pub specimen: Option<String>,
    /// What sets specimens apart that are not to be compared: species, patch. Empty where the table has no such column.
    pub group: String,
    /// Whether nobody wrote down where light and viewer stood. The geometry is then that of the normal, and only a model
    /// that does not depend on it may be compared with the spectrum.
    pub without_geometry: bool,
}

/// A checked gonio table: at least one spectrum, either all with σ or none.
#[derive(Debug, Clone, PartialEq)]
pub struct GonioTable {
    /// Meaning of the values.
    pub quantity: Quantity,
    /// One spectrum a geometry, in the order of the file.
    pub spectra: Vec<Spectrum>,
}

impl Spectrum {
    /// The individual's name: the table's, or the spectrum's own where the table names no individuals.
    pub fn specimen(&self) -> &str {
        self.origin.specimen.as_deref().unwrap_or(&self.id)
    }
}

/// One peak wavelength read off a spectrum.
#[derive(Debug, Clone, PartialEq)]
pub struct PeakReading {
    /// Name in the table, or its angles where the table has none.
    pub id: String,
    /// Angles of light and viewer.
    pub geometry: Geometry,
    /// Wavelength of the spectrum's local maximum, nm.
    pub wavelength_nm: f64,
    /// Standard deviation, nm, where the table gives one.
    pub sigma_nm: Option<f64>,
    /// Which maximum: 1 is the one of longest wavelength, 2 the next. Missing where nobody knows.
    pub order: Option<u32>,
}

/// A checked peak table: at least one reading, either all with σ or none.
#[derive(Debug, Clone, PartialEq)]
pub struct PeakTable {
    /// In the order of the file.
    pub readings: Vec<PeakReading>,
}

/// A checked table of either kind.
#[derive(Debug, Clone, PartialEq)]
pub enum Table {
    /// Readings over wavelength.
    Spectra(GonioTable),
    /// Peak wavelengths.
    Peaks(PeakTable),
}
