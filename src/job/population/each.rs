//! One specimen by itself.

use super::{Specimen, SpecimenSpectrum, rms};
use crate::fit::{Control, Estimate, Fit, Minimum};
use crate::job::predict::{predict, solve};
use crate::job::values::Values;
use crate::job::{JobError, JobFile};
use crate::measure::GonioTable;

/// Fits one specimen's spectra; gives also the factor by which its errors were widened.
///
/// Where the misfit has many minima along a parameter that was scanned, the one nearest to the best of all specimens together
/// is taken, so that values of one order of interference are compared; whether it is the specimen's own best is noted.
pub(super) fn fit_specimen(
    file: &JobFile,
    own: &GonioTable,
    name: &str,
    free: &[&String],
    pooled: &Fit,
    control: &Control,
) -> Result<(Specimen, f64), JobError> {
    let (_, Some(fit)) = solve(file, own, control)? else {
        return Err(JobError::key("specimens", "nothing is free in the fit of one specimen; free a parameter"));
    };
    let scanned = pooled.profiles.first().and_then(|(scanned, _)| {
        Some((position(&fit, scanned)?, pooled.estimates.iter().find(|estimate| estimate.name == *scanned)?.value))
    });
    let chosen = match scanned {
        Some((index, wanted)) => {
            let distance = |minimum: &Minimum| (minimum.values[index] / wanted).ln().abs();
            let nearest = fit.minima.iter().enumerate().min_by(|a, b| distance(a.1).total_cmp(&distance(b.1)));
            nearest.map_or(0, |(chosen, _)| chosen)
        }
        None => 0,
    };
    let minimum = &fit.minima[chosen];
    let rivals = scanned.map_or_else(Vec::new, |(index, _)| {
        fit.rivals().map(|(_, minimum)| (minimum.values[index], minimum.weight)).collect()
    });
    let found = free.iter().map(|name| {
        let Some(index) = position(&fit, name) else { return (f64::NAN, None) };
        let Estimate { open, at_bound, .. } = &fit.estimates[index];
        let determined = chosen > 0 || !(*open || at_bound.is_some());
        (minimum.values[index], minimum.standard_errors[index].filter(|error| determined && *error > 0.0))
    });
    let (values, standard_errors): (Vec<f64>, Vec<Option<f64>>) = found.unzip();
    let named: Values =
        fit.estimates.iter().zip(&minimum.values).map(|(estimate, value)| (estimate.name.clone(), *value)).collect();
    let model = predict(file, own, &named)?;
    let spectra: Vec<SpecimenSpectrum> = own
        .spectra
        .iter()
        .zip(model)
        .map(|(spectrum, fitted)| SpecimenSpectrum {
            id: spectrum.id.clone(),
            wavelengths_nm: spectrum.wavelengths_nm.clone(),
            measured: spectrum.values.clone(),
            fitted,
            predicted: None,
        })
        .collect();
    let rms = rms(spectra.iter().map(|one| (one.measured.as_slice(), one.fitted.as_slice())));
    let own_errors = standard_errors.clone();
    let (name, own_best) = (name.to_owned(), chosen == 0);
    let specimen = Specimen { name, values, standard_errors, own_errors, rms, own_best, rivals, spectra };
    Ok((specimen, fit.goodness.error_widening))
}

fn position(fit: &Fit, name: &str) -> Option<usize> {
    fit.estimates.iter().position(|estimate| estimate.name == name)
}
