//! Cost over each scanned parameter, with every minimum marked.

use super::cost_label;
use crate::fit::ProfilePoint;
use crate::job::Case;
use crate::report::chart::{
    Axis, Cell, Chart, Figure, Layer, Look, Mark, PAGE_WIDTH, Series, extent, with_room, with_room_logarithmic,
};
use crate::report::palette::{BLUE, GREY, VERMILION};
use crate::report::tables::SHOWN_MINIMA;

pub(super) fn draw(case: &Case) -> Vec<Figure> {
    let drawn = case.fit.profiles.iter().filter(|(_, points)| points.len() > 1);
    drawn.enumerate().map(|(index, (name, points))| figure(case, index, name, points)).collect()
}

fn figure(case: &Case, index: usize, name: &str, points: &[ProfilePoint]) -> Figure {
    let fit = &case.fit;
    let column = fit.estimates.iter().position(|e| e.name == name);
    let estimate = column.map(|c| &fit.estimates[c]);
    let minima: Vec<(f64, f64)> =
        column.map_or_else(Vec::new, |c| fit.minima.iter().filter_map(|m| Some((*m.values.get(c)?, m.cost))).collect());
    let values = extent(points.iter().map(|p| p.value).chain(minima.iter().map(|m| m.0)));
    let costs = extent(points.iter().map(|p| p.cost).chain(minima.iter().map(|m| m.1)));
    let y = if costs.0 > 0.0 && costs.1 > 20.0 * costs.0 {
        Axis::logarithmic(cost_label(case), with_room_logarithmic(costs))
    } else {
        Axis::linear(cost_label(case), with_room(costs))
    };
    let x_label = match estimate {
        Some(e) if !e.unit.is_empty() => format!("{}: {} ({})", e.symbol, e.name, e.unit),
        _ => name.to_owned(),
    };
    let look = |open: bool| Look::Marks { colour: if open { VERMILION } else { BLUE }, mark: Mark::Diamond, open };
    let curve = points.iter().map(|p| (p.value, p.cost));
    let mut layers = vec![
        Layer::Series(Series::new(
            "scan before the fit",
            curve,
            Look::Line { colour: GREY, width: 1.2, dashed: false },
        )),
        Layer::Series(Series::new("other minima of the fit", minima.iter().skip(1).copied(), look(true))),
        Layer::Series(Series::new("best minimum of the fit", minima.first().copied(), look(false))),
    ];
    layers.extend(minima.iter().take(SHOWN_MINIMA).enumerate().map(|(i, (x, y))| Layer::Note {
        x: *x,
        y: *y,
        text: (i + 1).to_string(),
    }));
    Figure {
        name: if index == 0 { "profile".to_owned() } else { format!("profile-{}", index + 1) },
        title: match estimate {
            Some(e) => format!("Cost over {} ({name})", e.symbol),
            None => format!("Cost over {name}"),
        },
        caption: "The curve is a scan before the fit: the lowest cost found with this parameter held. Where readings are \
                  many it is made on a part of them and scaled to their full number, so that its level is rough. Diamonds \
                  are the minima of the fit to all readings, each at its own cost and numbered as in the table; they may \
                  lie above or below the curve. Costs of diamonds compare with each other, not with the curve."
            .to_owned(),
        width: PAGE_WIDTH,
        columns: 1,
        cells: vec![Cell {
            title: String::new(),
            charts: vec![Chart { x: Axis::linear(x_label, values), y, height: 250.0, layers }],
        }],
    }
}
