//! Readings made from known values: the job run forward.

use std::collections::BTreeMap;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::case::spectra_problem;
use super::file::SyntheticFile;
use super::{JobError, JobFile};
use crate::fit::Residuals;
use crate::measure::{Geometry, GonioTable, Spectrum};

/// Most readings a synthetic table may have.
const LARGEST_TABLE: f64 = 1e7;

/// Readings of the recipe, noise included.
pub(super) fn readings(recipe: &SyntheticFile, file: &JobFile) -> Result<GonioTable, JobError> {
    let key = |name: &str, problem: String| JobError::key(format!("data.synthetic.{name}"), problem);
    let [first_nm, last_nm] = recipe.window_nm;
    // The small addition keeps a last wavelength that rounding would lose.
    let count = ((last_nm - first_nm) / recipe.step_nm + 1e-9).floor() + 1.0;
    if !(first_nm > 0.0 && recipe.step_nm > 0.0 && last_nm > first_nm && count.is_finite()) {
        let found = format!("found {first_nm} to {last_nm} in steps of {}", recipe.step_nm);
        return Err(key("window_nm", format!("{found}; expected a rising range above 0 and a step above 0")));
    }
    if count * f64::from(u32::try_from(recipe.mirror_deg.len()).unwrap_or(u32::MAX)) > LARGEST_TABLE {
        return Err(key("step_nm", format!("this makes more than {LARGEST_TABLE:e} readings; take a larger step")));
    }
    if recipe.mirror_deg.is_empty() {
        return Err(key("mirror_deg", "the list is empty; give at least one inclination".into()));
    }
    if let Some(angle) = recipe.mirror_deg.iter().find(|angle| !(0.0..90.0).contains(*angle)) {
        return Err(key("mirror_deg", format!("found {angle}; expected inclinations from 0 to below 90 degrees")));
    }
    if !(0.0..1.0).contains(&recipe.noise) {
        return Err(key(
            "noise",
            format!("found {}; expected a share of each reading from 0 to below 1", recipe.noise),
        ));
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "bounded by LARGEST_TABLE above")]
    let wavelengths_nm: Vec<f64> = (0..count as u32).map(|step| first_nm + recipe.step_nm * f64::from(step)).collect();
    let spectra = recipe
        .mirror_deg
        .iter()
        .map(|angle| Spectrum {
            id: format!("{angle}°"),
            geometry: Geometry::mirror(*angle),
            values: vec![0.0; wavelengths_nm.len()],
            wavelengths_nm: wavelengths_nm.clone(),
            sigmas: None,
        })
        .collect();
    let mut table = GonioTable { quantity: recipe.quantity, spectra };
    let exact = forward(file, &table, &recipe.truth).map_err(|error| match error {
        JobError::Key { key, problem } if key.starts_with("truth") => {
            JobError::key(format!("data.synthetic.{key}"), problem)
        }
        other => other,
    })?;
    for (spectrum, values) in table.spectra.iter_mut().zip(exact) {
        spectrum.values = values;
    }
    add_noise(&mut table, recipe.noise, recipe.seed);
    Ok(table)
}

/// The model's readings at the geometry of a table, with these parameter values and the defaults for the rest.
pub(super) fn forward(
    file: &JobFile,
    table: &GonioTable,
    values: &BTreeMap<String, f64>,
) -> Result<Vec<Vec<f64>>, JobError> {
    let problem = spectra_problem(file, table, &vec![true; table.spectra.len()])?;
    let declared = problem.parameters();
    for (name, value) in values {
        let Some(parameter) = declared.iter().find(|parameter| parameter.name == *name) else {
            let known: Vec<&str> = declared.iter().map(|parameter| parameter.name.as_str()).collect();
            let problem = format!("this model has no such parameter; it has {}", known.join(", "));
            return Err(JobError::key(format!("truth.\"{name}\""), problem));
        };
        if !(parameter.lower..=parameter.upper).contains(value) {
            let problem = format!("found {value}; expected a value from {} to {}", parameter.lower, parameter.upper);
            return Err(JobError::key(format!("truth.\"{name}\""), problem));
        }
    }
    let all: Vec<f64> = declared.iter().map(|p| values.get(&p.name).copied().unwrap_or(p.default)).collect();
    Ok(problem.readings(&all))
}

/// Multiplies each reading by 1 + noise·z and notes σ = noise · reading as an instrument's maker would state it. The
/// random numbers belong to the spectrum, so that leaving one out changes no other.
pub(super) fn add_noise(table: &mut GonioTable, noise: f64, seed: u64) {
    if noise <= 0.0 {
        return;
    }
    for (index, spectrum) in table.spectra.iter_mut().enumerate() {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        random.set_stream(index as u64);
        for value in &mut spectrum.values {
            let deviate: f64 = StandardNormal.sample(&mut random);
            *value *= 1.0 + noise * deviate;
        }
        spectrum.sigmas = Some(spectrum.values.iter().map(|value| noise * value).collect());
    }
}
