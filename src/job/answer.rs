//! The answer in a sentence or two: value ± error, its rivals, what stays open.

use super::held_out::comparison_answer;
use super::outcome::{Case, CaseData, Outcome, PeakFit, ThicknessOrder};
use super::population::{BRIEF, brief};
use crate::fit::{Bound, Estimate, Fit, Minimum, RIVAL_SHARE, StopReason, misfit};
use crate::measure::Compared;
use crate::number::{minus, significant, to_place, with_error};

/// Most parameters that a sentence can carry.
const MOST_NAMED: usize = 3;

/// Most groups of specimens that are each told in full.
const MOST_GROUPS_IN_FULL: usize = 4;

/// The answer of the whole job: the main case, then the others in a few words each.
pub(super) fn job_answer(outcome: &Outcome) -> String {
    let mut sentences = Vec::new();
    if outcome.synthetic.is_some() {
        sentences.push("Synthetic readings, made from known values.".to_owned());
    }
    if outcome.cases.iter().filter(|case| !case.group.is_empty()).count() > MOST_GROUPS_IN_FULL {
        sentences.push(groups_answer(&outcome.cases));
        return sentences.join(" ");
    }
    let (main, others) = match outcome.cases.as_slice() {
        [] => return String::new(),
        [main, others @ ..] => (main, others),
    };
    // A group is a part of the readings, no assumption.
    let heading = |case: &Case| {
        if case.group.is_empty() { format!("Assuming {}: ", case.name) } else { format!("{}: ", case.name) }
    };
    let assumed = if others.is_empty() { String::new() } else { heading(main) };
    sentences.push(format!("{assumed}{}", main.answer));
    let main = sentences.join(" ");
    let others = others.iter().map(|case| format!("{}{}", heading(case), values_sentence(case)));
    let judged = outcome.comparison.as_ref().and_then(|comparison| comparison_answer(comparison, &outcome.cases));
    std::iter::once(main).chain(others).chain(judged).collect::<Vec<_>>().join("\n")
}

/// A line a group.
fn groups_answer(cases: &[Case]) -> String {
    let heading = format!("{BRIEF}; more on each group in the report.");
    let line = |case: &Case| {
        let values = case.population.as_ref().map_or_else(|| values_sentence(case), brief);
        format!("{}: {values}", case.name)
    };
    std::iter::once(heading).chain(cases.iter().map(line)).collect::<Vec<_>>().join("\n")
}

/// The answer of one case.
pub(super) fn case_answer(case: &Case) -> String {
    let fit = &case.fit;
    let mut sentences = Vec::new();
    if let Some(support) = &case.support {
        let verdict = if support.supported {
            "The data support a film."
        } else {
            "The data do not support a film: the thickness that follows means nothing."
        };
        sentences.push(verdict.to_owned());
    }
    sentences.push(values_sentence(case));
    // Of specimens, each has rivals of its own: all as if they were one have weights that mean little.
    if case.orders.len() < 2 && case.population.is_none() {
        sentences.extend(rivals(fit));
    }
    if case.population.is_none() {
        sentences.extend(misfit_size(case));
    }
    sentences.extend(held_out(case));
    sentences.extend(reddening(case));
    // Differences between specimens are no misfit.
    if case.population.is_none() {
        sentences.extend(misfit(&fit.goodness));
    }
    if !fit.open_directions.is_empty() {
        let open: Vec<&str> =
            fit.open_directions.iter().map(|direction| direction.text.trim_end_matches('.')).collect();
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
pub(super) fn values_sentence(case: &Case) -> String {
    if let Some(population) = &case.population {
        return population.text.clone();
    }
    let (first, last) = match case.orders.as_slice() {
        [] => return main_values(&case.fit),
        [only] => {
            let values = main_values(&case.fit);
            return format!(
                "{values} Peaks alone do not give the order of interference: that it is {} here is the doing of the bounds.",
                only.order
            );
        }
        [first, .., last] => (first, last),
    };
    let text = |order: &ThicknessOrder| rounded(order.thickness_nm, order.standard_error_nm);
    // The law gives all orders one index; where a full model does not, the range says so.
    let spread = first.index_standard_error.unwrap_or(0.0).max(1e-3 * first.index);
    let index = if (first.index - last.index).abs() < spread {
        rounded(first.index, first.index_standard_error)
    } else {
        format!("{:.3} to {:.3}", first.index.min(last.index), first.index.max(last.index))
    };
    let thicknesses: Vec<String> = case.orders.iter().map(text).collect();
    let orders: Vec<String> = case.orders.iter().map(|order| order.order.to_string()).collect();
    let bounds = case.fit.estimates.iter().find(|estimate| estimate.name.ends_with(".thickness_nm"));
    let bounds = bounds
        .and_then(|estimate| estimate.bounds)
        .map_or_else(String::new, |[lower, upper]| format!(", within the bounds {lower} to {upper} nm"));
    format!(
        "n = {index}; peaks alone do not give the order of interference, so that the thickness is one of {} nm (orders {}\
         {bounds}).",
        thicknesses.join(", "),
        orders.join(", "),
    )
}

/// A value with its error; an error that is only rounding is left out.
fn rounded(value: f64, error: Option<f64>) -> String {
    with_error(value, error.filter(|error| *error > 1e-7 * value.abs()))
}

/// How far the model is from the readings, in their own unit.
fn misfit_size(case: &Case) -> Option<String> {
    let rms = case.fit.minima.first()?.rms;
    match &case.data {
        CaseData::Peaks { peaks, .. } if peaks.iter().all(|peak| peak.sigma_nm.is_none()) => {
            Some(format!("The model misses the fitted peaks by {rms:.2} nm (rms)."))
        }
        CaseData::Spectra { spectra, compare, .. } if spectra.iter().all(|spectrum| spectrum.sigmas.is_none()) => {
            let fitted = spectra.iter().filter(|spectrum| spectrum.fitted).flat_map(|spectrum| &spectrum.measured);
            let compared = fitted.map(|value| compare.of(*value));
            let (squares, count) = compared.fold((0.0, 0.0), |(sum, count), value| (sum + value * value, count + 1.0));
            let typical = (squares / count).sqrt();
            let what = match compare {
                Compared::Values => "the readings",
                Compared::CubeRoots => "the cube roots of the readings",
            };
            (typical > 0.0)
                .then(|| format!("The model misses {what} by {} (rms, of their own rms).", percent(rms / typical)))
        }
        _ => None,
    }
}

/// Peaks that move to longer wavelengths as the angle grows, which no film does.
fn reddening(case: &Case) -> Option<String> {
    let CaseData::Peaks { peaks, .. } = &case.data else { return None };
    let angle = |peak: &PeakFit| peak.geometry.theta_i_deg + peak.geometry.theta_o_deg;
    let first = peaks.iter().min_by(|a, b| angle(a).total_cmp(&angle(b)))?;
    let last = peaks.iter().max_by(|a, b| angle(a).total_cmp(&angle(b)))?;
    (last.measured_nm > first.measured_nm && angle(last) > angle(first)).then(|| {
        "Peaks move to longer wavelengths with angle, which a film's do not: are the angles counted from the surface \
         instead of its normal?"
            .to_owned()
    })
}

/// A held-out peak that is missed by more than this many times the misfit of the fitted ones tells against the model.
const BEYOND: f64 = 3.0;

/// How well readings that the fit did not see are predicted.
fn held_out(case: &Case) -> Option<String> {
    match &case.data {
        CaseData::Peaks { peaks, .. } => held_out_peaks(peaks),
        CaseData::Spectra { .. } => case.held_out.as_ref().map(|held_out| {
            format!(
                "It misses the {} readings held out by {} (rms; of cube roots {}).",
                held_out.readings,
                significant(held_out.rms, 3),
                significant(held_out.rms_of_cube_roots, 3)
            )
        }),
    }
}

fn held_out_peaks(peaks: &[PeakFit]) -> Option<String> {
    let held: Vec<&PeakFit> = peaks.iter().filter(|peak| !peak.fitted).collect();
    let error = |peak: &&PeakFit| peak.model_nm.map(|nm| nm - peak.measured_nm);
    let text = |peak: &&PeakFit| error(peak).map_or_else(|| "no peak".into(), |nm| minus(&format!("{nm:+.1}")));
    let errors: Vec<String> = held.iter().map(text).collect();
    if errors.is_empty() {
        return None;
    }
    let what = if errors.len() == 1 { "peak that was" } else { "peaks that were" };
    let sentence = format!("Model minus measured at the {what} held out: {} nm.", list(&errors));
    let largest = held.iter().filter_map(error).fold(0.0, |most: f64, nm| most.max(nm.abs()));
    let usual = peaks.iter().filter(|peak| peak.fitted).filter_map(|peak| error(&peak)).map(|nm| nm * nm);
    let (sum, count) = usual.fold((0.0, 0.0), |(sum, count), square| (sum + square, count + 1.0));
    let rms = f64::sqrt(sum / count);
    if largest > BEYOND * rms && rms > 0.0 {
        let times = largest / rms;
        return Some(format!(
            "{sentence} That is up to {times:.0} times the misfit of the fitted ones: the model fails there, and the \
             errors given hold only if it is right where it was fitted."
        ));
    }
    Some(sentence)
}

/// The physical parameters, a few of them; the instrument's only where nothing else is free.
fn main_values(fit: &Fit) -> String {
    let mut free: Vec<&Estimate> = fit.estimates.iter().filter(|estimate| estimate.role == "free").collect();
    if free.iter().any(|estimate| importance(&estimate.name) < INSTRUMENT) {
        free.retain(|estimate| importance(&estimate.name) < INSTRUMENT);
    }
    free.sort_by_key(|estimate| importance(&estimate.name));
    let named: Vec<String> = free.iter().take(MOST_NAMED).map(|estimate| value_text(estimate)).collect();
    format!("{}.", list(&named))
}

/// Rank of gains and offsets in [`importance`].
const INSTRUMENT: u32 = 3;

fn importance(name: &str) -> u32 {
    if name.ends_with(".thickness_nm") {
        0
    } else if name.contains(".index") || name.contains(".cauchy") || name.contains(".extinction") {
        1
    } else if name.starts_with("gain") || name.starts_with("offset") {
        INSTRUMENT
    } else {
        2
    }
}

fn value_text(estimate: &Estimate) -> String {
    let unit = if estimate.unit.is_empty() { String::new() } else { format!(" {}", estimate.unit) };
    let name = format!("{} ({})", estimate.symbol, estimate.name);
    if let Some(side) = estimate.at_bound {
        let side = match side {
            Bound::Lower => "lower",
            Bound::Upper => "upper",
        };
        return format!(
            "{name} at its {side} bound {}{unit} (widen it, or doubt the model)",
            rounded(estimate.value, None)
        );
    }
    match estimate.standard_error {
        Some(error) if !estimate.open => format!("{name} = {}{unit}", rounded(estimate.value, Some(error))),
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
