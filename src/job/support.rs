//! Whether the data support a film: how well incidences that were left out are predicted with and without it.

use std::sync::atomic::Ordering;

use super::case::{CheckedCase, Comparison};
use super::file::{JobFile, ModelFile};
use super::predict::{predict, solve};
use super::values::{Values, values_by_name};
use super::{JobError, Support};
use crate::bsdf::Model;
use crate::bsdf::{CoatedBase, Design};
use crate::fit::{Control, Fit};
use crate::measure::{GonioTable, Spectrum};
use crate::number::with_error;

/// Fewest incidences that a standard error over them means something for.
const FEWEST_INCIDENCES: usize = 3;

/// Leaves each incidence out in turn, with the film and without it. None where the model has no film, the table too few
/// incidences, or the user stopped the fit.
///
/// An information criterion over all readings finds a film almost everywhere, since residuals of spectra are strongly
/// correlated along wavelength. An incidence that the fit did not see is a better judge.
pub(super) fn film_support(case: &CheckedCase, best: &Fit, control: &Control) -> Result<Option<Support>, JobError> {
    let (Comparison::Spectra(table, fitted, _), ModelFile::CoatedBase(design)) = (&case.comparison, &case.file.model)
    else {
        return Ok(None);
    };
    let seen = part(table, |index| fitted[index]);
    let incidences_deg = incidences(&seen);
    let interrupted = || control.interrupt.load(Ordering::Relaxed);
    if design.layers.is_empty() || incidences_deg.len() < FEWEST_INCIDENCES || interrupted() {
        return Ok(None);
    }
    let with = &case.file;
    let without = JobFile { model: ModelFile::CoatedBase(Box::new(design.without_layers())), ..with.clone() };
    let values = values_by_name(best);
    let thickness = free_thickness(best);

    let (mut with_film, mut without_film, mut thickness_by_fold_nm) = (Vec::new(), Vec::new(), Vec::new());
    for incidence_deg in &incidences_deg {
        let is_left_out = |index: usize| same_angle(seen.spectra[index].geometry.theta_i_deg, *incidence_deg);
        let left_out = part(&seen, is_left_out);
        let rest = part(&seen, |index| !is_left_out(index));
        let (found, _) = solve(with, &rest, control)?;
        with_film.push(prediction_error(with, &left_out, &found)?);
        thickness_by_fold_nm.extend(thickness.as_ref().and_then(|name| found.get(name)).copied());
        let (found, _) = solve(&without, &rest, control)?;
        without_film.push(prediction_error(&without, &left_out, &found)?);
    }

    // Folds that were cut short judge nothing.
    if interrupted() {
        return Ok(None);
    }
    let gains: Vec<f64> = without_film.iter().zip(&with_film).map(|(without, with)| without - with).collect();
    let (gain, gain_standard_error) = mean_and_standard_error(&gains);
    let same_order = match &thickness {
        Some(name) => {
            let quarter_nm = quarter_order_nm(design, &seen, &values, name)?;
            thickness_by_fold_nm.iter().all(|fold| (fold - values[name]).abs() < quarter_nm)
        }
        None => true,
    };
    let supported = gain > 2.0 * gain_standard_error && same_order;
    let (_, control_fit) = solve(&without, &seen, control)?;
    let aicc_without = control_fit.and_then(|fit| fit.goodness.aicc);
    let delta_aicc = best.goodness.aicc.zip(aicc_without).map(|(with, without)| with - without);
    let verdict = if supported { "A film is supported" } else { "No film is supported" };
    let falls = if gain >= 0.0 { "lowers" } else { "raises" };
    let enough = gain > 2.0 * gain_standard_error;
    let needed =
        if enough { "more than the two standard errors needed" } else { "two standard errors lower are needed" };
    let joined = if enough == same_order { "and" } else { "but" };
    let orders = if same_order { "of the same order" } else { "not of the same order" };
    let unit = if seen.spectra.iter().all(|spectrum| spectrum.sigmas.is_some()) {
        "in units of σ²"
    } else {
        "as a share of the mean squared reading"
    };
    let text = format!(
        "{verdict}: leaving out one incidence at a time, the film {falls} the mean squared prediction error by {} ({unit}; \
         {needed}), {joined} its thickness is {orders} of interference in every fold.",
        with_error(gain.abs(), Some(gain_standard_error)),
    );
    Ok(Some(Support {
        incidences_deg,
        with_film,
        without_film,
        gain,
        gain_standard_error,
        thickness_by_fold_nm,
        same_order,
        supported,
        delta_aicc,
        effective_readings: best.goodness.effective_readings,
        text,
    }))
}

/// The spectra of a table that are to be kept.
pub(super) fn part(table: &GonioTable, keep: impl Fn(usize) -> bool) -> GonioTable {
    let kept = table.spectra.iter().enumerate().filter(|(index, _)| keep(*index));
    GonioTable { quantity: table.quantity, spectra: kept.map(|(_, spectrum)| spectrum.clone()).collect() }
}

/// Incidences closer than this are one: angles in tables carry two decimals at most.
fn same_angle(a_deg: f64, b_deg: f64) -> bool {
    (a_deg - b_deg).abs() < 0.01
}

fn incidences(table: &GonioTable) -> Vec<f64> {
    let mut angles: Vec<f64> = table.spectra.iter().map(|spectrum| spectrum.geometry.theta_i_deg).collect();
    angles.sort_by(f64::total_cmp);
    angles.dedup_by(|a, b| same_angle(*a, *b));
    angles
}

/// Mean squared error of the prediction: in units of σ² where σ is known, else over the mean squared reading, so that a
/// bright incidence does not outweigh a dark one.
fn prediction_error(file: &JobFile, left_out: &GonioTable, values: &Values) -> Result<f64, JobError> {
    let predicted = predict(file, left_out, values)?;
    let (mut squares, mut scale) = (0.0, 0.0);
    for (spectrum, model) in left_out.spectra.iter().zip(&predicted) {
        for (index, (m, y)) in model.iter().zip(&spectrum.values).enumerate() {
            let compare = file.data.compare;
            let sigma = known_sigma(spectrum, index).map(|sigma| compare.sigma_of(*y, sigma));
            let (m, y) = (compare.of(*m), compare.of(*y));
            squares += ((m - y) / sigma.unwrap_or(1.0)).powi(2);
            scale += if sigma.is_some() { 1.0 } else { y * y };
        }
    }
    Ok(if scale > 0.0 { squares / scale } else { 0.0 })
}

fn known_sigma(spectrum: &Spectrum, index: usize) -> Option<f64> {
    spectrum.sigmas.as_ref().map(|sigmas| sigmas[index])
}

fn mean_and_standard_error(values: &[f64]) -> (f64, f64) {
    #[expect(clippy::cast_precision_loss, reason = "a handful of incidences")]
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0);
    (mean, (variance / count).sqrt())
}

/// The first free thickness.
fn free_thickness(fit: &Fit) -> Option<String> {
    let is_thickness = |name: &&String| name.ends_with(".thickness_nm");
    fit.free.iter().find(is_thickness).cloned()
}

/// λ/4n at the shortest wavelength of the table: half the way to the next order of interference.
fn quarter_order_nm(design: &Design, table: &GonioTable, values: &Values, name: &str) -> Result<f64, JobError> {
    let wavelengths = table.spectra.iter().filter_map(|spectrum| spectrum.wavelengths_nm.first());
    let shortest_nm = wavelengths.copied().fold(f64::INFINITY, f64::min);
    let model = CoatedBase::new(design, &[shortest_nm])?;
    let at = |thickness_nm: f64| {
        let all = model.parameters().iter().map(|parameter| {
            if parameter.name == name {
                thickness_nm
            } else {
                values.get(&parameter.name).copied().unwrap_or(parameter.default)
            }
        });
        model.optical_thickness_nm(&all.collect::<Vec<f64>>(), shortest_nm)
    };
    // The optical thickness is linear in the layer's own, so that one step gives its index.
    let index = at(values[name] + 1.0) - at(values[name]);
    Ok(shortest_nm / (4.0 * index))
}
