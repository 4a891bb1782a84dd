//! Solving a case on part of a table, and predicting the rest.

use std::collections::BTreeMap;

use super::case::{assign, first_gains, spectra_problem};
use super::{JobError, JobFile};
use crate::fit::{Control, Fit, FitError, Residuals, Role, fit};
use crate::measure::{Calibration, GonioTable, Spectrum};

/// Parameter values by name.
pub(super) type Values = BTreeMap<String, f64>;

/// Values of a fit's best minimum by name.
pub(super) fn values_by_name(fit: &Fit) -> Values {
    fit.estimates.iter().map(|estimate| (estimate.name.clone(), estimate.value)).collect()
}

/// Fits a job's model to these spectra. Names in the job's list of parameters that its model does not have (those of a
/// film that was taken away) are passed over. No fit where nothing is free.
pub(super) fn solve(file: &JobFile, table: &GonioTable, control: &Control) -> Result<(Values, Option<Fit>), JobError> {
    let problem = spectra_problem(file, table, &vec![true; table.spectra.len()])?;
    let declared = problem.parameters();
    let mut typed = file.parameters.clone();
    typed.retain(|name, _| declared.iter().any(|parameter| parameter.name == *name));
    let gains = first_gains(&problem, &table.spectra, &file.instrument);
    let assignments = assign(declared, &typed, &file.instrument, &gains)?;
    match fit(&problem, &assignments, &file.fit, control) {
        Ok(fit) => Ok((values_by_name(&fit), Some(fit))),
        Err(FitError::NothingFree) => {
            let fixed = declared.iter().zip(&assignments).map(|(parameter, assignment)| {
                let value = if let Role::Fixed(value) = assignment.role { value } else { parameter.default };
                (parameter.name.clone(), value)
            });
            Ok((fixed.collect(), None))
        }
        Err(error) => Err(error.into()),
    }
}

/// The model's readings at the geometry of these spectra. A gain or offset of a spectrum that the fit did not see is
/// taken from that spectrum itself, by least squares: it says how the instrument was set, not what the feather is.
pub(super) fn predict(file: &JobFile, table: &GonioTable, values: &Values) -> Result<Vec<Vec<f64>>, JobError> {
    let problem = spectra_problem(file, table, &vec![true; table.spectra.len()])?;
    let declared = problem.parameters();
    let all: Vec<f64> =
        declared.iter().map(|parameter| values.get(&parameter.name).copied().unwrap_or(parameter.default)).collect();
    let mut readings = problem.readings(&all);
    for (spectrum, model) in table.spectra.iter().zip(&mut readings) {
        let unseen = |word: &str, calibration| {
            calibration == Calibration::PerSpectrum && !values.contains_key(&format!("{word}.{}", spectrum.id))
        };
        let (gain, offset) = (unseen("gain", file.instrument.gain), unseen("offset", file.instrument.offset));
        if gain || offset {
            calibrate(spectrum, gain, offset, model);
        }
    }
    Ok(readings)
}

/// Scales and shifts a model spectrum to a measured one by weighted least squares, as far as each is free.
fn calibrate(spectrum: &Spectrum, free_gain: bool, free_offset: bool, model: &mut [f64]) {
    let weight = |index: usize| spectrum.sigmas.as_ref().map_or(1.0, |sigmas| sigmas[index].powi(-2));
    let (mut s, mut sm, mut sy, mut smm, mut smy) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for (index, (m, y)) in model.iter().zip(&spectrum.values).enumerate() {
        let w = weight(index);
        s += w;
        sm += w * m;
        sy += w * y;
        smm += w * m * m;
        smy += w * m * y;
    }
    let (gain, offset) = match (free_gain, free_offset) {
        (true, true) => {
            let determinant = s * smm - sm * sm;
            if determinant <= f64::EPSILON * s * smm {
                (0.0, sy / s) // a flat model carries no shape to scale
            } else {
                ((s * smy - sm * sy) / determinant, (smm * sy - sm * smy) / determinant)
            }
        }
        (true, false) => (if smm > 0.0 { smy / smm } else { 0.0 }, 0.0),
        (false, _) => (1.0, (sy - sm) / s),
    };
    for value in model {
        *value = gain * *value + offset;
    }
}
