//! What a reader must know before using the numbers, each a sentence: what was seen, and what to do.

use super::outcome::{Bound, Fit, Loss, SigmaSource, StopReason};

/// A rival with more than this share of the best one's weight is spoken of.
const RIVAL: f64 = 0.05;

/// The warnings of a result, the gravest first.
pub(super) fn warnings(fit: &Fit) -> Vec<String> {
    let mut sentences = Vec::new();
    sentences.extend(stop(fit));
    sentences.extend(rivals(fit));
    sentences.extend(fit.open_directions.iter().map(|direction| direction.text.clone()));
    sentences.extend(bounds(fit));
    sentences.extend(errors(fit));
    sentences.extend(not_finite(fit));
    sentences
}

fn stop(fit: &Fit) -> Option<String> {
    Some(match fit.stop {
        StopReason::Converged => return None,
        StopReason::Limit => format!(
            "The solver reached its limit of {} iterations before it converged; raise `max_iterations`.",
            fit.settings.max_iterations
        ),
        StopReason::Stalled => "The solver stalled: no step lowers the cost, yet the gradient is not small; \
                                the standard errors mean little."
            .to_owned(),
        StopReason::Failed => "The model gives no finite number near the best point found.".to_owned(),
        StopReason::Cancelled => "The fit was interrupted; this is the best point found so far.".to_owned(),
    })
}

fn rivals(fit: &Fit) -> Option<String> {
    let best = fit.minima.first()?.weight;
    let rivals = fit.minima.iter().skip(1).filter(|minimum| minimum.weight > RIVAL * best).count();
    let share =
        fit.minima.iter().skip(1).map(|minimum| minimum.weight).fold(0.0, f64::max) / best.max(f64::MIN_POSITIVE);
    (rivals > 0).then(|| {
        let (noun, verb) = if rivals == 1 { ("minimum", "has") } else { ("minima", "have") };
        format!(
            "{rivals} other {noun} {verb} more than 5 % of the weight of the best one, up to {:.0} %: the readings do not decide between them.",
            100.0 * share
        )
    })
}

fn bounds(fit: &Fit) -> Vec<String> {
    fit.estimates
        .iter()
        .filter_map(|estimate| {
            let side = match estimate.at_bound? {
                Bound::Lower => "lower",
                Bound::Upper => "upper",
            };
            Some(format!(
                "`{}` lies on its {side} bound {}; only one side of it can be told.",
                estimate.name, estimate.value
            ))
        })
        .collect()
}

fn errors(fit: &Fit) -> Option<String> {
    if fit.goodness.sigma_source == SigmaSource::Estimated && fit.goodness.degrees_of_freedom <= 0 {
        return Some(
            "As many parameters as readings: nothing is left to estimate σ from, so there are no standard errors."
                .to_owned(),
        );
    }
    (fit.settings.loss != Loss::Squares)
        .then(|| "Standard errors under the robust loss are those of the sandwich estimator.".to_owned())
}

fn not_finite(fit: &Fit) -> Option<String> {
    (fit.not_finite > 0).then(|| {
        format!(
            "{} of {} evaluations gave a number that is not finite and were refused; the bounds may reach where the model makes no sense.",
            fit.not_finite, fit.evaluations
        )
    })
}
