//! Cost against iteration of the start that won.

use super::cost_label;
use crate::job::Case;
use crate::report::chart::{
    Axis, Cell, Chart, Figure, Layer, Look, Mark, Series, extent, with_room, with_room_logarithmic,
};
use crate::report::palette::BLUE;

pub(super) fn draw(case: &Case) -> Vec<Figure> {
    let trace = &case.fit.trace;
    if trace.len() < 2 {
        return Vec::new();
    }
    // An iteration is a count, far below 2⁵³.
    let iteration = |i: u64| u32::try_from(i).map_or(f64::MAX, f64::from);
    let costs = extent(trace.iter().map(|t| t.cost).filter(|c| *c > 0.0));
    let look = if trace.len() <= 60 {
        Look::Both { colour: BLUE, mark: Mark::Disc, dashed: false }
    } else {
        Look::Line { colour: BLUE, width: 1.5, dashed: false }
    };
    vec![Figure {
        name: "convergence".to_owned(),
        title: "Convergence of the best start".to_owned(),
        caption: "Cost after each iteration of the start that reached the best minimum.".to_owned(),
        width: 660,
        columns: 1,
        cells: vec![Cell {
            title: String::new(),
            charts: vec![Chart {
                x: Axis::counts("iteration", with_room(extent(trace.iter().map(|t| iteration(t.iteration))))),
                y: Axis::logarithmic(cost_label(case), with_room_logarithmic(costs)),
                height: 170.0,
                layers: vec![Layer::Series(Series::new(
                    "cost",
                    trace.iter().filter(|t| t.cost > 0.0).map(|t| (iteration(t.iteration), t.cost)),
                    look,
                ))],
            }],
        }],
    }]
}
