//! A job run forward: the model's readings at the geometry of its table.

use super::case::Comparison;
use super::predict::readings_at;
use super::synthetic::{add_noise, deviates};
use super::values::{Values, checked};
use super::{Job, JobError};
use crate::fit::{Role, first_values};
use crate::measure::{Geometry, GonioTable};

/// Noise to add to simulated readings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Standard deviation as a share of each reading.
    pub share: f64,
    /// Seed of the random numbers.
    pub seed: u64,
}

/// The main case's readings as CSV: spectra as a long table with all four angles, peaks as a peak table.
///
/// Free parameters have their first starts, fixed ones their values, unless `set` says otherwise.
pub fn simulate(job: &Job, set: &Values, noise: Noise) -> Result<String, JobError> {
    if !(0.0..1.0).contains(&noise.share) {
        let problem = format!("found {}; expected a share of each reading from 0 to below 1", noise.share);
        return Err(JobError::Option { option: "--noise", problem });
    }
    let mut case = job.cases()?.0.swap_remove(0);
    for (name, &value) in set {
        let places = checked(case.residuals().parameters(), name, value)
            .map_err(|problem| JobError::Option { option: "--set", problem: format!("{name}: {problem}") })?;
        for index in places {
            case.assignments[index].role = Role::Fixed(value);
        }
    }
    let values = first_values(&case.assignments);
    match &case.comparison {
        Comparison::Spectra(table, _, _) => {
            let mut table: GonioTable = table.clone();
            let names = case.residuals().parameters().iter().map(|parameter| parameter.name.clone());
            let readings = readings_at(&case.file, &table, &names.zip(values).collect())?;
            for (spectrum, readings) in table.spectra.iter_mut().zip(readings) {
                spectrum.values = readings;
                spectrum.sigmas = None;
            }
            add_noise(&mut table, noise.share, noise.seed);
            Ok(spectra_csv(&table))
        }
        Comparison::Peaks(table, _, problem) => {
            let implied = problem.implied_order(&values);
            let with_sigma = noise.share > 0.0;
            let mut text = format!("{NAME_AND_ANGLES},peak_nm{}\n", if with_sigma { ",sigma_nm" } else { "" });
            for (item, reading) in table.readings.iter().enumerate() {
                let Some(exact_nm) = problem.peak_nm(&values, reading, implied) else {
                    let problem = format!("at these values the model has no peak for reading `{}`", reading.id);
                    return Err(JobError::key("parameters", problem));
                };
                let factor = deviates(noise.seed, item).next().map_or(1.0, |deviate| 1.0 + noise.share * deviate);
                let nm = exact_nm * factor;
                let sigma = if with_sigma { format!(",{}", noise.share * nm.abs()) } else { String::new() };
                text += &format!("{},{nm}{sigma}\n", name_and_angles(&reading.id, Some(&reading.geometry)));
            }
            Ok(text)
        }
    }
}

/// Columns of [`name_and_angles`].
const NAME_AND_ANGLES: &str = "id,theta_i_deg,phi_i_deg,theta_o_deg,phi_o_deg";

/// The first cells of a row, without the angles where nobody wrote them down. A name with a comma or a quotation mark in it
/// is put in quotation marks (RFC 4180).
fn name_and_angles(name: &str, geometry: Option<&Geometry>) -> String {
    let quoted = name.contains([',', '"']).then(|| format!("\"{}\"", name.replace('"', "\"\"")));
    let name = quoted.as_deref().unwrap_or(name);
    match geometry {
        Some(Geometry { theta_i_deg, phi_i_deg, theta_o_deg, phi_o_deg }) => {
            format!("{name},{theta_i_deg},{phi_i_deg},{theta_o_deg},{phi_o_deg}")
        }
        None => name.to_owned(),
    }
}

fn spectra_csv(table: &GonioTable) -> String {
    let value = table.quantity.column();
    let with_sigma = table.spectra.iter().all(|spectrum| spectrum.sigmas.is_some());
    let sigma_header = if with_sigma { ",sigma" } else { "" };
    let without_angles = table.spectra.iter().any(|spectrum| spectrum.origin.without_geometry);
    let first_columns = if without_angles { "id" } else { NAME_AND_ANGLES };
    let mut text = format!("{first_columns},wavelength_nm,{value}{sigma_header}\n");
    for spectrum in &table.spectra {
        let first_cells = name_and_angles(&spectrum.id, (!without_angles).then_some(&spectrum.geometry));
        for (index, (nm, reading)) in spectrum.wavelengths_nm.iter().zip(&spectrum.values).enumerate() {
            let sigma = spectrum.sigmas.as_ref().map_or_else(String::new, |sigmas| format!(",{}", sigmas[index]));
            text += &format!("{first_cells},{nm},{reading}{sigma}\n");
        }
    }
    text
}
