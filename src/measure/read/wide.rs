//! Wide tables: one row a wavelength, one column a spectrum.

use super::columns::{WrittenAngles, at};
use super::spectra::{Owner, Written, WrittenReading, WrittenSpectrum};
use crate::measure::Geometry;
use crate::measure::error::{Place, TableError, TableProblem};
use crate::measure::layout::{PerColumn, WideAngles, WideColumns};
use crate::measure::text::Rows;

/// The spectra as they stand in the file, in the order of their columns.
pub(super) fn collect(mut rows: Rows<'_>, columns: &WideColumns) -> Result<Written, TableError> {
    let file = rows.file;
    let wavelength_column = rows.column(&columns.wavelength)?;
    let spectrum_columns = spectrum_columns(&rows, wavelength_column)?;
    let wanted = match &columns.angles {
        WideAngles::Mirror(angles) => assign(angles, &rows, &spectrum_columns, |theta| WrittenAngles::Mirror(*theta))?,
        WideAngles::Four(geometries) => assign(geometries, &rows, &spectrum_columns, four)?,
        WideAngles::NotRecorded => {
            spectrum_columns.iter().map(|&column| (column, WrittenAngles::NotRecorded)).collect()
        }
    };
    let wanted = match &columns.starts_with {
        Some(prefix) => starting_with(prefix, wanted, &rows)?,
        None => wanted,
    };
    let mut spectra: Vec<WrittenSpectrum> = wanted
        .iter()
        .map(|&(column, angles)| WrittenSpectrum {
            id: Some(rows.columns[column].clone()),
            owner: Owner::default(),
            angles,
            place: Place::Column(rows.columns[column].clone()),
            first_line: 0,
            value_column: rows.columns[column].clone(),
            readings: Vec::new(),
        })
        .collect();
    let mut count = 0;
    while let Some(row) = rows.next()? {
        count += 1;
        let wavelength =
            row.number(wavelength_column).map_err(|problem| at(file, &row, Some(wavelength_column), problem))?;
        for (spectrum, (column, _)) in spectra.iter_mut().zip(&wanted) {
            let value = row.number(*column).map_err(Box::new);
            spectrum.readings.push(WrittenReading { line: row.line, wavelength, value, sigma: None });
        }
    }
    let wavelength_column = Some(columns.wavelength.clone());
    Ok(Written { spectra, wavelength_column, sigma_column: None, rows: count, left_out: 0 })
}

/// All columns but the wavelengths and R's row numbers.
fn spectrum_columns(rows: &Rows<'_>, wavelength_column: usize) -> Result<Vec<usize>, TableError> {
    let mut places = Vec::new();
    for (index, name) in rows.columns.iter().enumerate() {
        if index == wavelength_column || (index == 0 && name.is_empty()) {
            continue;
        }
        if name.is_empty() {
            let problem = TableProblem::ColumnNameless { number: index + 1 };
            return Err(TableError::new(rows.file, Place::Line(1), problem));
        }
        // Looked up by its name, so that a name that stands twice is found.
        places.push(rows.column(name)?);
    }
    Ok(places)
}

/// Those whose names start so.
fn starting_with(
    prefix: &str,
    wanted: Vec<(usize, WrittenAngles)>,
    rows: &Rows<'_>,
) -> Result<Vec<(usize, WrittenAngles)>, TableError> {
    let names: Vec<String> = wanted.iter().map(|(column, _)| rows.columns[*column].clone()).collect();
    let kept: Vec<_> = wanted.into_iter().filter(|(column, _)| rows.columns[*column].starts_with(prefix)).collect();
    if kept.is_empty() {
        let problem = TableProblem::NothingStartsWith { prefix: prefix.to_owned(), columns: names };
        return Err(TableError::new(rows.file, Place::Line(1), problem));
    }
    Ok(kept)
}

/// The columns that the job wants, in the order of the file, with their angles.
fn assign<T>(
    angles: &PerColumn<T>,
    rows: &Rows<'_>,
    spectrum_columns: &[usize],
    written: impl Fn(&T) -> WrittenAngles,
) -> Result<Vec<(usize, WrittenAngles)>, TableError> {
    match angles {
        PerColumn::InOrder(list) if list.len() == spectrum_columns.len() => {
            Ok(spectrum_columns.iter().copied().zip(list.iter().map(written)).collect())
        }
        PerColumn::InOrder(list) => {
            let columns = spectrum_columns.iter().map(|&column| rows.columns[column].clone()).collect();
            Err(TableError::new(rows.file, Place::Line(1), TableProblem::AngleCount { found: list.len(), columns }))
        }
        PerColumn::ByName(table) => {
            let mut wanted = table
                .iter()
                .map(|(name, angles)| Ok((rows.column(name)?, written(angles))))
                .collect::<Result<Vec<_>, TableError>>()?;
            wanted.sort_by_key(|(column, _)| *column);
            Ok(wanted)
        }
    }
}

fn four(geometry: &Geometry) -> WrittenAngles {
    WrittenAngles::Four([geometry.theta_i_deg, geometry.phi_i_deg, geometry.theta_o_deg, geometry.phi_o_deg])
}
