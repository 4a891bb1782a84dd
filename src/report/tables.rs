//! The tables of a case, every entry already written as text.

use std::collections::BTreeMap;

use super::readings::{self, labelled};
use crate::fit::{Bound, Estimate, Fit, Goodness, Loss, Minimum, RIVAL_SHARE, SigmaSource, StopReason};
use crate::job::{Case, Comparison, ThicknessOrder, Truth};
use crate::number::{beside_error, count, percent, plain, significant, with_error};

/// Correlations of at least this size are listed.
pub(crate) const STRONG_CORRELATION: f64 = 0.9;
/// Most parameters that the table of minima has columns for.
const MOST_MINIMUM_COLUMNS: usize = 5;
/// Most minima that are listed at once and numbered in plots; the others are folded away.
pub(crate) const SHOWN_MINIMA: usize = 12;
/// Parameters named in the comparison of cases.
const MAIN_PARAMETERS: usize = 4;

/// One line of the parameter table.
pub(crate) struct ParameterRow {
    pub(crate) symbol: String,
    pub(crate) name: String,
    pub(crate) text: String,
    /// Value ± error with unit.
    pub(crate) value: String,
    pub(crate) percent: String,
    pub(crate) interval: String,
    pub(crate) start: String,
    pub(crate) bounds: String,
    pub(crate) role: String,
    /// At a bound, open: sentences.
    pub(crate) notes: Vec<String>,
    pub(crate) prior: Option<String>,
    pub(crate) truth: String,
    /// (fit − truth)/error.
    pub(crate) deviation: String,
}

/// The parameters that are held fixed, or all the others, with the truth beside the fit where it is known.
pub(crate) fn parameters(case: &Case, truth: Option<&Truth>, are_fixed: bool) -> Vec<ParameterRow> {
    let chosen = case.fit.estimates.iter().filter(|e| (e.role == "fixed") == are_fixed);
    chosen.map(|e| parameter(case, e, truth.and_then(|t| t.values.get(&e.name).copied()))).collect()
}

/// Whether the value is the thickness under one of several orders of interference, between which the data do not decide.
fn is_one_of_several_orders(case: &Case, e: &Estimate) -> bool {
    case.orders.len() > 1 && e.role == "free" && e.name.ends_with(".thickness_nm")
}

fn parameter(case: &Case, e: &Estimate, truth: Option<f64>) -> ParameterRow {
    let error = e.standard_error;
    let beside = |v: f64| beside_error(v, error);
    let range = |[low, high]: [f64; 2], write: &dyn Fn(f64) -> String| format!("{} to {}", write(low), write(high));
    let one_sided = |words: &str, limit: Option<f64>| match limit {
        Some(limit) => format!("{words} {} at 95 %", with_unit(&beside(limit), &e.unit)),
        None => "the data say nothing of how far it may be from it".to_owned(),
    };
    let mut notes = Vec::new();
    match e.at_bound {
        Some(Bound::Lower) => {
            notes.push(format!("At its lower bound: {}.", one_sided("below", e.interval_95.map(|i| i[1]))));
        }
        Some(Bound::Upper) => {
            notes.push(format!("At its upper bound: {}.", one_sided("above", e.interval_95.map(|i| i[0]))));
        }
        None => {}
    }
    if is_one_of_several_orders(case, e) {
        notes.push("One of several orders, see above.".to_owned());
    } else if e.open {
        notes.push("Open: the data do not determine it.".to_owned());
    }
    ParameterRow {
        symbol: e.symbol.clone(),
        name: e.name.clone(),
        text: e.text.clone(),
        value: with_unit(&with_error(e.value, error), &e.unit),
        percent: percent(e.value, error).unwrap_or_default(),
        interval: match (e.at_bound, e.interval_95) {
            (Some(Bound::Lower), Some([_, high])) => format!("≤ {}", beside(high)),
            (Some(Bound::Upper), Some([low, _])) => format!("≥ {}", beside(low)),
            (None, Some(interval)) => range(interval, &beside),
            (_, None) => String::new(),
        },
        start: e.start.map(plain).unwrap_or_default(),
        bounds: e.bounds.map(|b| range(b, &plain)).unwrap_or_default(),
        role: e.role.clone(),
        notes,
        prior: e.prior.map(|[mean, sigma]| with_unit(&with_error(mean, Some(sigma)), &e.unit)),
        truth: truth.map(plain).unwrap_or_default(),
        deviation: truth
            .zip(error.filter(|s| *s > 0.0))
            .map(|(truth, error)| signed((e.value - truth) / error))
            .unwrap_or_default(),
    }
}

/// The main parameters in one line: those that were scanned, then the first free ones.
pub(crate) fn main_parameters(case: &Case) -> Vec<String> {
    let fit = &case.fit;
    let mut shown: Vec<&Estimate> =
        fit.profiles.iter().filter_map(|(name, _)| fit.estimates.iter().find(|e| e.name == *name)).collect();
    for e in fit.estimates.iter().filter(|e| e.role == "free") {
        if !shown.iter().any(|s| s.name == e.name) {
            shown.push(e);
        }
    }
    shown.truncate(MAIN_PARAMETERS);
    shown
        .iter()
        .map(|e| match is_one_of_several_orders(case, e) {
            true => format!("{}: order open", e.symbol),
            false => format!("{} = {}", e.symbol, with_unit(&with_error(e.value, e.standard_error), &e.unit)),
        })
        .collect()
}

/// Free parameters, rms of what was held out, that of cube roots, and `AICc` of one case among several.
pub(crate) fn judged(comparison: &Comparison, index: usize) -> Option<[String; 4]> {
    let row = comparison.rows.get(index)?;
    Some([
        row.free_parameters.to_string(),
        significant(row.held_out.rms, 3),
        significant(row.held_out.rms_of_cube_roots, 3),
        row.aicc.map_or_else(|| "–".to_owned(), |aicc| crate::number::to_place(aicc, -1)),
    ])
}

/// What the columns of [`judged`] mean.
pub(crate) fn comparison_sentence(comparison: &Comparison) -> String {
    let held_out = comparison.rows.first().map_or(0, |row| row.held_out.readings);
    format!(
        "Held out: root mean square of model − measured at the {held_out} readings that no case was fitted to, and the same of          cube roots, in which bright readings do not drown dark ones. AICc is on the readings fitted, as if {} of them were          independent (as for the case that follows them best); lower is better, and differences alone mean something.",
        significant(comparison.effective_readings, 3)
    )
}

/// The table of minima.
pub(crate) struct Minima {
    pub(crate) parameters: Vec<String>,
    /// The best, and the others.
    pub(crate) rows: Vec<MinimumRow>,
    pub(crate) further: Vec<MinimumRow>,
    /// How many parameters have no column.
    pub(crate) left_out: usize,
    pub(crate) cost_label: String,
    pub(crate) rms_label: String,
    pub(crate) sentence: String,
}

/// One line of it.
pub(crate) struct MinimumRow {
    pub(crate) number: usize,
    pub(crate) values: Vec<String>,
    pub(crate) cost: String,
    pub(crate) rms: String,
    pub(crate) weight: String,
    pub(crate) hits: usize,
    pub(crate) stop: &'static str,
}

pub(crate) fn minima(case: &Case) -> Minima {
    let (fit, units) = (&case.fit, readings::units(case));
    let scanned = |e: &Estimate| fit.profiles.iter().any(|(name, _)| *name == e.name);
    let mut columns: Vec<usize> = (0..fit.estimates.len()).filter(|i| fit.estimates[*i].role == "free").collect();
    columns.sort_by_key(|i| !scanned(&fit.estimates[*i]));
    let left_out = columns.len().saturating_sub(MOST_MINIMUM_COLUMNS);
    columns.truncate(MOST_MINIMUM_COLUMNS);
    let header = |i: &usize| {
        let e = &fit.estimates[*i];
        let is_unique = fit.estimates.iter().filter(|other| other.symbol == e.symbol).count() == 1;
        let name = if is_unique { &e.symbol } else { &e.name };
        labelled(name, &e.unit)
    };
    let row = |(index, m): (usize, &Minimum)| MinimumRow {
        number: index + 1,
        values: columns
            .iter()
            .map(|i| match m.values.get(*i) {
                Some(value) => with_error(*value, m.standard_errors.get(*i).copied().flatten()),
                None => String::new(),
            })
            .collect(),
        cost: significant(m.cost, 5),
        rms: significant(m.rms, 3),
        weight: share(m.weight),
        hits: m.hits,
        stop: stop_words(m.stop),
    };
    let mut rows: Vec<MinimumRow> = fit.minima.iter().enumerate().map(row).collect();
    let further = rows.split_off(rows.len().min(SHOWN_MINIMA));
    Minima {
        parameters: columns.iter().map(header).collect(),
        rows,
        further,
        left_out,
        cost_label: match (fit.settings.loss, fit.goodness.sigma_source) {
            (Loss::Squares, SigmaSource::Known) => "χ²".to_owned(),
            (Loss::Squares, SigmaSource::Estimated) => labelled("Sum of squares", units.squared),
            _ => "Cost".to_owned(),
        },
        rms_label: match fit.goodness.sigma_source {
            SigmaSource::Known => "rms (σ)".to_owned(),
            SigmaSource::Estimated => labelled("rms", units.name),
        },
        sentence: rivals(fit),
    }
}

fn rivals(fit: &Fit) -> String {
    let Some(best) = fit.minima.first() else { return "No minimum was found.".to_owned() };
    let rivals: Vec<String> =
        fit.rivals().map(|(index, m)| format!("number {} ({})", index + 1, share(m.weight))).collect();
    let (bar, best) = (percent_of(RIVAL_SHARE), share(best.weight));
    match (fit.minima.len(), rivals.as_slice()) {
        (0, _) => "No minimum was found.".to_owned(),
        (1, _) => "The fit found one minimum.".to_owned(),
        (n, []) => format!("Of {n} minima, none but the best has more than {bar} of its weight."),
        (_, [one]) => format!("One rival has more than {bar} of the best fit's weight ({best}): {one}."),
        (_, many) => {
            format!(
                "{} rivals have more than {bar} of the best fit's weight ({best}): {}.",
                many.len(),
                many.join(", ")
            )
        }
    }
}

/// One line of the table of orders.
pub(crate) struct OrderRow {
    pub(crate) order: String,
    pub(crate) thickness: String,
    pub(crate) index: String,
    pub(crate) rms: String,
    pub(crate) weight: String,
}

pub(crate) fn orders(orders: &[ThicknessOrder]) -> Vec<OrderRow> {
    orders
        .iter()
        .map(|o| OrderRow {
            order: plain(o.order),
            thickness: with_error(o.thickness_nm, o.standard_error_nm),
            index: with_error(o.index, o.index_standard_error),
            rms: significant(o.rms_nm, 3),
            weight: share(o.weight),
        })
        .collect()
}

/// Pairs of strongly correlated parameters, strongest first, each a line.
pub(crate) fn strong_correlations(fit: &Fit) -> Vec<String> {
    let mut pairs: Vec<(f64, String)> = Vec::new();
    for (i, one) in fit.free.iter().enumerate() {
        for (j, other) in fit.free.iter().enumerate().skip(i + 1) {
            if let Some(r) = fit.correlations.get(i).and_then(|row| row.get(j)).copied().flatten()
                && r.abs() >= STRONG_CORRELATION
            {
                pairs.push((r, format!("{one} and {other}: {}", crate::number::correlation(r, 3))));
            }
        }
    }
    pairs.sort_by(|a, b| b.0.abs().total_cmp(&a.0.abs()));
    pairs.into_iter().map(|(_, text)| text).collect()
}

/// Goodness of fit as label and text.
pub(crate) fn goodness(case: &Case) -> Vec<(&'static str, String)> {
    let fit = &case.fit;
    let g: &Goodness = &fit.goodness;
    let effective = format!(
        "{} (what they would be worth if they were independent; neighbouring residuals are not)",
        significant(g.effective_readings, 3)
    );
    let mut rows = Vec::new();
    if let Some(rms) = readings::rms(case) {
        rows.push(("Root mean square residual", rms));
    }
    rows.push(("Readings", count(u64::try_from(g.readings).unwrap_or(u64::MAX))));
    rows.push(("Effective readings", effective));
    rows.push(("Free parameters", g.free_parameters.to_string()));
    rows.push(("Degrees of freedom", crate::number::minus(&g.degrees_of_freedom.to_string())));
    match g.sigma_source {
        SigmaSource::Known => {
            let none_left = || "not available: no degrees of freedom are left".to_owned();
            rows.push(("χ²", significant(g.chi_squared, 4)));
            rows.push(("Reduced χ²", g.reduced_chi_squared.map_or_else(none_left, |value| significant(value, 3))));
            rows.push(("σ of a reading", "known, from the table or the job".to_owned()));
        }
        SigmaSource::Estimated => {
            let units = readings::units(case);
            rows.push(("Residual sum of squares", with_unit(&significant(g.chi_squared, 4), units.squared)));
            rows.push((
                "σ of a reading",
                format!(
                    "unknown; estimated from the residuals of this fit as σ = {}{}, so that the errors hold only if the \
                     model is right",
                    significant(g.sigma_scale, 3),
                    units.following
                ),
            ));
        }
    }
    rows.push((
        "AICc on effective readings",
        g.aicc.map_or_else(|| "not available: too few effective readings".to_owned(), plain),
    ));
    rows.push(("Solver", format!("{}, {} residual evaluations", stop_words(fit.stop), count(fit.evaluations))));
    if fit.not_finite > 0 {
        rows.push(("Evaluations without a finite value", count(fit.not_finite)));
    }
    rows
}

/// Why a solver stopped, in words.
pub(crate) fn stop_words(stop: StopReason) -> &'static str {
    match stop {
        StopReason::Converged => "converged",
        StopReason::Limit => "stopped at the iteration limit",
        StopReason::Stalled => "stalled",
        StopReason::Failed => "failed",
        StopReason::Cancelled => "cancelled by the user",
    }
}

/// True values by name, for synthetic readings.
pub(crate) fn truth_sentence(truth: &Truth) -> String {
    let values: &BTreeMap<String, f64> = &truth.values;
    let listed: Vec<String> = values.iter().map(|(name, value)| format!("{name} = {}", plain(*value))).collect();
    format!(
        "The readings were not measured. Barbule made them from {}, with noise of {} % of each reading (seed {}).",
        if listed.is_empty() { "known values".to_owned() } else { listed.join(", ") },
        plain(100.0 * truth.noise),
        truth.seed
    )
}

/// A share of 1 as percent, small ones as "< 0.1 %".
pub(crate) fn share(weight: f64) -> String {
    if weight > 0.0 && weight < 0.001 {
        "< 0.1 %".to_owned()
    } else {
        format!("{} %", crate::number::to_place(100.0 * weight, -1))
    }
}

pub(crate) fn with_unit(number: &str, unit: &str) -> String {
    match unit {
        "" => number.to_owned(),
        _ if number.contains(" ± ") && !number.starts_with('(') => format!("({number}) {unit}"),
        _ => format!("{number} {unit}"),
    }
}

/// A round share of 1 as whole percent.
fn percent_of(share: f64) -> String {
    format!("{} %", plain(100.0 * share))
}

fn signed(value: f64) -> String {
    let text = crate::number::to_place(value, -1);
    if value > 0.0 { format!("+{text}") } else { text }
}
