//! How measured and fitted spectra look, side by side, and how far apart they are.

use super::angles;
use super::readings::{self, Reading};
use crate::job::{Case, CaseData, SpectrumFit};
use crate::measure::Quantity;
use crate::measure::colour::{Swatch, Xyz};

/// Measured and fitted colour of one geometry.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Pair {
    pub(crate) name: String,
    pub(crate) measured: Swatch,
    pub(crate) fitted: Swatch,
}

impl Pair {
    /// CIEDE2000 difference.
    pub(crate) fn difference(&self) -> f64 {
        self.measured.lab.delta_e_2000(self.fitted.lab)
    }
}

/// The swatches of a case.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Swatches {
    pub(crate) pairs: Vec<Pair>,
    pub(crate) caption: String,
}

/// Swatches of the spectra that the page shows one by one; none where a case has no spectra.
///
/// Where the brightest measured one outshines the white standard, as glossy samples do in mirror position, all are
/// darkened by one factor so that it just does not: a colour beyond white can neither be shown nor compared.
pub(crate) fn of(case: &Case) -> Option<Swatches> {
    let CaseData::Spectra { quantity, spectra, .. } = &case.data else { return None };
    // Two wavelengths have no colour.
    if spectra.iter().all(|spectrum| spectrum.wavelengths_nm.len() < 3) {
        return None;
    }
    let selection = angles::representative(spectra);
    let names = angles::spectrum_names(spectra);
    let chosen: Vec<(&String, Factors)> =
        selection.indices.iter().filter_map(|i| Some((&names[*i], Factors::of(*quantity, &spectra[*i])?))).collect();
    let brightest = chosen
        .iter()
        .filter_map(|(_, factors)| Some(Xyz::of_reflectance(&factors.wavelengths_nm, &factors.measured)?.y))
        .fold(0.0, f64::max);
    let exposure = if brightest > 1.0 { 1.0 / brightest } else { 1.0 };
    let pairs: Vec<Pair> =
        chosen.into_iter().filter_map(|(name, factors)| factors.pair(name.clone(), exposure)).collect();
    if pairs.is_empty() {
        return None;
    }
    let any = |test: fn(&Swatch) -> bool| pairs.iter().any(|p| test(&p.measured) || test(&p.fitted));
    let mut caption = vec!["CIE 1931 observer, illuminant D65; the white standard has L* = 100.".to_owned()];
    caption.extend(selection.text);
    if exposure < 1.0 {
        let factor = crate::number::significant(exposure, 3);
        caption.push(format!("All were darkened by the factor {factor}, so that the brightest is as bright as white."));
    }
    if any(|s| s.extended) {
        caption.push("The readings do not reach over 380 to 780 nm; their ends stand in for the rest.".to_owned());
    }
    if any(|s| s.clipped) {
        caption.push("An asterisk marks a colour that a screen cannot show; the nearest is shown.".to_owned());
    }
    Some(Swatches { pairs, caption: caption.join(" ") })
}

/// A spectrum as reflectance factors: ratios to a perfect white diffuser in the same place.
struct Factors {
    wavelengths_nm: Vec<f64>,
    measured: Vec<f64>,
    model: Vec<f64>,
}

impl Factors {
    /// None where no reading is a number.
    fn of(quantity: Quantity, spectrum: &SpectrumFit) -> Option<Self> {
        let is_legible = |r: &Reading| r.measured.is_finite() && r.model.is_finite();
        let legible: Vec<Reading> = readings::of(spectrum).filter(is_legible).collect();
        let factor = |reading: f64| quantity.reflectance_factor(reading, &spectrum.geometry);
        (!legible.is_empty()).then(|| Self {
            wavelengths_nm: legible.iter().map(|r| r.wavelength_nm).collect(),
            measured: legible.iter().map(|r| factor(r.measured)).collect(),
            model: legible.iter().map(|r| factor(r.model)).collect(),
        })
    }

    fn pair(&self, name: String, exposure: f64) -> Option<Pair> {
        let seen = |values: &[f64]| {
            let exposed: Vec<f64> = values.iter().map(|v| exposure * v).collect();
            Swatch::new(&self.wavelengths_nm, &exposed)
        };
        Some(Pair { name, measured: seen(&self.measured)?, fitted: seen(&self.model)? })
    }
}
