//! Peak wavelengths and a peak model as the fit engine sees them.

use crate::fit::Residuals;
use crate::measure::{Peak, PeakModel, PeakReading};
use crate::parameter::Parameter;

/// Readings of peaks against a model that predicts them.
///
/// Where the readings do not say which maximum they are, all are taken to be the same one, and at given parameters it
/// is the order that fits best: each order of interference then is a minimum of its own along thickness, and the engine
/// finds and lists them all.
#[derive(Debug)]
pub(super) struct PeaksProblem {
    model: Box<dyn PeakModel>,
    readings: Vec<PeakReading>,
}

/// How far beyond the readings the model's peaks are looked for, as a factor on the wavelength: an octave each way, so
/// that a poor start still has a peak to move.
const SEARCH: f64 = 2.0;

impl PeaksProblem {
    /// Compares these readings with this model.
    pub(super) fn new(model: Box<dyn PeakModel>, readings: Vec<PeakReading>) -> Self {
        Self { model, readings }
    }

    /// The order that these parameter values imply for readings without one: the one that all readings have and that
    /// fits best. None where no order has a peak at every reading.
    pub(super) fn implied_order(&self, values: &[f64]) -> Option<u32> {
        best_order(&self.all_peaks(values), &self.readings)
    }

    /// The peak of the given order (or the reading's own) at a reading's angles, nm.
    pub(super) fn peak_nm(&self, values: &[f64], reading: &PeakReading, implied: Option<u32>) -> Option<f64> {
        let order = reading.order.or(implied)?;
        find(&self.model_peaks(values, reading), order)
    }

    /// Order of interference of a peak.
    pub(super) fn interference_order(&self, peak_order: u32) -> f64 {
        self.model.interference_order(peak_order)
    }

    fn model_peaks(&self, values: &[f64], reading: &PeakReading) -> Vec<Peak> {
        let (shortest_nm, longest_nm) = (reading.wavelength_nm / SEARCH, reading.wavelength_nm * SEARCH);
        self.model.peaks(values, &reading.geometry, shortest_nm, longest_nm)
    }

    fn all_peaks(&self, values: &[f64]) -> Vec<Vec<Peak>> {
        self.readings.iter().map(|reading| self.model_peaks(values, reading)).collect()
    }
}

impl Residuals for PeaksProblem {
    fn parameters(&self) -> &[Parameter] {
        self.model.parameters()
    }

    fn count(&self) -> usize {
        self.readings.len()
    }

    fn evaluate(&self, values: &[f64], residuals: &mut [f64]) {
        let peaks = self.all_peaks(values);
        let implied = best_order(&peaks, &self.readings);
        for ((residual, reading), peaks) in residuals.iter_mut().zip(&self.readings).zip(&peaks) {
            let found = reading.order.or(implied).and_then(|order| find(peaks, order));
            *residual = found.map_or(f64::NAN, |nm| weighted(nm, reading));
        }
    }

    fn sigma_known(&self) -> bool {
        self.readings.iter().all(|reading| reading.sigma_nm.is_some())
    }
}

fn weighted(peak_nm: f64, reading: &PeakReading) -> f64 {
    (peak_nm - reading.wavelength_nm) / reading.sigma_nm.unwrap_or(1.0)
}

fn find(peaks: &[Peak], order: u32) -> Option<f64> {
    peaks.iter().find(|peak| peak.order == order).map(|peak| peak.wavelength_nm)
}

/// Among the orders that every reading without an order has a peak of, the one with the least Σr².
fn best_order(peaks: &[Vec<Peak>], readings: &[PeakReading]) -> Option<u32> {
    let open: Vec<(&Vec<Peak>, &PeakReading)> =
        peaks.iter().zip(readings).filter(|(_, reading)| reading.order.is_none()).collect();
    let (first, _) = open.first()?;
    let cost = |order: u32| -> Option<f64> {
        open.iter().map(|(peaks, reading)| find(peaks, order).map(|nm| weighted(nm, reading).powi(2))).sum()
    };
    first
        .iter()
        .filter_map(|peak| cost(peak.order).map(|cost| (peak.order, cost)))
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(order, _)| order)
}
