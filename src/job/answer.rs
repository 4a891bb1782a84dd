//! The answer in a sentence or two: value ± error, its rivals, what stays open.

use super::outcome::{Case, CaseData, Outcome, ThicknessOrder};
use crate::fit::{Bound, Estimate, Fit, Minimum, RIVAL_SHARE, StopReason, misfit};
use crate::number::{minus, to_place, with_error};

/// Most parameters that a sentence can carry.
const MOST_NAMED: usize = 3;

/// The answer of the whole job: the main case, then the others in a few words each.
pub(super) fn job_answer(outcome: &Outcome) -> String {
    let mut sentences = Vec::new();
    if outcome.synthetic.is_some() {
        sentences.push("Synthetic readings, made from known values.".to_owned());
    }
    let (main, others) = match outcome.cases.as_slice() {
        [] => return String::new(),
        [main, others @ ..] => (main, others),
    };
    let assumed = if others.is_empty() { String::new() } else { format!("Assuming {}: ", main.name) };
    sentences.push(format!("{assumed}{}", main.answer));
    sentences.extend(others.iter().map(|case| format!("Assuming {}: {}", case.name, values_sentence(case))));
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
    sentences.push(values_sentence(case));
    if case.orders.len() < 2 {
        sentences.extend(rivals(fit));
    }
    sentences.extend(held_out(case));
    sentences.extend(misfit(&fit.goodness));
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

/// The fitted values, or every order's where the readings do not tell them apart.
fn values_sentence(case: &Case) -> String {
    let [first, .., last] = case.orders.as_slice() else { return main_values(&case.fit) };
    let text = |order: &ThicknessOrder| with_error(order.thickness_nm, order.standard_error_nm);
    // The law gives all orders one index; where a full model does not, the range says so.
    let index = if (first.index - last.index).abs() < first.index_standard_error.unwrap_or(0.0) {
        with_error(first.index, first.index_standard_error)
    } else {
        format!("{:.3} to {:.3}", first.index.min(last.index), first.index.max(last.index))
    };
    let thicknesses: Vec<String> = case.orders.iter().map(text).collect();
    format!(
        "n = {index}; peaks alone do not give the order of interference, so that the thickness is one of {} nm (orders {} to {}).",
        thicknesses.join(", "),
        first.order,
        last.order
    )
}

/// How well peaks that the fit did not see are predicted.
fn held_out(case: &Case) -> Option<String> {
    let CaseData::Peaks { peaks, .. } = &case.data else { return None };
    let errors: Vec<String> = peaks
        .iter()
        .filter(|peak| !peak.fitted)
        .map(|peak| {
            peak.model_nm.map_or_else(|| "no peak".into(), |nm| minus(&format!("{:+.1}", peak.measured_nm - nm)))
        })
        .collect();
    let what = if errors.len() == 1 { "peak that was held out lies" } else { "peaks that were held out lie" };
    (!errors.is_empty()).then(|| format!("The {what} {} nm from the prediction.", list(&errors)))
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
        (Some(Bound::Lower), Some([_, upper])) => return format!("{name} below {}{unit} (95 %)", to_place(upper, -4)),
        (Some(Bound::Upper), Some([lower, _])) => return format!("{name} above {}{unit} (95 %)", to_place(lower, -4)),
        (Some(_), None) => return format!("{name} at its bound {}{unit}", to_place(estimate.value, -4)),
        (None, _) => {}
    }
    match estimate.standard_error {
        Some(error) if !estimate.open => format!("{name} = {}{unit}", with_error(estimate.value, Some(error))),
        _ => format!("{name} near {}{unit}, not determined", to_place(estimate.value, -4)),
    }
}

/// Most rivals that a sentence can carry.
const MOST_RIVALS: usize = 4;

/// A sentence on minima that the data cannot rule out, the heaviest first.
fn rivals(fit: &Fit) -> Option<String> {
    let (best, others) = fit.minima.split_first()?;
    let mut heavy: Vec<&Minimum> = fit.rivals().map(|(_, minimum)| minimum).collect();
    if heavy.is_empty() {
        let count = others.len();
        let noun = if count == 1 { "other minimum was" } else { "other minima were" };
        return (count > 0)
            .then(|| format!("{count} {noun} found, none with more than {} of its weight.", percent(RIVAL_SHARE)));
    }
    heavy.sort_by(|a, b| b.weight.total_cmp(&a.weight));
    let scanned = fit.profiles.first().and_then(|(name, _)| fit.estimates.iter().position(|e| e.name == *name));
    let text = |minimum: &&Minimum| match scanned {
        Some(index) => {
            let Estimate { symbol, unit, .. } = &fit.estimates[index];
            format!("{symbol} = {:.1} {unit} ({})", minimum.values[index], percent(minimum.weight))
        }
        None => percent(minimum.weight),
    };
    let mut texts: Vec<String> = heavy.iter().take(MOST_RIVALS).map(text).collect();
    if heavy.len() > MOST_RIVALS {
        texts.push(format!("{} more", heavy.len() - MOST_RIVALS));
    }
    Some(format!("The data do not rule out {} by weight; the best fit has {}.", list(&texts), percent(best.weight)))
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
