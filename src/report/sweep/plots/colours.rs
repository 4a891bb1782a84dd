//! Swatches over the grid: one strip a geometry, or one field a geometry where two parameters are swept.

use plotters::style::RGBColor;

use crate::job::Sweep;
use crate::report::chart::{Axis, Cell, Chart, ColourCells, Figure, Layer, PAGE_WIDTH, length};
use crate::report::palette::Colour;
use crate::report::sweep::swept::{
    axis_label, borders, cell, columns, inner, outer, setting, views, views_note, x_axis,
};

pub(super) fn draw(sweep: &Sweep) -> Vec<Figure> {
    if sweep.own.colours.is_empty() {
        return Vec::new();
    }
    let x = inner(sweep);
    let columns = columns(x);
    let borders = borders(x, &columns);
    let colour = |outer: usize, column: usize, view: usize| {
        screen_colour(&sweep.cells[cell(sweep, outer, column)].colours[view].hex)
    };
    let chart = |names: Vec<String>, label: &str, height: f64, rows: Vec<Vec<Colour>>| Chart {
        x: x_axis(x, &borders),
        y: Axis::bands(label, names).reversed(),
        height,
        layers: vec![Layer::ColourCells(ColourCells { borders: borders.clone(), rows, label: "sRGB".to_owned() })],
    };
    let shown = views(sweep);
    let cells: Vec<Cell> = match outer(sweep) {
        None => {
            let rows = shown.iter().map(|(view, _)| columns.iter().map(|c| colour(0, *c, *view)).collect());
            let names = shown.iter().map(|(_, name)| name.clone()).collect();
            let height = 40.0 * length(shown.len());
            vec![Cell { title: String::new(), charts: vec![chart(names, "geometry", height, rows.collect())] }]
        }
        Some(y) => {
            let outer_rows = super::super::swept::columns(y);
            let names: Vec<String> = outer_rows.iter().map(|row| setting(y, y.values[*row])).collect();
            let height = (22.0 * length(names.len())).clamp(80.0, 320.0);
            let of_view = |(view, name): &(usize, String)| {
                let rows = outer_rows.iter().map(|o| columns.iter().map(|c| colour(*o, *c, *view)).collect());
                let charts = vec![chart(names.clone(), &axis_label(&y.parameter), height, rows.collect())];
                Cell { title: name.clone(), charts }
            };
            shown.iter().map(of_view).collect()
        }
    };
    let clipped = sweep.cells.iter().flat_map(|cell| &cell.colours).filter(|colour| colour.clipped).count();
    let all = sweep.cells.len() * sweep.views.len();
    let hidden = match clipped {
        0 => "A screen can show all of them.".to_owned(),
        some => format!("Of {all} colours a screen cannot show {some}; the nearest in each channel is shown."),
    };
    vec![Figure {
        name: "colours".to_owned(),
        title: "Colours over the sweep".to_owned(),
        caption: format!("{} {hidden} {}", sweep.colour_note, views_note(sweep)),
        width: PAGE_WIDTH,
        columns: if outer(sweep).is_some() { 2.min(cells.len()) } else { 1 },
        cells,
    }]
}

/// The colour that `#1a2b3c` writes.
fn screen_colour(hex: &str) -> Colour {
    let code = u32::from_str_radix(hex.trim_start_matches('#'), 16).unwrap_or(0);
    let [_, red, green, blue] = code.to_be_bytes();
    RGBColor(red, green, blue)
}
