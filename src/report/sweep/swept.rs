//! How a sweep is laid along axes: which values stand where, and which of many are shown.

use crate::job::{Sweep, SweepAxis};
use crate::number::plain;
use crate::parameter::Parameter;
use crate::report::angles;
use crate::report::chart::{Axis, Look, Mark, extent};
use crate::report::palette::{BLACK, BLUE, Colour, GREEN, PURPLE, SKY, VERMILION};

/// Most geometries that the page shows one by one.
const MOST_VIEWS: usize = 4;
/// Most columns of a map; more cannot be told apart at its width.
const MOST_COLUMNS: usize = 240;
/// Most points of a line.
const MOST_POINTS: usize = 4000;

/// Name, symbol and unit of a parameter, as an axis says it.
pub(super) fn axis_label(parameter: &Parameter) -> String {
    let unit = if parameter.unit.is_empty() { String::new() } else { format!(" ({})", parameter.unit) };
    format!("{}, {}{unit}", parameter.symbol, parameter.name)
}

/// `d = 330 nm`, and what moves along.
pub(super) fn setting(axis: &SweepAxis, value: f64) -> String {
    let one = |(parameter, value): (&Parameter, f64)| {
        let unit = if parameter.unit.is_empty() { String::new() } else { format!(" {}", parameter.unit) };
        format!("{} = {}{unit}", parameter.symbol, short(value))
    };
    axis.at(value).map(one).collect::<Vec<_>>().join(", ")
}

/// A number to three significant digits at most, as a label has room for.
fn short(value: f64) -> String {
    plain(format!("{value:.2e}").parse().unwrap_or(value))
}

/// Geometries that are shown: their index and name.
pub(super) fn views(sweep: &Sweep) -> Vec<(usize, String)> {
    let names = angles::names(sweep.views.iter().map(|view| &view.geometry));
    angles::evenly(names.len(), MOST_VIEWS).into_iter().map(|view| (view, names[view].clone())).collect()
}

/// A sentence where geometries are left out, and one on what their names mean.
pub(super) fn views_note(sweep: &Sweep) -> String {
    let meaning = angles::meaning(sweep.views.iter().map(|view| &view.geometry));
    if sweep.views.len() <= MOST_VIEWS {
        return meaning.to_owned();
    }
    format!("{MOST_VIEWS} of {} geometries are shown; the tables have all. {meaning}", sweep.views.len())
}

/// The axis that cells run through first.
pub(super) fn inner(sweep: &Sweep) -> &SweepAxis {
    &sweep.axes[sweep.axes.len() - 1]
}

/// The other axis, where there are two.
pub(super) fn outer(sweep: &Sweep) -> Option<&SweepAxis> {
    sweep.axes.first().filter(|_| sweep.axes.len() > 1)
}

/// Indices of an axis's values in rising order, thinned to what a map can show.
pub(super) fn columns(axis: &SweepAxis) -> Vec<usize> {
    rising(axis, MOST_COLUMNS)
}

/// The same, thinned to what a line can show.
pub(super) fn points(axis: &SweepAxis) -> Vec<usize> {
    rising(axis, MOST_POINTS)
}

fn rising(axis: &SweepAxis, most: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..axis.values.len()).collect();
    order.sort_by(|a, b| axis.values[*a].total_cmp(&axis.values[*b]));
    angles::evenly(order.len(), most).into_iter().map(|place| order[place]).collect()
}

/// Cell of these places on the outer and the inner axis.
pub(super) fn cell(sweep: &Sweep, outer: usize, inner_place: usize) -> usize {
    outer * inner(sweep).values.len() + inner_place
}

/// Borders between rising values, halfway to the neighbours.
pub(super) fn borders(axis: &SweepAxis, columns: &[usize]) -> Vec<f64> {
    let place = |value: f64| if axis.is_logarithmic { value.ln() } else { value };
    let back = |place: f64| if axis.is_logarithmic { place.exp() } else { place };
    let at: Vec<f64> = columns.iter().map(|column| place(axis.values[*column])).collect();
    let (first, last) = (at[0], at[at.len() - 1]);
    if at.len() == 1 {
        let half = (0.05 * first.abs()).max(1e-3);
        return vec![back(first - half), back(first + half)];
    }
    let mut borders = vec![first - (at[1] - first) / 2.0];
    borders.extend(at.windows(2).map(|pair| (pair[0] + pair[1]) / 2.0));
    borders.push(last + (last - at[at.len() - 2]) / 2.0);
    borders.into_iter().map(back).collect()
}

/// The x axis over these borders or values.
pub(super) fn x_axis(axis: &SweepAxis, places: &[f64]) -> Axis {
    let range = extent(places.iter().copied());
    let range = if range.0 < range.1 { range } else { (range.0 - 1e-3, range.1 + 1e-3) };
    let label = axis_label(&axis.parameter);
    if axis.is_logarithmic { Axis::logarithmic(label, range) } else { Axis::linear(label, range) }
}

/// Looks of lines that stay apart for every reader: by colour, and by dash too.
const LINES: [(Colour, bool); 6] =
    [(BLUE, false), (VERMILION, true), (GREEN, false), (BLACK, true), (SKY, false), (PURPLE, true)];
/// Most lines in one chart.
pub(super) const MOST_LINES: usize = LINES.len();

/// The look of a line by its place in the chart.
pub(super) fn line(place: usize) -> Look {
    let (colour, dashed) = LINES[place % MOST_LINES];
    Look::Line { colour, width: 1.8, dashed }
}

/// The same with a mark at each point.
pub(super) fn marked_line(place: usize) -> Look {
    let (colour, dashed) = LINES[place % MOST_LINES];
    Look::Both { colour, mark: [Mark::Disc, Mark::Square, Mark::Diamond][place % 3], dashed }
}
