//! Rectangles in a picture, and tables of them.

use std::fmt;
use std::fs;
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// A rectangle in a picture, in whole pixels; x and y are of its upper left corner and count from the picture's.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Rectangle {
    /// Pixels left of it.
    pub x_px: usize,
    /// Rows above it.
    pub y_px: usize,
    /// Pixels a row.
    pub width_px: usize,
    /// Rows.
    pub height_px: usize,
}

impl Rectangle {
    /// Whether it holds a pixel and lies in a picture of this size.
    pub fn lies_in(&self, width: usize, height: usize) -> bool {
        let ends_within = |start: usize, length: usize, end: usize| {
            length > 0 && start.checked_add(length).is_some_and(|reached| reached <= end)
        };
        ends_within(self.x_px, self.width_px, width) && ends_within(self.y_px, self.height_px, height)
    }

    /// Places of its pixels in a picture of this width, in rows from the top.
    pub(crate) fn places(self, width: usize) -> impl Iterator<Item = usize> {
        (self.y_px..self.y_px + self.height_px)
            .flat_map(move |y| (self.x_px..self.x_px + self.width_px).map(move |x| y * width + x))
    }
}

impl fmt::Display for Rectangle {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "x {} y {}, {} × {} pixels", self.x_px, self.y_px, self.width_px, self.height_px)
    }
}

/// A named rectangle.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Region {
    /// The photograph that it belongs to; none where the table has no such column, or an empty cell.
    pub file: Option<String>,
    /// What is seen there.
    pub name: String,
    /// Where.
    pub rectangle: Rectangle,
}

/// A table of regions that cannot be read.
#[derive(Debug, Error)]
#[error("{}: {reason}", file.display())]
pub struct RegionError {
    /// The table.
    pub file: PathBuf,
    /// What was found, what was expected, how to mend it.
    pub reason: String,
}

/// A table of regions.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Regions(pub Vec<Region>);

/// The columns that a table of regions must have, beside one for names.
const COLUMNS: [&str; 4] = ["x_px", "y_px", "width_px", "height_px"];
/// Columns of names; the first that is there counts.
const NAMES: [&str; 3] = ["patch", "region", "feather"];

impl Regions {
    /// Reads a table: CSV with the columns `x_px`, `y_px`, `width_px`, `height_px`, one of `patch`, `region` or `feather` for
    /// names, and, if there are several pictures, `file`.
    ///
    /// # Errors
    ///
    /// A sentence that names line and column.
    pub fn read(path: &Path) -> Result<Self, RegionError> {
        let refused = |reason: String| RegionError { file: path.to_owned(), reason };
        let text = fs::read_to_string(path).map_err(|error| {
            refused(format!("{}; correct the path", error.to_string().split(" (os error").next().unwrap_or_default()))
        })?;
        let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(text.as_bytes());
        let header = reader.headers().map_err(|error| refused(error.to_string()))?.clone();
        let column = |name: &str| header.iter().position(|cell| cell == name);
        let expected = || format!("expected the columns {} and one of {}", COLUMNS.join(", "), NAMES.join(", "));
        let missing = |name: &str| {
            let found = header.iter().collect::<Vec<_>>().join(", ");
            refused(format!("line 1: found the columns {found} without {name}; {}", expected()))
        };
        let mut numbers = [0; 4];
        for (place, name) in numbers.iter_mut().zip(COLUMNS) {
            *place = column(name).ok_or_else(|| missing(name))?;
        }
        let name = NAMES.iter().find_map(|name| column(name)).ok_or_else(|| missing("one of names"))?;
        let file = column("file");
        let mut regions = Vec::new();
        for record in reader.records() {
            let record = record.map_err(|error| refused(error.to_string()))?;
            let line = record.position().map_or(0, csv::Position::line);
            let mut values = [0; 4];
            for ((value, column), label) in values.iter_mut().zip(numbers).zip(COLUMNS) {
                let cell = record.get(column).unwrap_or_default();
                *value = cell.parse().map_err(|_| {
                    refused(format!("line {line}, column {label}: found `{cell}`, expected a whole number of pixels"))
                })?;
            }
            let [x_px, y_px, width_px, height_px] = values;
            let cell = |column: usize| record.get(column).unwrap_or_default().to_owned();
            regions.push(Region {
                file: file.map(cell).filter(|name| !name.is_empty()),
                name: cell(name),
                rectangle: Rectangle { x_px, y_px, width_px, height_px },
            });
        }
        if regions.is_empty() {
            return Err(refused("there is no row in it; give each region a row".into()));
        }
        Ok(Self(regions))
    }

    /// The regions of a photograph: those that name its file, and those that name none. Empty where all name others.
    pub fn of(&self, photograph: &Path) -> Vec<Region> {
        let name = photograph.file_name().map(|name| name.to_string_lossy().into_owned());
        let belongs = |region: &&Region| region.file.is_none() || region.file == name;
        self.0.iter().filter(belongs).cloned().collect()
    }
}
