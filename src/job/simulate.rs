//! A job run forward: the model's readings at the geometry of its table.

use super::case::Comparison;
use super::predict::Values;
use super::synthetic::{add_noise, forward};
use super::{Job, JobError};
use crate::fit::Role;
use crate::measure::{GonioTable, Quantity, nearest};

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
    let case = job.cases()?.0.swap_remove(0);
    let declared = case.residuals().parameters();
    let refused = |problem: String| Err(JobError::Option { option: "--set", problem });
    for (name, value) in set {
        let Some(parameter) = declared.iter().find(|parameter| parameter.name == *name) else {
            let known: Vec<String> = declared.iter().map(|parameter| parameter.name.clone()).collect();
            let meant = nearest(name, &known).map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
            return refused(format!("there is no parameter `{name}`; this job has {}{meant}", known.join(", ")));
        };
        let (lower, upper) = (parameter.lower, parameter.upper);
        if !(lower..=upper).contains(value) {
            return refused(format!("found {name} = {value}; expected a value from {lower} to {upper}"));
        }
    }
    let start = |role: &Role| match role {
        Role::Free { start, .. } => *start,
        Role::Fixed(value) => *value,
        Role::Tied { .. } => f64::NAN,
    };
    let named = |index: usize| set.get(&declared[index].name).copied();
    let mut all: Vec<f64> = case.assignments.iter().map(|assignment| start(&assignment.role)).collect();
    for (index, value) in all.iter_mut().enumerate() {
        *value = named(index).unwrap_or(*value);
    }
    let free = all.clone();
    for (index, assignment) in case.assignments.iter().enumerate() {
        if let (Role::Tied { constant, terms }, None) = (&assignment.role, named(index)) {
            all[index] = constant + terms.iter().map(|(other, factor)| factor * free[*other]).sum::<f64>();
        }
    }
    match &case.comparison {
        Comparison::Spectra(table, _, _) => {
            let mut table: GonioTable = table.clone();
            let values = declared.iter().zip(&all).map(|(parameter, value)| (parameter.name.clone(), *value));
            let readings = forward(&case.file, &table, &values.collect())?;
            for (spectrum, readings) in table.spectra.iter_mut().zip(readings) {
                spectrum.values = readings;
                spectrum.sigmas = None;
            }
            add_noise(&mut table, noise.share, noise.seed);
            Ok(spectra_csv(&table))
        }
        Comparison::Peaks(table, _, problem) => {
            let implied = problem.implied_order(&all);
            let mut text = String::from("id,theta_i_deg,phi_i_deg,theta_o_deg,phi_o_deg,peak_nm\n");
            for reading in &table.readings {
                let Some(nm) = problem.peak_nm(&all, reading, implied) else {
                    let problem = format!("at these values the model has no peak for reading `{}`", reading.id);
                    return Err(JobError::key("parameters", problem));
                };
                let g = reading.geometry;
                text += &format!(
                    "{},{},{},{},{},{nm}\n",
                    reading.id, g.theta_i_deg, g.phi_i_deg, g.theta_o_deg, g.phi_o_deg
                );
            }
            Ok(text)
        }
    }
}

fn spectra_csv(table: &GonioTable) -> String {
    let value = match table.quantity {
        Quantity::Brdf => "brdf_per_sr",
        Quantity::BsdfCos => "bsdf_cos_per_sr",
        Quantity::Reflectance => "reflectance",
    };
    let with_sigma = table.spectra.iter().all(|spectrum| spectrum.sigmas.is_some());
    let sigma_header = if with_sigma { ",sigma" } else { "" };
    let mut text = format!("id,theta_i_deg,phi_i_deg,theta_o_deg,phi_o_deg,wavelength_nm,{value}{sigma_header}\n");
    for spectrum in &table.spectra {
        let g = spectrum.geometry;
        for (index, (nm, reading)) in spectrum.wavelengths_nm.iter().zip(&spectrum.values).enumerate() {
            let sigma = spectrum.sigmas.as_ref().map_or_else(String::new, |sigmas| format!(",{}", sigmas[index]));
            text += &format!(
                "{},{},{},{},{},{nm},{reading}{sigma}\n",
                spectrum.id, g.theta_i_deg, g.phi_i_deg, g.theta_o_deg, g.phi_o_deg
            );
        }
    }
    text
}
