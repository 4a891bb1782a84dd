//! What a reader must know before using the numbers, each a sentence: what was seen, and what to do.

use super::outcome::{Bound, Fit, Goodness, Loss, SigmaSource, StopReason};
use crate::number::plain;

/// The warnings of a result, the gravest first.
pub(super) fn warnings(fit: &Fit) -> Vec<String> {
    let mut sentences = Vec::new();
    sentences.extend(stop(fit));
    sentences.extend(misfit(&fit.goodness));
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
    let heavy = fit.rivals().count();
    let largest = fit.rivals().map(|(_, minimum)| minimum.weight).fold(0.0, f64::max);
    (heavy > 0).then(|| {
        let (noun, verb) = if heavy == 1 { ("minimum", "has") } else { ("minima", "have") };
        format!(
            "{heavy} other {noun} {verb} more than 5 % of the weight of the best fit: the readings do not decide between \
             them. The best fit carries {:.1} % of all weight, the heaviest of the others {:.1} %.",
            100.0 * best,
            100.0 * largest
        )
    })
}

/// What keeps the standard errors from being the whole truth: a model that misses the readings, or readings that err
/// together.
pub fn misfit(goodness: &Goodness) -> Vec<String> {
    #[expect(clippy::cast_precision_loss, reason = "numbers of readings are far below 2^53")]
    let (readings, freedom) = (goodness.readings as f64, goodness.degrees_of_freedom as f64);
    let mut sentences = Vec::new();
    if let Some(reduced) = goodness.reduced_chi_squared {
        // χ²/ν has the standard deviation √(2/ν); three of them, and a fifth of σ, are too much for chance.
        if reduced > (1.0 + 3.0 * (2.0 / freedom).sqrt()).max(1.44) {
            sentences.push(format!(
                "The model misses the readings by {:.1} times their σ on the whole (reduced χ² {reduced:.1}): standard \
                 errors are too small, and weights too sure.",
                reduced.sqrt()
            ));
        }
    }
    if readings / goodness.effective_readings > 2.0 {
        let widened = if goodness.error_widening > 1.0 {
            format!("standard errors have been widened by {:.1} for it", goodness.error_widening)
        } else {
            "standard errors do not allow for it".to_owned()
        };
        sentences.push(format!(
            "Neighbouring residuals err together: {} readings tell about as much as {:.0} independent ones would, and \
             {widened}.",
            goodness.readings, goodness.effective_readings
        ));
    }
    #[expect(clippy::cast_precision_loss, reason = "a number of parameters is small")]
    let free = goodness.free_parameters as f64;
    if goodness.effective_readings <= free {
        sentences.push(format!(
            "That is no more than the {} free parameters: this model cannot be judged by these readings, and no error or \
             weight should be relied on.",
            goodness.free_parameters
        ));
    }
    sentences
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
                estimate.name,
                plain(estimate.value)
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
