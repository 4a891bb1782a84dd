//! The tables of a population, every entry already written as text.

use super::tables::with_unit;
use crate::job::{Population, Specimen};
use crate::number::{beside_error, significant, with_error};

/// Most parameters that the table of specimens has columns for.
const MOST_COLUMNS: usize = 6;

/// The tables.
pub(crate) struct Specimens {
    pub(crate) spreads: Vec<SpreadRow>,
    /// Headings of the specimens' values.
    pub(crate) columns: Vec<String>,
    pub(crate) rows: Vec<SpecimenRow>,
    pub(crate) has_rivals: bool,
    pub(crate) has_prediction: bool,
    /// Name and value.
    pub(crate) prediction: Vec<(&'static str, String)>,
    /// Pigment, error of the prediction with and without it, gain, verdict.
    pub(crate) absorbers: Vec<[String; 5]>,
}

/// One parameter over all specimens.
pub(crate) struct SpreadRow {
    pub(crate) symbol: String,
    pub(crate) name: String,
    pub(crate) mean: String,
    pub(crate) interval: String,
    pub(crate) between: String,
    pub(crate) between_interval: String,
    pub(crate) within: String,
    pub(crate) shared: String,
    pub(crate) count: usize,
}

/// One specimen.
pub(crate) struct SpecimenRow {
    pub(crate) name: String,
    pub(crate) values: Vec<String>,
    pub(crate) rms: String,
    pub(crate) by_model: String,
    pub(crate) by_mean: String,
    pub(crate) rivals: String,
}

/// The tables of this population; misfits in `unit` as it follows a number.
pub(crate) fn of(population: &Population, unit: &str) -> Specimens {
    let misfit = |value: f64| format!("{}{unit}", significant(value, 2));
    let spreads = population.parameters.iter().map(|parameter| {
        let text =
            |write: &dyn Fn(&crate::job::Effects) -> String| parameter.effects.as_ref().map(write).unwrap_or_default();
        SpreadRow {
            symbol: parameter.symbol.clone(),
            name: parameter.name.clone(),
            mean: text(&|e| with_unit(&with_error(e.mean, Some(e.mean_standard_error)), &parameter.unit)),
            interval: text(&|e| range(e.mean_interval_95, e.mean_standard_error)),
            between: text(&|e| with_unit(&with_error(e.between, e.between_standard_error), &parameter.unit)),
            between_interval: text(&|e| {
                range(e.between_interval_95, e.between_standard_error.unwrap_or(e.mean_standard_error))
            }),
            within: text(&|e| significant(e.within, 2)),
            shared: text(&|e| significant(e.shared, 2)),
            count: parameter.count,
        }
    });
    let rows = population.specimens.iter().enumerate().map(|(index, specimen)| {
        let left_out = |pick: &dyn Fn(&crate::job::LeftOut) -> Option<f64>| {
            population.left_out.as_ref().and_then(pick).map(misfit).unwrap_or_default()
        };
        let values = specimen.values.iter().zip(&specimen.own_errors).take(MOST_COLUMNS);
        SpecimenRow {
            name: specimen.name.clone(),
            values: values.map(|(value, error)| value_text(*value, *error)).collect(),
            rms: misfit(specimen.rms),
            by_model: left_out(&|all| all.by_model.get(index).copied()),
            by_mean: left_out(&|all| all.by_mean.get(index).copied()),
            rivals: rivals(specimen),
        }
    });
    let mut prediction = Vec::new();
    if let Some(left_out) = &population.left_out {
        prediction.push(("Error of the model, fitted to the others", misfit(left_out.model)));
        prediction.extend(left_out.mean.map(|v| ("Error of the mean spectrum of the others", misfit(v))));
        prediction.extend(left_out.spread.map(|v| ("Standard deviation between specimens", misfit(v))));
        prediction.extend(left_out.sigma.map(|v| ("σ of the readings", misfit(v))));
    }
    let absorbers = population.absorbers.iter().map(|test| {
        let gain = with_error(test.gain, Some(test.gain_standard_error));
        let verdict = if test.needed { "yes" } else { "not shown" };
        [test.name.clone(), misfit(test.rms_with), misfit(test.rms_without), gain, verdict.to_owned()]
    });
    Specimens {
        spreads: spreads.collect(),
        columns: population.parameters.iter().take(MOST_COLUMNS).map(|parameter| parameter.symbol.clone()).collect(),
        rows: rows.collect(),
        has_rivals: population.specimens.iter().any(|one| !one.rivals.is_empty() || !one.own_best),
        has_prediction: population.left_out.is_some(),
        prediction,
        absorbers: absorbers.collect(),
    }
}

fn range([low, high]: [f64; 2], error: f64) -> String {
    format!("{} to {}", beside_error(low, Some(error)), beside_error(high, Some(error)))
}

fn value_text(value: f64, error: Option<f64>) -> String {
    match error {
        Some(_) => with_error(value, error),
        None => format!("{} (not determined)", significant(value, 3)),
    }
}

/// The specimen's other minima, with their weights.
fn rivals(specimen: &Specimen) -> String {
    let each = specimen.rivals.iter().map(|(value, weight)| format!("{value:.0} ({:.0} %)", 100.0 * weight));
    let list = each.collect::<Vec<_>>().join(", ");
    match (specimen.own_best, list.is_empty()) {
        (true, _) => list,
        (false, true) => "another is its best".to_owned(),
        (false, false) => format!("another is its best; {list}"),
    }
}
