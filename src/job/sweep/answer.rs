//! What a sweep found, in sentences.

use super::outcome::{Sweep, Varying};
use crate::number::{plain, significant, with_error};
use crate::parameter::Parameter;
use crate::sensitivity::Indices;

/// The sentences, one a line.
pub(super) fn answer(sweep: &Sweep) -> String {
    let mut lines = vec![over_the_grid(sweep)];
    lines.extend(at_own_values(sweep));
    lines.extend(over_the_ranges(sweep));
    lines.join("\n")
}

fn with_unit(value: f64, unit: &str) -> String {
    if unit.is_empty() { plain(value) } else { format!("{} {unit}", plain(value)) }
}

fn setting(name: &str, parameter: &Parameter, value: f64) -> String {
    format!("{name} = {}", with_unit(value, parameter.unit))
}

fn over_the_grid(sweep: &Sweep) -> String {
    let axes: Vec<String> = sweep
        .axes
        .iter()
        .map(|axis| match axis.values.as_slice() {
            [value] => axis.at(*value).map(|(p, value)| setting(&p.name, p, value)).collect::<Vec<_>>().join(", "),
            [first, .., last] => format!(
                "{} from {} to {} ({} values)",
                axis.parameters().map(|parameter| parameter.name.as_str()).collect::<Vec<_>>().join(" with "),
                plain(*first),
                with_unit(*last, axis.parameter.unit),
                axis.values.len()
            ),
            [] => axis.parameter.name.clone(),
        })
        .collect();
    let over = format!("Over {}", axes.join(" and "));
    let first = &sweep.cells[0];
    let mut largest: Option<(f64, usize, usize)> = None;
    for (cell, view) in (0..sweep.cells.len()).flat_map(|cell| (0..first.colours.len()).map(move |view| (cell, view))) {
        let difference = sweep.cells[cell].colours[view].lab.delta_e_2000(first.colours[view].lab);
        if largest.is_none_or(|(so_far, ..)| difference > so_far) {
            largest = Some((difference, cell, view));
        }
    }
    match largest {
        None => format!("{over} the readings of {} geometries were computed.", sweep.views.len()),
        Some((difference, cell, view)) => {
            let at: Vec<String> = sweep
                .axes
                .iter()
                .zip(&sweep.cells[cell].values)
                .flat_map(|(axis, value)| axis.at(*value))
                .map(|(parameter, value)| setting(&parameter.symbol, parameter, value))
                .collect();
            format!(
                "{over} the colour differs from the first one by up to ΔE₀₀ = {}, at {} seen at {}.",
                significant(difference, 3),
                at.join(", "),
                sweep.views[view].id
            )
        }
    }
}

/// What 1 % of each parameter does, the strongest first.
fn at_own_values(sweep: &Sweep) -> Option<String> {
    let mut parts: Vec<(f64, String)> = sweep
        .slopes
        .iter()
        .filter_map(|slope| {
            let percent = slope.differences.iter().filter_map(|rate| slope.per_percent(*rate));
            let largest = percent.reduce(f64::max)?;
            Some((largest, format!("1 % of {} changes it by {}", slope.parameter.name, significant(largest, 2))))
        })
        .collect();
    parts.sort_by(|a, b| b.0.total_cmp(&a.0));
    parts.truncate(4);
    let list: Vec<String> = parts.into_iter().map(|(_, text)| text).collect();
    (!list.is_empty())
        .then(|| format!("At the job's own values, in ΔE₀₀ and in the geometry where it is most: {}.", list.join("; ")))
}

/// What each free parameter does to the colour, or to the readings where there is none.
fn over_the_ranges(sweep: &Sweep) -> Option<String> {
    let variance = sweep.variance.as_ref().ok()?;
    let what = if sweep.own.colours.is_empty() { Varying::Readings } else { Varying::Difference };
    let output = variance
        .outputs
        .iter()
        .filter(|output| output.what == what)
        .max_by(|a, b| a.standard_deviation.total_cmp(&b.standard_deviation))?;
    let of = match what {
        Varying::Readings => "the readings",
        Varying::Difference => "ΔE₀₀ to the job's own values",
    };
    let Some(indices) = &output.indices else {
        return Some(format!("Over the ranges of the free parameters {of} do not vary."));
    };
    let percent = |estimate: crate::sensitivity::Estimate| {
        format!("({}) %", with_error(100.0 * estimate.value, Some(100.0 * estimate.standard_error)))
    };
    let mut parts: Vec<(f64, String)> = variance
        .inputs
        .iter()
        .zip(indices)
        .map(|((parameter, ..), Indices { first_order, total })| {
            let text = format!("{} {} alone, {} with others", parameter.name, percent(*first_order), percent(*total));
            (total.value, text)
        })
        .collect();
    parts.sort_by(|a, b| b.0.total_cmp(&a.0));
    parts.truncate(4);
    let list: Vec<String> = parts.into_iter().map(|(_, text)| text).collect();
    Some(format!(
        "Share in the variance of {of}, seen at {}, over the ranges of the free parameters: {}.",
        sweep.views[output.view].id,
        list.join("; ")
    ))
}
