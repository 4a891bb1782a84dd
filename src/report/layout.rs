//! Where everything of a figure goes: a [`Figure`] becomes a list of shapes in page pixels.

use super::chart::{Axis, AxisKind, Cell, Chart, Figure, Layer, Look, Map, Mark, Point, Series, length};
use super::colour_cells;
use super::disc::{self, Disc};
use super::frame::{Frame, clipped, thinned};
use super::map::{colour_bar, lay_map};
use super::palette::{Colour, GREY, INK, PALE, WHITE};
use super::plot::{Align, Drawing, Shape, text_width};
use super::ticks::{Tick, linear, logarithmic, whole};

const TITLE_SIZE: f64 = 14.0;
const CELL_TITLE_SIZE: f64 = 12.0;
pub(super) const LABEL_SIZE: f64 = 12.0;
pub(super) const TICK_SIZE: f64 = 11.0;
const MARGIN: f64 = 4.0;
const TITLE_HEIGHT: f64 = 26.0;
const CELL_TITLE_HEIGHT: f64 = 20.0;
const LEGEND_ROW_HEIGHT: f64 = 20.0;
pub(super) const TICK_LENGTH: f64 = 4.0;
pub(super) const TICK_ROW_HEIGHT: f64 = 18.0;
pub(super) const LABEL_ROW_HEIGHT: f64 = 18.0;
const GAP: f64 = 10.0;
/// Right of a frame, for the half of the last tick's label that stands beyond it.
const RIGHT_ROOM: f64 = 14.0;
const MARK_RADIUS: f64 = 3.4;
const LEGEND_SAMPLE: f64 = 26.0;

/// Lays a figure out.
pub(crate) fn drawing(figure: &Figure) -> Drawing {
    let width = f64::from(figure.width);
    let mut shapes = Vec::new();
    let title = shortened(&figure.title, TITLE_SIZE, true, width - 2.0 * MARGIN);
    shapes.push(text(title, (MARGIN, MARGIN + 8.0), TITLE_SIZE, Align::Start).bold());
    let mut top = MARGIN + TITLE_HEIGHT;
    top = legend(figure, top, &mut shapes);

    let columns = figure.columns.max(1);
    // Left of each frame: the axis's name in the first column, ticks in all, unless all cells have the same rows.
    let tick_width = figure.cells.iter().map(widest_y_tick).fold(0.0, f64::max) + TICK_LENGTH + 4.0;
    let shares_rows = figure.cells.len() <= columns && have_same_bands(&figure.cells);
    let lead = |column: usize| match column {
        0 => LABEL_ROW_HEIGHT + tick_width,
        _ if shares_rows => 0.0,
        _ => tick_width,
    };
    let leads: f64 = (0..columns).map(lead).sum();
    let frame_width = (width - 2.0 * MARGIN - leads - GAP * length(columns - 1)) / length(columns);
    for (row, cells) in figure.cells.chunks(columns).enumerate() {
        let heights: Vec<f64> = cells
            .iter()
            .enumerate()
            .map(|(column, cell)| {
                let before: f64 = (0..column).map(|c| lead(c) + frame_width + GAP).sum();
                let place = CellPlace {
                    left: MARGIN + before,
                    top,
                    lead: lead(column),
                    frame_width,
                    ticks_y: column == 0 || !shares_rows,
                    names_y: column == 0,
                    names_x: (row + 1) * columns + column >= figure.cells.len(),
                };
                lay_cell(cell, place, &mut shapes)
            })
            .collect();
        top += heights.into_iter().fold(0.0, f64::max) + GAP;
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a page height, some thousand pixels")]
    let height = top.ceil() as u32;
    Drawing { width: figure.width, height, shapes }
}

/// Writes the legend from `top` down and returns where it ends. One entry a name; none where there is only one series.
fn legend(figure: &Figure, top: f64, shapes: &mut Vec<Shape>) -> f64 {
    let mut entries: Vec<&Series> = Vec::new();
    for series in figure.cells.iter().flat_map(|c| &c.charts).flat_map(|c| &c.layers).flat_map(series_of) {
        if !series.points.is_empty() && !entries.iter().any(|e| e.name == series.name) {
            entries.push(series);
        }
    }
    if entries.len() < 2 {
        return top;
    }
    let right = f64::from(figure.width) - MARGIN;
    let (mut x, mut y) = (MARGIN, top + 6.0);
    for series in entries {
        let name = shortened(&series.name, LABEL_SIZE, false, right - MARGIN - LEGEND_SAMPLE - 6.0);
        let width = LEGEND_SAMPLE + 6.0 + text_width(&name, LABEL_SIZE, false) + 18.0;
        if x > MARGIN && x + width > right {
            (x, y) = (MARGIN, y + LEGEND_ROW_HEIGHT);
        }
        sample(series.look, (x, y), shapes);
        shapes.push(text(name, (x + LEGEND_SAMPLE + 6.0, y), LABEL_SIZE, Align::Start).into());
        x += width;
    }
    y + LEGEND_ROW_HEIGHT
}

/// The curves of a layer.
pub(super) fn series_of(layer: &Layer) -> &[Series] {
    match layer {
        Layer::Series(series) => std::slice::from_ref(series),
        Layer::Disc(Disc::Lobes(chart)) => &chart.curves,
        _ => &[],
    }
}

fn sample(look: Look, (x, y): (f64, f64), shapes: &mut Vec<Shape>) {
    match look {
        Look::Line { colour, width, dashed } => {
            stroke(&[(x, y), (x + LEGEND_SAMPLE, y)], colour, width, dashed, shapes);
        }
        Look::Marks { colour, mark, open } => marker((x + LEGEND_SAMPLE / 2.0, y), mark, colour, open, shapes),
        Look::Both { colour, mark, dashed } => {
            stroke(&[(x, y), (x + LEGEND_SAMPLE, y)], colour, 1.4, dashed, shapes);
            marker((x + LEGEND_SAMPLE / 2.0, y), mark, colour, false, shapes);
        }
    }
}

/// Room that a cell gets.
#[derive(Debug, Clone, Copy)]
struct CellPlace {
    left: f64,
    top: f64,
    /// Room left of the frame, and the frame's own width, so that frames stand in line.
    lead: f64,
    frame_width: f64,
    /// Whether this cell writes the ticks of its y axis and the names of its axes; neighbours share them.
    ticks_y: bool,
    names_y: bool,
    names_x: bool,
}

/// Draws a cell and returns its height.
fn lay_cell(cell: &Cell, place: CellPlace, shapes: &mut Vec<Shape>) -> f64 {
    let left = place.left + place.lead;
    let right = left + place.frame_width - RIGHT_ROOM;
    let mut top = place.top;
    if !cell.title.is_empty() {
        let title = shortened(&cell.title, CELL_TITLE_SIZE, true, right - left);
        shapes.push(text(title, (left, top + 8.0), CELL_TITLE_SIZE, Align::Start).bold());
        top += CELL_TITLE_HEIGHT;
    }
    for (index, chart) in cell.charts.iter().enumerate() {
        let is_last = index + 1 == cell.charts.len();
        let frame = Frame { left, top, right, bottom: top + chart.height };
        lay_chart(chart, frame, shapes);
        if place.ticks_y {
            y_ticks(&chart.y, frame, shapes);
        }
        if place.names_y {
            let at = (place.left + 7.0, (frame.top + frame.bottom) / 2.0);
            let label = shortened(&chart.y.label, LABEL_SIZE, false, frame.height() + GAP);
            shapes.push(text(label, at, LABEL_SIZE, Align::Middle).upwards());
        }
        top = frame.bottom;
        if let Some(disc) = chart.as_disc() {
            top += 2.0;
            if let Disc::Dome(dome) = disc {
                top = disc::colour_bar(dome, frame, top, shapes);
            }
        } else if is_last {
            x_ticks(&chart.x, frame, shapes);
            top += TICK_LENGTH + TICK_ROW_HEIGHT;
            if place.names_x {
                let label = shortened(&chart.x.label, LABEL_SIZE, false, frame.width() + 2.0 * GAP);
                let middle = (frame.left + frame.right) / 2.0;
                shapes.push(text(label, (middle, top + 5.0), LABEL_SIZE, Align::Middle).into());
                top += LABEL_ROW_HEIGHT;
            }
            if let Some(map) = first_map(chart) {
                top = colour_bar(map, frame, top + 6.0, shapes);
            }
        } else {
            top += GAP;
        }
    }
    top - place.top + 4.0
}

fn lay_chart(chart: &Chart, frame: Frame, shapes: &mut Vec<Shape>) {
    if let Some(disc) = chart.as_disc() {
        return disc::lay(disc, frame, shapes);
    }
    let has_map = first_map(chart).is_some();
    if !has_map {
        for tick in ticks(&chart.y, frame.height() / 30.0) {
            if let Some(y) = place_y(&chart.y, tick.at, frame) {
                shapes.push(line(&[(frame.left, y), (frame.right, y)], PALE, 0.7));
            }
        }
    }
    // Boxes that a note must not cover: middle, half width, half height.
    let mut taken = marker_boxes(chart, frame);
    for layer in &chart.layers {
        match layer {
            Layer::Series(series) => lay_series(series, chart, frame, shapes),
            Layer::Map(map) => lay_map(map, chart, frame, shapes),
            Layer::ColourCells(cells) => colour_cells::lay(cells, chart, frame, shapes),
            // Stands alone, see above.
            Layer::Disc(_) => {}
            Layer::Level(at) => {
                if let Some(y) = place_y(&chart.y, *at, frame) {
                    shapes.push(line(&[(frame.left, y), (frame.right, y)], GREY, 1.0));
                }
            }
            Layer::Note { x, y, text: note } => {
                let (Some(x), Some(y)) = (place_x(&chart.x, *x, frame), place_y(&chart.y, *y, frame)) else { continue };
                let half = text_width(note, TICK_SIZE, false) / 2.0;
                let x = x.clamp(frame.left + half + 3.0, frame.right - half);
                let is_free = |y: &f64| {
                    (frame.top + 5.0..frame.bottom - 5.0).contains(y)
                        && !taken.iter().any(|((tx, ty), w, h)| (x - tx).abs() < half + w && (y - ty).abs() < 6.0 + h)
                };
                if let Some(y) = [y - 12.0, y + 12.0].into_iter().find(is_free) {
                    taken.push(((x, y), half + 3.0, 6.0));
                    shapes.push(text(note.clone(), (x, y), TICK_SIZE, Align::Middle).into());
                }
            }
        }
    }
    let corners = [(frame.left, frame.top), (frame.left, frame.bottom), (frame.right, frame.bottom)];
    shapes.push(line(&corners, INK, 1.0));
}

fn marker_boxes(chart: &Chart, frame: Frame) -> Vec<((f64, f64), f64, f64)> {
    let marked = chart.layers.iter().filter_map(|layer| match layer {
        Layer::Series(series) if !matches!(series.look, Look::Line { .. }) => Some(&series.points),
        _ => None,
    });
    marked
        .flatten()
        .filter_map(|p| Some(((x_of(&chart.x, p.x, frame)?, y_of(&chart.y, p.y, frame)?), MARK_RADIUS, MARK_RADIUS)))
        .collect()
}

fn lay_series(series: &Series, chart: &Chart, frame: Frame, shapes: &mut Vec<Shape>) {
    let at = |p: &Point| Some((x_of(&chart.x, p.x, frame)?, y_of(&chart.y, p.y, frame)?));
    let (line_look, mark_look) = match series.look {
        Look::Line { colour, width, dashed } => (Some((colour, width, dashed)), None),
        Look::Marks { colour, mark, open } => (None, Some((colour, mark, open))),
        Look::Both { colour, mark, dashed } => (Some((colour, 1.4, dashed)), Some((colour, mark, false))),
    };
    if let Some((colour, width, dashed)) = line_look {
        let points: Vec<_> = series.points.iter().filter_map(at).collect();
        for piece in clipped(&points, frame) {
            stroke(&thinned(&piece), colour, width, dashed, shapes);
        }
    }
    if let Some((colour, mark, open)) = mark_look {
        for point in &series.points {
            let Some((x, y)) = at(point) else { continue };
            if !(frame.left - 0.5..=frame.right + 0.5).contains(&x) {
                continue;
            }
            if let Some(error) = point.error {
                let ends = [point.y - error, point.y + error].map(|y| y_of(&chart.y, y, frame));
                if let [Some(low), Some(high)] = ends {
                    let (low, high) = (low.clamp(frame.top, frame.bottom), high.clamp(frame.top, frame.bottom));
                    shapes.push(line(&[(x, low), (x, high)], colour, 1.0));
                    for end in [low, high] {
                        shapes.push(line(&[(x - 2.5, end), (x + 2.5, end)], colour, 1.0));
                    }
                }
            }
            if (frame.top - 0.5..=frame.bottom + 0.5).contains(&y) {
                marker((x, y), mark, colour, open, shapes);
            }
        }
    }
}

pub(super) fn x_ticks(axis: &Axis, frame: Frame, shapes: &mut Vec<Shape>) {
    let mut free_from = f64::NEG_INFINITY;
    for tick in ticks(axis, frame.width() / 46.0) {
        let Some(x) = place_x(axis, tick.at, frame) else { continue };
        if !matches!(axis.kind, AxisKind::Bands(_)) {
            shapes.push(line(&[(x, frame.bottom), (x, frame.bottom + TICK_LENGTH)], INK, 1.0));
        }
        let half = text_width(&tick.label, TICK_SIZE, false) / 2.0;
        if x - half >= free_from {
            let at = (x, frame.bottom + TICK_LENGTH + 8.0);
            shapes.push(text(tick.label, at, TICK_SIZE, Align::Middle).into());
            free_from = x + half + 4.0;
        }
    }
}

fn y_ticks(axis: &Axis, frame: Frame, shapes: &mut Vec<Shape>) {
    let mut last: Option<f64> = None;
    for tick in ticks(axis, frame.height() / 30.0) {
        let Some(y) = place_y(axis, tick.at, frame) else { continue };
        if !matches!(axis.kind, AxisKind::Bands(_)) {
            shapes.push(line(&[(frame.left - TICK_LENGTH, y), (frame.left, y)], INK, 1.0));
        }
        if last.is_none_or(|l| (l - y).abs() >= 13.0) {
            let label = shortened(&tick.label, TICK_SIZE, false, WIDEST_TICK);
            shapes.push(text(label, (frame.left - TICK_LENGTH - 3.0, y), TICK_SIZE, Align::End).into());
            last = Some(y);
        }
    }
}

/// Whether all cells have the same named rows, so that naming them once is enough.
fn have_same_bands(cells: &[Cell]) -> bool {
    let bands = |cell: &Cell| match cell.charts.as_slice() {
        [Chart { y: Axis { kind: AxisKind::Bands(names), .. }, .. }] => Some(names.clone()),
        _ => None,
    };
    let mut all = cells.iter().map(bands);
    all.next().flatten().is_some_and(|first| all.all(|other| other.as_ref() == Some(&first)))
}

/// The widest label beside a y axis, page pixels; longer names are cut.
const WIDEST_TICK: f64 = 210.0;

fn widest_y_tick(cell: &Cell) -> f64 {
    cell.charts
        .iter()
        .flat_map(|chart| ticks(&chart.y, chart.height / 30.0))
        .map(|tick| text_width(&tick.label, TICK_SIZE, false).min(WIDEST_TICK))
        .fold(0.0, f64::max)
}

fn ticks(axis: &Axis, wanted: f64) -> Vec<Tick> {
    let (low, high) = (axis.low.min(axis.high), axis.low.max(axis.high));
    match &axis.kind {
        AxisKind::Linear => linear(low, high, wanted),
        AxisKind::Counts => whole(low, high, wanted),
        AxisKind::Logarithmic => logarithmic(low, high, wanted),
        AxisKind::Bands(names) => names
            .iter()
            .enumerate()
            .map(|(index, name)| Tick { at: length(index) + 0.5, label: name.clone() })
            .collect(),
    }
}

fn first_map(chart: &Chart) -> Option<&Map> {
    chart.layers.iter().find_map(|layer| if let Layer::Map(map) = layer { Some(map) } else { None })
}

pub(super) fn x_of(axis: &Axis, value: f64, frame: Frame) -> Option<f64> {
    Some(frame.left + axis.share(value)? * frame.width())
}

pub(super) fn y_of(axis: &Axis, value: f64, frame: Frame) -> Option<f64> {
    Some(frame.bottom - axis.share(value)? * frame.height())
}

/// Like [`x_of`], only for values inside the axis.
fn place_x(axis: &Axis, value: f64, frame: Frame) -> Option<f64> {
    x_of(axis, value, frame).filter(|x| (frame.left - 0.5..=frame.right + 0.5).contains(x))
}

fn place_y(axis: &Axis, value: f64, frame: Frame) -> Option<f64> {
    y_of(axis, value, frame).filter(|y| (frame.top - 0.5..=frame.bottom + 0.5).contains(y))
}

/// A line, or its dashes.
pub(super) fn stroke(points: &[(f64, f64)], colour: Colour, width: f64, dashed: bool, shapes: &mut Vec<Shape>) {
    const DASH: f64 = 5.0;
    const SPACE: f64 = 3.0;
    if !dashed {
        shapes.push(line(points, colour, width));
        return;
    }
    let (mut is_drawn, mut left) = (true, DASH);
    let mut dash: Vec<(f64, f64)> = points.first().copied().into_iter().collect();
    for pair in points.windows(2) {
        let (mut from, to) = (pair[0], pair[1]);
        loop {
            let distance = (to.0 - from.0).hypot(to.1 - from.1);
            if distance <= left {
                left -= distance;
                dash.push(to);
                break;
            }
            let share = left / distance;
            from = (from.0 + share * (to.0 - from.0), from.1 + share * (to.1 - from.1));
            dash.push(from);
            if is_drawn {
                shapes.push(line(&dash, colour, width));
            }
            dash = vec![from];
            (is_drawn, left) = (!is_drawn, if is_drawn { SPACE } else { DASH });
        }
    }
    if is_drawn && dash.len() > 1 {
        shapes.push(line(&dash, colour, width));
    }
}

pub(super) fn marker(centre: (f64, f64), mark: Mark, colour: Colour, open: bool, shapes: &mut Vec<Shape>) {
    let mut filled = |radius: f64, colour: Colour| {
        let corners: &[(f64, f64)] = match mark {
            Mark::Disc => {
                shapes.push(Shape::Disc { centre, radius, colour });
                return;
            }
            Mark::Square => &[(-0.9, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)],
            Mark::Diamond => &[(0.0, -1.3), (1.3, 0.0), (0.0, 1.3), (-1.3, 0.0)],
        };
        let points = corners.iter().map(|(x, y)| (centre.0 + radius * x, centre.1 + radius * y)).collect();
        shapes.push(Shape::Polygon { points, colour });
    };
    filled(MARK_RADIUS, colour);
    if open {
        filled(MARK_RADIUS - 1.4, WHITE);
    }
}

pub(super) fn line(points: &[(f64, f64)], colour: Colour, width: f64) -> Shape {
    Shape::Line { points: points.to_vec(), colour, width }
}

/// A text on its way to become a shape.
pub(super) struct Writing {
    text: String,
    at: (f64, f64),
    size: f64,
    align: Align,
}

pub(super) fn text(text: String, at: (f64, f64), size: f64, align: Align) -> Writing {
    Writing { text, at, size, align }
}

impl Writing {
    fn shape(self, colour: Colour, bold: bool, upwards: bool) -> Shape {
        Shape::Text { text: self.text, at: self.at, size: self.size, align: self.align, colour, bold, upwards }
    }

    fn bold(self) -> Shape {
        self.shape(INK, true, false)
    }

    fn upwards(self) -> Shape {
        self.shape(INK, false, true)
    }

    pub(super) fn coloured(self, colour: Colour) -> Shape {
        self.shape(colour, false, false)
    }
}

impl From<Writing> for Shape {
    fn from(writing: Writing) -> Self {
        writing.shape(INK, false, false)
    }
}

/// The text, cut with an ellipsis where it is wider than there is room.
pub(super) fn shortened(text: &str, size: f64, bold: bool, room: f64) -> String {
    if text_width(text, size, bold) <= room {
        return text.to_owned();
    }
    let mut kept: Vec<char> = text.chars().collect();
    while kept.pop().is_some() {
        let candidate: String = kept.iter().collect::<String>().trim_end().to_owned() + "…";
        if text_width(&candidate, size, bold) <= room {
            return candidate;
        }
    }
    String::new()
}
