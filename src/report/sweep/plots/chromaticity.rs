//! The colour's way through the CIE 1931 chromaticity diagram.

use crate::job::Sweep;
use crate::measure::colour::{LinearRgb, Xyz, spectral_locus};
use crate::report::chart::{Axis, Cell, Chart, Figure, Layer, Look, Mark, PAGE_WIDTH, Point, Series, extent};
use crate::report::palette::{BLACK, GREY, INK};
use crate::report::sweep::swept::{cell, columns, inner, line, marked_line, outer, points, setting, views, views_note};

/// Width of a frame where two stand beside each other on the page, page pixels: what makes both axes equally long.
const FRAME_WIDTH: f64 = 400.0;
/// Wavelengths that are named on the spectral locus, nm.
const NAMED_NM: [f64; 9] = [460.0, 480.0, 490.0, 500.0, 520.0, 540.0, 560.0, 580.0, 620.0];
/// How far a wavelength stands from the locus, and how far a note's text above its point, in units of the whole diagram.
const NOTE_DISTANCE: f64 = 0.045;
const NOTE_RISE: f64 = 0.027;
/// Most paths that an eye follows beside each other, where two parameters are swept.
const MOST_PATHS: usize = 4;
/// The least extent of the enlarged part.
const LEAST_EXTENT: f64 = 0.02;
/// Up to this many points each has its mark.
const FEW_POINTS: usize = 25;

pub(super) fn draw(sweep: &Sweep) -> Vec<Figure> {
    let paths = paths(sweep);
    if paths.iter().all(|series| series.points.is_empty()) {
        return Vec::new();
    }
    let white = Xyz::white().chromaticity();
    let white = Series::new(
        "white (D65)",
        white.map(|[x, y]| (x, y)),
        Look::Marks { colour: BLACK, mark: Mark::Diamond, open: true },
    );
    let chart = |x: (f64, f64), y: (f64, f64)| {
        let mut layers = surroundings();
        layers.extend(paths.iter().cloned().map(Layer::Series));
        layers.push(Layer::Series(white.clone()));
        layers.extend(ends(sweep, &paths).into_iter().map(Layer::Series));
        Chart {
            x: Axis::linear("x (CIE 1931)", x),
            y: Axis::linear("y (CIE 1931)", y),
            height: FRAME_WIDTH * (y.1 - y.0) / (x.1 - x.0),
            layers,
        }
    };
    let all = || paths.iter().chain([&white]).flat_map(|series| &series.points);
    let (left, right) = extent(all().map(|point| point.x));
    let (low, high) = extent(all().map(|point| point.y));
    let half = 0.58 * (right - left).max(high - low).max(LEAST_EXTENT);
    let around = |low: f64, high: f64| ((low + high) / 2.0 - half, (low + high) / 2.0 + half);
    vec![Figure {
        name: "chromaticity".to_owned(),
        title: "Chromaticity along the sweep".to_owned(),
        caption: format!(
            "CIE 1931 chromaticity diagram for the 2° observer: the spectral locus with wavelengths in nm, closed by the line \
             of purples, the colours that an sRGB screen can show (triangle), and the white point of D65. Right: enlarged. \
             Black has no place in it and is left out. {}",
            views_note(sweep)
        ),
        width: PAGE_WIDTH,
        columns: 2,
        cells: vec![
            Cell { title: "whole".to_owned(), charts: vec![chart((-0.1, 0.8), (-0.02, 0.94))] },
            Cell { title: "enlarged".to_owned(), charts: vec![chart(around(left, right), around(low, high))] },
        ],
    }]
}

/// One path a geometry, or a geometry and value of the outer axis; as many as can be told apart.
fn paths(sweep: &Sweep) -> Vec<Series> {
    if sweep.own.colours.is_empty() {
        return Vec::new();
    }
    let x = inner(sweep);
    let order = points(x);
    let shown = views(sweep);
    let families: Vec<(usize, String)> = match outer(sweep) {
        None => vec![(0, String::new())],
        Some(y) => {
            let room = (MOST_PATHS / shown.len()).max(1);
            let rows = columns(y);
            crate::report::angles::evenly(rows.len(), room)
                .into_iter()
                .map(|place| (rows[place], format!(", {}", setting(y, y.values[rows[place]]))))
                .collect()
        }
    };
    let both = shown.iter().flat_map(|view| families.iter().map(move |family| (view, family)));
    both.enumerate()
        .map(|(place, ((view, name), (row, family)))| {
            let points = order.iter().filter_map(|column| {
                let [x, y] = sweep.cells[cell(sweep, *row, *column)].colours[*view].xyz.chromaticity()?;
                Some((x, y))
            });
            let look = if order.len() <= FEW_POINTS { marked_line(place) } else { line(place) };
            Series::new(format!("{name}{family}"), points, look)
        })
        .collect()
}

/// Where every path begins and ends.
fn ends(sweep: &Sweep, paths: &[Series]) -> Vec<Series> {
    let x = inner(sweep);
    let order = points(x);
    let [first, .., last] = order.as_slice() else { return Vec::new() };
    let end = |column: usize, mark: Mark, open: bool, pick: fn(&Series) -> Option<&Point>| {
        let places = paths.iter().filter_map(pick).map(|point| (point.x, point.y));
        Series::new(setting(x, x.values[column]), places, Look::Marks { colour: BLACK, mark, open })
    };
    vec![
        end(*first, Mark::Disc, true, |path| path.points.first()),
        end(*last, Mark::Square, false, |path| path.points.last()),
    ]
}

/// The spectral locus with its wavelengths, and what a screen can show.
fn surroundings() -> Vec<Layer> {
    let locus: Vec<(f64, [f64; 2])> = spectral_locus().collect();
    let closed = locus.iter().chain(locus.first()).map(|(_, [x, y])| (*x, *y));
    let primaries = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]];
    let corners = primaries.into_iter().filter_map(|rgb| LinearRgb(rgb).to_xyz().chromaticity()).map(|[x, y]| (x, y));
    let mut layers = vec![
        Layer::Series(Series::new("spectral locus", closed, Look::Line { colour: INK, width: 1.2, dashed: false })),
        Layer::Series(Series::new("sRGB", corners, Look::Line { colour: GREY, width: 1.0, dashed: true })),
    ];
    layers.extend(locus.iter().filter(|(nm, _)| NAMED_NM.contains(nm)).map(|(nm, [x, y])| {
        // Outside of the locus, away from the white; a note stands above its point.
        let (dx, dy) = (x - 0.313, y - 0.329);
        let outwards = NOTE_DISTANCE / dx.hypot(dy);
        Layer::Note { x: x + outwards * dx, y: y + outwards * dy - NOTE_RISE, text: nm.to_string() }
    }));
    layers
}
