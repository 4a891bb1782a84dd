//! The fit, from assignments to result.

use std::sync::Arc;
use std::time::{Duration, Instant};

use super::assignment::Assignment;
use super::checkpoint::{Checkpoints, fingerprint};
use super::control::Control;
use super::curvature::Curvature;
use super::differences::{Accuracy, Differences, Pattern};
use super::error::FitError;
use super::least_squares::Finish;
use super::local::least_squares;
use super::mapping::Mapping;
use super::minima::Found;
use super::objective::{Counters, Objective};
use super::outcome::{Fit, Settings, Solver};
use super::residuals::Residuals;
use super::search::{Survey, all_bounds, matters, search, sigma};
use super::summary::summarise;

/// Most repetitions of the search for the sake of σ.
const ROUNDS: usize = 4;
/// Most rounds of settling σ with the best minimum; each brings it two digits or so nearer.
const SIGMA_ROUNDS: usize = 20;

/// Fits the free parameters to the readings.
///
/// The same residuals, assignments and settings give the same result on any number of threads, unless the interrupt comes
/// in between. Numerical trouble is no error: the result then says why its solver stopped.
///
/// # Errors
///
/// What only the user can mend: a checkpoint of another fit, contradictory bounds, a start outside of them, a tie to a
/// tied parameter, nothing free, too few readings, a setting out of range, or a model that is finite at no start.
pub fn fit(
    residuals: &dyn Residuals,
    assignments: &[Assignment],
    settings: &Settings,
    control: &Control<'_>,
) -> Result<Fit, FitError> {
    let mapping = checked(residuals, assignments, settings)?;
    let counters = Counters::default();
    let mut objective = Objective::new(residuals, &mapping, assignments, settings, control, &counters);
    enough_readings(&objective)?;
    let begin = |checkpoints: &Checkpoints| checkpoints.next(fingerprint(&objective, assignments, settings));
    let record = control.checkpoint.map(begin).transpose()?.map(Arc::new);
    objective.record = record.as_ref();
    let pattern = Pattern::new(&objective, expensive(&objective));
    let mut survey = search(&objective, &pattern, settings);
    // A prior is weighed against σ. Where that is unknown it comes from the fit itself, and the search is repeated until
    // both agree; what is left is settled with the best minimum.
    for _ in 0..ROUNDS {
        let Some(best) = survey.minima.first().filter(|_| objective.weighs_priors()) else { break };
        let (before, now) = (objective.sigma, sigma(&objective, best.cost));
        objective.sigma = now;
        if (now / before).ln().abs() < 0.05 || control.interrupted() {
            break;
        }
        survey = search(&objective, &pattern, settings);
    }
    if survey.minima.is_empty() {
        return Err(no_finite_start(&objective, survey.starts));
    }
    settle(&mut objective, &pattern, settings, &mut survey);
    let mut found = summarise(&objective, &pattern, assignments, settings, survey);
    if let Some(record) = &record {
        record.end(control.interrupted());
        let warning = |error| format!("The fit is complete, but could not be picked up had it been killed: {error}");
        found.warnings.extend(record.failure().map(warning));
    }
    Ok(found)
}

/// Finds the mistakes that can be found before anything is computed, as [`fit`] does when it begins.
///
/// # Errors
///
/// As of [`fit`], without those that need the model: too few readings, and no start that is finite.
pub fn check(residuals: &dyn Residuals, assignments: &[Assignment], settings: &Settings) -> Result<(), FitError> {
    checked(residuals, assignments, settings).map(|_| ())
}

fn checked(residuals: &dyn Residuals, assignments: &[Assignment], settings: &Settings) -> Result<Mapping, FitError> {
    check_settings(settings)?;
    Mapping::new(residuals.parameters(), assignments)
}

/// Brings the minima that can matter to the last digit, and differentiates them anew.
fn settle(objective: &mut Objective<'_>, pattern: &Pattern, settings: &Settings, survey: &mut Survey) {
    let mut differences = Differences::new(pattern);
    settle_one(objective, &mut differences, settings, &mut survey.minima[0]);
    for _ in 0..SIGMA_ROUNDS {
        let now = sigma(objective, survey.minima[0].cost);
        if !objective.weighs_priors() || (now - objective.sigma).abs() <= 1e-12 * now {
            break;
        }
        objective.sigma = now;
        settle_one(objective, &mut differences, settings, &mut survey.minima[0]);
    }
    let lowest = survey.minima[0].cost;
    for found in survey.minima.iter_mut().skip(1) {
        if matters(objective, lowest, found) {
            settle_one(objective, &mut differences, settings, found);
        }
    }
    survey.minima.sort_by(|a, b| a.cost.total_cmp(&b.cost));
}

/// One minimum, by least squares where that is the solver asked for; the steps found are kept for the next one.
fn settle_one(objective: &Objective<'_>, differences: &mut Differences, settings: &Settings, found: &mut Found) {
    let bounds = all_bounds(objective);
    if matches!(settings.solver, Solver::LeastSquares | Solver::ParticleSwarm) {
        let start = differences.clone();
        let end = least_squares(objective, start, &bounds, &found.free, Finish::Settled, settings.max_iterations);
        if let Some(end) = end {
            found.path.extend(end.path);
            (found.free, found.cost, found.stop) = (end.free, end.cost, end.stop);
        }
    }
    let curvature = Curvature::new(objective, differences, &bounds, &found.free, Accuracy::Settled);
    found.curvature = curvature.or(found.curvature.take());
}

/// Whether one evaluation costs much more than the 20 µs or so that handing it to another thread takes. It decides where
/// work is done, never what comes out.
fn expensive(objective: &Objective<'_>) -> bool {
    let mut values = vec![0.0; objective.residuals.parameters().len()];
    let mut rows = vec![0.0; objective.rows()];
    let begin = Instant::now();
    objective.evaluate(&objective.mapping.start(), &mut values, &mut rows);
    begin.elapsed() > Duration::from_millis(1)
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
