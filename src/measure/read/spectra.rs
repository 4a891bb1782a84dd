//! Spectra as they stand in a file become checked spectra.

use std::path::Path;

use super::average::averaged;
use super::columns::WrittenAngles;
use super::{checks, long, wide};
use crate::measure::Geometry;
use crate::measure::error::{Place, TableError, TableProblem};
use crate::measure::layout::{AngleUnit, Negative, SpectraColumns, SpectraLayout};
use crate::measure::table::{GonioTable, Origin, Quantity, Spectrum};
use crate::measure::text::TableText;

/// Ratios to a white standard above this are percents. A mirror-like sample may well send more light into a small
/// detector than a white one; three times as much has to be said on purpose.
const LARGEST_RATIO: f64 = 3.0;

/// A table of spectra before units and order have been looked at.
pub(super) struct Written {
    pub(super) spectra: Vec<WrittenSpectrum>,
    /// None where the job gives one wavelength for all.
    pub(super) wavelength_column: Option<String>,
    pub(super) sigma_column: Option<String>,
    /// Rows in the file, and how many of them the job's `only` leaves out.
    pub(super) rows: u64,
    pub(super) left_out: u64,
}

/// Whose a spectrum is, as the table's columns say.
#[derive(Debug, Clone, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Owner {
    pub(super) specimen: Option<String>,
    /// Empty where the table has no such columns.
    pub(super) group: String,
}

pub(super) struct WrittenSpectrum {
    /// None where the table names no spectra.
    pub(super) id: Option<String>,
    pub(super) owner: Owner,
    pub(super) angles: WrittenAngles,
    /// Where its angles stand.
    pub(super) place: Place,
    pub(super) first_line: u64,
    pub(super) value_column: String,
    pub(super) readings: Vec<WrittenReading>,
}

/// A cell that is no number matters only if the job's window keeps it: instruments leave the ends of a range empty.
type WrittenNumber = Result<f64, Box<TableProblem>>;

pub(super) struct WrittenReading {
    pub(super) line: u64,
    pub(super) wavelength: f64,
    pub(super) value: WrittenNumber,
    /// None where the table has no column for it.
    pub(super) sigma: Option<WrittenNumber>,
}

/// A reading with its wavelength in nm, its value and σ still in the file's unit.
struct Reading {
    line: u64,
    wavelength_nm: f64,
    value: f64,
    sigma: Option<f64>,
}

/// Reads and checks a table of spectra.
pub(super) fn read_spectra(text: &TableText, layout: &SpectraLayout) -> Result<GonioTable, TableError> {
    let path = &text.file;
    check_keys(layout).map_err(|problem| TableError::new(path, Place::File, problem))?;
    let rows = text.rows(layout.text)?;
    let written = match &layout.columns {
        SpectraColumns::Long(columns) => long::collect(rows, layout, columns)?,
        SpectraColumns::Wide(columns) => wide::collect(rows, columns)?,
    };
    if written.rows == 0 {
        return Err(TableError::new(path, Place::File, TableProblem::HeaderOnly));
    }
    Checker { file: path, layout, written: &written }.check()
}

fn check_keys(layout: &SpectraLayout) -> Result<(), TableProblem> {
    if let Some([from, to]) = layout.window_nm
        && !(from.is_finite() && to.is_finite() && from < to)
    {
        let expected = "[first, last], the first below the last";
        return Err(TableProblem::Key { key: "window_nm", found: format!("[{from}, {to}]"), expected });
    }
    if layout.stride == 0 {
        return Err(TableProblem::Key { key: "stride", found: "0".to_owned(), expected: "1 or more" });
    }
    if layout.percent == Some(true) && layout.quantity != Quantity::Reflectance {
        let expected = "left out, since only a reflectance is measured in percent";
        return Err(TableProblem::Key { key: "percent", found: "true".to_owned(), expected });
    }
    if let Some(sigma) = &layout.sigma {
        checks::check_sigma(sigma)?;
    }
    if let Some(count) = layout.average_of {
        if count < 2 {
            return Err(TableProblem::Key { key: "average_of", found: count.to_string(), expected: "2 or more" });
        }
        if layout.sigma.is_some() {
            let expected = "left out, since `average_of` takes σ from the scatter of the readings";
            return Err(TableProblem::Key { key: "sigma", found: "given".to_owned(), expected });
        }
    }
    if matches!(layout.columns, SpectraColumns::Wide(_)) {
        if !layout.only.is_empty() {
            let expected = "left out, since a row of a wide table holds one wavelength of all spectra; \
                            name the columns wanted under `angles`";
            return Err(TableProblem::Key { key: "only", found: "given".to_owned(), expected });
        }
        if layout.sigma.as_ref().is_some_and(|sigma| sigma.column.is_some()) {
            let expected = "left out, since a wide table has one column a spectrum; give relative or absolute";
            return Err(TableProblem::Key { key: "sigma.column", found: "given".to_owned(), expected });
        }
    }
    Ok(())
}

struct Checker<'a> {
    file: &'a Path,
    layout: &'a SpectraLayout,
    written: &'a Written,
}

impl Checker<'_> {
    fn check(&self) -> Result<GonioTable, TableError> {
        let spectra = &self.written.spectra;
        let wavelengths = spectra.iter().flat_map(|spectrum| &spectrum.readings).map(|reading| reading.wavelength);
        let column = self.written.wavelength_column.as_deref();
        let factor = checks::wavelength_factor(self.file, self.layout.wavelength_unit, column, wavelengths)?;
        let unit = checks::angle_unit(self.file, self.layout.angle_unit, spectra.iter().map(|one| one.angles))?;

        if spectra.is_empty() {
            let Written { rows, left_out, .. } = *self.written;
            let problem = TableProblem::NothingLeft { rows, by_only: left_out, by_window: 0, by_negative: 0 };
            return Err(TableError::new(self.file, Place::File, problem));
        }
        let mut seen = checks::Seen::new();
        let checked = spectra.iter().map(|spectrum| {
            let checked = self.spectrum(spectrum, factor, unit)?;
            if !self.layout.replicates && self.layout.average_of.is_none() && !checked.origin.without_geometry {
                let owner = format!("{}/{:?}", checked.origin.group, checked.origin.specimen);
                let noted = seen.note(&owner, &checked.geometry, 0, &checked.id);
                noted.map_err(|problem| TableError::new(self.file, spectrum.place.clone(), problem))?;
            }
            Ok(checked)
        });
        let mut spectra: Vec<Spectrum> = checked.collect::<Result<_, _>>()?;
        if let Some(count) = self.layout.average_of {
            spectra = averaged(&spectra, count).map_err(|problem| TableError::new(self.file, Place::File, problem))?;
        }
        Ok(GonioTable { quantity: self.layout.quantity, spectra })
    }

    /// The name of a spectrum: group, specimen, and its own name or its angles, as far as the table has them.
    fn name(&self, spectrum: &WrittenSpectrum, geometry: &Geometry) -> String {
        let Owner { specimen, group } = &spectrum.owner;
        let own = spectrum.id.clone().unwrap_or_else(|| checks::name_of(spectrum.angles, geometry));
        let parts = [group.as_str(), specimen.as_deref().unwrap_or_default(), &own];
        let name = parts.iter().filter(|part| !part.is_empty()).copied().collect::<Vec<_>>().join(" ");
        if name.is_empty() { "the spectrum".to_owned() } else { name }
    }

    fn spectrum(&self, spectrum: &WrittenSpectrum, factor: f64, unit: AngleUnit) -> Result<Spectrum, TableError> {
        let refuse = |problem| TableError::new(self.file, spectrum.place.clone(), problem);
        let geometry = checks::geometry(spectrum.angles, unit).map_err(refuse)?;
        let id = self.name(spectrum, &geometry);
        let wavelengths_nm = self.wavelengths_nm(spectrum, factor)?;
        self.check_order(spectrum, &wavelengths_nm, &id)?;

        let inside = self.in_window(spectrum, &wavelengths_nm)?;
        let outside = wavelengths_nm.len() - inside.len();
        let thinned: Vec<Reading> = inside.into_iter().step_by(self.layout.stride).collect();
        let thinned_count = thinned.len();
        let dropped = |reading: &Reading| self.layout.negative == Negative::Drop && reading.value < 0.0;
        let readings: Vec<Reading> = thinned.into_iter().filter(|reading| !dropped(reading)).collect();
        if readings.is_empty() {
            let (rows, by_window, by_negative) = (wavelengths_nm.len() as u64, outside as u64, thinned_count as u64);
            return Err(refuse(TableProblem::NothingLeft { rows, by_only: 0, by_window, by_negative }));
        }
        let sigmas = self.sigmas(&readings)?;
        let scale = if self.layout.percent == Some(true) { 0.01 } else { 1.0 };
        Ok(Spectrum {
            id,
            geometry,
            origin: Origin {
                specimen: spectrum.owner.specimen.clone(),
                group: spectrum.owner.group.clone(),
                without_geometry: matches!(spectrum.angles, WrittenAngles::NotRecorded),
            },
            wavelengths_nm: readings.iter().map(|reading| reading.wavelength_nm).collect(),
            values: readings.iter().map(|reading| reading.value * scale).collect(),
            sigmas: sigmas.map(|sigmas| sigmas.iter().map(|sigma| sigma * scale).collect()),
        })
    }

    fn wavelengths_nm(&self, spectrum: &WrittenSpectrum, factor: f64) -> Result<Vec<f64>, TableError> {
        let convert = |reading: &WrittenReading| {
            checks::wavelength_nm(reading.wavelength, factor)
                .map_err(|problem| TableError::new(self.file, self.wavelength_place(reading.line), problem))
        };
        spectrum.readings.iter().map(convert).collect()
    }

    /// Wavelengths must rise throughout, or fall throughout: some instruments scan downwards, and that hides nothing.
    fn check_order(&self, spectrum: &WrittenSpectrum, wavelengths_nm: &[f64], id: &str) -> Result<(), TableError> {
        let falls = wavelengths_nm.len() > 1 && wavelengths_nm[1] < wavelengths_nm[0];
        for (index, pair) in wavelengths_nm.windows(2).enumerate() {
            let (previous_nm, found_nm) = (pair[0], pair[1]);
            if (found_nm > previous_nm && !falls) || (found_nm < previous_nm && falls) {
                continue;
            }
            let spectrum_name =
                if spectrum.id.is_some() { format!("spectrum \"{id}\"") } else { format!("the spectrum at {id}") };
            // The same wavelength anywhere before says more than the broken order does.
            let twin = wavelengths_nm[..=index].iter().position(|earlier| earlier.total_cmp(&found_nm).is_eq());
            let problem = match twin {
                Some(twin) => TableProblem::ReadingTwice {
                    wavelength_nm: found_nm,
                    spectrum: spectrum_name,
                    first_line: spectrum.readings[twin].line,
                },
                None => TableProblem::Unsorted { found_nm, previous_nm, spectrum: spectrum_name },
            };
            let place = self.wavelength_place(spectrum.readings[index + 1].line);
            return Err(TableError::new(self.file, place, problem));
        }
        Ok(())
    }

    /// The readings inside the job's window, by rising wavelength.
    fn in_window(&self, spectrum: &WrittenSpectrum, wavelengths_nm: &[f64]) -> Result<Vec<Reading>, TableError> {
        let inside = |wavelength_nm: f64| match self.layout.window_nm {
            Some([from, to]) => (from..=to).contains(&wavelength_nm),
            None => true,
        };
        let mut readings = Vec::new();
        for (written, &wavelength_nm) in spectrum.readings.iter().zip(wavelengths_nm) {
            if !inside(wavelength_nm) {
                continue;
            }
            let place = |column: &str| Place::Cell { line: written.line, column: column.to_owned() };
            let value = self.number(&written.value, || place(&spectrum.value_column))?;
            self.check_value(value)
                .map_err(|problem| TableError::new(self.file, place(&spectrum.value_column), problem))?;
            let sigma_column = self.written.sigma_column.as_deref().unwrap_or_default();
            let sigma = written.sigma.as_ref().map(|sigma| self.number(sigma, || place(sigma_column))).transpose()?;
            readings.push(Reading { line: written.line, wavelength_nm, value, sigma });
        }
        if wavelengths_nm.len() > 1 && wavelengths_nm[1] < wavelengths_nm[0] {
            readings.reverse();
        }
        Ok(readings)
    }

    fn check_value(&self, found: f64) -> Result<(), TableProblem> {
        if found < 0.0 && self.layout.negative == Negative::Refuse {
            return Err(TableProblem::NegativeReading { found });
        }
        let unit_known = self.layout.quantity != Quantity::Reflectance || self.layout.percent.is_some();
        if found > LARGEST_RATIO && !unit_known {
            return Err(TableProblem::Percent { found });
        }
        Ok(())
    }

    fn sigmas(&self, readings: &[Reading]) -> Result<Option<Vec<f64>>, TableError> {
        let Some(layout) = &self.layout.sigma else { return Ok(None) };
        let sigma = |reading: &Reading| {
            checks::sigma_of(layout, reading.value, reading.sigma)
                .map_err(|problem| TableError::new(self.file, Place::Line(reading.line), problem))
        };
        readings.iter().map(sigma).collect::<Result<_, _>>().map(Some)
    }

    fn number(&self, written: &WrittenNumber, place: impl Fn() -> Place) -> Result<f64, TableError> {
        written.clone().map_err(|problem| TableError::new(self.file, place(), *problem))
    }

    fn wavelength_place(&self, line: u64) -> Place {
        match &self.written.wavelength_column {
            Some(column) => Place::Cell { line, column: column.clone() },
            None => Place::Line(line),
        }
    }
}
