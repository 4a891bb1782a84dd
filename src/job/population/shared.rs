//! The misfit that all specimens share, taken out of their errors.
//!
//! A model that is not quite right misses every specimen alike, over many neighbouring wavelengths. A fit's standard errors are
//! widened for that, and rightly: its values may be off by so much. But they are off by the same in every specimen, and a
//! difference between two specimens is not. Compared by their whole errors, all specimens would always seem alike.
//!
//! So the residuals rᵢ(λ) of k specimens are split into their mean and the rest, sᵢ = (rᵢ − r̄) √(k/(k − 1)), and the error
//! of specimen i beside the others is its standard error times √(S Wₛ/R W): S and R are the mean squares of sᵢ and rᵢ (in units
//! of σ where it is known; then R is 1, since the standard error holds for that, and S not below 1), Wₛ and W the factors N/Nₑ by
//! which their lag-1 correlation lowers the number of independent readings.

use super::{Specimen, as_f64};
use crate::fit::effective_readings;
use crate::measure::GonioTable;

/// Fewest specimens whose mean says what they share.
const FEWEST: usize = 3;

/// Sets every specimen's own errors; leaves them as the fit gave them where specimens differ in their wavelengths, or are
/// fewer than three.
pub(super) fn take_out_shared_misfit(
    specimens: &mut [Specimen],
    widenings: &[f64],
    table: &GonioTable,
    is_widened: bool,
) {
    let Some(first) = specimens.first() else { return };
    let grid = |one: &Specimen| one.spectra.iter().map(|spectrum| spectrum.wavelengths_nm.clone()).collect::<Vec<_>>();
    let common = grid(first);
    if specimens.len() < FEWEST || specimens.iter().any(|one| grid(one) != common) {
        return;
    }
    let known = table.spectra.iter().all(|spectrum| spectrum.sigmas.is_some());
    let residuals: Vec<Vec<f64>> = specimens
        .iter()
        .map(|one| {
            let own = table.spectra.iter().filter(|spectrum| spectrum.specimen() == one.name);
            let sigmas = own.flat_map(|spectrum| match &spectrum.sigmas {
                Some(sigmas) if known => sigmas.clone(),
                _ => vec![1.0; spectrum.values.len()],
            });
            let misfit = one.spectra.iter().flat_map(|s| s.fitted.iter().zip(&s.measured).map(|(m, y)| m - y));
            misfit.zip(sigmas).map(|(misfit, sigma)| misfit / sigma).collect()
        })
        .collect();
    let count = as_f64(specimens.len());
    let readings = residuals[0].len();
    let mean: Vec<f64> = (0..readings).map(|k| residuals.iter().map(|r| r[k]).sum::<f64>() / count).collect();
    let mean_square = |values: &[f64]| values.iter().map(|value| value * value).sum::<f64>() / as_f64(readings);
    for ((specimen, residuals), widening) in specimens.iter_mut().zip(&residuals).zip(widenings) {
        let scale = (count / (count - 1.0)).sqrt();
        let rest: Vec<f64> = residuals.iter().zip(&mean).map(|(residual, mean)| scale * (residual - mean)).collect();
        let size = match known {
            true => mean_square(&rest).max(1.0),
            false => mean_square(&rest) / mean_square(residuals),
        };
        let rest_widening = if is_widened { as_f64(readings) / effective_readings(&rest) } else { 1.0 };
        let factor = (size * rest_widening).sqrt() / widening;
        // A fit without any misfit has no error to split.
        if factor.is_finite() && factor > 0.0 {
            specimen.own_errors = specimen.standard_errors.iter().map(|error| error.map(|e| factor * e)).collect();
        }
    }
}
