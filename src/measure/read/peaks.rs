//! Peak tables: one row a peak.

use std::path::Path;

use super::checks::{self, Seen};
use super::columns::{AnglesOf, Only, WrittenAngles, at};
use crate::measure::error::{Place, TableError, TableProblem};
use crate::measure::layout::{Angles, PeaksLayout};
use crate::measure::table::{PeakReading, PeakTable};
use crate::measure::text::{Row, TableText};

/// Orders above this are slips: a film with a hundred maxima in view is 30 µm thick.
const LARGEST_ORDER: f64 = 100.0;

/// A row as it stands in the file.
struct WrittenPeak {
    line: u64,
    id: Option<String>,
    angles: WrittenAngles,
    wavelength: f64,
    sigma: Option<f64>,
    order: Option<u32>,
}

/// Reads and checks a peak table.
pub(super) fn read_peaks(text: &TableText, layout: &PeaksLayout) -> Result<PeakTable, TableError> {
    let path = &text.file;
    if layout.angles == Angles::NotRecorded {
        let expected = "the angles, without which a peak's wavelength says little; or the whole spectra";
        let problem = TableProblem::Key { key: "angles", found: "\"not_recorded\"".to_owned(), expected };
        return Err(TableError::new(path, Place::File, problem));
    }
    if let Some(sigma) = &layout.sigma {
        checks::check_sigma(sigma).map_err(|problem| TableError::new(path, Place::File, problem))?;
    }
    let peaks = collect(text, layout)?;
    let wavelengths = peaks.iter().map(|peak| peak.wavelength);
    let factor = checks::wavelength_factor(path, layout.wavelength_unit, Some(&layout.wavelength), wavelengths)?;
    let unit = checks::angle_unit(path, layout.angle_unit, peaks.iter().map(|peak| peak.angles))?;

    let mut seen = Seen::new();
    let mut readings = Vec::with_capacity(peaks.len());
    for peak in peaks {
        let line = peak.line;
        let refuse = |problem| TableError::new(path, Place::Line(line), problem);
        let wavelength_nm = checks::wavelength_nm(peak.wavelength, factor).map_err(|problem| {
            TableError::new(path, Place::Cell { line, column: layout.wavelength.clone() }, problem)
        })?;
        let geometry = checks::geometry(peak.angles, unit).map_err(refuse)?;
        let id = peak.id.unwrap_or_else(|| checks::name_of(peak.angles, &geometry));
        if !layout.replicates {
            seen.note("", &geometry, peak.order.unwrap_or(0), &format!("the peak \"{id}\"")).map_err(refuse)?;
        }
        let sigma = layout.sigma.as_ref().map(|sigma| checks::sigma_of(sigma, peak.wavelength, peak.sigma)).transpose();
        let sigma_nm = sigma.map_err(refuse)?.map(|sigma| sigma * factor);
        readings.push(PeakReading { id, geometry, wavelength_nm, sigma_nm, order: peak.order });
    }
    Ok(PeakTable { readings })
}

fn collect(text: &TableText, layout: &PeaksLayout) -> Result<Vec<WrittenPeak>, TableError> {
    let path = &text.file;
    let mut rows = text.rows(layout.text)?;
    let angles_of = AnglesOf::find(&layout.angles, &rows)?;
    let wavelength_column = rows.column(&layout.wavelength)?;
    let find = |name: Option<&String>| name.map(|name| rows.column(name)).transpose();
    let sigma_column = find(layout.sigma.as_ref().and_then(|sigma| sigma.column.as_ref()))?;
    let order_column = find(layout.order.as_ref())?;
    let id_column = find(layout.id.as_ref())?;
    let only = Only::find(&layout.only, &rows)?;

    let (mut count, mut peaks) = (0, Vec::new());
    while let Some(row) = rows.next()? {
        count += 1;
        if !only.keeps(&row) {
            continue;
        }
        let number = |column| row.number(column).map_err(|problem| at(path, &row, Some(column), problem));
        peaks.push(WrittenPeak {
            line: row.line,
            id: id_column.map(|column| row.text(column).to_owned()),
            angles: angles_of.of(&row, path)?,
            wavelength: number(wavelength_column)?,
            sigma: sigma_column.map(number).transpose()?,
            order: order_column.map(|column| order(path, &row, column)).transpose()?,
        });
    }
    match (count, peaks.len()) {
        (0, _) => Err(TableError::new(path, Place::File, TableProblem::HeaderOnly)),
        (rows, 0) => {
            let problem = TableProblem::NothingLeft { rows, by_only: rows, by_window: 0, by_negative: 0 };
            Err(TableError::new(path, Place::File, problem))
        }
        _ => Ok(peaks),
    }
}

fn order(path: &Path, row: &Row<'_>, column: usize) -> Result<u32, TableError> {
    let refuse = |problem| at(path, row, Some(column), problem);
    let found = row.number(column).map_err(refuse)?;
    if found.fract().abs() > 0.0 || !(1.0..=LARGEST_ORDER).contains(&found) {
        return Err(refuse(TableProblem::Order { found }));
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a whole number from 1 to 100")]
    let order = found as u32;
    Ok(order)
}
