//! Long tables: one row a reading. Rows of a spectrum need not stand together; their order within it is checked later.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use super::columns::{AnglesOf, Number, Only, at};
use super::spectra::{Owner, Written, WrittenReading, WrittenSpectrum};
use crate::measure::error::{TableError, TableProblem};
use crate::measure::layout::{LongColumns, SpectraLayout};
use crate::measure::text::Rows;

/// The spectra as they stand in the file, in the order of their first rows.
pub(super) fn collect(
    mut rows: Rows<'_>,
    layout: &SpectraLayout,
    columns: &LongColumns,
) -> Result<Written, TableError> {
    let file = rows.file;
    let angles_of = AnglesOf::find(&columns.angles, &rows)?;
    let wavelength_of = Number::find(&columns.wavelength, &rows)?;
    let value_column = rows.column(&columns.value)?;
    let sigma_name = layout.sigma.as_ref().and_then(|sigma| sigma.column.clone());
    let sigma_column = sigma_name.as_deref().map(|name| rows.column(name)).transpose()?;
    let id_column = columns.id.as_deref().map(|name| rows.column(name)).transpose()?;
    let specimen_column = columns.specimen.as_deref().map(|name| rows.column(name)).transpose()?;
    let group_columns = columns.group.iter().map(|name| rows.column(name)).collect::<Result<Vec<_>, _>>()?;
    let only = Only::find(&layout.only, &rows)?;

    let mut written = Written {
        spectra: Vec::new(),
        wavelength_column: wavelength_of.column().map(|column| rows.columns[column].clone()),
        sigma_column: sigma_name,
        rows: 0,
        left_out: 0,
    };
    // A spectrum is known by its owner and its name, or its angles where the table has no name for it.
    let mut known: BTreeMap<(Owner, Option<String>, [u64; 4]), usize> = BTreeMap::new();
    while let Some(row) = rows.next()? {
        written.rows += 1;
        if !only.keeps(&row) {
            written.left_out += 1;
            continue;
        }
        let angles = angles_of.of(&row, file)?;
        let wavelength = wavelength_of.of(&row).map_err(|problem| at(file, &row, wavelength_of.column(), problem))?;
        let id = id_column.map(|column| row.text(column).to_owned());
        let groups: Vec<&str> = group_columns.iter().map(|&column| row.text(column)).collect();
        let owner =
            Owner { specimen: specimen_column.map(|column| row.text(column).to_owned()), group: groups.join(" ") };
        let key = (owner.clone(), id.clone(), if id.is_some() { [0; 4] } else { angles.bits() });
        let index = match known.entry(key) {
            Entry::Occupied(entry) => *entry.get(),
            Entry::Vacant(entry) => {
                let angle_column = match &angles_of {
                    AnglesOf::Mirror(theta) => theta.column(),
                    AnglesOf::Four(_) | AnglesOf::NotRecorded => None,
                };
                let place = at(file, &row, angle_column, TableProblem::EmptyCell).place;
                let value_column = columns.value.clone();
                let first_line = row.line;
                let readings = Vec::new();
                written.spectra.push(WrittenSpectrum { id, owner, angles, place, first_line, value_column, readings });
                *entry.insert(written.spectra.len() - 1)
            }
        };
        let spectrum = &mut written.spectra[index];
        // Compared by their bits, since angles that a job leaves open are NaN.
        if spectrum.angles.bits() != angles.bits() {
            let id = spectrum.id.clone().unwrap_or_default();
            let problem = TableProblem::IdWithTwoGeometries { id, first_line: spectrum.first_line };
            return Err(at(file, &row, id_column, problem));
        }
        spectrum.readings.push(WrittenReading {
            line: row.line,
            wavelength,
            value: row.number(value_column).map_err(Box::new),
            sigma: sigma_column.map(|column| row.number(column).map_err(Box::new)),
        });
    }
    Ok(written)
}
