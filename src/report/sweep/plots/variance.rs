//! Shares of the variance that each free parameter causes.

use crate::job::{Sweep, VarianceOf, Varying};
use crate::report::chart::{Axis, Cell, Chart, Figure, Layer, Look, Mark, PAGE_WIDTH, Series, extent, length};
use crate::report::palette::{BLUE, VERMILION};
use crate::report::sweep::swept::{views, views_note};
use crate::sensitivity::{Estimate, Indices};

/// Half the distance between the two marks of a parameter, of its band.
const APART: f64 = 0.12;

pub(super) fn draw(sweep: &Sweep) -> Vec<Figure> {
    let Ok(variance) = &sweep.variance else { return Vec::new() };
    let names: Vec<String> = variance.inputs.iter().map(|(parameter, ..)| parameter.name.clone()).collect();
    let mut cells = Vec::new();
    for (view, name) in views(sweep) {
        for output in variance.outputs.iter().filter(|output| output.view == view) {
            if let Some(indices) = &output.indices {
                cells.push(panel(&name, &names, output, indices));
            }
        }
    }
    if cells.is_empty() {
        return Vec::new();
    }
    vec![Figure {
        name: "sobol".to_owned(),
        title: "Shares of the variance over the ranges of the free parameters".to_owned(),
        caption: format!(
            "Sobol indices with their standard errors. First order: the share that a parameter causes alone; total: alone \
             and together with others. {}",
            views_note(sweep)
        ),
        width: PAGE_WIDTH,
        columns: 2.min(cells.len()),
        cells,
    }]
}

fn panel(view: &str, names: &[String], output: &VarianceOf, indices: &[Indices]) -> Cell {
    let series = |name: &str, shift: f64, pick: fn(&Indices) -> Estimate, look: Look| {
        let points = indices.iter().enumerate().map(|(place, indices)| {
            let Estimate { value, standard_error } = pick(indices);
            (length(place) + 0.5 + shift, value, Some(standard_error))
        });
        Series::with_errors(name, points, look)
    };
    let first_order = series(
        "first order",
        -APART,
        |indices| indices.first_order,
        Look::Marks { colour: BLUE, mark: Mark::Disc, open: false },
    );
    let total = series(
        "total",
        APART,
        |indices| indices.total,
        Look::Marks { colour: VERMILION, mark: Mark::Square, open: true },
    );
    let ends = |s: &Series| {
        s.points.iter().flat_map(|p| [-1.0, 1.0].map(|sign| p.y + sign * p.error.unwrap_or(0.0))).collect()
    };
    let reach: Vec<f64> = [&first_order, &total].into_iter().flat_map(|s| -> Vec<f64> { ends(s) }).collect();
    let (low, high) = extent(reach.into_iter().chain([0.0, 1.0]));
    let what = match output.what {
        Varying::Readings => "readings",
        Varying::Difference => "ΔE₀₀ to the job's own values",
    };
    let chart = Chart {
        x: Axis::bands("free parameter", names.to_vec()),
        y: Axis::linear("share of the variance", (low - 0.05, high + 0.05)),
        height: 180.0,
        layers: vec![Layer::Level(0.0), Layer::Level(1.0), Layer::Series(first_order), Layer::Series(total)],
    };
    Cell { title: format!("{what}, {view}"), charts: vec![chart] }
}
