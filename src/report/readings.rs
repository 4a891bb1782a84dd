//! One reading at a time: what a case's data hold in parallel lists.

use crate::job::{Case, CaseData, SpectrumFit};
use crate::measure::{Compared, Quantity};

/// One reading of a spectrum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Reading {
    pub(crate) wavelength_nm: f64,
    pub(crate) measured: f64,
    pub(crate) model: f64,
}

impl Reading {
    /// Model minus reading.
    pub(crate) fn residual(&self) -> f64 {
        self.model - self.measured
    }
}

/// The readings of a spectrum, in the order of their wavelengths.
pub(crate) fn of(spectrum: &SpectrumFit) -> impl Iterator<Item = Reading> {
    let values = spectrum.measured.iter().zip(&spectrum.model);
    spectrum.wavelengths_nm.iter().zip(values).map(|(wavelength_nm, (measured, model))| Reading {
        wavelength_nm: *wavelength_nm,
        measured: *measured,
        model: *model,
    })
}

/// Whether a table has curves over wavelength to draw, and not only a few channels.
pub(crate) fn are_spectra(spectra: &[SpectrumFit]) -> bool {
    spectra.iter().any(|spectrum| spectrum.wavelengths_nm.len() > FEW_CHANNELS)
}

/// Most channels that are drawn as channels: RGB has three.
pub(crate) const FEW_CHANNELS: usize = 3;

/// Name and unit of what was measured, as an axis says it.
pub(crate) fn quantity_label(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Brdf => "BRDF (1/sr)",
        Quantity::BsdfCos => "BRDF × cos θₒ (1/sr)",
        Quantity::Reflectance => "reflectance",
    }
}

/// What a reader must know of the quantity's scale.
pub(crate) fn quantity_note(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Reflectance => "Reflectance is relative to a white standard in the same instrument, which has 1.",
        Quantity::Brdf | Quantity::BsdfCos => "",
    }
}

/// Units of a quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Units {
    /// As it follows a number, its space included.
    pub(crate) following: &'static str,
    /// As a heading says it; empty for a pure number.
    pub(crate) name: &'static str,
    /// That of the squared readings.
    pub(crate) squared: &'static str,
}

/// Units of what a case's fit compares.
pub(crate) fn units(case: &Case) -> Units {
    match &case.data {
        CaseData::Spectra { compare: Compared::CubeRoots, quantity, .. } => match quantity {
            Quantity::Brdf | Quantity::BsdfCos => {
                Units { following: "/sr^⅓", name: "cube roots, 1/sr^⅓", squared: "1/sr^⅔" }
            }
            Quantity::Reflectance => Units { following: "", name: "cube roots", squared: "" },
        },
        _ => reading_units(case),
    }
}

/// Units of a case's readings.
pub(crate) fn reading_units(case: &Case) -> Units {
    match &case.data {
        CaseData::Spectra { quantity: Quantity::Brdf | Quantity::BsdfCos, .. } => {
            Units { following: "/sr", name: "1/sr", squared: "1/sr²" }
        }
        CaseData::Spectra { quantity: Quantity::Reflectance, .. } => Units { following: "", name: "", squared: "" },
        CaseData::Peaks { .. } => Units { following: " nm", name: "nm", squared: "nm²" },
    }
}

/// A quantity's name with its unit in brackets, as a heading has it.
pub(crate) fn labelled(name: &str, unit: &str) -> String {
    if unit.is_empty() { name.to_owned() } else { format!("{name} ({unit})") }
}

/// Root mean square of model minus reading over what the fit saw, with its unit.
pub(crate) fn rms(case: &Case) -> Option<String> {
    let residuals: Vec<f64> = match &case.data {
        CaseData::Spectra { spectra, .. } => {
            spectra.iter().filter(|s| s.fitted).flat_map(of).map(|r| r.residual()).collect()
        }
        CaseData::Peaks { peaks, .. } => {
            let fitted = peaks.iter().filter(|p| p.fitted);
            fitted.filter_map(|p| Some(p.model_nm? - p.measured_nm)).collect()
        }
    };
    if residuals.is_empty() {
        return None;
    }
    let mean = residuals.iter().map(|r| r * r).sum::<f64>() / super::chart::length(residuals.len());
    Some(format!("{}{}", crate::number::significant(mean.sqrt(), 3), reading_units(case).following))
}
