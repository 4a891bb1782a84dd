//! The answer in a sentence or two: value ± error, its rivals, what stays open.

use super::outcome::{Case, Outcome};
use crate::fit::{Bound, Estimate, Fit, StopReason};
use crate::number::with_error;

/// A rival minimum with more than this share of the best one's weight is named.
const RIVAL_SHARE: f64 = 0.05;

/// Most parameters that a sentence can carry.
const MOST_NAMED: usize = 3;

/// The answer of the whole job: the main case, then the others in a few words each.
pub(super) fn job_answer(outcome: &Outcome) -> String {
    let mut sentences = Vec::new();
    if outcome.synthetic.is_some() {
        sentences.push("Synthetic readings, made from known values.".to_owned());
    }
    for (index, case) in outcome.cases.iter().enumerate() {
        if outcome.cases.len() == 1 {
            sentences.push(case.answer.clone());
        } else if index == 0 {
            sentences.push(format!("{}: {}", case.name, case.answer));
        } else {
            sentences.push(format!("{}: {}", case.name, main_values(&case.fit)));
        }
    }
    sentences.join(" ")
}

/// The answer of one case.
pub(super) fn case_answer(case: &Case) -> String {
    let fit = &case.fit;
    let mut sentences = Vec::new();
    if let Some(support) = &case.support {
        let verdict = if support.supported {
            "The data support a film."
        } else {
            "The data do not support a film: the thickness below means nothing."
        };
        sentences.push(verdict.to_owned());
    }
    sentences.push(main_values(fit));
    if case.orders.len() > 1 {
        let orders: Vec<String> = case.orders.iter().map(|order| format!("{:.0}", order.thickness_nm)).collect();
        sentences
            .push(format!("Peaks alone do not give the order of interference: d may be any of {} nm.", list(&orders)));
    } else {
        sentences.extend(rivals(fit));
    }
    if !fit.open_directions.is_empty() {
        let open: Vec<&str> = fit.open_directions.iter().map(|direction| direction.text.as_str()).collect();
        sentences.push(format!("The data leave open: {}.", open.join("; ")));
    }
    match fit.stop {
        StopReason::Converged => {}
        StopReason::Limit => sentences.push("The iteration limit was reached before the fit converged.".into()),
        StopReason::Stalled => sentences.push("The fit stalled before it converged.".into()),
        StopReason::Failed => sentences.push("The model failed near the best point; do not use these values.".into()),
        StopReason::Cancelled => sentences.push("The fit was stopped early; this is the best so far.".into()),
    }
    sentences.join(" ")
}

/// The physical parameters first, the instrument's last; a few of them.
fn main_values(fit: &Fit) -> String {
    let mut free: Vec<&Estimate> = fit.estimates.iter().filter(|estimate| estimate.role == "free").collect();
    free.sort_by_key(|estimate| importance(&estimate.name));
    let named: Vec<String> = free.iter().take(MOST_NAMED).map(|estimate| value_text(estimate)).collect();
    format!("{}.", list(&named))
}

fn importance(name: &str) -> u32 {
    if name.ends_with(".thickness_nm") {
        0
    } else if name.contains(".index") || name.contains(".cauchy") || name.contains(".extinction") {
        1
    } else if name.starts_with("gain") || name.starts_with("offset") {
        3
    } else {
        2
    }
}

fn value_text(estimate: &Estimate) -> String {
    let unit = if estimate.unit.is_empty() { String::new() } else { format!(" {}", estimate.unit) };
    let name = format!("{} ({})", estimate.symbol, estimate.name);
    match (estimate.at_bound, estimate.interval_95) {
        (Some(Bound::Lower), Some([_, upper])) => return format!("{name} below {upper:.4}{unit} (95 %)"),
        (Some(Bound::Upper), Some([lower, _])) => return format!("{name} above {lower:.4}{unit} (95 %)"),
        (Some(_), None) => return format!("{name} at its bound {:.4}{unit}", estimate.value),
        (None, _) => {}
    }
    match estimate.standard_error {
        Some(error) if !estimate.open => format!("{name} = {}{unit}", with_error(estimate.value, Some(error))),
        _ => format!("{name} near {:.4}{unit}, not determined", estimate.value),
    }
}

/// A sentence on minima that the data cannot rule out.
fn rivals(fit: &Fit) -> Option<String> {
    let best = fit.minima.first()?;
    let others: Vec<_> = fit.minima[1..].iter().filter(|minimum| minimum.weight > RIVAL_SHARE * best.weight).collect();
    if others.is_empty() {
        let count = fit.minima.len() - 1;
        return (count > 0).then(|| {
            format!(
                "{count} other minima were found, none with more than {} of the best one's weight.",
                percent(RIVAL_SHARE)
            )
        });
    }
    let scanned = fit.profiles.first().and_then(|(name, _)| fit.estimates.iter().position(|e| e.name == *name));
    let texts: Vec<String> = others
        .iter()
        .map(|minimum| {
            let share = percent(minimum.weight / best.weight);
            match scanned {
                Some(index) => {
                    let estimate = &fit.estimates[index];
                    format!("{} = {:.1} {} ({share})", estimate.symbol, minimum.values[index], estimate.unit)
                }
                None => format!("one with {share}"),
            }
        })
        .collect();
    Some(format!(
        "Rivals that the data do not rule out, with their share of the best one's weight: {}.",
        texts.join(", ")
    ))
}

fn percent(share: f64) -> String {
    if share < 0.095 { format!("{:.1} %", 100.0 * share) } else { format!("{:.0} %", 100.0 * share) }
}

fn list(items: &[String]) -> String {
    match items {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}
