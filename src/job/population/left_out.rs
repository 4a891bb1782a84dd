//! Each specimen predicted from the others, by the model and by their mean.

use super::{LeftOut, Specimen, as_f64, of_specimen, rms, without_specimen};
use crate::fit::Control;
use crate::job::predict::{calibrate, predict, solve};
use crate::job::{JobError, JobFile};
use crate::measure::{Calibration, GonioTable, Instrument, Spectrum};

/// Leaves out each specimen in turn, predicts it, and keeps the prediction beside its spectra.
///
/// The model is fitted to all the others as if they were one. What it is held against needs no model: the mean spectrum of
/// the others, which no model of their common shape can beat by much, and the spread of the specimens' spectra. A gain or
/// offset that the instrument gives each spectrum is taken from the left-out spectrum itself, for both.
pub(super) fn leave_one_out(
    file: &JobFile,
    seen: &GonioTable,
    specimens: &mut [Specimen],
    control: &Control,
) -> Result<LeftOut, JobError> {
    let (mut by_model, mut by_mean) = (Vec::new(), Vec::new());
    for specimen in specimens.iter_mut() {
        let (left_out, others) = (of_specimen(seen, &specimen.name), without_specimen(seen, &specimen.name));
        let (predicted, missed_by) = predict_one(file, seen, &specimen.name, control)?;
        by_model.push(missed_by);
        for (spectrum, predicted) in specimen.spectra.iter_mut().zip(predicted) {
            spectrum.predicted = Some(predicted);
        }
        let means = left_out.spectra.iter().map(|spectrum| mean_of(&others, spectrum, &file.instrument));
        by_mean.extend(means.collect::<Option<Vec<_>>>().map(|means| error(&left_out, &means)));
    }
    // One specimen that cannot be compared makes the comparison one of unlike things.
    if by_mean.len() < specimens.len() {
        by_mean.clear();
    }
    let counts: Vec<f64> =
        specimens.iter().map(|one| as_f64(one.spectra.iter().map(|s| s.measured.len()).sum())).collect();
    let together = |errors: &[f64]| {
        let squares: f64 = errors.iter().zip(&counts).map(|(error, count)| error * error * count).sum();
        (squares / counts.iter().sum::<f64>()).sqrt()
    };
    let sigmas: Option<Vec<f64>> = seen
        .spectra
        .iter()
        .map(|spectrum| spectrum.sigmas.as_ref().map(|s| s.iter().map(|sigma| sigma * sigma).sum::<f64>()))
        .collect();
    let readings: f64 = counts.iter().sum();
    Ok(LeftOut {
        model: together(&by_model),
        mean: (!by_mean.is_empty()).then(|| together(&by_mean)),
        spread: spread(seen),
        sigma: sigmas.map(|squares| (squares.iter().sum::<f64>() / readings).sqrt()),
        by_model,
        by_mean,
    })
}

/// The model's readings of one specimen from a fit to all the others, and their root mean square error.
pub(super) fn predict_one(
    file: &JobFile,
    seen: &GonioTable,
    name: &str,
    control: &Control,
) -> Result<(Vec<Vec<f64>>, f64), JobError> {
    let left_out = of_specimen(seen, name);
    let (values, _) = solve(file, &without_specimen(seen, name), control)?;
    let predicted = predict(file, &left_out, &values)?;
    let missed_by = error(&left_out, &predicted);
    Ok((predicted, missed_by))
}

fn error(measured: &GonioTable, model: &[Vec<f64>]) -> f64 {
    rms(measured.spectra.iter().zip(model).map(|(spectrum, model)| (spectrum.values.as_slice(), model.as_slice())))
}

/// The mean of the spectra at the same angles and wavelengths, with the gain and offset that this one asks for.
fn mean_of(others: &GonioTable, spectrum: &Spectrum, instrument: &Instrument) -> Option<Vec<f64>> {
    let mut mean = mean(&alike(others, spectrum))?;
    let is_free = |calibration| calibration == Calibration::PerSpectrum;
    let (gain, offset) = (is_free(instrument.gain), is_free(instrument.offset));
    if gain || offset {
        calibrate(spectrum, gain, offset, &mut mean);
    }
    Some(mean)
}

/// The spectra at the same angles and wavelengths.
fn alike<'a>(table: &'a GonioTable, spectrum: &Spectrum) -> Vec<&'a Spectrum> {
    let is_alike =
        |other: &&Spectrum| other.geometry == spectrum.geometry && other.wavelengths_nm == spectrum.wavelengths_nm;
    table.spectra.iter().filter(is_alike).collect()
}

fn mean(spectra: &[&Spectrum]) -> Option<Vec<f64>> {
    let count = as_f64(spectra.len());
    let readings = spectra.first()?.values.len();
    Some((0..readings).map(|index| spectra.iter().map(|one| one.values[index]).sum::<f64>() / count).collect())
}

/// Standard deviation of the spectra about the mean of those alike, √(Σ (y − ȳ)²/Σ (k − 1)). None where none has another
/// like it.
fn spread(table: &GonioTable) -> Option<f64> {
    let (mut squares, mut freedom) = (0.0, 0.0);
    for spectrum in &table.spectra {
        let alike = alike(table, spectrum);
        let mean = mean(&alike)?;
        squares += spectrum.values.iter().zip(&mean).map(|(y, m)| (y - m).powi(2)).sum::<f64>();
        // Each of k spectra counts for (k − 1)/k.
        freedom += as_f64(mean.len()) * (1.0 - 1.0 / as_f64(alike.len()));
    }
    (freedom > 0.0).then(|| (squares / freedom).sqrt())
}
