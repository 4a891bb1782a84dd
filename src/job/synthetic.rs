//! Readings made from known values: the job run forward.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::case::spectra_problem;
use super::file::SyntheticFile;
use super::values::{checked, in_order};
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
    // A spectrum is named after its angle, and its gain after its name.
    let mut sorted = recipe.mirror_deg.clone();
    sorted.sort_by(f64::total_cmp);
    if let Some(pair) = sorted.windows(2).find(|pair| pair[0] >= pair[1]) {
        return Err(key("mirror_deg", format!("found {} twice; give each inclination once", pair[0])));
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
    let problem = spectra_problem(file, &table, &vec![true; table.spectra.len()])?;
    for (name, value) in &recipe.truth {
        checked(problem.parameters(), name, *value).map_err(|problem| key(&format!("truth.\"{name}\""), problem))?;
    }
    let exact = problem.readings(&in_order(problem.parameters(), &recipe.truth));
    for (spectrum, values) in table.spectra.iter_mut().zip(exact) {
        spectrum.values = values;
    }
    add_noise(&mut table, recipe.noise, recipe.seed);
    let mut sigmas = table.spectra.iter().flat_map(|spectrum| spectrum.sigmas.iter().flatten());
    if sigmas.any(|sigma| *sigma <= 0.0) {
        let problem = "the model reads 0 somewhere, and no share of 0 is a σ; choose a truth that reflects everywhere, \
                       or write 0";
        return Err(key("noise", problem.into()));
    }
    Ok(table)
}

/// Multiplies each reading by 1 + noise·z and notes σ = noise · |reading| as an instrument's maker would state it.
pub(super) fn add_noise(table: &mut GonioTable, noise: f64, seed: u64) {
    if noise <= 0.0 {
        return;
    }
    for (index, spectrum) in table.spectra.iter_mut().enumerate() {
        for (value, deviate) in spectrum.values.iter_mut().zip(deviates(seed, index)) {
            *value *= 1.0 + noise * deviate;
        }
        spectrum.sigmas = Some(spectrum.values.iter().map(|value| noise * value.abs()).collect());
    }
}

/// Standard normal deviates that belong to one item of a table, so that leaving one out changes no other.
pub(super) fn deviates(seed: u64, item: usize) -> impl Iterator<Item = f64> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    random.set_stream(item as u64);
    StandardNormal.sample_iter(random)
}
