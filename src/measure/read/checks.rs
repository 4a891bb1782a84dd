//! Units, ranges and uncertainties: what spectra and peaks have in common.

use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_2;
use std::path::Path;

use super::columns::WrittenAngles;
use crate::measure::Geometry;
use crate::measure::error::{Place, TableError, TableProblem};
use crate::measure::layout::{AngleUnit, SigmaLayout, WavelengthUnit};

/// Wavelengths that gonio instruments measure, nm: vacuum ultraviolet to the short-wave infrared.
const WAVELENGTHS_NM: (f64, f64) = (100.0, 3000.0);
/// Wavelengths all below this are micrometres: 10 nm is X-rays, and 10 µm is beyond any colour.
const LARGEST_MICROMETRES: f64 = 10.0;

/// What turns the file's wavelengths into nm.
pub(super) fn wavelength_factor(
    file: &Path,
    unit: Option<WavelengthUnit>,
    column: Option<&str>,
    wavelengths: impl Iterator<Item = f64>,
) -> Result<f64, TableError> {
    match unit {
        Some(WavelengthUnit::Nm) => return Ok(1.0),
        Some(WavelengthUnit::Um) => return Ok(1000.0),
        None => {}
    }
    let (from, to) = wavelengths
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(from, to), wavelength| (from.min(wavelength), to.max(wavelength)));
    // Of no wavelengths at all, `from` is infinite.
    if from > 0.0 && to < LARGEST_MICROMETRES && from <= to {
        let place = column.map_or(Place::File, |column| Place::Column(column.to_owned()));
        return Err(TableError::new(file, place, TableProblem::Micrometres { from, to }));
    }
    Ok(1.0)
}

/// A wavelength in nm, inside the range that can be.
pub(super) fn wavelength_nm(written: f64, factor: f64) -> Result<f64, TableProblem> {
    let (from, to) = WAVELENGTHS_NM;
    let found = written * factor;
    if written <= 0.0 {
        Err(TableProblem::WavelengthNotPositive { found: written })
    } else if !(from..=to).contains(&found) {
        Err(TableProblem::WavelengthRange { found, from, to })
    } else {
        Ok(found)
    }
}

/// The unit of the file's angles.
pub(super) fn angle_unit(
    file: &Path,
    unit: Option<AngleUnit>,
    angles: impl Iterator<Item = WrittenAngles>,
) -> Result<AngleUnit, TableError> {
    if let Some(unit) = unit {
        return Ok(unit);
    }
    let (mut largest, mut fractional) = (0.0_f64, false);
    for inclination in angles.flat_map(|angles| angles.inclinations()) {
        largest = largest.max(inclination.abs());
        fractional |= inclination.fract().abs() > 0.0;
    }
    // Whole numbers this small are degrees near the normal.
    if fractional && largest <= FRAC_PI_2 {
        return Err(TableError::new(file, Place::File, TableProblem::Radians { largest }));
    }
    Ok(AngleUnit::Degrees)
}

/// Checked angles, degrees.
pub(super) fn geometry(angles: WrittenAngles, unit: AngleUnit) -> Result<Geometry, TableProblem> {
    let degrees = |angle: f64| match unit {
        AngleUnit::Degrees => angle,
        AngleUnit::Radians => angle.to_degrees(),
    };
    let geometry = match angles {
        WrittenAngles::Mirror(theta) => Geometry::mirror(degrees(theta)),
        WrittenAngles::Four(angles) => {
            let [theta_i_deg, phi_i_deg, theta_o_deg, phi_o_deg] = angles.map(degrees);
            Geometry { theta_i_deg, phi_i_deg, theta_o_deg, phi_o_deg }
        }
        WrittenAngles::NotRecorded => Geometry::mirror(0.0),
    };
    // No cell gives NaN; a job that was made for its author to complete does.
    if [geometry.theta_i_deg, geometry.phi_i_deg, geometry.theta_o_deg, geometry.phi_o_deg].iter().any(|a| a.is_nan()) {
        return Err(TableProblem::AngleMissing);
    }
    for found in [geometry.theta_i_deg, geometry.theta_o_deg] {
        if !(0.0..90.0).contains(&found) {
            return Err(TableProblem::InclinationRange { found });
        }
    }
    for found in [geometry.phi_i_deg, geometry.phi_o_deg] {
        if !(-360.0..=360.0).contains(&found) {
            return Err(TableProblem::AzimuthRange { found });
        }
    }
    Ok(geometry)
}

/// Name of a spectrum or peak that has none in the table.
pub(super) fn name_of(angles: WrittenAngles, geometry: &Geometry) -> String {
    let Geometry { theta_i_deg, phi_i_deg, theta_o_deg, phi_o_deg } = geometry;
    match angles {
        WrittenAngles::Mirror(_) => format!("{theta_i_deg}°"),
        WrittenAngles::Four(_) => format!("θi {theta_i_deg}° φi {phi_i_deg}° θo {theta_o_deg}° φo {phi_o_deg}°"),
        WrittenAngles::NotRecorded => String::new(),
    }
}

/// Finds the second of two things at the same angles (and of the same order, where things have one).
pub(super) struct Seen {
    names: BTreeMap<(String, [u64; 4], u32), String>,
}

impl Seen {
    pub(super) fn new() -> Self {
        Self { names: BTreeMap::new() }
    }

    /// Takes note of it, unless it was seen. Things of two owners are never the same.
    pub(super) fn note(
        &mut self,
        owner: &str,
        geometry: &Geometry,
        order: u32,
        name: &str,
    ) -> Result<(), TableProblem> {
        // Adding 0 turns −0 into 0.
        let azimuth = |phi: f64| (phi.rem_euclid(360.0) + 0.0).to_bits();
        let inclination = |theta: f64| (theta + 0.0).to_bits();
        let key = [
            inclination(geometry.theta_i_deg),
            azimuth(geometry.phi_i_deg),
            inclination(geometry.theta_o_deg),
            azimuth(geometry.phi_o_deg),
        ];
        match self.names.insert((owner.to_owned(), key, order), name.to_owned()) {
            Some(first) => Err(TableProblem::GeometryTwice { first, second: name.to_owned() }),
            None => Ok(()),
        }
    }
}

/// Whether the job's σ makes sense.
pub(super) fn check_sigma(sigma: &SigmaLayout) -> Result<(), TableProblem> {
    for (key, part) in [("sigma.relative", sigma.relative), ("sigma.absolute", sigma.absolute)] {
        if let Some(part) = part
            && !(part.is_finite() && part > 0.0)
        {
            return Err(TableProblem::Key { key, found: part.to_string(), expected: "a number more than 0" });
        }
    }
    if *sigma == SigmaLayout::default() {
        let expected = "at least one of column, relative and absolute; leave `sigma` out where it is unknown";
        return Err(TableProblem::Key { key: "sigma", found: "empty".to_owned(), expected });
    }
    Ok(())
}

/// σ of a reading, both in the file's unit; `written` is the σ column's.
pub(super) fn sigma_of(sigma: &SigmaLayout, value: f64, written: Option<f64>) -> Result<f64, TableProblem> {
    if let Some(found) = written
        && found <= 0.0
    {
        return Err(TableProblem::SigmaNotPositive { found });
    }
    let relative = sigma.relative.map_or(0.0, |share| share * value);
    let found = written.unwrap_or(0.0).hypot(relative).hypot(sigma.absolute.unwrap_or(0.0));
    if found > 0.0 && found.is_finite() { Ok(found) } else { Err(TableProblem::SigmaNotPositive { found }) }
}
