//! Guesses how a table is laid out, from its column names and the size of its numbers.
//!
//! A guess is a start for a person who then looks at each note. Nothing is taken for granted that the file does not say:
//! where the viewer stands is a guess, and of angles that the file does not hold the layout says that nobody recorded them,
//! which only models that need none accept.

mod comments;
mod names;
mod scan;

use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_2;

use names::Role;
use scan::{Column, Scan};

use super::Quantity;
use super::error::{Place, TableError, TableProblem};
use super::layout::{
    AngleUnit, Angles, Cell, FourAngles, LongColumns, PeaksLayout, PerColumn, SigmaLayout, Source, SpectraColumns,
    SpectraLayout, TableLayout, TextFormat, WavelengthUnit, WideAngles, WideColumns,
};
use super::read::read_table;
use super::text::TableText;

/// A table's layout as far as it can be told, and why.
#[derive(Debug, Clone, PartialEq)]
pub struct Guess {
    /// The layout; a light's angle that nobody can tell, where the viewer's is there, is NaN.
    pub layout: TableLayout,
    /// One for each key of the layout, in the order of importance.
    pub notes: Vec<GuessNote>,
}

/// Why a key of a layout has its value.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GuessNote {
    /// The key, from the layout's own: `percent`, `columns.long.angles`.
    pub key: &'static str,
    /// How far to trust it.
    pub certainty: Certainty,
    /// The reason, one sentence without a full stop.
    pub text: String,
}

/// How far to trust a guess.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Certainty {
    /// The file says so.
    Read,
    /// Likely; to be checked.
    Guessed,
    /// Not in the file; to be filled in.
    Missing,
}

/// Guesses the layout of a table.
///
/// # Errors
///
/// If the file is no table of cells at all, or has neither wavelengths nor peaks that can be found.
pub fn guess_layout(text: &TableText) -> Result<Guess, TableError> {
    let scan = scan::scan(text)?;
    let mut guesser = Guesser { scan: &scan, notes: Vec::new() };
    let layout = guesser.layout().ok_or_else(|| TableError::new(&text.file, Place::Line(1), no_wavelength(&scan)))?;
    let mut guess = Guess { layout, notes: guesser.notes };
    allow_replicates(text, &mut guess);
    Ok(guess)
}

fn no_wavelength(scan: &Scan) -> TableProblem {
    let found = scan.columns.iter().map(|column| column.name.clone()).collect();
    TableProblem::ColumnMissing { wanted: "wavelength".to_owned(), found, nearest: None }
}

/// Reads the table as guessed; if all that is wrong is that angles repeat, it holds repeated measurements.
fn allow_replicates(text: &TableText, guess: &mut Guess) {
    let Err(error) = read_table(text, &guess.layout) else { return };
    if matches!(*error.problem, TableProblem::GeometryTwice { .. }) {
        match &mut guess.layout {
            TableLayout::Spectra(layout) => layout.replicates = true,
            TableLayout::Peaks(layout) => layout.replicates = true,
        }
        let text = "the same angles come more than once, which looks like repeated measurements".to_owned();
        guess.notes.push(GuessNote { key: "replicates", certainty: Certainty::Guessed, text });
    }
}

struct Guesser<'a> {
    scan: &'a Scan,
    notes: Vec<GuessNote>,
}

impl<'a> Guesser<'a> {
    fn layout(&mut self) -> Option<TableLayout> {
        if self.scan.format != TextFormat::default() {
            self.note("text", Certainty::Read, "the file's cells and decimals are written so");
        }
        if let (Some(peak), None) = (self.find(Role::Peak), self.find(Role::Wavelength)) {
            return Some(TableLayout::Peaks(self.peaks(peak)));
        }
        let (value, angle) = (self.find(Role::Value), self.find(Role::ThetaI));
        match (self.find(Role::Wavelength), value, angle) {
            (Some(wavelength), _, None) if wavelength.rises || wavelength.falls => {
                Some(TableLayout::Spectra(self.wide(wavelength)))
            }
            (Some(wavelength), Some(value), _) => Some(TableLayout::Spectra(self.long(Some(wavelength), value))),
            (None, Some(value), Some(_)) => Some(TableLayout::Spectra(self.long(None, value))),
            (Some(wavelength), None, Some(_)) => Some(TableLayout::Peaks(self.peaks(wavelength))),
            (Some(_), None, None) => None,
            (None, ..) => {
                // A first column that runs through the visible range is wavelengths, whatever its name.
                let first = self.scan.columns.iter().find(|column| !column.name.is_empty())?;
                let runs = first.numbers == self.scan.rows && (first.rises || first.falls);
                let visible = first.smallest >= 100.0 && first.largest <= 3000.0;
                (runs && visible).then(|| TableLayout::Spectra(self.wide(first)))
            }
        }
    }

    fn long(&mut self, wavelength: Option<&'a Column>, value: &'a Column) -> SpectraLayout {
        let angles = self.angles("columns.long.angles");
        let wavelength_source = match wavelength {
            Some(column) => {
                self.wavelength("columns.long.wavelength", column);
                Source::Column(column.name.clone())
            }
            None => {
                let text = "the file has no wavelengths; 550 nm stands for the middle of the visible range";
                self.note("columns.long.wavelength", Certainty::Missing, text);
                Source::Number(550.0)
            }
        };
        self.note("columns.long.value", Certainty::Guessed, format!("the name \"{}\" says so", value.name));
        let id = self.find(Role::Id).map(|column| column.name.clone());
        if let Some(id) = &id {
            self.note("columns.long.id", Certainty::Guessed, format!("\"{id}\" seems to name each spectrum"));
        }
        let (specimen, group) = self.owner();
        let sigma = self.sigma();
        let only = self.only();
        let wavelength_unit = wavelength.and_then(|column| self.wavelength_unit(column));
        let columns =
            LongColumns { angles, wavelength: wavelength_source, value: value.name.clone(), id, specimen, group };
        SpectraLayout { sigma, only, wavelength_unit, ..self.readings(SpectraColumns::Long(columns), &[value]) }
    }

    /// Columns that say whose spectrum a row belongs to.
    fn owner(&mut self) -> (Option<String>, Vec<String>) {
        let specimen = self.find(Role::Specimen).map(|column| column.name.clone());
        if let Some(specimen) = &specimen {
            self.note(
                "columns.long.specimen",
                Certainty::Guessed,
                format!("\"{specimen}\" seems to name the individual"),
            );
        }
        let groups = self.scan.columns.iter().filter(|column| names::role(&column.name) == Role::Group);
        let group: Vec<String> = groups.map(|column| column.name.clone()).collect();
        if !group.is_empty() {
            let text =
                "specimens that differ in these are not compared with each other: each group is fitted by itself";
            self.note("columns.long.group", Certainty::Guessed, text);
        }
        (specimen, group)
    }

    fn wide(&mut self, wavelength: &'a Column) -> SpectraLayout {
        self.wavelength("columns.wide.wavelength", wavelength);
        let is_spectrum =
            |column: &&Column| column.name != wavelength.name && !column.name.is_empty() && column.numbers > 0;
        let spectra: Vec<&Column> = self.scan.columns.iter().filter(is_spectrum).collect();
        let angles: Vec<Option<f64>> = spectra.iter().map(|column| names::angle_in(&column.name)).collect();
        let known: Option<BTreeMap<String, f64>> =
            spectra.iter().zip(&angles).map(|(column, angle)| Some((column.name.clone(), (*angle)?))).collect();
        let angles = match known {
            Some(by_name) => {
                let text =
                    "taken from the columns' names; that the viewer stands in the mirror direction is an assumption";
                self.note("columns.wide.angles", Certainty::Guessed, text);
                WideAngles::Mirror(PerColumn::ByName(by_name))
            }
            None => {
                let text = format!(
                    "the file does not hold the angles of its {} spectra: where you know them, write {{ mirror = [15, 30, …] }}, \
                     the light's inclination for each column with the viewer in the mirror direction, or {{ four = … }}; left \
                     as it is, only models that need none can be fitted",
                    spectra.len()
                );
                self.note("columns.wide.angles", Certainty::Missing, text);
                WideAngles::NotRecorded
            }
        };
        let columns = WideColumns { wavelength: wavelength.name.clone(), angles, starts_with: None };
        let wavelength_unit = self.wavelength_unit(wavelength);
        let readings = self.readings(SpectraColumns::Wide(columns), &spectra);
        SpectraLayout { angle_unit: None, wavelength_unit, ..readings }
    }

    fn peaks(&mut self, peak: &'a Column) -> PeaksLayout {
        let angles = self.angles("angles");
        self.wavelength("wavelength", peak);
        let order = self.find(Role::Order).map(|column| column.name.clone());
        if let Some(order) = &order {
            self.note(
                "order",
                Certainty::Guessed,
                format!("\"{order}\" seems to count maxima from the longest wavelength"),
            );
        }
        PeaksLayout {
            angles,
            wavelength: peak.name.clone(),
            sigma: self.sigma(),
            order,
            id: self.find(Role::Id).map(|column| column.name.clone()),
            only: self.only(),
            replicates: false,
            wavelength_unit: self.wavelength_unit(peak),
            angle_unit: self.angle_unit(),
            text: self.scan.format,
        }
    }

    fn note(&mut self, key: &'static str, certainty: Certainty, text: impl Into<String>) {
        self.notes.push(GuessNote { key, certainty, text: text.into() });
    }

    /// The first column of this role that holds numbers; a name may be any text.
    fn find(&self, role: Role) -> Option<&'a Column> {
        // Two columns with an angle in their names are two spectra; one may be called theta1.
        let with_angle = |column: &&Column| names::angle_in(&column.name).is_some();
        let spectra_by_angle = self.scan.columns.iter().filter(with_angle).count() > 1;
        let fits = |column: &&Column| {
            let spectrum = role == Role::ThetaI && spectra_by_angle && with_angle(column);
            let is_text = matches!(role, Role::Id | Role::Specimen | Role::Group);
            names::role(&column.name) == role && (column.numbers > 0 || is_text) && !spectrum
        };
        self.scan.columns.iter().find(fits)
    }

    fn angles(&mut self, key: &'static str) -> Angles {
        let source = |column: Option<&Column>, otherwise: f64| {
            column.map_or(Source::Number(otherwise), |column| Source::Column(column.name.clone()))
        };
        let [theta_i, phi_i, theta_o, phi_o] =
            [Role::ThetaI, Role::PhiI, Role::ThetaO, Role::PhiO].map(|role| self.find(role));
        match (theta_i, theta_o) {
            (None, None) => {
                let text = "the file has no angles: where you know them, write { mirror = 15 } or { mirror = \"column\" } for the \
                            light's inclination with the viewer in the mirror direction, or all four; left as it is, only \
                            models that need none can be fitted";
                self.note(key, Certainty::Missing, text);
                Angles::NotRecorded
            }
            (Some(theta), None) => {
                let text = format!(
                    "\"{}\" holds one angle, taken for the light's inclination; the file does not say where the viewer \
                     stands, and the mirror direction is an assumption",
                    theta.name
                );
                self.note(key, Certainty::Guessed, text);
                Angles::Mirror(source(Some(theta), f64::NAN))
            }
            (theta_i, Some(theta_o)) => {
                let (certainty, text) = if theta_i.is_none() {
                    (
                        Certainty::Missing,
                        "the file has the viewer's angle and not the light's: write it in place of nan",
                    )
                } else if phi_i.is_some() && phi_o.is_some() {
                    (Certainty::Read, "the file names all four angles")
                } else {
                    (
                        Certainty::Guessed,
                        "the file lacks an azimuth; light and viewer on opposite sides are an assumption",
                    )
                };
                self.note(key, certainty, text);
                Angles::Four(FourAngles {
                    theta_i: source(theta_i, f64::NAN),
                    phi_i: source(phi_i, 0.0),
                    theta_o: source(Some(theta_o), f64::NAN),
                    phi_o: source(phi_o, 180.0),
                })
            }
        }
    }

    fn wavelength(&mut self, key: &'static str, column: &Column) {
        let step = column.step.map(|step| format!(", step {}", rounded(step))).unwrap_or_default();
        let range = format!("{} to {}{step}", rounded(column.smallest), rounded(column.largest));
        self.note(key, Certainty::Guessed, format!("\"{}\" runs from {range}", column.name));
    }

    fn wavelength_unit(&mut self, column: &Column) -> Option<WavelengthUnit> {
        if column.smallest > 0.0 && column.largest < 10.0 {
            self.note("wavelength_unit", Certainty::Guessed, "wavelengths below 10 are micrometres");
            return Some(WavelengthUnit::Um);
        }
        None
    }

    fn angle_unit(&mut self) -> Option<AngleUnit> {
        let inclinations: Vec<&Column> =
            [Role::ThetaI, Role::ThetaO].into_iter().filter_map(|role| self.find(role)).collect();
        let small = inclinations.iter().all(|column| column.largest <= FRAC_PI_2);
        if small && inclinations.iter().any(|column| column.fractional) {
            self.note("angle_unit", Certainty::Guessed, "no inclination is above π/2");
            return Some(AngleUnit::Radians);
        }
        None
    }

    fn sigma(&mut self) -> Option<SigmaLayout> {
        let column = self.find(Role::Sigma)?.name.clone();
        let text = format!(
            "\"{column}\" seems to hold standard deviations; if they are standard errors or ranges, convert them"
        );
        self.note("sigma", Certainty::Guessed, text);
        Some(SigmaLayout { column: Some(column), ..SigmaLayout::default() })
    }

    /// A column of 0 and 1 whose name speaks of keeping.
    fn only(&mut self) -> BTreeMap<String, Cell> {
        let Some(keep) = self.find(Role::Keep) else { return BTreeMap::new() };
        let flags = !keep.fractional && keep.smallest >= 0.0 && keep.largest <= 1.0 && keep.numbers == self.scan.rows;
        if !flags {
            return BTreeMap::new();
        }
        let (name, kept, rows) = (&keep.name, keep.ones, self.scan.rows);
        self.note("only", Certainty::Guessed, format!("\"{name}\" seems to mark the rows to keep: {kept} of {rows}"));
        BTreeMap::from([(keep.name.clone(), Cell::Number(1.0))])
    }

    /// What the readings mean, with everything that the columns do not decide.
    fn readings(&mut self, columns: SpectraColumns, values: &[&Column]) -> SpectraLayout {
        let names = values.iter().map(|column| column.name.to_lowercase()).collect::<Vec<_>>().join(" ");
        let largest = values.iter().map(|column| column.largest).fold(f64::NEG_INFINITY, f64::max);
        let negative: u64 = values.iter().map(|column| column.negative).sum();
        let quantity = if names.contains("cos") {
            Quantity::BsdfCos
        } else if names.contains("brdf") || names.contains("bsdf") || names.contains("btdf") {
            Quantity::Brdf
        } else {
            Quantity::Reflectance
        };
        let (certainty, text) = match quantity {
            Quantity::Reflectance => (Certainty::Guessed, "no name speaks of a BRDF; taken against a white standard"),
            _ => (Certainty::Guessed, "the column's name says so"),
        };
        self.note("quantity", certainty, text);
        let percent = (quantity == Quantity::Reflectance).then(|| {
            let named = names.contains("percent") || names.contains('%');
            let percent = named || largest > 3.0;
            let why = if named { "the column's name says so; " } else { "" };
            let unit = if percent { "percent" } else { "ratios" };
            let text = format!("{why}readings go up to {}, which are {unit}", rounded(largest));
            self.note("percent", Certainty::Guessed, text);
            percent
        });
        if negative > 0 {
            let text = format!(
                "{negative} readings are below 0: \"keep\" them if they are noise about dark readings, or correct the table"
            );
            self.note("negative", Certainty::Missing, text);
        }
        SpectraLayout {
            percent,
            angle_unit: self.angle_unit(),
            text: self.scan.format,
            ..SpectraLayout::new(quantity, columns)
        }
    }
}

/// Six digits, without the tail that binary fractions have.
fn rounded(number: f64) -> f64 {
    (number * 1e6).round() / 1e6
}
