//! The result as it is written: estimates, errors, correlations, weights, goodness, warnings.

use super::assignment::{Assignment, Role};
use super::curvature::Inverse;
use super::differences::Pattern;
use super::minima::{Found, Likelihood, ln_weight, normalised};
use super::objective::Objective;
use super::open::open_directions;
use super::outcome::{
    Bound, Estimate, Fit, Goodness, Minimum, OpenDirection, ProfilePoint, Settings, SigmaSource, TracePoint,
};
use super::profile::Surroundings;
use super::search::{Survey, all_bounds};
use super::statistics::{central_95, effective_readings, one_sided_95};
use super::warnings::warnings;
use crate::parameter::Spread;

/// A square matrix over the free parameters, with holes where there is no number.
type Matrix = Vec<Vec<Option<f64>>>;

/// Turns a finished survey into the result.
pub(super) fn summarise(
    objective: &Objective<'_>,
    pattern: &Pattern,
    assignments: &[Assignment],
    settings: &Settings,
    survey: Survey,
) -> Fit {
    let Survey { minima: found, profiles, .. } = survey;
    let best = &found[0];
    let goodness = goodness(objective, best, settings);
    let errors: Vec<Option<Errors>> =
        found.iter().map(|found| Errors::of(objective, found, goodness.error_widening)).collect();
    let minima = minima(objective, &found, &errors, &goodness);
    let names: Vec<String> =
        objective.mapping.free.iter().map(|p| objective.residuals.parameters()[p.index].name.clone()).collect();
    let (covariance, correlations) = errors[0].as_ref().map_or_else(|| no_covariance(names.len()), Errors::matrices);
    let open_directions =
        best.curvature.as_ref().map_or_else(Vec::new, |c| open_directions(objective, best, c, &names));
    let quantile = quantile(&goodness);
    let surroundings = |sigma: f64| Surroundings {
        objective,
        pattern,
        bounds: all_bounds(objective),
        best,
        covariance: &covariance,
        quantile,
        sigma: sigma * goodness.error_widening,
        max_iterations: settings.max_iterations,
    };
    let intervals =
        sigma(objective, best.cost).map_or_else(|| vec![None; names.len()], |sigma| surroundings(sigma).intervals());
    let cut_short = objective.control.interrupted();
    let of_best = Best { found: best, minimum: &minima[0], intervals: &intervals, quantile };
    let estimates = estimates(objective, assignments, &of_best, &goodness, &open_directions);
    let profiles = profiles
        .into_iter()
        .map(|(position, points)| {
            let points = points.iter().map(|point| ProfilePoint { value: point.free[position], cost: point.cost });
            (names[position].clone(), points.collect())
        })
        .collect();
    let trace = trace(objective, best);
    let (evaluations, not_finite) = objective.counts();
    let mut fit = Fit {
        settings: settings.clone(),
        estimates,
        stop: best.stop,
        minima,
        free: names,
        covariance,
        correlations,
        open_directions,
        goodness,
        profiles,
        trace,
        evaluations,
        not_finite,
        warnings: Vec::new(),
    };
    fit.warnings = warnings(&fit);
    if cut_short {
        let words = "Interrupted before the 95 % intervals were known: they are those of a Gaussian.";
        fit.warnings.push(words.to_owned());
    }
    fit
}

#[expect(clippy::cast_precision_loss, reason = "numbers of rows are far below 2^53")]
fn goodness(objective: &Objective<'_>, best: &Found, settings: &Settings) -> Goodness {
    let rows = rows(objective, &best.free);
    let readings = &rows[..objective.readings];
    let count = readings.len() as f64;
    let chi_squared: f64 = readings.iter().map(|r| r * r).sum();
    let free = objective.mapping.free.len();
    let freedom = objective.rows() as i64 - free as i64;
    let known = objective.residuals.sigma_known();
    let per_freedom = (freedom > 0).then(|| best.cost / freedom as f64);
    let effective = effective_readings(readings);
    let goodness = Goodness {
        readings: objective.readings,
        effective_readings: effective,
        free_parameters: free,
        degrees_of_freedom: freedom,
        chi_squared,
        reduced_chi_squared: if known && freedom > 0 { Some(chi_squared / freedom as f64) } else { None },
        sigma_source: if known { SigmaSource::Known } else { SigmaSource::Estimated },
        sigma_scale: if known { 1.0 } else { per_freedom.map_or(1.0, f64::sqrt) },
        error_widening: if settings.correlated_errors { (count / effective).sqrt() } else { 1.0 },
        aicc: None,
    };
    Goodness { aicc: goodness.aicc_on(effective), ..goodness }
}

fn rows(objective: &Objective<'_>, free: &[f64]) -> Vec<f64> {
    let mut values = vec![0.0; objective.residuals.parameters().len()];
    let mut rows = vec![0.0; objective.rows()];
    objective.evaluate(free, &mut values, &mut rows);
    rows
}

/// Covariance of the free parameters at one minimum.
struct Errors {
    /// Over all free parameters; None where one is on a bound or has no rank.
    covariance: Matrix,
}

impl Errors {
    fn of(objective: &Objective<'_>, found: &Found, widening: f64) -> Option<Self> {
        let curvature = found.curvature.as_ref()?;
        let sigma = sigma(objective, found.cost)?;
        let inverse = curvature.inverse(&curvature.inner);
        let matrix = if objective.loss.is_squares() {
            sigma * sigma * &inverse.covariance
        } else {
            curvature.sandwich(objective, &curvature.inner)?
        };
        let matrix = widening * widening * matrix;
        let size = found.free.len();
        let mut covariance = vec![vec![None; size]; size];
        let known: Vec<bool> = (0..curvature.inner.len()).map(|k| determined(&inverse, k)).collect();
        for (a, &i) in curvature.inner.iter().enumerate() {
            for (b, &j) in curvature.inner.iter().enumerate() {
                if known[a] && known[b] {
                    covariance[i][j] = finite(matrix[(a, b)]);
                }
            }
        }
        Some(Self { covariance })
    }

    /// Covariance and correlations.
    fn matrices(&self) -> (Matrix, Matrix) {
        let size = self.covariance.len();
        let mut correlations = vec![vec![None; size]; size];
        for (i, row) in correlations.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                let parts = (self.covariance[i][j], self.covariance[i][i], self.covariance[j][j]);
                if let (Some(shared), Some(a), Some(b)) = parts {
                    *entry = finite(shared / (a * b).sqrt()).map(|r| r.clamp(-1.0, 1.0));
                }
            }
        }
        (self.covariance.clone(), correlations)
    }

    /// Standard error of constant + Σ factor·free, over the parameters that can move.
    fn standard_error(&self, terms: &[(usize, f64)], at_bound: &[Option<Bound>]) -> Option<f64> {
        let moving: Vec<&(usize, f64)> = terms.iter().filter(|term| at_bound[term.0].is_none()).collect();
        if moving.is_empty() {
            return None;
        }
        let mut variance = 0.0;
        for &&(i, a) in &moving {
            for &&(j, b) in &moving {
                variance += a * b * self.covariance[i][j]?;
            }
        }
        finite(variance.max(0.0).sqrt())
    }
}

fn no_covariance(size: usize) -> (Matrix, Matrix) {
    (vec![vec![None; size]; size], vec![vec![None; size]; size])
}

/// Whether column `k` takes no part in a direction without rank.
fn determined(inverse: &Inverse, k: usize) -> bool {
    inverse.missing.iter().all(|direction| {
        let largest = direction.iter().fold(0.0, |most: f64, share| most.max(share.abs()));
        direction[k].abs() <= 1e-3 * largest
    })
}

/// σ of the readings; None where it would have to come from residuals that are not there.
pub(super) fn sigma(objective: &Objective<'_>, cost: f64) -> Option<f64> {
    if objective.residuals.sigma_known() {
        return Some(1.0);
    }
    let freedom = objective.rows().checked_sub(objective.mapping.free.len()).filter(|&freedom| freedom > 0)?;
    #[expect(clippy::cast_precision_loss, reason = "a number of rows is far below 2^53")]
    Some((cost / freedom as f64).sqrt())
}

fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

pub(super) fn ranges(objective: &Objective<'_>) -> Vec<f64> {
    objective.mapping.free.iter().map(|parameter| parameter.upper - parameter.lower).collect()
}

fn minima(objective: &Objective<'_>, found: &[Found], errors: &[Option<Errors>], goodness: &Goodness) -> Vec<Minimum> {
    let ranges = ranges(objective);
    let likelihood = if objective.residuals.sigma_known() {
        Likelihood::Known
    } else {
        // Fewer readings than twice the parameters could not have determined them, and would turn weights upside down:
        // integrating over p parameters takes p from the exponent of the residuals' sum of squares.
        #[expect(clippy::cast_precision_loss, reason = "numbers of readings and parameters are small")]
        let (all, least) = (goodness.readings as f64, 2.0 * goodness.free_parameters as f64);
        let readings = goodness.effective_readings.max(least.min(all));
        Likelihood::Unknown { readings, floor: f64::MIN_POSITIVE }
    };
    let ln_weight = |found: &Found| {
        found.curvature.as_ref().map_or(f64::NEG_INFINITY, |curvature| {
            ln_flat_prior(objective, &found.free) + ln_weight(found.cost, curvature, &ranges, likelihood)
        })
    };
    let weights = normalised(&found.iter().map(ln_weight).collect::<Vec<_>>());
    let count = objective.residuals.parameters().len();
    let minimum = |((found, errors), weight): ((&Found, &Option<Errors>), f64)| {
        let mut values = vec![0.0; count];
        objective.mapping.expand(&found.free, &mut values);
        let error = |index| {
            let (errors, curvature) = (errors.as_ref()?, found.curvature.as_ref()?);
            errors.standard_error(&objective.mapping.linear_form(index).1, &curvature.at_bound)
        };
        let rows = rows(objective, &found.free);
        #[expect(clippy::cast_precision_loss, reason = "a number of readings is far below 2^53")]
        let mean = rows[..objective.readings].iter().map(|r| r * r).sum::<f64>() / objective.readings.max(1) as f64;
        Minimum {
            values,
            standard_errors: (0..count).map(error).collect(),
            cost: found.cost,
            rms: mean.sqrt(),
            weight,
            hits: found.hits,
            stop: found.stop,
        }
    };
    found.iter().zip(errors).zip(weights).map(minimum).collect()
}

/// ln of the density that stands for knowing nothing beforehand: even in a parameter that is spread evenly, and even in
/// the logarithm, 1/x, of one that is spread so (a thickness, a gain), whose scale is not known. A parameter with a prior
/// of its own has that in the cost.
fn ln_flat_prior(objective: &Objective<'_>, free: &[f64]) -> f64 {
    let has_prior = |j: usize| objective.priors.iter().any(|prior| matches!(prior.terms[..], [(k, _)] if k == j));
    let declared = objective.mapping.free.iter().zip(free).enumerate();
    declared
        .filter(|(j, (parameter, _))| parameter.spread == Spread::Logarithmic && !has_prior(*j))
        .map(|(_, (_, value))| -value.ln())
        .sum()
}

/// Half the width of a central 95 % interval in standard errors.
fn quantile(goodness: &Goodness) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "degrees of freedom are far below 2^53")]
    let freedom = (goodness.sigma_source == SigmaSource::Estimated).then(|| {
        // Readings that err together leave fewer degrees of freedom.
        let lost =
            if goodness.error_widening > 1.0 { goodness.readings as f64 - goodness.effective_readings } else { 0.0 };
        (goodness.degrees_of_freedom as f64 - lost).max(1.0)
    });
    central_95(freedom)
}

/// What is known of the best minimum.
struct Best<'a> {
    found: &'a Found,
    minimum: &'a Minimum,
    /// Of each free parameter on no bound.
    intervals: &'a [Option<[f64; 2]>],
    quantile: f64,
}

fn estimates(
    objective: &Objective<'_>,
    assignments: &[Assignment],
    &Best { found: best, minimum, intervals, quantile }: &Best<'_>,
    goodness: &Goodness,
    open: &[OpenDirection],
) -> Vec<Estimate> {
    let parameters = objective.residuals.parameters();
    let estimate = |index: usize| {
        let (parameter, assignment) = (&parameters[index], &assignments[index]);
        let value = minimum.values[index];
        let standard_error = minimum.standard_errors[index];
        let position = objective.mapping.free.iter().position(|free| free.index == index);
        let at_bound = position.and_then(|j| best.curvature.as_ref()?.at_bound[j]);
        let (role, start, range) = match &assignment.role {
            Role::Free { start, lower, upper } => ("free", Some(*start), [*lower, *upper]),
            Role::Fixed(_) => ("fixed", None, [parameter.lower, parameter.upper]),
            Role::Tied { .. } => ("tied", None, [parameter.lower, parameter.upper]),
        };
        let (constant, terms) = objective.mapping.linear_form(index);
        let interval_95 = match (at_bound, position) {
            (Some(side), Some(j)) => one_sided(objective, best, j, side, range, goodness.error_widening),
            (None, Some(j)) => intervals[j],
            (_, None) if terms.len() == 1 => intervals[terms[0].0].map(|[low, high]| {
                let factor = terms[0].1;
                let ends = [low, high].map(|end| (constant + factor * end).clamp(range[0], range[1]));
                if factor < 0.0 { [ends[1], ends[0]] } else { ends }
            }),
            // Tied to several.
            _ => standard_error
                .map(|error| [(value - quantile * error).max(range[0]), (value + quantile * error).min(range[1])]),
        };
        Estimate {
            name: parameter.name.clone(),
            symbol: parameter.symbol.clone(),
            unit: parameter.unit.to_owned(),
            text: parameter.text.clone(),
            role: role.to_owned(),
            value,
            start,
            bounds: (role == "free" && range[0].is_finite() && range[1].is_finite()).then_some(range),
            prior: assignment.prior.map(|prior| [prior.mean, prior.sigma]),
            standard_error,
            interval_95,
            at_bound,
            open: open.iter().any(|direction| direction.shares.iter().any(|(name, _)| *name == parameter.name)),
        }
    };
    (0..parameters.len()).map(estimate).collect()
}

/// The interval from a bound inwards that holds 95 % of the likelihood.
fn one_sided(
    objective: &Objective<'_>,
    best: &Found,
    j: usize,
    side: Bound,
    range: [f64; 2],
    widening: f64,
) -> Option<[f64; 2]> {
    let curvature = best.curvature.as_ref()?;
    let sigma = widening * sigma(objective, best.cost)?;
    let mut positions = curvature.inner.clone();
    positions.push(j);
    let inverse = curvature.inverse(&positions);
    let last = positions.len() - 1;
    if !determined(&inverse, last) {
        return Some(range).filter(|range| range.iter().all(|bound| bound.is_finite()));
    }
    let width = sigma * inverse.covariance[(last, last)].sqrt();
    let reach = one_sided_95(curvature.gradient[j].abs() / (sigma * sigma), width);
    let interval = match side {
        Bound::Lower => [range[0], (range[0] + reach).min(range[1])],
        Bound::Upper => [(range[1] - reach).max(range[0]), range[1]],
    };
    interval.iter().all(|bound| bound.is_finite()).then_some(interval)
}

/// Cost of the full problem along the way of the start that won, each point an improvement.
fn trace(objective: &Objective<'_>, best: &Found) -> Vec<TracePoint> {
    let mut values = vec![0.0; objective.residuals.parameters().len()];
    let mut rows = vec![0.0; objective.rows()];
    let mut trace: Vec<TracePoint> = Vec::new();
    for free in &best.path {
        if objective.evaluate(free, &mut values, &mut rows) {
            let cost = objective.cost(&rows);
            if trace.last().is_none_or(|last| cost < last.cost) {
                trace.push(TracePoint { iteration: trace.len() as u64, cost });
            }
        }
    }
    trace
}
