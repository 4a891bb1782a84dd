//! What can be wrong with a table, each in a sentence that says where, what was found, what was expected and how to
//! mend it.

use std::fmt;
use std::path::{Path, PathBuf};

use thiserror::Error;

/// A table that cannot be read, with the place of the trouble.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{}{place}: {problem}", file.display())]
pub struct TableError {
    /// The file.
    pub file: PathBuf,
    /// Where in it.
    pub place: Place,
    /// What is wrong.
    pub problem: Box<TableProblem>,
}

impl TableError {
    pub(super) fn new(file: &Path, place: Place, problem: TableProblem) -> Self {
        Self { file: file.to_owned(), place, problem: Box::new(problem) }
    }
}

/// Where in a table file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Place {
    /// The file as a whole.
    File,
    /// A line, counted from 1 as an editor does.
    Line(u64),
    /// A column as a whole.
    Column(String),
    /// One cell.
    Cell {
        /// Line, counted from 1.
        line: u64,
        /// Name of the column.
        column: String,
    },
}

impl fmt::Display for Place {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File => Ok(()),
            Self::Line(line) => write!(formatter, ", line {line}"),
            Self::Column(column) => write!(formatter, ", column \"{column}\""),
            Self::Cell { line, column } => write!(formatter, ", line {line}, column \"{column}\""),
        }
    }
}

/// What is wrong with a table.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum TableProblem {
    // The file as bytes.
    /// No such file.
    #[error("there is no such file; correct the path (in a job it counts from the job file's folder)")]
    NotThere,
    /// The system would not let us read it.
    #[error("it cannot be read ({0}); check that the file may be read and its disk is there")]
    Unreadable(String),
    /// A folder or a device.
    #[error("found a folder or a device where a table file was expected; name the file in it")]
    NotAFile,
    /// Nothing in it.
    #[error("the file is empty; expected a line of column names and then one row of numbers after another")]
    Empty,
    /// Larger than any table of readings.
    #[error("the file has {bytes} bytes, and a table may have {limit}; split it, or thin it out, and try again")]
    TooLarge {
        /// Size found.
        bytes: u64,
        /// Largest size.
        limit: u64,
    },
    /// Zero bytes: not text.
    #[error(
        "found a zero byte at offset {offset}, which no text has; the copy may be damaged, or it is another kind of file: expected a table as CSV text"
    )]
    ZeroByte {
        /// Bytes before it.
        offset: usize,
    },
    /// Another kind of file, known by its first bytes.
    #[error("this is {found}; expected a table as CSV text: save the sheet as \"CSV UTF-8\" and name that file")]
    OtherFormat {
        /// What it is.
        found: &'static str,
    },
    /// Not UTF-8.
    #[error("found the byte 0x{byte:02X}, which is not UTF-8 text; save the file as \"CSV UTF-8\"")]
    NotUtf8 {
        /// The first byte that does not fit.
        byte: u8,
    },
    /// A line longer than any table's.
    #[error("the line has {bytes} bytes, and a line may have {limit}; expected one row a line")]
    LongLine {
        /// Length found.
        bytes: usize,
        /// Largest length.
        limit: usize,
    },
    /// An odd number of quotation marks.
    #[error("a quotation mark is opened and not closed on the same line; close it, or delete it")]
    OpenQuote,
    /// The csv reader's own complaint.
    #[error("it does not read as CSV ({0}); expected cells with one delimiter between them")]
    Csv(String),

    // Header and columns.
    /// Column names and no more.
    #[error("found column names but no row of numbers; the file may have been cut off when it was written")]
    HeaderOnly,
    /// Numbers where names belong.
    #[error("found numbers where column names were expected; write a first line that names the columns")]
    NoHeader,
    /// Two columns of one name.
    #[error("two columns have this name; rename one of them")]
    ColumnTwice,
    /// A column without a name.
    #[error("column {number} has no name; name it in the first line, or delete it")]
    ColumnNameless {
        /// Counted from 1.
        number: usize,
    },
    /// A column that the job names and the file has not.
    #[error("there is no column \"{wanted}\"; the file has {}{}", list(.found), suggestion(.nearest.as_deref()))]
    ColumnMissing {
        /// Name in the job.
        wanted: String,
        /// Names in the file.
        found: Vec<String>,
        /// The most similar of them.
        nearest: Option<String>,
    },
    /// Cells parted by something else than the job says.
    #[error("the first line has {} between its cells where the job says {}; write text = {{ delimiter = \"{}\" }}", .found.0, .expected.0, .found.1)]
    OtherDelimiter {
        /// What is there: in words, and as a job writes it.
        found: (&'static str, &'static str),
        /// What the job says.
        expected: (&'static str, &'static str),
    },

    // Rows and cells.
    /// A row that is too short or too long.
    #[error("the row has {found} cells where the first line names {expected} columns; {}", row_length(*.found, *.expected))]
    RowLength {
        /// Cells in the row.
        found: usize,
        /// Columns in the header.
        expected: usize,
    },
    /// A row that is too long because commas are in its numbers.
    #[error(
        "the row has {found} cells where the first line names {expected} columns, as if its numbers had decimal commas; write numbers as 0.5, or save with semicolons between cells and write text = {{ delimiter = \"semicolon\", decimal_comma = true }}"
    )]
    DecimalCommaInRow {
        /// Cells in the row.
        found: usize,
        /// Columns in the header.
        expected: usize,
    },
    /// A decimal comma in a cell.
    #[error(
        "found \"{found}\", a number with a decimal comma; if all are written so, add decimal_comma = true under `text`"
    )]
    DecimalComma {
        /// The cell.
        found: String,
    },
    /// An empty cell.
    #[error("the cell is empty where a number was expected; fill it in, or leave the row out")]
    EmptyCell,
    /// NaN, NA, inf.
    #[error("found \"{found}\" where a number was expected; a reading that is missing has no row: leave the row out")]
    NotFinite {
        /// The cell.
        found: String,
    },
    /// No number at all.
    #[error("found \"{found}\" where a number was expected; correct the cell, or name another column in the job")]
    NotANumber {
        /// The cell.
        found: String,
    },
    /// An order that is no whole number from 1.
    #[error("found {found} where a count of maxima was expected: 1 for the one of longest wavelength, 2 for the next")]
    Order {
        /// The value.
        found: f64,
    },

    // Values and units.
    /// A wavelength at or below 0.
    #[error("found the wavelength {found}; a wavelength is more than 0 nm: correct the cell, or delete the row")]
    WavelengthNotPositive {
        /// The value.
        found: f64,
    },
    /// Wavelengths of the size of micrometres.
    #[error(
        "the wavelengths run from {from} to {to}, which are micrometres rather than nm; write wavelength_unit = \"um\", or multiply them by 1000"
    )]
    Micrometres {
        /// Smallest.
        from: f64,
        /// Largest.
        to: f64,
    },
    /// A wavelength that no gonio instrument measures.
    #[error(
        "found the wavelength {found} nm, and expected {from} to {to} nm; if the table is in another unit (ångström, 1/cm), convert it to nm"
    )]
    WavelengthRange {
        /// The value, nm.
        found: f64,
        /// Smallest, nm.
        from: f64,
        /// Largest, nm.
        to: f64,
    },
    /// A reading below 0.
    #[error(
        "found the reading {found}, below 0; if it is noise about a dark reading, write negative = \"keep\" (or \"drop\" to leave such readings out), else correct it"
    )]
    NegativeReading {
        /// The value.
        found: f64,
    },
    /// A ratio of the size of a percentage.
    #[error(
        "found the reflectance {found}, and the job does not say its unit; if 100 is the white standard, write percent = true; if 1 is, percent = false"
    )]
    Percent {
        /// The value.
        found: f64,
    },
    /// An inclination out of range.
    #[error(
        "found an inclination of {found}°, and expected 0° to less than 90°, counted from the surface's normal; {}",
        inclination(*.found)
    )]
    InclinationRange {
        /// The value, degrees.
        found: f64,
    },
    /// An azimuth out of range.
    #[error("found an azimuth of {found}°, and expected −360° to 360°; correct it")]
    AzimuthRange {
        /// The value, degrees.
        found: f64,
    },
    /// Angles of the size of radians.
    #[error(
        "all inclinations lie between 0 and {largest}, which are radians rather than degrees; write angle_unit = \"radians\", or if they are degrees, angle_unit = \"degrees\""
    )]
    Radians {
        /// The largest.
        largest: f64,
    },
    /// A σ at or below 0.
    #[error(
        "the standard deviation is {found}; it is more than 0: where it is unknown, leave `sigma` out, and where readings may be 0 give `absolute` too"
    )]
    SigmaNotPositive {
        /// The value.
        found: f64,
    },

    // Rows together.
    /// The same reading twice.
    #[error(
        "the reading at {wavelength_nm} nm of {spectrum} stands in line {first_line} already; delete one of them, or if they are two spectra, name the column that tells them apart as `id`"
    )]
    ReadingTwice {
        /// Wavelength, nm.
        wavelength_nm: f64,
        /// The spectrum.
        spectrum: String,
        /// Line of the first.
        first_line: u64,
    },
    /// Wavelengths that neither rise nor fall throughout.
    #[error(
        "{found_nm} nm comes after {previous_nm} nm in {spectrum}, against the order of the lines before; sort the table by spectrum and wavelength, and look whether two spectra were mixed"
    )]
    Unsorted {
        /// The wavelength, nm.
        found_nm: f64,
        /// The one before, nm.
        previous_nm: f64,
        /// The spectrum.
        spectrum: String,
    },
    /// Two spectra, or two peaks, at the same angles.
    #[error(
        "{second} has the same angles as {first}; correct them, or if they are repeated measurements, write replicates = true"
    )]
    GeometryTwice {
        /// The one before.
        first: String,
        /// The one at this place.
        second: String,
    },
    /// Readings that do not come in the sets that the job says.
    #[error(
        "`average_of` is {count}, and the {spectra} spectra that the job keeps are no multiple of it; correct it, or leave the odd ones out by `only`"
    )]
    AverageCount {
        /// Spectra there are.
        spectra: usize,
        /// How many the job says make one.
        count: usize,
    },
    /// Readings to be averaged that are not of one thing.
    #[error(
        "`average_of` is {count}, but \"{first}\" and \"{second}\" differ in specimen, group, angles or wavelengths; sort the table so that the readings of one place follow each other, or correct `average_of`"
    )]
    AverageOfUnlike {
        /// The first of the set.
        first: String,
        /// The one that differs.
        second: String,
        /// How many the job says make one.
        count: usize,
    },
    /// Readings without scatter.
    #[error(
        "the readings of \"{id}\" and its group are equal at {wavelength_nm} nm, so that `average_of` gives no σ there; are they copies of one another? Take `average_of` away, or narrow `window_nm`"
    )]
    NoScatter {
        /// The mean's name.
        id: String,
        /// Where.
        wavelength_nm: f64,
    },
    /// One spectrum name with two geometries.
    #[error(
        "the spectrum \"{id}\" has other angles here than in line {first_line}; correct them, or leave `id` out if that column does not name a spectrum"
    )]
    IdWithTwoGeometries {
        /// The name.
        id: String,
        /// Its first line.
        first_line: u64,
    },
    /// No column of the name that the job says.
    #[error("no column's name starts with \"{prefix}\"; expected one of these to: {}", columns.join(", "))]
    NothingStartsWith {
        /// What the job says.
        prefix: String,
        /// Columns of spectra there are.
        columns: Vec<String>,
    },
    /// Nothing left after the job's choice of rows and wavelengths.
    #[error("of {rows} readings nothing is left: {}; widen the job's choice", left_out(*.by_only, *.by_window, *.by_negative))]
    NothingLeft {
        /// Readings in the file, or in the spectrum at this place.
        rows: u64,
        /// Left out by `only`.
        by_only: u64,
        /// Left out by `window_nm`.
        by_window: u64,
        /// Left out by `negative`.
        by_negative: u64,
    },

    // The job's words on the table.
    /// Angles for fewer or more columns than there are.
    #[error("the job gives angles for {found} spectra and the file has {}: {}; give one for each, in this order, or name them as {{ \"{}\" = 15 }}", .columns.len(), list(.columns), .columns.first().map_or("column", String::as_str))]
    AngleCount {
        /// Angles in the job.
        found: usize,
        /// Columns of spectra in the file.
        columns: Vec<String>,
    },
    /// Angles that are still to be filled in.
    #[error("the job does not give the angles of this spectrum yet; write them, in degrees, where it says nan")]
    AngleMissing,
    /// A key whose value makes no sense.
    #[error("the job's `{key}` is {found}; expected {expected}")]
    Key {
        /// The key.
        key: &'static str,
        /// What it is.
        found: String,
        /// What it may be.
        expected: &'static str,
    },
}

fn inclination(found: f64) -> &'static str {
    if found < 0.0 {
        "write a negative one as positive, with the azimuth turned by 180°"
    } else {
        "if the table counts from the surface itself, write 90° − angle"
    }
}

/// Names in quotation marks; a long list is cut, since a wide table may have hundreds of columns.
fn list(names: &[String]) -> String {
    const SHOWN: usize = 20;
    let mut text = names.iter().take(SHOWN).map(|name| format!("\"{name}\"")).collect::<Vec<_>>().join(", ");
    if names.len() > SHOWN {
        text += &format!(" and {} more", names.len() - SHOWN);
    }
    text
}

fn suggestion(name: Option<&str>) -> String {
    name.map_or_else(|| "; name one of these in the job".to_owned(), |name| format!("; did you mean \"{name}\"?"))
}

fn row_length(found: usize, expected: usize) -> &'static str {
    if found < expected {
        "it may have been cut off: complete it, or delete it"
    } else {
        "put quotation marks around a cell that has the delimiter in it, or delete what is too much"
    }
}

fn left_out(by_only: u64, by_window: u64, by_negative: u64) -> String {
    let causes = [(by_only, "only"), (by_window, "window_nm"), (by_negative, "negative = \"drop\"")];
    let parts = causes.iter().filter(|(count, _)| *count > 0).map(|(count, key)| format!("`{key}` leaves out {count}"));
    parts.collect::<Vec<_>>().join(", ")
}
