//! The fit, from assignments to result.

use super::assignment::Assignment;
use super::control::Control;
use super::differences::{Accuracy, Differences, Pattern};
use super::error::FitError;
use super::least_squares::Finish;
use super::local::least_squares;
use super::mapping::Mapping;
use super::minima::Found;
use super::objective::{Counters, Objective};
use super::outcome::{Fit, Settings};
use super::residuals::Residuals;
use super::search::{Survey, all_bounds, search, sigma};
use super::summary::summarise;
use crate::fit::curvature::Curvature;

/// Fits the free parameters to the readings.
///
/// The same residuals, assignments and settings give the same result on any number of threads, unless the interrupt comes
/// in between. Numerical trouble is no error: the result then says why its solver stopped.
///
/// # Errors
///
/// What only the user can mend: contradictory bounds, a start outside of them, a tie to a tied parameter, nothing free,
/// too few readings, a setting out of range, or a model that is finite at no start.
pub fn fit(
    residuals: &dyn Residuals,
    assignments: &[Assignment],
    settings: &Settings,
    control: &Control<'_>,
) -> Result<Fit, FitError> {
    check_settings(settings)?;
    let parameters = residuals.parameters();
    let mapping = Mapping::new(parameters, assignments)?;
    let counters = Counters::default();
    let objective = Objective::new(residuals, &mapping, assignments, settings, control, &counters);
    enough_readings(&objective)?;
    let pattern = Pattern::new(&objective, false);
    let mut survey = search(&objective, &pattern, settings);
    if survey.minima.is_empty() {
        return Err(no_finite_start(&objective, survey.starts));
    }
    settle(&objective, &pattern, settings, &mut survey);
    Ok(summarise(&objective, assignments, settings, survey))
}

/// Brings the minima that can matter to the last digit, and differentiates them anew.
fn settle(objective: &Objective<'_>, pattern: &Pattern, settings: &Settings, survey: &mut Survey) {
    let bounds = all_bounds(objective);
    let lowest = survey.minima[0].cost;
    let mut differences = Differences::new(pattern);
    for found in &mut survey.minima {
        if !matters(objective, lowest, found) {
            break;
        }
        let start = differences.clone();
        let end = least_squares(objective, start, &bounds, &found.free, Finish::Settled, settings.max_iterations);
        if let Some(end) = end {
            found.path.extend(end.path);
            (found.free, found.cost, found.stop) = (end.free, end.cost, end.stop);
        }
        let curvature = Curvature::new(objective, &mut differences, &bounds, &found.free, Accuracy::Settled);
        found.curvature = curvature.or(found.curvature.take());
    }
    survey.minima.sort_by(|a, b| a.cost.total_cmp(&b.cost));
}

/// Whether a minimum can have any weight beside the lowest: exp(−40) is none.
fn matters(objective: &Objective<'_>, lowest: f64, found: &Found) -> bool {
    let sigma = sigma(objective, lowest);
    found.cost - lowest <= 80.0 * sigma * sigma
}

fn check_settings(settings: &Settings) -> Result<(), FitError> {
    if !(settings.loss_scale.is_finite() && settings.loss_scale > 0.0) {
        let (value, expected) = (settings.loss_scale.to_string(), "a finite number above 0");
        return Err(FitError::Setting { name: "loss_scale", value, expected });
    }
    if !(1..=65_536).contains(&settings.starts) {
        let value = settings.starts.to_string();
        return Err(FitError::Setting { name: "starts", value, expected: "from 1 to 65536" });
    }
    if settings.max_iterations == 0 {
        return Err(FitError::Setting { name: "max_iterations", value: "0".to_owned(), expected: "at least 1" });
    }
    Ok(())
}

fn enough_readings(objective: &Objective<'_>) -> Result<(), FitError> {
    let (rows, free) = (objective.rows(), objective.mapping.free.len());
    if rows >= free {
        return Ok(());
    }
    let parameters = objective.residuals.parameters();
    let names: Vec<String> =
        objective.mapping.free.iter().map(|parameter| format!("`{}`", parameters[parameter.index].name)).collect();
    Err(FitError::TooFewReadings { free, names: names.join(", "), rows })
}

fn no_finite_start(objective: &Objective<'_>, starts: usize) -> FitError {
    let parameters = objective.residuals.parameters();
    let first: Vec<String> = objective
        .mapping
        .free
        .iter()
        .map(|parameter| format!("{} = {}", parameters[parameter.index].name, parameter.start))
        .collect();
    FitError::NoFiniteStart { starts, first: first.join(", ") }
}
