//! Several specimens in one table: each fitted by itself, what they have in common, how much they differ, and how well one is
//! predicted from the others.

mod absorbers;
mod each;
mod left_out;
mod shared;
mod words;

use std::sync::atomic::Ordering;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub(super) use words::{BRIEF, brief};

use super::JobError;
use super::case::{CheckedCase, Comparison};
use super::support::part;
use crate::fit::{Control, Fit, random_effects};
use crate::measure::GonioTable;

/// What a job says of specimens.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct SpecimensFile {
    /// Whether each specimen is left out in turn and predicted from a fit to the others.
    pub leave_one_out: bool,
}

impl Default for SpecimensFile {
    fn default() -> Self {
        Self { leave_one_out: true }
    }
}

/// What the specimens of a table tell, each and together.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Population {
    /// Every specimen, in the order of the table.
    pub specimens: Vec<Specimen>,
    /// Mean and spread of each parameter that is free and no gain or offset.
    pub parameters: Vec<ParameterSpread>,
    /// Prediction of each specimen from the others, where the job asks for it.
    pub left_out: Option<LeftOut>,
    /// Whether the spectra need each of the pigments, where specimens are left out.
    pub absorbers: Vec<AbsorberTest>,
    /// All this in a few sentences.
    pub text: String,
}

/// One specimen, fitted by itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Specimen {
    /// Its name in the table.
    pub name: String,
    /// Values in the order of [`Population::parameters`].
    pub values: Vec<f64>,
    /// Their standard errors, as of any fit; None at a bound, or where its spectra do not determine the parameter.
    pub standard_errors: Vec<Option<f64>>,
    /// Their standard errors without the misfit that all specimens share, which moves all alike: what counts beside the
    /// differences between specimens.
    pub own_errors: Vec<Option<f64>>,
    /// Root mean square of the readings minus the fit, in the unit of the readings.
    pub rms: f64,
    /// Where the misfit has many minima: whether the one given here, nearest to that of all specimens together, is this
    /// specimen's own best.
    pub own_best: bool,
    /// Its other minima of more than 5 % of the best one's weight: (value of the scanned parameter, weight).
    pub rivals: Vec<(f64, f64)>,
    /// Its spectra.
    pub spectra: Vec<SpecimenSpectrum>,
}

/// One spectrum of a specimen, measured and modelled.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SpecimenSpectrum {
    /// Name in the table.
    pub id: String,
    /// Wavelengths, nm.
    pub wavelengths_nm: Vec<f64>,
    /// Readings.
    pub measured: Vec<f64>,
    /// The specimen's own fit.
    pub fitted: Vec<f64>,
    /// The fit to the other specimens, where the job asks for it.
    pub predicted: Option<Vec<f64>>,
}

/// A parameter over the specimens: random effects, with each specimen's own error within.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ParameterSpread {
    /// Name in the job.
    pub name: String,
    /// Symbol on plots.
    pub symbol: String,
    /// Unit, empty for a pure number.
    pub unit: String,
    /// Specimens that determine it; the others have no error and are left out of what follows.
    pub count: usize,
    /// Mean and spread, where at least two specimens determine it.
    pub effects: Option<Effects>,
}

/// Mean and spread of a parameter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Effects {
    /// Mean of the population.
    pub mean: f64,
    /// Standard error of the mean (Knapp and Hartung 2003).
    pub mean_standard_error: f64,
    /// 95 % interval of the mean.
    pub mean_interval_95: [f64; 2],
    /// Standard deviation between individuals (restricted maximum likelihood).
    pub between: f64,
    /// Its standard error; None where it is 0.
    pub between_standard_error: Option<f64>,
    /// 95 % interval of it (Q profile, Viechtbauer 2007).
    pub between_interval_95: [f64; 2],
    /// Root mean square of the specimens' own errors, [`Specimen::own_errors`].
    pub within: f64,
    /// Error that the misfit shared by all specimens may put into all of them, and into the mean: no number of specimens
    /// makes it smaller.
    pub shared: f64,
}

/// Prediction of each specimen from the others. All numbers are root mean squares in the unit of the readings.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LeftOut {
    /// Error of the model, fitted to the others, one a specimen.
    pub by_model: Vec<f64>,
    /// Error of the mean spectrum of the others, one a specimen; empty where their wavelengths or angles differ.
    pub by_mean: Vec<f64>,
    /// Error of the model over all specimens.
    pub model: f64,
    /// Error of the mean spectrum over all specimens.
    pub mean: Option<f64>,
    /// Standard deviation between the specimens' spectra, over the wavelengths.
    pub spread: Option<f64>,
    /// σ of the readings, where it is known.
    pub sigma: Option<f64>,
}

/// Whether the spectra need a pigment: specimens left out in turn and predicted without it beside with it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AbsorberTest {
    /// The pigment.
    pub name: String,
    /// Root mean square error of the prediction with it.
    pub rms_with: f64,
    /// The same without it.
    pub rms_without: f64,
    /// Mean over specimens of the squared error without it minus that with it, in the squared unit of the readings.
    pub gain: f64,
    /// Its standard error over the specimens.
    pub gain_standard_error: f64,
    /// Whether the gain is more than Student's 97.5 % quantile times its standard error.
    pub needed: bool,
}

/// Fits every specimen of a case. None where the job has no `[specimens]`, the case fewer than two of them or nothing
/// free, or the user stopped the fit.
pub(super) fn population(case: &CheckedCase, pooled: &Fit, control: &Control) -> Result<Option<Population>, JobError> {
    let (Comparison::Spectra(table, fitted, _), Some(settings)) = (&case.comparison, &case.file.specimens) else {
        return Ok(None);
    };
    let seen = part(table, |index| fitted[index]);
    let names = specimen_names(&seen);
    let is_physical = |name: &&String| !name.starts_with("gain") && !name.starts_with("offset");
    let free: Vec<&String> = pooled.free.iter().filter(is_physical).collect();
    let interrupted = || control.interrupt.load(Ordering::Relaxed);
    if names.len() < 2 || free.is_empty() || interrupted() {
        return Ok(None);
    }
    let file = &case.file;
    let (mut specimens, mut widenings) = (Vec::new(), Vec::new());
    for name in &names {
        let (specimen, widening) = each::fit_specimen(file, &of_specimen(&seen, name), name, &free, pooled, control)?;
        specimens.push(specimen);
        widenings.push(widening);
    }
    shared::take_out_shared_misfit(&mut specimens, &widenings, &seen, file.fit.correlated_errors);
    let (mut left_out, mut absorbers) = (None, Vec::new());
    if settings.leave_one_out {
        let found = left_out::leave_one_out(file, &seen, &mut specimens, control)?;
        absorbers = absorbers::absorber_tests(file, &seen, &specimens, &found.by_model, &free, control)?;
        left_out = Some(found);
    }
    // Fits that were cut short tell of no spread.
    if interrupted() {
        return Ok(None);
    }
    let parameters = free.iter().enumerate().filter_map(|(index, name)| {
        let estimate = pooled.estimates.iter().find(|estimate| estimate.name == **name)?;
        let (symbol, unit) = (estimate.symbol.clone(), estimate.unit.clone());
        let determined: Vec<[f64; 3]> = specimens
            .iter()
            .filter_map(|one| Some([one.values[index], one.own_errors[index]?, one.standard_errors[index]?]))
            .collect();
        let (count, effects) = (determined.len(), effects(&determined));
        Some(ParameterSpread { name: (*name).clone(), symbol, unit, count, effects })
    });
    let mut population =
        Population { parameters: parameters.collect(), specimens, left_out, absorbers, text: String::new() };
    population.text = words::text(&population, file, &seen);
    Ok(Some(population))
}

/// Mean and spread from each specimen's value, own error and whole standard error.
fn effects(determined: &[[f64; 3]]) -> Option<Effects> {
    let column = |index: usize| determined.iter().map(|one| one[index]).collect::<Vec<f64>>();
    let (own, whole) = (column(1), column(2));
    let found = random_effects(&column(0), &own)?;
    let between = found.variance.sqrt();
    let mean_square = |errors: &[f64]| errors.iter().map(|error| error * error).sum::<f64>() / as_f64(errors.len());
    Some(Effects {
        mean: found.mean,
        mean_standard_error: found.mean_standard_error,
        mean_interval_95: found.mean_interval_95,
        between,
        // d√x = dx/(2√x).
        between_standard_error: (between > 0.0).then(|| found.variance_standard_error / (2.0 * between)),
        between_interval_95: found.variance_interval_95.map(f64::sqrt),
        within: mean_square(&own).sqrt(),
        shared: (mean_square(&whole) - mean_square(&own)).max(0.0).sqrt(),
    })
}

/// Names of the specimens, in the order of the table.
pub(super) fn specimen_names(table: &GonioTable) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for spectrum in &table.spectra {
        if !names.iter().any(|name| name == spectrum.specimen()) {
            names.push(spectrum.specimen().to_owned());
        }
    }
    names
}

fn of_specimen(table: &GonioTable, name: &str) -> GonioTable {
    part(table, |index| table.spectra[index].specimen() == name)
}

fn without_specimen(table: &GonioTable, name: &str) -> GonioTable {
    part(table, |index| table.spectra[index].specimen() != name)
}

/// Root mean square of measured minus model, over all spectra.
fn rms<'a>(pairs: impl Iterator<Item = (&'a [f64], &'a [f64])>) -> f64 {
    let (mut squares, mut count) = (0.0, 0.0);
    for (measured, model) in pairs {
        squares += measured.iter().zip(model).map(|(y, m)| (y - m).powi(2)).sum::<f64>();
        count += as_f64(measured.len());
    }
    f64::sqrt(squares / count)
}

fn as_f64(count: usize) -> f64 {
    f64::from(u32::try_from(count).unwrap_or(u32::MAX))
}
