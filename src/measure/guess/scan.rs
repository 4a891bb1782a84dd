//! What a table's cells look like, column by column.

use crate::measure::error::{Place, TableError, TableProblem};
use crate::measure::layout::{Delimiter, TextFormat};
use crate::measure::text::{self, TableText};

/// One column's cells in short.
#[derive(Debug, Clone)]
pub(super) struct Column {
    pub(super) name: String,
    /// Cells that are finite numbers.
    pub(super) numbers: u64,
    /// Smallest and largest of them.
    pub(super) smallest: f64,
    pub(super) largest: f64,
    /// Whether one of them is no whole number.
    pub(super) fractional: bool,
    /// Numbers below 0.
    pub(super) negative: u64,
    /// Cells that are the number 1.
    pub(super) ones: u64,
    /// Whether each number is above the one before, or below it.
    pub(super) rises: bool,
    pub(super) falls: bool,
    /// Smallest distance between numbers of neighbouring rows that differ.
    pub(super) step: Option<f64>,
    last: f64,
}

impl Column {
    fn new(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            numbers: 0,
            smallest: f64::INFINITY,
            largest: f64::NEG_INFINITY,
            fractional: false,
            negative: 0,
            ones: 0,
            rises: true,
            falls: true,
            step: None,
            last: f64::NAN,
        }
    }

    fn note(&mut self, number: f64) {
        self.numbers += 1;
        self.smallest = self.smallest.min(number);
        self.largest = self.largest.max(number);
        self.fractional |= number.fract().abs() > 0.0;
        self.negative += u64::from(number < 0.0);
        self.ones += u64::from((number - 1.0).abs() == 0.0);
        let step = number - self.last;
        if step.is_finite() {
            self.rises &= step > 0.0;
            self.falls &= step < 0.0;
            let size = step.abs();
            if size > 0.0 && self.step.is_none_or(|least| size < least) {
                self.step = Some(size);
            }
        }
        self.last = number;
    }
}

/// A table in short.
pub(super) struct Scan {
    pub(super) format: TextFormat,
    pub(super) columns: Vec<Column>,
    pub(super) rows: u64,
}

/// Reads the whole table once.
pub(super) fn scan(text: &TableText) -> Result<Scan, TableError> {
    let line = text.first_line();
    let delimiter = text::DELIMITERS.into_iter().rev().max_by_key(|delimiter| text::count(line, *delimiter));
    let delimiter = delimiter.unwrap_or_default();
    let decimal_comma = delimiter != Delimiter::Comma && has_decimal_commas(text, delimiter)?;
    let format = TextFormat { delimiter, decimal_comma };

    let mut rows = text.rows(format)?;
    let mut columns: Vec<Column> = rows.columns.iter().map(|name| Column::new(name)).collect();
    let mut count = 0;
    while let Some(row) = rows.next()? {
        count += 1;
        for (index, column) in columns.iter_mut().enumerate() {
            if let Ok(number) = row.number(index) {
                column.note(number);
            }
        }
    }
    if count == 0 {
        return Err(TableError::new(&text.file, Place::File, TableProblem::HeaderOnly));
    }
    Ok(Scan { format, columns, rows: count })
}

/// Whether some cell is a number only if its comma is a decimal one.
fn has_decimal_commas(text: &TableText, delimiter: Delimiter) -> Result<bool, TableError> {
    let mut rows = text.rows(TextFormat { delimiter, decimal_comma: false })?;
    let cells = rows.columns.len();
    while let Some(row) = rows.next()? {
        if (0..cells).any(|cell| matches!(row.number(cell), Err(TableProblem::DecimalComma { .. }))) {
            return Ok(true);
        }
    }
    Ok(false)
}
