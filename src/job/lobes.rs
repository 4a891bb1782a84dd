//! What a model does with light from a few directions: lobes to look at.

use rayon::prelude::*;

use super::JobError;
use super::file::{JobFile, ModelFile};
use super::models::examples;
use super::outcome::{LightLobes, Lobes};
use super::values::{Values, checked, in_order};
use crate::bsdf::Model;
use crate::measure::{Geometry, GonioTable};

/// Steps of the viewer's angle in the plane of incidence, degrees. Angles lie in the middle of steps, so that none is along
/// the surface, where a BSDF may have no value.
const STEP_DEG: f64 = 1.0;
/// Rings of equal inclination, and azimuths in each, of the hemisphere of viewers.
const RINGS: usize = 20;
const AZIMUTHS: usize = 60;
/// Each way, viewers whose mean stands for a cell of the hemisphere: a narrow lobe then shows, if blurred.
const VIEWERS: usize = 2;
/// Most inclinations of the light that a report shows.
const MOST_LIGHTS: usize = 3;

/// The lobes of a fitted model, for light from the lowest, a middle and the highest inclination that was fitted.
pub(super) fn lobes_of_fit(
    file: &JobFile,
    table: &GonioTable,
    fitted: &[bool],
    values: &Values,
) -> Result<Lobes, JobError> {
    let seen = || table.spectra.iter().zip(fitted).filter(|(_, fitted)| **fitted).map(|(spectrum, _)| spectrum);
    let mut inclinations_deg: Vec<f64> = seen().map(|spectrum| spectrum.geometry.theta_i_deg).collect();
    inclinations_deg.sort_by(f64::total_cmp);
    inclinations_deg.dedup();
    let last = inclinations_deg.len().saturating_sub(1);
    let mut shown: Vec<usize> = (0..MOST_LIGHTS).map(|k| k * last / (MOST_LIGHTS - 1)).collect();
    shown.dedup();
    let lights_deg: Vec<f64> = shown.into_iter().map(|index| inclinations_deg[index]).collect();

    let grid: &[f64] = seen().next().map_or(&[], |spectrum| &spectrum.wavelengths_nm);
    let chosen = few(grid.len());
    let few_nm: Vec<f64> = chosen.iter().map(|&index| grid[index]).collect();
    let model = file.model.scattering(&few_nm)?;
    // What has a value a channel must be asked at the channels that it was fitted at.
    if model.parameters().iter().all(|parameter| values.contains_key(&parameter.name)) {
        let all: Vec<usize> = (0..few_nm.len()).collect();
        return Ok(lobes(&*model, few_nm, &all, &in_order(model.parameters(), values), &lights_deg));
    }
    let model = file.model.scattering(grid)?;
    Ok(lobes(&*model, few_nm, &chosen, &in_order(model.parameters(), values), &lights_deg))
}

/// At most three of so many channels: the middle ones of three equal parts.
fn few(channels: usize) -> Vec<usize> {
    if channels <= 3 { (0..channels).collect() } else { [1, 3, 5].map(|sixth| sixth * channels / 6).to_vec() }
}

/// Wavelengths of three channels, nm: those that stand for blue, green and red where a job has no others.
const RGB_NM: [f64; 3] = [445.0, 525.0, 645.0];
/// Most settings of parameters that are drawn beside each other.
const MOST_SETTINGS: usize = 6;

/// A model's lobes at some settings of its parameters, each with the words for it.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelLobes {
    /// Name in a job.
    pub kind: &'static str,
    /// Settings (`roughness = 0.1`; `defaults` where nothing is set) and their lobes.
    pub settings: Vec<(String, Lobes)>,
}

/// Lobes of the example of every model, or of the one named, for light from these inclinations, at every combination of
/// these parameter values; the rest have their defaults.
///
/// # Errors
/// A name that no model or no parameter has, a value or inclination out of range, or too many combinations.
pub fn model_lobes(
    kind: Option<&str>,
    set: &[(String, Vec<f64>)],
    lights_deg: &[f64],
) -> Result<Vec<ModelLobes>, JobError> {
    let slip = |option, problem| JobError::Option { option, problem };
    if let Some(found) = lights_deg.iter().find(|angle| !(0.0..90.0).contains(*angle)) {
        return Err(slip("--light", format!("found {found}; expected inclinations from 0 to below 90 degrees")));
    }
    let mut combinations = vec![Values::new()];
    for (name, values) in set {
        combinations = values
            .iter()
            .flat_map(|value| {
                combinations.iter().map(|others| {
                    let mut all = others.clone();
                    all.insert(name.clone(), *value);
                    all
                })
            })
            .collect();
    }
    if combinations.len() > MOST_SETTINGS {
        let found = combinations.len();
        return Err(slip(
            "--set",
            format!("found {found} combinations of values; at most {MOST_SETTINGS} can be told apart"),
        ));
    }
    let drawn = |(kind, model): (&'static str, ModelFile)| {
        let model = model.scattering(&RGB_NM)?;
        let settings = combinations.iter().map(|set| {
            for (name, value) in set {
                checked(model.parameters(), name, *value)
                    .map_err(|problem| slip("--set", format!("{kind}: {name}: {problem}")))?;
            }
            let words: Vec<String> = set.iter().map(|(name, value)| format!("{name} = {value}")).collect();
            let words = if words.is_empty() { "defaults".to_owned() } else { words.join(", ") };
            let values = in_order(model.parameters(), set);
            Ok((words, lobes(&*model, RGB_NM.to_vec(), &[0, 1, 2], &values, lights_deg)))
        });
        Ok(ModelLobes { kind, settings: settings.collect::<Result<_, JobError>>()? })
    };
    examples(kind)?.into_iter().filter(|(_, model)| !matches!(model, ModelFile::ThinFilmLaw(_))).map(drawn).collect()
}

/// Lobes at these channels of a model.
fn lobes(model: &dyn Model, wavelengths_nm: Vec<f64>, channels: &[usize], values: &[f64], lights_deg: &[f64]) -> Lobes {
    let bsdf = model.bind(values);
    let seen = |theta_i_deg: f64, theta_o_deg: f64, phi_o_deg: f64| -> Vec<f64> {
        let geometry = Geometry { theta_i_deg, phi_i_deg: 0.0, theta_o_deg, phi_o_deg };
        let mut all = vec![0.0; model.channel_count()];
        bsdf.evaluate(&geometry.incoming(), &geometry.outgoing(), &mut all);
        channels.iter().map(|&channel| all[channel]).collect()
    };
    let upper: Vec<f64> = (0..180).map(|step| -90.0 + STEP_DEG * (f64::from(step) + 0.5)).collect();
    let lower: Vec<f64> = (0..180).map(|step| 90.0 + STEP_DEG * (f64::from(step) + 0.5)).collect();
    // The mirror direction of light from azimuth 0 is at azimuth 180°.
    let at = |theta_i_deg: f64, angle_deg: f64| seen(theta_i_deg, angle_deg, 180.0);
    let shines_through = lights_deg
        .iter()
        .any(|theta_i_deg| lower.iter().any(|angle_deg| at(*theta_i_deg, *angle_deg).iter().any(|value| *value > 0.0)));
    let angles_deg: Vec<f64> = if shines_through { upper.into_iter().chain(lower).collect() } else { upper };
    let lights = lights_deg.iter().map(|&theta_i_deg| {
        let readings: Vec<Vec<f64>> = angles_deg.iter().map(|angle_deg| at(theta_i_deg, *angle_deg)).collect();
        LightLobes {
            theta_i_deg,
            in_plane: (0..channels.len()).map(|c| readings.iter().map(|all| short(all[c])).collect()).collect(),
            hemisphere: hemisphere(|theta_o_deg, phi_o_deg| {
                seen(theta_i_deg, theta_o_deg, phi_o_deg)[channels.len() / 2]
            }),
        }
    });
    Lobes { lights: lights.collect(), wavelengths_nm, angles_deg }
}

/// Means over the cells of the hemisphere of viewers.
fn hemisphere(value: impl Fn(f64, f64) -> f64 + Sync) -> Vec<Vec<f64>> {
    let (ring_deg, azimuth_deg) = (90.0 / as_f64(RINGS), 360.0 / as_f64(AZIMUTHS));
    let inside = |index: usize, part: usize| as_f64(index) + (as_f64(part) + 0.5) / as_f64(VIEWERS);
    let cell = |ring: usize, azimuth: usize| {
        let mut sum = 0.0;
        for (across, around) in (0..VIEWERS).flat_map(|across| (0..VIEWERS).map(move |around| (across, around))) {
            sum += value(ring_deg * inside(ring, across), azimuth_deg * inside(azimuth, around));
        }
        short(sum / as_f64(VIEWERS * VIEWERS))
    };
    (0..RINGS).into_par_iter().map(|ring| (0..AZIMUTHS).map(|azimuth| cell(ring, azimuth)).collect()).collect()
}

/// Five significant digits, more than a picture shows: a result file is read by people too.
fn short(value: f64) -> f64 {
    format!("{value:.4e}").parse().unwrap_or(value)
}

#[expect(clippy::cast_precision_loss, reason = "a small count")]
fn as_f64(count: usize) -> f64 {
    count as f64
}
