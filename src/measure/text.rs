//! A table file as text: bytes that are surely text, and rows of cells with the line they stand on.
//!
//! The file is looked at before it is read (kind, size, first bytes), so that a wrong file costs neither time nor memory,
//! and it is made uniform (no byte order mark, `\n` at every line's end), so that the csv reader's line count is an editor's.

use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};

use csv::StringRecord;

use super::error::{Place, TableError, TableProblem};
use super::layout::{Delimiter, TextFormat};
use crate::nearest::nearest;

/// Largest table file, bytes. Some five million readings; the largest public gonio tables have fewer.
const FILE_LIMIT: u64 = 256 << 20;
/// Longest line, bytes: fifty thousand columns of numbers.
const LINE_LIMIT: usize = 1 << 20;
/// Bytes looked at before the rest is read.
const PREFIX: usize = 1 << 16;
/// Longest piece of a cell that an error message repeats, characters.
const SHOWN_CELL: usize = 40;

/// A table file's text, checked and made uniform, not yet understood.
#[derive(Debug, Clone)]
pub struct TableText {
    pub(super) file: PathBuf,
    content: String,
}

impl TableText {
    /// Reads the file.
    ///
    /// # Errors
    ///
    /// If there is no such file, or it is no text, or larger than 256 MiB, which is found out before it is read.
    pub fn load(path: &Path) -> Result<Self, TableError> {
        let bytes = read_bytes(path).map_err(|problem| TableError::new(path, Place::File, problem))?;
        Self::from_bytes(path, bytes)
    }

    /// The same of bytes that were read from the file before.
    ///
    /// # Errors
    ///
    /// If they are no text.
    pub fn from_bytes(path: &Path, bytes: Vec<u8>) -> Result<Self, TableError> {
        let error = |place, problem| TableError::new(path, place, problem);
        check_bytes(&bytes).map_err(|problem| error(Place::File, problem))?;
        let text = match String::from_utf8(bytes) {
            Ok(text) => text,
            Err(invalid) => {
                let valid = invalid.utf8_error().valid_up_to();
                let bytes = invalid.as_bytes();
                let place = Place::Line(line_of(&bytes[..valid]));
                return Err(error(place, TableProblem::NotUtf8 { byte: bytes[valid] }));
            }
        };
        let content = uniform(text);
        if content.trim().is_empty() {
            return Err(error(Place::File, TableProblem::Empty));
        }
        for (index, line) in content.split('\n').enumerate() {
            let place = Place::Line(index as u64 + 1);
            if line.len() > LINE_LIMIT {
                return Err(error(place, TableProblem::LongLine { bytes: line.len(), limit: LINE_LIMIT }));
            }
            if line.bytes().filter(|&byte| byte == b'"').count() % 2 == 1 {
                return Err(error(place, TableProblem::OpenQuote));
            }
        }
        Ok(Self { file: path.to_owned(), content })
    }

    /// The first line that is not blank.
    pub(super) fn first_line(&self) -> &str {
        self.content.lines().find(|line| !line.trim().is_empty()).unwrap_or_default()
    }

    /// Its rows, after the line of column names.
    pub(super) fn rows(&self, format: TextFormat) -> Result<Rows<'_>, TableError> {
        let mut reader = csv::ReaderBuilder::new()
            .delimiter(format.delimiter.byte())
            .has_headers(false)
            .flexible(true)
            .from_reader(self.content.as_bytes());
        let mut record = StringRecord::new();
        reader
            .read_record(&mut record)
            .map_err(|error| TableError::new(&self.file, Place::File, TableProblem::Csv(error.to_string())))?;
        let columns: Vec<String> = record.iter().map(|name| name.trim().to_owned()).collect();
        let rows = Rows { file: &self.file, columns, reader, record, decimal_comma: format.decimal_comma };
        rows.check_header(self.first_line(), format.delimiter)?;
        Ok(rows)
    }
}

/// The rows of a table, one at a time.
pub(super) struct Rows<'a> {
    pub(super) file: &'a Path,
    /// Names of the columns.
    pub(super) columns: Vec<String>,
    reader: csv::Reader<&'a [u8]>,
    record: StringRecord,
    decimal_comma: bool,
}

impl Rows<'_> {
    /// The next row that is not blank, which has a cell for each column.
    pub(super) fn next(&mut self) -> Result<Option<Row<'_>>, TableError> {
        let more = self
            .reader
            .read_record(&mut self.record)
            .map_err(|error| TableError::new(self.file, Place::File, TableProblem::Csv(error.to_string())))?;
        if !more {
            return Ok(None);
        }
        // The text ends every line with \n and no cell holds one, so the reader now stands on the line after the row's.
        let line = self.reader.position().line() - 1;
        let (found, expected) = (self.record.len(), self.columns.len());
        if found != expected {
            let whole = |cell: &str| !cell.is_empty() && cell.bytes().all(|byte| byte.is_ascii_digit() || byte == b'-');
            let problem = if found > expected && self.record.iter().all(|cell| whole(cell.trim())) {
                TableProblem::DecimalCommaInRow { found, expected }
            } else {
                TableProblem::RowLength { found, expected }
            };
            return Err(TableError::new(self.file, Place::Line(line), problem));
        }
        Ok(Some(Row { line, columns: &self.columns, cells: &self.record, decimal_comma: self.decimal_comma }))
    }

    /// Index of the column of this name.
    pub(super) fn column(&self, wanted: &str) -> Result<usize, TableError> {
        let mut places = self.columns.iter().enumerate().filter(|(_, name)| *name == wanted).map(|(index, _)| index);
        match (places.next(), places.next()) {
            (Some(index), None) => Ok(index),
            (Some(_), Some(_)) => {
                Err(TableError::new(self.file, Place::Column(wanted.to_owned()), TableProblem::ColumnTwice))
            }
            (None, _) => {
                let problem = TableProblem::ColumnMissing {
                    wanted: wanted.to_owned(),
                    found: self.columns.clone(),
                    nearest: nearest(wanted, self.columns.iter().map(String::as_str)).map(str::to_owned),
                };
                Err(TableError::new(self.file, Place::Line(1), problem))
            }
        }
    }

    fn check_header(&self, first_line: &str, delimiter: Delimiter) -> Result<(), TableError> {
        let error = |problem| Err(TableError::new(self.file, Place::Line(1), problem));
        if let [only] = self.columns.as_slice() {
            let other = DELIMITERS.into_iter().find(|other| *other != delimiter && count(first_line, *other) > 0);
            if let Some(other) = other {
                return error(TableProblem::OtherDelimiter { found: words(other), expected: words(delimiter) });
            }
            if only.is_empty() {
                return error(TableProblem::ColumnNameless { number: 1 });
            }
        }
        let format = TextFormat { delimiter, decimal_comma: self.decimal_comma };
        if self.columns.iter().all(|name| number(name, format.decimal_comma).is_ok()) {
            return error(TableProblem::NoHeader);
        }
        Ok(())
    }
}

/// One row of a table.
pub(super) struct Row<'a> {
    /// Line in the file, counted from 1.
    pub(super) line: u64,
    columns: &'a [String],
    cells: &'a StringRecord,
    decimal_comma: bool,
}

impl Row<'_> {
    /// The cell's text, without blanks around it.
    pub(super) fn text(&self, column: usize) -> &str {
        self.cells.get(column).unwrap_or_default().trim()
    }

    /// The cell's number, which is finite.
    pub(super) fn number(&self, column: usize) -> Result<f64, TableProblem> {
        number(self.text(column), self.decimal_comma)
    }

    /// Where the cell is.
    pub(super) fn place(&self, column: usize) -> Place {
        Place::Cell { line: self.line, column: self.columns[column].clone() }
    }
}

/// All delimiters that a table may have.
pub(super) const DELIMITERS: [Delimiter; 3] = [Delimiter::Comma, Delimiter::Semicolon, Delimiter::Tab];

/// How often the delimiter stands in the line outside quotation marks.
pub(super) fn count(line: &str, delimiter: Delimiter) -> usize {
    line.split('"').step_by(2).flat_map(str::bytes).filter(|&byte| byte == delimiter.byte()).count()
}

/// A finite number, or what is wrong with it.
pub(super) fn number(cell: &str, decimal_comma: bool) -> Result<f64, TableProblem> {
    let shown = || cell.chars().take(SHOWN_CELL).collect::<String>();
    let with_point = cell.replacen(',', ".", 1);
    let parsed = if decimal_comma && !cell.contains('.') { with_point.parse() } else { cell.parse::<f64>() };
    match parsed {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) => Err(TableProblem::NotFinite { found: shown() }),
        Err(_) if cell.is_empty() => Err(TableProblem::EmptyCell),
        Err(_) if MISSING.contains(&cell.to_ascii_lowercase().as_str()) => {
            Err(TableProblem::NotFinite { found: shown() })
        }
        Err(_) if !decimal_comma && with_point.parse::<f64>().is_ok() => {
            Err(TableProblem::DecimalComma { found: shown() })
        }
        Err(_) => Err(TableProblem::NotANumber { found: shown() }),
    }
}

/// What programs write for a number that is missing (R, spreadsheets, MATLAB), in lower case.
const MISSING: [&str; 6] = ["na", "n/a", "#n/a", "null", "1.#qnan", "#div/0!"];

fn words(delimiter: Delimiter) -> (&'static str, &'static str) {
    match delimiter {
        Delimiter::Comma => ("commas", "comma"),
        Delimiter::Semicolon => ("semicolons", "semicolon"),
        Delimiter::Tab => ("tabulators", "tab"),
    }
}

fn read_bytes(path: &Path) -> Result<Vec<u8>, TableProblem> {
    let unreadable = |error: std::io::Error| match error.kind() {
        ErrorKind::NotFound => TableProblem::NotThere,
        _ => TableProblem::Unreadable(error.to_string()),
    };
    // Looked at before it is opened: opening a pipe would wait for its writer.
    let kind = std::fs::metadata(path).map_err(unreadable)?;
    if !kind.is_file() {
        return Err(TableProblem::NotAFile);
    }
    let file = File::open(path).map_err(unreadable)?;
    let mut bytes = Vec::new();
    (&file).take(PREFIX as u64).read_to_end(&mut bytes).map_err(unreadable)?;
    check_bytes(&bytes)?;
    if kind.len() > FILE_LIMIT {
        return Err(TableProblem::TooLarge { bytes: kind.len(), limit: FILE_LIMIT });
    }
    // The file may have grown since it was looked at.
    (&file).take(FILE_LIMIT).read_to_end(&mut bytes).map_err(unreadable)?;
    Ok(bytes)
}

/// Whether these bytes can be the start of a text.
fn check_bytes(bytes: &[u8]) -> Result<(), TableProblem> {
    if let Some((_, found)) = OTHER_FORMATS.iter().find(|(start, _)| bytes.starts_with(start)) {
        return Err(TableProblem::OtherFormat { found });
    }
    match bytes.iter().position(|&byte| byte == 0) {
        Some(offset) => Err(TableProblem::ZeroByte { offset }),
        None => Ok(()),
    }
}

/// First bytes of files that people take for tables.
const OTHER_FORMATS: [(&[u8], &str); 6] = [
    (b"PK\x03\x04", "an Excel workbook or another zip archive"),
    (b"\xD0\xCF\x11\xE0", "an old Excel workbook"),
    (b"\xFF\xFE", "UTF-16 text"),
    (b"\xFE\xFF", "UTF-16 text"),
    (b"\x1F\x8B", "a gzip archive"),
    (b"%PDF", "a PDF document"),
];

/// Without a byte order mark, and with `\n` at the end of every line, the last one too.
fn uniform(mut text: String) -> String {
    if text.starts_with('\u{feff}') {
        text.remove(0);
    }
    if text.contains('\r') {
        text = text.replace("\r\n", "\n").replace('\r', "\n");
    }
    if !text.ends_with('\n') {
        text.push('\n');
    }
    text
}

fn line_of(before: &[u8]) -> u64 {
    before.iter().filter(|&&byte| byte == b'\n').count() as u64 + 1
}
