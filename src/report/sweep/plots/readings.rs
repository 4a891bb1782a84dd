//! Readings over the swept parameter: as a map over wavelength, or as a line for each of a few channels.

use crate::job::Sweep;
use crate::number::plain;
use crate::report::angles::evenly;
use crate::report::chart::{Axis, Cell, Chart, Figure, Layer, Map, PAGE_WIDTH, Series, extent, from_zero};
use crate::report::palette::Scale;
use crate::report::readings::{quantity_label, quantity_note};
use crate::report::sweep::swept::{
    MOST_LINES, borders, cell, columns, inner, line, outer, points, setting, views, views_note, x_axis,
};

/// Most panels.
const MOST_PANELS: usize = 8;
/// Most rows of a map; more cannot be told apart at its height.
const MOST_ROWS: usize = 120;

/// One panel: a geometry and a row of the outer axis.
struct Panel {
    view: usize,
    row: usize,
    title: String,
}

pub(super) fn draw(sweep: &Sweep) -> Vec<Figure> {
    let panels = panels(sweep);
    let label = quantity_label(sweep.quantity);
    let x = inner(sweep);
    let columns = columns(x);
    let reading = |panel: &Panel, column: usize, channel: usize| {
        sweep.cells[cell(sweep, panel.row, column)].readings[panel.view][channel]
    };
    let is_few = panels.iter().all(|panel| sweep.views[panel.view].wavelengths_nm.len() <= MOST_LINES);
    let of_panel = |panel: &Panel| {
        let all = columns.iter().flat_map(|column| &sweep.cells[cell(sweep, panel.row, *column)].readings[panel.view]);
        let range = extent(all.copied());
        let wavelengths_nm = &sweep.views[panel.view].wavelengths_nm;
        let chart = if is_few {
            let points = points(x);
            let values: Vec<f64> = points.iter().map(|column| x.values[*column]).collect();
            let lines = wavelengths_nm.iter().enumerate().map(|(channel, nm)| {
                let points = points.iter().map(|column| (x.values[*column], reading(panel, *column, channel)));
                Layer::Series(Series::new(format!("{nm} nm"), points, line(channel)))
            });
            Chart {
                x: x_axis(x, &values),
                y: Axis::linear(label, from_zero(range)),
                height: 180.0,
                layers: lines.collect(),
            }
        } else {
            let rows = evenly(wavelengths_nm.len(), MOST_ROWS);
            let borders = borders(x, &columns);
            let row = |channel: &usize| columns.iter().map(|c| Some(reading(panel, *c, *channel))).collect();
            let map = Map {
                borders: borders.clone(),
                rows: rows.iter().map(row).collect(),
                scale: Scale::Sequential { low: range.0.min(0.0), high: if range.1 > 0.0 { range.1 } else { 1.0 } },
                label: label.to_owned(),
                clipped: String::new(),
                with_numbers: false,
            };
            let names = rows.iter().map(|row| plain(wavelengths_nm[*row])).collect();
            Chart {
                x: x_axis(x, &borders),
                y: Axis::bands("wavelength (nm)", names),
                height: 220.0,
                layers: vec![Layer::Map(map)],
            }
        };
        Cell { title: panel.title.clone(), charts: vec![chart] }
    };
    let cells: Vec<Cell> = panels.iter().map(of_panel).collect();
    vec![Figure {
        name: "readings".to_owned(),
        title: "Readings over the sweep".to_owned(),
        caption: format!("Each panel has its own scale. {} {}", quantity_note(sweep.quantity), views_note(sweep)),
        width: PAGE_WIDTH,
        columns: 2.min(cells.len()),
        cells,
    }]
}

fn panels(sweep: &Sweep) -> Vec<Panel> {
    let shown = views(sweep);
    let room = (MOST_PANELS / shown.len()).max(1);
    let rows: Vec<(usize, String)> = match outer(sweep) {
        None => vec![(0, String::new())],
        Some(y) => {
            let order = columns(y);
            let chosen = evenly(order.len(), room).into_iter().map(|place| order[place]);
            chosen.map(|row| (row, format!(", {}", setting(y, y.values[row])))).collect()
        }
    };
    let both = rows.iter().flat_map(|row| shown.iter().map(move |view| (row, view)));
    both.map(|((row, text), (view, name))| Panel { view: *view, row: *row, title: format!("{name}{text}") }).collect()
}
