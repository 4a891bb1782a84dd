//! The histogram of differences, and the scale of their map.

use crate::compare::Comparison;
use crate::report::chart::{
    Axis, Cell, Chart, ColourCells, Figure, Layer, Look, PAGE_WIDTH, Series, from_zero, length,
};
use crate::report::palette::{BLUE, Scale};

/// Steps of the scale.
const STEPS: usize = 64;
/// Bars of the histogram.
const BINS: usize = 50;

/// Where the scale of the map ends: the 95 % quantile, rounded up to a number that is easy to read.
pub(super) fn scale_end(comparison: &Comparison) -> f64 {
    let reach = comparison.difference.percentile_95;
    [1.0, 2.0, 5.0, 10.0, 20.0, 50.0].into_iter().find(|end| *end >= reach).unwrap_or(100.0)
}

/// The colours of the map.
pub(super) fn scale_to(high: f64) -> Scale {
    Scale::Sequential { low: 0.0, high }
}

/// The scale of the map, to be put below it.
pub(super) fn scale(high: f64) -> Figure {
    let step = |index: usize| high * length(index) / length(STEPS);
    let row = (0..STEPS).map(|index| scale_to(high).colour((step(index) + step(index + 1)) / 2.0)).collect();
    let cells = ColourCells { borders: (0..=STEPS).map(step).collect(), rows: vec![row], label: "colour".to_owned() };
    Figure {
        name: "scale".to_owned(),
        title: "Scale of the map of differences".to_owned(),
        caption: format!("Differences above {high} have the last colour. Grey: left out."),
        width: PAGE_WIDTH,
        columns: 1,
        cells: vec![Cell {
            title: String::new(),
            charts: vec![Chart {
                x: Axis::linear("ΔE2000", (0.0, high)),
                y: Axis::bands("", vec![String::new()]),
                height: 14.0,
                layers: vec![Layer::ColourCells(cells)],
            }],
        }],
    }
}

/// How many pixels differ by how much.
pub(super) fn histogram(comparison: &Comparison) -> Figure {
    let values = || comparison.pixels.difference.iter().flatten().map(|value| f64::from(*value));
    let end = if comparison.difference.largest > 0.0 { comparison.difference.largest } else { 1.0 };
    let mut counts = [0usize; BINS];
    for value in values() {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "cut to the number of bars")]
        let bin = (value / end * length(BINS)) as usize;
        counts[bin.min(BINS - 1)] += 1;
    }
    let percent = |count: usize| 100.0 * length(count) / length(comparison.compared);
    let edge = |index: usize| end * length(index) / length(BINS);
    let steps = counts
        .iter()
        .enumerate()
        .flat_map(|(index, count)| [(edge(index), percent(*count)), (edge(index + 1), percent(*count))]);
    let highest = counts.iter().map(|count| percent(*count)).fold(0.0, f64::max);
    let look = Look::Line { colour: BLUE, width: 1.6, dashed: false };
    Figure {
        name: "histogram".to_owned(),
        title: "How many pixels differ by how much".to_owned(),
        caption: format!("Share of the pixels compared in each of {BINS} steps from 0 to the largest difference."),
        width: PAGE_WIDTH,
        columns: 1,
        cells: vec![Cell {
            title: String::new(),
            charts: vec![Chart {
                x: Axis::linear("ΔE2000", (0.0, end)),
                y: Axis::linear("share of pixels (%)", from_zero((0.0, highest))),
                height: 240.0,
                layers: vec![Layer::Series(Series::new("pixels", steps, look))],
            }],
        }],
    }
}
