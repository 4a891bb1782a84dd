//! Shares of the variance of readings and colours over the ranges of the free parameters.

use super::colour::ColourMaker;
use super::excursion::place;
use super::file::SobolFile;
use super::forward::Forward;
use super::outcome::{Own, Variance, VarianceOf, Varying};
use crate::job::JobError;
use crate::parameter::Spread;
use crate::sensitivity::{SobolSettings, sobol_indices};

/// Most readings that are computed for the indices.
const MOST_READINGS: f64 = 4e9;

/// A free parameter of the job: its index and range, and how it is spread there.
pub(super) type FreeRange = (usize, [f64; 2], Spread);

/// Checked settings.
pub(super) fn settings(file: &SobolFile, inputs: usize, readings: usize) -> Result<SobolSettings, JobError> {
    let SobolFile { samples, replicates, seed } = *file;
    if !samples.is_power_of_two() || !(16..=65_536).contains(&samples) {
        let problem = format!("found {samples}; expected a power of two from 16 to 65536, as 256");
        return Err(JobError::key("sweep.sobol.samples", problem));
    }
    if !(4..=1000).contains(&replicates) {
        return Err(JobError::key("sweep.sobol.replicates", format!("found {replicates}; expected 4 to 1000")));
    }
    #[expect(clippy::cast_precision_loss, reason = "counts for a limit")]
    let cost = f64::from(samples) * f64::from(replicates) * (inputs as f64 + 2.0) * readings as f64;
    if cost > MOST_READINGS {
        let problem = format!(
            "{samples} points, {replicates} times over, for {inputs} free parameters and {readings} readings make \
             {cost:.1e} readings, more than {MOST_READINGS:e}; take fewer points, or fewer readings"
        );
        return Err(JobError::key("sweep.sobol.samples", problem));
    }
    Ok(SobolSettings { samples, replicates, seed })
}

/// Indices of every free parameter, for the readings of each view and for its ΔE2000 to the job's own values.
pub(super) fn variance(
    forward: &Forward,
    colours: &ColourMaker,
    exposure: f64,
    own: &Own,
    free: &[FreeRange],
    settings: SobolSettings,
) -> Result<Variance, JobError> {
    let mut outputs = Vec::new();
    let mut groups = Vec::new();
    let mut next = 0;
    for (number, view) in forward.views.iter().enumerate() {
        outputs.push((number, Varying::Readings));
        groups.push(next..next + view.wavelengths_nm.len());
        next += view.wavelengths_nm.len();
    }
    for number in 0..own.colours.len() {
        outputs.push((number, Varying::Difference));
        groups.push(next..next + 1);
        next += 1;
    }
    let evaluate = |point: &[f64]| {
        let moved: Vec<(usize, f64)> = free
            .iter()
            .zip(point)
            .map(|((index, range, spread), share)| (*index, place(*range, *spread, *share)))
            .collect();
        let readings = forward.readings(&moved)?;
        let seen = forward.views.iter().zip(&readings).zip(&own.colours);
        let differences: Vec<f64> = seen
            .filter_map(|((view, readings), own)| {
                let colour = colours.colour(view, forward.quantity, readings, exposure)?;
                Some(colour.lab.delta_e_2000(own.lab))
            })
            .collect();
        Ok(readings.into_iter().flatten().chain(differences).collect())
    };
    let found = sobol_indices(free.len(), next, &groups, settings, evaluate)
        .map_err(|refusal: super::forward::Refusal| refusal.at("parameters"))?;
    let outputs = outputs.into_iter().zip(found).map(|((view, what), shares)| VarianceOf {
        view,
        what,
        mean: shares.mean,
        standard_deviation: shares.standard_deviation,
        indices: shares.indices,
    });
    let inputs = free.iter().map(|(index, range, spread)| (forward.parameters()[*index].clone(), *range, *spread));
    Ok(Variance { settings, inputs: inputs.collect(), outputs: outputs.collect() })
}
