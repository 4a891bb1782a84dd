//! Solving a case on part of a table, and predicting the rest.

use super::case::{assign, first_gains, spectra_problem};
use super::file::ParameterFile;
use super::values::{Values, in_order, places_of, values_by_name};
use super::{JobError, JobFile};
use crate::fit::{Control, ExpressionError, Fit, FitError, Residuals, first_values, fit, parse_tie};
use crate::measure::{Calibration, GonioTable, Spectrum};

/// Fits a job's model to these spectra. What the job says of parameters that are not there any more (those of a film
/// that was taken away, the gain of a spectrum that was left out) is passed over, ties to them too. No fit where nothing
/// is free.
pub(super) fn solve(file: &JobFile, table: &GonioTable, control: &Control) -> Result<(Values, Option<Fit>), JobError> {
    let problem = spectra_problem(file, table, &vec![true; table.spectra.len()])?;
    let declared = problem.parameters();
    let mut typed = file.parameters.clone();
    let first_of = |name: &str| places_of(declared, name).ok().map(|places| places[0]);
    typed.retain(|name, role| {
        let to_nothing =
            |expression: &str| matches!(parse_tie(expression, first_of), Err(ExpressionError::UnknownName { .. }));
        first_of(name).is_some() && !matches!(role, ParameterFile::Tied(expression) if to_nothing(expression))
    });
    let gains = first_gains(&problem, &table.spectra, &file.instrument);
    let assignments = assign(declared, &typed, &file.instrument, &gains)?;
    match fit(&problem, &assignments, &file.fit, control) {
        Ok(fit) => Ok((values_by_name(&fit), Some(fit))),
        Err(FitError::NothingFree) => {
            let names = declared.iter().map(|parameter| parameter.name.clone());
            Ok((names.zip(first_values(&assignments)).collect(), None))
        }
        Err(error) => Err(error.into()),
    }
}

/// The model's readings at the geometry of these spectra, with the default of whatever has no value.
pub(super) fn readings_at(file: &JobFile, table: &GonioTable, values: &Values) -> Result<Vec<Vec<f64>>, JobError> {
    let problem = spectra_problem(file, table, &vec![true; table.spectra.len()])?;
    Ok(problem.readings(&in_order(problem.parameters(), values)))
}

/// The same, but a gain or offset of a spectrum that the fit did not see is taken from that spectrum itself, by least
/// squares: it says how the instrument was set, not what the feather is.
pub(super) fn predict(file: &JobFile, table: &GonioTable, values: &Values) -> Result<Vec<Vec<f64>>, JobError> {
    let mut readings = readings_at(file, table, values)?;
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
pub(super) fn calibrate(spectrum: &Spectrum, free_gain: bool, free_offset: bool, model: &mut [f64]) {
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
