//! What a figure shows, before anybody says where on the page: cells in columns, in each cell charts above one another.
//!
//! A plot builds a [`Figure`] and nothing else. Its picture ([`super::layout`]) and its table of numbers
//! ([`super::curves`]) are both made from it, so that a drawn curve cannot be missing from the tables.

use super::disc::Disc;
use super::palette::{Colour, Scale};

/// Width in page pixels of a figure that fills the page.
pub(crate) const PAGE_WIDTH: u32 = 920;

/// One picture: a file of the report.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Figure {
    /// File name without extension.
    pub(crate) name: String,
    pub(crate) title: String,
    /// What a reader must know to read it: complete sentences, shown below.
    pub(crate) caption: String,
    pub(crate) width: u32,
    pub(crate) columns: usize,
    pub(crate) cells: Vec<Cell>,
}

/// Charts above one another, sharing the width.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Cell {
    pub(crate) title: String,
    pub(crate) charts: Vec<Chart>,
}

/// Two axes and what is drawn between them, later layers over earlier ones.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Chart {
    pub(crate) x: Axis,
    pub(crate) y: Axis,
    /// Height of the area between the axes, page pixels.
    pub(crate) height: f64,
    pub(crate) layers: Vec<Layer>,
}

/// An axis. `low` stands left or below, and may be the larger number.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Axis {
    /// Name and unit: `wavelength (nm)`.
    pub(crate) label: String,
    pub(crate) low: f64,
    pub(crate) high: f64,
    pub(crate) kind: AxisKind,
}

/// How an axis is divided.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum AxisKind {
    Linear,
    /// Linear, with ticks at whole numbers only.
    Counts,
    Logarithmic,
    /// One band each, the first from 0 to 1. Where bands are narrow, some go without their label.
    Bands(Vec<String>),
}

/// Something drawn between the axes.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Layer {
    Series(Series),
    Map(Map),
    ColourCells(ColourCells),
    /// A chart around a point; it stands alone, and its chart's axes are not drawn.
    Disc(Disc),
    /// A thin line across the chart at this y.
    Level(f64),
    /// A short text above a point; left out where it would cover another.
    Note {
        x: f64,
        y: f64,
        text: String,
    },
}

/// Points with one look.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Series {
    /// Name in the legend and the table.
    pub(crate) name: String,
    pub(crate) points: Vec<Point>,
    pub(crate) look: Look,
}

/// One point; `error` is drawn as a bar of ± that length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Point {
    pub(crate) x: f64,
    pub(crate) y: f64,
    pub(crate) error: Option<f64>,
}

/// How a series is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Look {
    Line { colour: Colour, width: f64, dashed: bool },
    Marks { colour: Colour, mark: Mark, open: bool },
    Both { colour: Colour, mark: Mark, dashed: bool },
}

/// Shape of a marker.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Mark {
    Disc,
    Square,
    Diamond,
}

/// Values by column and row, as colours.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Map {
    /// Borders of the columns on the x axis, one more than there are columns.
    pub(crate) borders: Vec<f64>,
    /// One row a band of the y axis; a missing value is hatched.
    pub(crate) rows: Vec<Vec<Option<f64>>>,
    pub(crate) scale: Scale,
    /// What the colours mean, with unit, beside the colour bar.
    pub(crate) label: String,
    /// Which values have no colour of their own, below the label; empty where all have.
    pub(crate) clipped: String,
    /// Whether each value is written in its cell.
    pub(crate) with_numbers: bool,
}

/// Colours by column and row, as they are.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ColourCells {
    /// Borders of the columns on the x axis, one more than there are columns.
    pub(crate) borders: Vec<f64>,
    /// One row a band of the y axis.
    pub(crate) rows: Vec<Vec<Colour>>,
    /// What a table calls the colours.
    pub(crate) label: String,
}

impl Chart {
    /// A chart around a point, without axes.
    pub(crate) fn disc(height: f64, disc: Disc) -> Self {
        let none = || Axis::bands("", Vec::new());
        Self { x: none(), y: none(), height, layers: vec![Layer::Disc(disc)] }
    }

    /// What is drawn around a point, where the chart is of that kind.
    pub(crate) fn as_disc(&self) -> Option<&Disc> {
        self.layers.iter().find_map(|layer| if let Layer::Disc(disc) = layer { Some(disc) } else { None })
    }
}

impl Axis {
    pub(crate) fn linear(label: impl Into<String>, (low, high): (f64, f64)) -> Self {
        Self { label: label.into(), low, high, kind: AxisKind::Linear }
    }

    /// For numbers of things: whole ticks only.
    pub(crate) fn counts(label: impl Into<String>, (low, high): (f64, f64)) -> Self {
        Self { label: label.into(), low, high, kind: AxisKind::Counts }
    }

    pub(crate) fn logarithmic(label: impl Into<String>, (low, high): (f64, f64)) -> Self {
        Self { label: label.into(), low, high, kind: AxisKind::Logarithmic }
    }

    /// Bands from the first at the bottom or left.
    pub(crate) fn bands(label: impl Into<String>, names: Vec<String>) -> Self {
        Self { label: label.into(), low: 0.0, high: length(names.len()), kind: AxisKind::Bands(names) }
    }

    /// With the first band at the top, or the largest number left.
    pub(crate) fn reversed(self) -> Self {
        Self { low: self.high, high: self.low, ..self }
    }

    /// Where a value lies: 0 at `low`, 1 at `high`. Nothing where it has no place, as 0 on a logarithmic axis.
    pub(crate) fn share(&self, value: f64) -> Option<f64> {
        let share = match self.kind {
            AxisKind::Logarithmic => (value / self.low).ln() / (self.high / self.low).ln(),
            AxisKind::Linear | AxisKind::Counts | AxisKind::Bands(_) => (value - self.low) / (self.high - self.low),
        };
        share.is_finite().then_some(share)
    }
}

impl Series {
    /// A curve through (x, y); pairs that are not finite numbers are left out.
    pub(crate) fn new(name: impl Into<String>, points: impl IntoIterator<Item = (f64, f64)>, look: Look) -> Self {
        Self::with_errors(name, points.into_iter().map(|(x, y)| (x, y, None)), look)
    }

    /// The same with error bars.
    pub(crate) fn with_errors(
        name: impl Into<String>,
        points: impl IntoIterator<Item = (f64, f64, Option<f64>)>,
        look: Look,
    ) -> Self {
        let points = points
            .into_iter()
            .filter(|(x, y, _)| x.is_finite() && y.is_finite())
            .map(|(x, y, error)| Point { x, y, error: error.filter(|e| e.is_finite()) })
            .collect();
        Self { name: name.into(), points, look }
    }
}

/// Smallest and largest of the finite values; (0, 1) where there is none.
pub(crate) fn extent(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
    let (low, high) = values
        .into_iter()
        .filter(|v| v.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    if low <= high { (low, high) } else { (0.0, 1.0) }
}

/// A range with room at both ends, so that nothing sits on the frame; never empty.
pub(crate) fn with_room((low, high): (f64, f64)) -> (f64, f64) {
    let room = if high > low { 0.06 * (high - low) } else { (0.05 * low.abs()).max(1e-3) };
    (low - room, high + room)
}

/// A range from 0 where all values are positive, with room above.
pub(crate) fn from_zero((low, high): (f64, f64)) -> (f64, f64) {
    if low >= 0.0 && high > 0.0 { (0.0, 1.08 * high) } else { with_room((low, high)) }
}

/// The same range for a logarithmic axis: room as a factor.
pub(crate) fn with_room_logarithmic((low, high): (f64, f64)) -> (f64, f64) {
    let factor = if high > low { (high / low).powf(0.06) } else { 2.0 };
    (low / factor, high * factor)
}

/// −limit to limit, where limit is the size of the largest value and some room.
pub(crate) fn around_zero(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
    let limit = values.into_iter().filter(|v| v.is_finite()).fold(0.0f64, |limit, v| limit.max(v.abs()));
    let limit = if limit > 0.0 { 1.1 * limit } else { 1.0 };
    (-limit, limit)
}

/// A count as a coordinate.
pub(crate) fn length(count: usize) -> f64 {
    f64::from(u32::try_from(count).unwrap_or(u32::MAX))
}
