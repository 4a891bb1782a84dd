//! A sweep: the job's model run forward over a grid of parameter values, and how sensitive readings and colours are.
//!
//! Everything is counted from the job's *own values*, those that `simulate` uses too: the start of a free parameter, the
//! value of a fixed one, ties after them. The ranges of the sensitivities are those that the job's `parameters` give to the
//! free parameters.

mod answer;
mod colour;
mod excursion;
mod file;
mod forward;
mod grid;
mod local;
mod outcome;
mod variance;

use rayon::prelude::*;

pub use file::{AxisFile, RenderFile, SobolFile, Spacing, SweepFile};
pub use grid::{Companion, SweepAxis};
pub use outcome::{Cell, Colour, Excursion, Own, Rate, Slope, Sweep, Variance, VarianceOf, Varying, View};

use self::answer::answer;
use self::colour::ColourMaker;
use self::excursion::excursion;
use self::forward::Forward;
use self::local::slope;
use self::variance::{FreeRange, settings, variance};
use super::case::CheckedCase;
use super::file::ParameterFile;
use super::model_note::model_note;
use super::values::{Values, said_of};
use super::{InputFile, Job, JobError};
use crate::fit::Role;
use crate::parameter::Spread;
use crate::sensitivity::SobolSettings;

/// Most readings of a grid.
const MOST_READINGS: f64 = 1e7;

/// Runs the sweep of a job's main case, with these parameters set to other values than the job's own.
///
/// # Errors
/// A sentence where the job has no sweep, or one that cannot be run as it is written.
pub fn sweep(job: &Job, set: &Values) -> Result<Sweep, JobError> {
    run(job, set).map_err(|error| job.placed(error, 0))
}

/// What a job's sweep would go through, in words, or what is wrong with it.
pub(super) fn describe(job: &Job) -> Result<String, JobError> {
    let plan = plan(job, &Values::new()).map_err(|error| job.placed(error, 0))?;
    let axis = |axis: &SweepAxis| {
        let names: Vec<&str> = axis.parameters().map(|parameter| parameter.name.as_str()).collect();
        format!("{} values of {}", axis.values.len(), names.join(" with "))
    };
    let axes: Vec<String> = plan.axes.iter().map(axis).collect();
    let sobol = plan.sobol.map_or_else(str::to_owned, |settings| {
        let (samples, replicates) = (settings.samples, settings.replicates);
        format!("Sobol indices of {} free parameters from {replicates} × {samples} points", plan.free.len())
    });
    let is_rendered = job.file.sweep.as_ref().is_some_and(|file| file.render.is_some());
    let pictures = if is_rendered { "; a picture of each cell" } else { "" };
    Ok(format!("{}, {} readings each; {sobol}{pictures}", axes.join(" × "), plan.forward.reading_count()))
}

/// A sweep, checked and ready to be run.
struct Plan {
    case: CheckedCase,
    inputs: Vec<InputFile>,
    axes: Vec<SweepAxis>,
    forward: Forward,
    free: Vec<FreeRange>,
    /// How to share out the variance, or why there is none to share.
    sobol: Result<SobolSettings, &'static str>,
}

fn plan(job: &Job, set: &Values) -> Result<Plan, JobError> {
    let Some(file) = &job.file.sweep else {
        let problem = "this job has none; add one, as [sweep] with \
                       grid = { roughness = { from = 0.05, to = 0.5, steps = 10 } }";
        return Err(JobError::key("sweep", problem));
    };
    let (mut cases, inputs) = job.cases()?;
    let case = cases.swap_remove(0);
    let axes = grid::axes(&file.grid, case.residuals().parameters(), &case.assignments)?;
    let forward = Forward::new(&case, set, least_roughness(&case, &axes, set))?;
    check_size(&axes, forward.reading_count())?;
    let free = free_ranges(&case, &forward);
    let sobol = match (&file.sobol, free.is_empty()) {
        (Some(_), true) => {
            let problem = "no parameter of this job is free, so that there are no ranges to vary over; free one under \
                           `parameters`, as roughness = { lower = 0.05, upper = 0.5 }, or take this section away";
            return Err(JobError::key("sweep.sobol", problem));
        }
        (None, true) => Err("No parameter of the job is free: there are no ranges over which to share out a variance."),
        (file, false) => Ok(settings(&file.clone().unwrap_or_default(), free.len(), forward.reading_count())?),
    };
    Ok(Plan { case, inputs, axes, forward, free, sobol })
}

fn run(job: &Job, set: &Values) -> Result<Sweep, JobError> {
    let Plan { case, inputs, axes, forward, free, sobol } = plan(job, set)?;
    let cells = grid::cells(&axes);
    let moved = |values: &[f64]| -> Vec<(usize, f64)> {
        axes.iter().zip(values).flat_map(|(axis, value)| axis.moved(*value)).collect()
    };
    let readings: Vec<_> = cells.par_iter().map(|values| forward.readings(&moved(values))).collect();
    let readings = readings.into_iter().collect::<Result<Vec<_>, _>>().map_err(|refusal| refusal.at("sweep.grid"))?;
    let parameters: Vec<_> = cells.iter().map(|values| forward.values(&moved(values))).collect();
    let parameters =
        parameters.into_iter().collect::<Result<Vec<_>, _>>().map_err(|refusal| refusal.at("sweep.grid"))?;
    let own_readings = forward.readings(&[]).map_err(|refusal| refusal.at("parameters"))?;

    let colours = ColourMaker::new(&forward.views);
    let exposure = exposure(&forward, &colours, readings.iter().chain([&own_readings]));
    let coloured = |readings: &[Vec<f64>]| -> Vec<Colour> {
        let views = forward.views.iter().zip(readings);
        views.filter_map(|(view, readings)| colours.colour(view, forward.quantity, readings, exposure)).collect()
    };
    let own = Own {
        parameters: forward.parameters().iter().cloned().zip(forward.own.iter().copied()).collect(),
        colours: coloured(&own_readings),
        readings: own_readings,
    };
    let cells: Vec<Cell> = cells
        .into_iter()
        .zip(parameters)
        .zip(readings)
        .map(|((values, parameters), readings)| Cell { values, parameters, colours: coloured(&readings), readings })
        .collect();

    let ranges = ranges(&axes, &free);
    let slopes = ranges
        .par_iter()
        .map(|(index, ..)| slope(&forward, &colours, exposure, (*index, forward.own[*index]), &[], true))
        .collect::<Vec<_>>();
    let slopes_along = match axes.as_slice() {
        [axis] => axis
            .values
            .par_iter()
            .map(|value| {
                let others: Vec<_> = axis.moved(*value).skip(1).collect();
                slope(&forward, &colours, exposure, (axis.index, *value), &others, false)
            })
            .collect::<Vec<_>>(),
        _ => Vec::new(),
    };
    let excursions = ranges
        .iter()
        .map(|(index, range, spread)| excursion(&forward, &colours, exposure, &own, *index, (*range, *spread)));
    let mut result = Sweep {
        barbule_version: env!("CARGO_PKG_VERSION").to_owned(),
        name: job.name.clone(),
        title: job.file.title.clone(),
        about: job.file.about.clone(),
        answer: String::new(),
        inputs,
        job_toml: job.text.clone(),
        settings: set.iter().map(|(name, value)| format!("{name} = {value}")).collect(),
        model: model_note(&case)?,
        quantity: forward.quantity,
        excursions: excursions.collect::<Result<_, _>>()?,
        slopes: slopes.into_iter().collect::<Result<_, _>>()?,
        slopes_along: slopes_along.into_iter().collect::<Result<_, _>>()?,
        variance: match sobol {
            Ok(settings) => Ok(variance(&forward, &colours, exposure, &own, &free, settings)?),
            Err(reason) => Err(reason.to_owned()),
        },
        colour_note: colours.note(&forward.views, exposure),
        views: forward.views,
        axes,
        cells,
        own,
    };
    result.answer = answer(&result);
    Ok(result)
}

/// The smallest roughness that will be asked for, where the sweep or the command line moves the roughness at all.
fn least_roughness(case: &CheckedCase, axes: &[SweepAxis], set: &Values) -> Option<f64> {
    const ROUGHNESS: &str = "roughness";
    let swept = axes.iter().filter(|axis| axis.parameter.name == ROUGHNESS).flat_map(|axis| &axis.values);
    let moved = swept.chain(set.get(ROUGHNESS)).copied().reduce(f64::min)?;
    let parameters = case.residuals().parameters();
    let index = parameters.iter().position(|parameter| parameter.name == ROUGHNESS)?;
    Some(moved.min(match case.assignments[index].role {
        Role::Free { lower, .. } => lower,
        Role::Fixed(value) => value,
        Role::Tied { .. } => parameters[index].lower,
    }))
}

fn check_size(axes: &[SweepAxis], readings: usize) -> Result<(), JobError> {
    #[expect(clippy::cast_precision_loss, reason = "counts for a limit")]
    let whole = axes.iter().fold(readings as f64, |product, axis| product * axis.values.len() as f64);
    if whole <= MOST_READINGS {
        return Ok(());
    }
    let sizes: Vec<String> = axes.iter().map(|axis| axis.values.len().to_string()).collect();
    let problem = format!(
        "{} cells of {readings} readings make {whole:.1e} readings, more than {MOST_READINGS:e}; take fewer steps, or a \
         larger step between wavelengths",
        sizes.join(" × ")
    );
    Err(JobError::key("sweep.grid", problem))
}

/// The parameters that the job itself frees, with their ranges: not a gain that only its instrument does.
fn free_ranges(case: &CheckedCase, forward: &Forward) -> Vec<FreeRange> {
    let roles = forward.parameters().iter().zip(&forward.assignments).enumerate();
    roles
        .filter_map(|(index, (parameter, assignment))| {
            let is_typed = matches!(said_of(&case.file.parameters, &parameter.name), Some(ParameterFile::Free(_)));
            match assignment.role {
                Role::Free { lower, upper, .. } if is_typed => {
                    let spread = if lower > 0.0 { parameter.spread } else { Spread::Linear };
                    Some((index, [lower, upper], spread))
                }
                _ => None,
            }
        })
        .collect()
}

/// What sensitivities are taken of: the free parameters over their ranges, then the swept ones that are not free over
/// their grid.
fn ranges(axes: &[SweepAxis], free: &[FreeRange]) -> Vec<FreeRange> {
    let swept = axes.iter().filter(|axis| !free.iter().any(|(index, ..)| *index == axis.index)).map(|axis| {
        let range = super::case::extent(axis.values.iter().copied());
        (axis.index, range, if axis.is_logarithmic { Spread::Logarithmic } else { Spread::Linear })
    });
    free.iter().copied().chain(swept).collect()
}

/// The factor by which all colours are darkened, so that none of the grid outshines the white standard.
fn exposure<'a>(forward: &Forward, colours: &ColourMaker, readings: impl Iterator<Item = &'a Vec<Vec<f64>>>) -> f64 {
    let brightest = readings
        .flat_map(|readings| forward.views.iter().zip(readings))
        .filter_map(|(view, readings)| colours.luminance(view, forward.quantity, readings))
        .fold(0.0, f64::max);
    if brightest > 1.0 { 1.0 / brightest } else { 1.0 }
}
