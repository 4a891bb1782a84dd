//! How far each cell's colour lies from the first one's, and how fast it changes along the sweep.

use crate::job::Sweep;
use crate::report::chart::{Axis, Cell, Chart, Figure, Layer, Map, PAGE_WIDTH, Series, extent, from_zero, length};
use crate::report::palette::Scale;
use crate::report::sweep::swept::{
    axis_label, borders, cell, columns, inner, line, outer, points, setting, views, views_note, x_axis,
};

pub(super) fn draw(sweep: &Sweep) -> Vec<Figure> {
    if sweep.own.colours.is_empty() || sweep.cells.len() < 2 {
        return Vec::new();
    }
    let x = inner(sweep);
    let columns = columns(x);
    let first = &sweep.cells[0];
    let difference =
        |index: usize, view: usize| sweep.cells[index].colours[view].lab.delta_e_2000(first.colours[view].lab);
    let shown = views(sweep);
    let (cells, width_in_cells, along) = match outer(sweep) {
        None => {
            let points = points(x);
            let values: Vec<f64> = points.iter().map(|column| x.values[*column]).collect();
            let lines = |number: &dyn Fn(usize, usize) -> f64| -> Vec<Series> {
                shown
                    .iter()
                    .enumerate()
                    .map(|(place, (view, name))| {
                        Series::new(name, points.iter().map(|c| (x.values[*c], number(*c, *view))), line(place))
                    })
                    .collect()
            };
            let chart = |label: String, height: f64, lines: Vec<Series>| {
                let range = from_zero(extent(lines.iter().flat_map(|s| s.points.iter().map(|p| p.y))));
                Chart {
                    x: x_axis(x, &values),
                    y: Axis::linear(label, range),
                    height,
                    layers: lines.into_iter().map(Layer::Series).collect(),
                }
            };
            let unit = if x.parameter.unit.is_empty() { "unit" } else { x.parameter.unit };
            let to_first = chart("ΔE₀₀ to the first".to_owned(), 200.0, lines(&difference));
            let rate = |column: usize, view: usize| sweep.slopes_along[column].differences[view].per_unit;
            let per_unit = chart(format!("ΔE₀₀ per {unit}"), 140.0, lines(&rate));
            (vec![Cell { title: String::new(), charts: vec![to_first, per_unit] }], 1, true)
        }
        Some(y) => {
            let borders = borders(x, &columns);
            let rows = super::super::swept::columns(y);
            let names: Vec<String> = rows.iter().map(|row| setting(y, y.values[*row])).collect();
            let height = (22.0 * length(names.len())).clamp(80.0, 320.0);
            let all = shown
                .iter()
                .flat_map(|(view, _)| rows.iter().flat_map(|r| columns.iter().map(|c| (cell(sweep, *r, *c), *view))));
            let (_, high) = extent(all.map(|(cell, view)| difference(cell, view)));
            let of_view = |(view, name): &(usize, String)| {
                let row = |r: &usize| columns.iter().map(|c| Some(difference(cell(sweep, *r, *c), *view))).collect();
                let map = Map {
                    borders: borders.clone(),
                    rows: rows.iter().map(row).collect(),
                    scale: Scale::Sequential { low: 0.0, high: if high > 0.0 { high } else { 1.0 } },
                    label: "ΔE₀₀ to the first".to_owned(),
                    clipped: String::new(),
                    with_numbers: false,
                };
                let chart = Chart {
                    x: x_axis(x, &borders),
                    y: Axis::bands(axis_label(&y.parameter), names.clone()).reversed(),
                    height,
                    layers: vec![Layer::Map(map)],
                };
                Cell { title: name.clone(), charts: vec![chart] }
            };
            let cells: Vec<Cell> = shown.iter().map(of_view).collect();
            let width = 2.min(cells.len());
            (cells, width, false)
        }
    };
    let first: Vec<String> = sweep.axes.iter().zip(&first.values).map(|(axis, value)| setting(axis, *value)).collect();
    let rates = if along {
        " Below: how fast the colour changes at each value, the slope of the colour by the parameter."
    } else {
        ""
    };
    vec![Figure {
        name: "differences".to_owned(),
        title: "Colour differences over the sweep".to_owned(),
        caption: format!(
            "CIEDE2000 difference to the first colour of the same geometry, at {}; about 1 can just be told apart side by \
             side. Steps are its own, where two hues lie opposite each other.{rates} {}",
            first.join(", "),
            views_note(sweep)
        ),
        width: PAGE_WIDTH,
        columns: width_in_cells,
        cells,
    }]
}
