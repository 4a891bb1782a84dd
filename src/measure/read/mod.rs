//! Reads a table file into checked types: first the cells as they stand ([`columns`], [`long`], [`wide`]), then units,
//! order and meaning ([`checks`], [`spectra`], [`average`], [`peaks`]).

mod average;
mod checks;
mod columns;
mod long;
mod peaks;
mod spectra;
mod wide;

use peaks::read_peaks;
use spectra::read_spectra;

use super::error::TableError;
use super::layout::TableLayout;
use super::table::Table;
use super::text::TableText;

/// Reads and checks a table.
///
/// # Errors
///
/// Whatever keeps the table from being what its layout says, with file, line and column: see
/// [`TableProblem`](super::TableProblem).
pub fn read_table(text: &TableText, layout: &TableLayout) -> Result<Table, TableError> {
    match layout {
        TableLayout::Spectra(layout) => read_spectra(text, layout).map(Table::Spectra),
        TableLayout::Peaks(layout) => read_peaks(text, layout).map(Table::Peaks),
    }
}
