//! How a table file is laid out, as a job says it.
//!
//! A unit that a job states is believed. One that it leaves out is nm, degrees and a plain ratio, and the reader refuses
//! a table whose numbers speak against that: a table in µm must never be read as one in nm.
//!
//! A long table of reflectances in percent, one row a reading:
//!
//! ```toml
//! [spectra]
//! quantity = "reflectance"
//! percent = true
//! window_nm = [320, 700]
//! sigma = { relative = 0.02, absolute = 0.1 }
//! [spectra.columns.long]
//! angles = { mirror = "incidence_deg" }
//! wavelength = "wavelength_nm"
//! value = "reflectance_percent"
//! ```
//!
//! A wide one, whose two spectra were taken at 15° and 30°: `columns.wide = { wavelength = "wl", angles = { mirror = [15,
//! 30] } }` in place of the last table. Peaks as a paper prints them:
//!
//! ```toml
//! [peaks]
//! angles = { mirror = "incidence_deg" }
//! wavelength = "peak_nm"
//! sigma = { absolute = 1 }
//! ```

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Geometry, Quantity};

/// What a table file holds, and in which columns.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TableLayout {
    /// Readings over wavelength at given angles.
    Spectra(SpectraLayout),
    /// Peak wavelengths at given angles, as papers print them.
    Peaks(PeaksLayout),
}

/// A table of readings over wavelength.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SpectraLayout {
    /// Meaning of the values.
    pub quantity: Quantity,
    /// Which column holds what.
    pub columns: SpectraColumns,
    /// Whether reflectances are in percent of the white standard; they are then divided by 100.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub percent: Option<bool>,
    /// Standard deviation of the readings, where it is known. Left out, it is unknown, not 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sigma: Option<SigmaLayout>,
    /// What to do with readings below 0.
    #[serde(default)]
    pub negative: Negative,
    /// First and last wavelength to keep, nm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub window_nm: Option<[f64; 2]>,
    /// Keep the first of each so many wavelengths of a spectrum, after the window: 5 makes a 1 nm grid a 5 nm one.
    #[serde(default = "every_one")]
    #[schemars(range(min = 1))]
    pub stride: usize,
    /// Keep only the rows that hold these values in these columns: `{ kept_by_authors = 1 }`. Long tables alone.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub only: BTreeMap<String, Cell>,
    /// How many spectra that follow each other are readings of one place on one specimen: their mean is then one spectrum, and
    /// their scatter, pooled over the specimens of a group, its σ.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 2))]
    pub average_of: Option<usize>,
    /// Whether several spectra may share one geometry. Left out, that is refused as a slip.
    #[serde(default)]
    pub replicates: bool,
    /// Unit of the wavelengths, nm where left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wavelength_unit: Option<WavelengthUnit>,
    /// Unit of the angles, degrees where left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub angle_unit: Option<AngleUnit>,
    /// How the text is written.
    #[serde(default, skip_serializing_if = "TextFormat::is_default")]
    pub text: TextFormat,
}

impl SpectraLayout {
    /// A layout with nothing but what it must have.
    pub fn new(quantity: Quantity, columns: SpectraColumns) -> Self {
        Self {
            quantity,
            columns,
            percent: None,
            sigma: None,
            negative: Negative::Refuse,
            window_nm: None,
            stride: 1,
            only: BTreeMap::new(),
            average_of: None,
            replicates: false,
            wavelength_unit: None,
            angle_unit: None,
            text: TextFormat::default(),
        }
    }

    /// Whether it says that nobody wrote down where light and viewer stood.
    pub fn is_without_geometry(&self) -> bool {
        match &self.columns {
            SpectraColumns::Long(columns) => columns.angles == Angles::NotRecorded,
            SpectraColumns::Wide(columns) => columns.angles == WideAngles::NotRecorded,
        }
    }
}

/// Where a table of spectra keeps its numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SpectraColumns {
    /// One row a reading.
    Long(LongColumns),
    /// One row a wavelength, one column a spectrum: what R writes for a pavo object.
    Wide(WideColumns),
}

/// Columns of a long table, by name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LongColumns {
    /// Angles of light and viewer.
    pub angles: Angles,
    /// Wavelength: a column, or one number where the table has none.
    pub wavelength: Source,
    /// Column of the readings.
    pub value: String,
    /// Column that names the spectrum a row belongs to. Left out, rows of equal angles (of one specimen, if there is such a
    /// column) are one spectrum.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub id: Option<String>,
    /// Column that names the individual. Left out, each spectrum is a specimen of its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub specimen: Option<String>,
    /// Columns whose values set specimens apart that are not to be compared, as species or patch: each group is fitted by
    /// itself.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub group: Vec<String>,
}

/// Columns of a wide table.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WideColumns {
    /// Column of the wavelengths. All others are spectra; a first column without a name is R's row number.
    pub wavelength: String,
    /// Angles of each spectrum.
    pub angles: WideAngles,
    /// Leave out the columns whose names do not start so: `cardinal` keeps `cardinal`, `cardinal.1` and so on. For tables
    /// whose angles are not recorded; elsewhere name the columns under `angles`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub starts_with: Option<String>,
}

/// Angles of the columns of a wide table.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum WideAngles {
    /// Inclination of the light, degrees; the viewer stands in the mirror direction.
    Mirror(PerColumn<f64>),
    /// All four angles.
    Four(PerColumn<Geometry>),
    /// Nobody wrote them down: `angles = "not_recorded"`. Only a model that needs none can be fitted then.
    NotRecorded,
}

/// One entry for each spectrum of a wide table.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(
    untagged,
    expecting = "expected a list with one entry a column, or a table of `column name = entry` for the columns wanted"
)]
pub enum PerColumn<T> {
    /// In the order of the columns, none left out.
    InOrder(Vec<T>),
    /// By column name; columns that are not named are left out.
    ByName(BTreeMap<String, T>),
}

/// A table of peak wavelengths.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PeaksLayout {
    /// Angles of light and viewer.
    pub angles: Angles,
    /// Column of the peak wavelength.
    pub wavelength: String,
    /// Standard deviation of a peak wavelength, in the unit of the wavelengths.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sigma: Option<SigmaLayout>,
    /// Column that counts the maxima of a spectrum, 1 for the one of longest wavelength.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub order: Option<String>,
    /// Column of names.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub id: Option<String>,
    /// Keep only the rows that hold these values in these columns.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub only: BTreeMap<String, Cell>,
    /// Whether one geometry may have several readings of the same maximum.
    #[serde(default)]
    pub replicates: bool,
    /// Unit of the wavelengths, nm where left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wavelength_unit: Option<WavelengthUnit>,
    /// Unit of the angles, degrees where left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub angle_unit: Option<AngleUnit>,
    /// How the text is written.
    #[serde(default, skip_serializing_if = "TextFormat::is_default")]
    pub text: TextFormat,
}

/// Where the angles of a row come from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Angles {
    /// Inclination of the light; the viewer stands in the mirror direction. `{ mirror = "incidence_deg" }`
    Mirror(Source),
    /// All four angles.
    Four(FourAngles),
    /// Nobody wrote them down: `angles = "not_recorded"`. Only a model that needs none can be fitted then.
    NotRecorded,
}

/// Sources of all four angles.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FourAngles {
    /// Inclination of the light from the normal.
    pub theta_i: Source,
    /// Azimuth of the light.
    pub phi_i: Source,
    /// Inclination of the viewer from the normal.
    pub theta_o: Source,
    /// Azimuth of the viewer.
    pub phi_o: Source,
}

/// A number from each row, or one for all.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged, expecting = "expected a column's name in quotes, or one number for all rows")]
pub enum Source {
    /// One number for all rows.
    Number(f64),
    /// A column's name.
    Column(String),
}

/// A value to compare a cell with: numbers as numbers, text as text.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged, expecting = "expected a number, or a text in quotes")]
pub enum Cell {
    /// Equal as a number: 1 is also `1.0`.
    Number(f64),
    /// Equal letter by letter, blanks around it aside.
    Text(String),
}

/// Standard deviation of a reading: the root of the summed squares of the parts that are given.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SigmaLayout {
    /// Column of standard deviations, in the unit of the readings as written in the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub column: Option<String>,
    /// Share of the reading: 0.02 is 2 %.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub relative: Option<f64>,
    /// The same for every reading, in the unit of the readings as written in the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub absolute: Option<f64>,
}

/// What to do with readings below 0, which noise about a dark reading makes and a slip as well.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Negative {
    /// Refuse the table and name the line.
    #[default]
    Refuse,
    /// Read them as they are: right for noise about 0, since leaving out one side of the noise biases a fit.
    Keep,
    /// Leave these readings out.
    Drop,
}

/// Unit of wavelengths in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum WavelengthUnit {
    /// Nanometres.
    Nm,
    /// Micrometres.
    Um,
}

/// Unit of angles in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum AngleUnit {
    /// Degrees.
    Degrees,
    /// Radians.
    Radians,
}

/// How the text of a table is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct TextFormat {
    /// What stands between two cells.
    pub delimiter: Delimiter,
    /// Whether numbers are written `0,5`.
    pub decimal_comma: bool,
}

impl TextFormat {
    fn is_default(&self) -> bool {
        *self == Self::default()
    }
}

/// What stands between two cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Delimiter {
    /// `,`
    #[default]
    Comma,
    /// `;`
    Semicolon,
    /// A tabulator.
    Tab,
}

impl Delimiter {
    /// The byte in the file.
    pub(super) fn byte(self) -> u8 {
        match self {
            Self::Comma => b',',
            Self::Semicolon => b';',
            Self::Tab => b'\t',
        }
    }
}

fn every_one() -> usize {
    1
}
