//! How measured and fitted spectra look, side by side, and how far apart they are.

use super::angles;
use crate::job::{Case, CaseData};
use crate::measure::{Geometry, Quantity};

/// Measured and fitted colour of one geometry.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Pair {
    pub(crate) name: String,
    pub(crate) measured: Seen,
    pub(crate) fitted: Seen,
    /// CIEDE2000 difference.
    pub(crate) delta_e: f64,
}

/// A colour under D65.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Seen {
    /// For a style: `#1a2b3c`.
    pub(crate) css: String,
    pub(crate) lab: [f64; 3],
}

/// The swatches of a case.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Swatches {
    pub(crate) pairs: Vec<Pair>,
    pub(crate) caption: String,
}

/// Swatches of the spectra that the page shows; none where there are no spectra or they cover too little of the visible.
pub(crate) fn of(case: &Case) -> Option<Swatches> {
    let CaseData::Spectra { quantity, spectra } = &case.data else { return None };
    let selection = angles::representative(spectra);
    let names = angles::names(spectra.iter().map(|s| &s.geometry));
    let pairs: Vec<Pair> = selection
        .indices
        .iter()
        .filter_map(|index| {
            let spectrum = &spectra[*index];
            let seen = |values: &[f64]| {
                let factors: Vec<f64> = values.iter().map(|v| v * to_factor(*quantity, &spectrum.geometry)).collect();
                colour(&spectrum.wavelengths_nm, &factors)
            };
            let (measured, fitted) = (seen(&spectrum.measured)?, seen(&spectrum.model)?);
            let delta_e = difference(&measured, &fitted);
            Some(Pair { name: names[*index].clone(), measured, fitted, delta_e })
        })
        .collect();
    (!pairs.is_empty()).then(|| Swatches { pairs, caption: selection.text.unwrap_or_default() })
}

/// What turns a reading into a reflectance factor: its ratio to a perfect white diffuser in the same place.
fn to_factor(quantity: Quantity, geometry: &Geometry) -> f64 {
    match quantity {
        Quantity::Brdf => std::f64::consts::PI,
        Quantity::BsdfCos => std::f64::consts::PI / geometry.theta_o_deg.to_radians().cos(),
        Quantity::Reflectance => 1.0,
    }
}

fn colour(_wavelengths_nm: &[f64], _reflectance_factors: &[f64]) -> Option<Seen> {
    None
}

fn difference(_one: &Seen, _other: &Seen) -> f64 {
    f64::NAN
}
