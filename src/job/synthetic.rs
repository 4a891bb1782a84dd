//! Readings made from known values: the job run forward.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::case::spectra_problem;
use super::file::SyntheticFile;
use super::values::{checked, in_order};
use super::{JobError, JobFile};
use crate::fit::Residuals;
use crate::measure::{Geometry, GonioTable, Origin, Spectrum};

/// Most readings a synthetic table may have.
const LARGEST_TABLE: f64 = 1e7;

/// Readings of the recipe, noise included.
pub(super) fn readings(recipe: &SyntheticFile, file: &JobFile) -> Result<GonioTable, JobError> {
    let wavelengths_nm = wavelengths_nm(recipe)?;
    let geometries = geometries(recipe)?;
    if as_f64(wavelengths_nm.len()) * as_f64(geometries.len()) > LARGEST_TABLE {
        return Err(key("step_nm", format!("this makes more than {LARGEST_TABLE:e} readings; take a larger step")));
    }
    if !(0.0..1.0).contains(&recipe.noise) {
        return Err(key(
            "noise",
            format!("found {}; expected a share of each reading from 0 to below 1", recipe.noise),
        ));
    }
    let spectra = geometries
        .into_iter()
        .map(|(id, geometry)| Spectrum {
            id,
            geometry,
            origin: Origin::default(),
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

/// The error of a key in the recipe's section.
fn key(name: &str, problem: String) -> JobError {
    JobError::key(format!("data.synthetic.{name}"), problem)
}

/// The recipe's wavelengths, however it gives them.
fn wavelengths_nm(recipe: &SyntheticFile) -> Result<Vec<f64>, JobError> {
    match (&recipe.wavelengths_nm, recipe.window_nm, recipe.step_nm) {
        (Some(list), None, None) => {
            let is_wrong = |nm: &&f64| !nm.is_finite() || **nm <= 0.0;
            if let Some(found) = list.iter().find(is_wrong) {
                return Err(key("wavelengths_nm", format!("found {found}; expected wavelengths above 0")));
            }
            if list.is_empty() {
                return Err(key("wavelengths_nm", "the list is empty; give at least one wavelength".into()));
            }
            if let Some(pair) = list.windows(2).find(|pair| pair[0] >= pair[1]) {
                let problem = format!("found {} before {}; write them rising, each once", pair[0], pair[1]);
                return Err(key("wavelengths_nm", problem));
            }
            Ok(list.clone())
        }
        (None, Some([first_nm, last_nm]), Some(step_nm)) => {
            // The small addition keeps a last wavelength that rounding would lose.
            let count = ((last_nm - first_nm) / step_nm + 1e-9).floor() + 1.0;
            if !(first_nm > 0.0 && step_nm > 0.0 && last_nm > first_nm && count.is_finite()) {
                let found = format!("found {first_nm} to {last_nm} in steps of {step_nm}");
                return Err(key("window_nm", format!("{found}; expected a rising range above 0 and a step above 0")));
            }
            if count > LARGEST_TABLE {
                let problem = format!("this makes more than {LARGEST_TABLE:e} readings; take a larger step");
                return Err(key("step_nm", problem));
            }
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "bounded by LARGEST_TABLE above"
            )]
            let steps = 0..count as u32;
            Ok(steps.map(|step| first_nm + step_nm * f64::from(step)).collect())
        }
        _ => {
            let problem = "expected either `window_nm` with `step_nm`, or `wavelengths_nm` alone".into();
            Err(key("window_nm", problem))
        }
    }
}

/// The recipe's geometries, named after their angles.
fn geometries(recipe: &SyntheticFile) -> Result<Vec<(String, Geometry)>, JobError> {
    let inside = |angle: f64| (0.0..90.0).contains(&angle);
    if recipe.mirror_deg.is_empty() && recipe.angles_deg.is_empty() {
        return Err(key("mirror_deg", "the list is empty; give at least one inclination".into()));
    }
    if let Some(angle) = recipe.mirror_deg.iter().find(|angle| !inside(**angle)) {
        return Err(key("mirror_deg", format!("found {angle}; expected inclinations from 0 to below 90 degrees")));
    }
    let mirror = recipe.mirror_deg.iter().map(|angle| (format!("{angle}°"), Geometry::mirror(*angle)));
    let mut found: Vec<(String, Geometry)> = mirror.collect();
    // A spectrum is named after its angles, and its gain after its name.
    let mut names = std::collections::BTreeSet::new();
    if let Some((name, _)) = found.iter().find(|(name, _)| !names.insert(name.clone())) {
        let problem = format!("found {} twice; give each inclination once", name.trim_end_matches('°'));
        return Err(key("mirror_deg", problem));
    }
    for [theta_i_deg, phi_i_deg, theta_o_deg, phi_o_deg] in recipe.angles_deg.iter().copied() {
        let name = format!("{theta_i_deg}°, {phi_i_deg}° to {theta_o_deg}°, {phi_o_deg}°");
        if !(inside(theta_i_deg) && inside(theta_o_deg) && phi_i_deg.is_finite() && phi_o_deg.is_finite()) {
            let problem = format!(
                "found {name}; expected inclinations (first and third) from 0 to below 90 degrees, and azimuths (second \
                 and fourth)"
            );
            return Err(key("angles_deg", problem));
        }
        if !names.insert(name.clone()) {
            return Err(key("angles_deg", format!("found {name} twice; give each geometry once")));
        }
        found.push((name, Geometry { theta_i_deg, phi_i_deg, theta_o_deg, phi_o_deg }));
    }
    Ok(found)
}

#[expect(clippy::cast_precision_loss, reason = "a count of readings")]
fn as_f64(count: usize) -> f64 {
    count as f64
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
