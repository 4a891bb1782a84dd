//! The grid as it is meant: checked axes, and the cells that they span.

use super::file::{AxisFile, Spacing};
use crate::fit::{Assignment, Role};
use crate::job::JobError;
use crate::job::values::{check_inside, index_of};
use crate::parameter::Parameter;

/// Most values of one axis; a page has fewer pixels.
const MOST_STEPS: usize = 100_000;

/// One swept parameter and its values.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepAxis {
    /// Its declaration.
    pub parameter: Parameter,
    /// Its values in the order of the job.
    pub values: Vec<f64>,
    /// Whether they are spread in the logarithm.
    pub is_logarithmic: bool,
    /// Parameters that move along, with as many values each.
    pub along: Vec<Companion>,
    /// Index among all parameters.
    pub(super) index: usize,
}

/// A parameter that moves along with a swept one.
#[derive(Debug, Clone, PartialEq)]
pub struct Companion {
    /// Its declaration.
    pub parameter: Parameter,
    /// Its values, in the order of the swept one's.
    pub values: Vec<f64>,
    /// Index among all parameters.
    index: usize,
}

impl SweepAxis {
    /// The parameters that this axis moves, the swept one first.
    pub fn parameters(&self) -> impl Iterator<Item = &Parameter> {
        std::iter::once(&self.parameter).chain(self.along.iter().map(|other| &other.parameter))
    }

    /// The parameters that this axis moves, each with what it has where the swept one has `value`, which comes first.
    pub fn at(&self, value: f64) -> impl Iterator<Item = (&Parameter, f64)> {
        // Most axes move one parameter, and have no need to look.
        let find = || self.values.iter().position(|own| own.total_cmp(&value).is_eq());
        let place = if self.along.is_empty() { None } else { find() };
        let along = self.along.iter().filter_map(move |other| Some((&other.parameter, *other.values.get(place?)?)));
        std::iter::once((&self.parameter, value)).chain(along)
    }

    /// The same by indices among all parameters.
    pub(super) fn moved(&self, value: f64) -> impl Iterator<Item = (usize, f64)> {
        let indices = std::iter::once(self.index).chain(self.along.iter().map(|other| other.index));
        indices.zip(self.at(value).map(|(_, value)| value))
    }
}

/// The checked axes of a sweep, the one with most values last: cells run through it first.
pub(super) fn axes(
    grid: &std::collections::BTreeMap<String, AxisFile>,
    declared: &[Parameter],
    assignments: &[Assignment],
) -> Result<Vec<SweepAxis>, JobError> {
    if !(1..=2).contains(&grid.len()) {
        let problem = format!("found {} parameters; expected one or two", grid.len());
        return Err(JobError::key("sweep.grid", problem));
    }
    let mut axes = grid
        .iter()
        .map(|(name, file)| axis(name, file, declared, assignments).map_err(|p| JobError::key(key(name), p)))
        .collect::<Result<Vec<_>, _>>()?;
    // Names in alphabetical order where both have as many.
    axes.sort_by_key(|axis| axis.values.len());
    let mut moved: Vec<&Parameter> = Vec::new();
    for axis in &axes {
        for (parameter, _) in axis.at(axis.values[0]) {
            if moved.iter().any(|other| other.name == parameter.name) {
                let problem = "this grid moves it twice; take one of the two away";
                return Err(JobError::key(key(&axis.parameter.name), format!("{}: {problem}", parameter.name)));
            }
            moved.push(parameter);
        }
    }
    Ok(axes)
}

/// The key of an axis.
pub(super) fn key(name: &str) -> String {
    format!("sweep.grid.\"{name}\"")
}

/// The values of every cell, one an axis; the last axis runs fastest.
pub(super) fn cells(axes: &[SweepAxis]) -> Vec<Vec<f64>> {
    axes.iter().fold(vec![Vec::new()], |cells, axis| {
        let with = |cell: &Vec<f64>, value: f64| cell.iter().copied().chain([value]).collect();
        cells.iter().flat_map(|cell| axis.values.iter().map(move |value| with(cell, *value))).collect()
    })
}

fn axis(name: &str, file: &AxisFile, declared: &[Parameter], assignments: &[Assignment]) -> Result<SweepAxis, String> {
    let values = values(file)?;
    let index = checked_index(name, &values, declared, assignments)?;
    let mut sorted = values.clone();
    sorted.sort_by(f64::total_cmp);
    if let Some(pair) = sorted.windows(2).find(|pair| pair[0] >= pair[1]) {
        return Err(format!("found {} twice; write each value once", pair[0]));
    }
    let along = file.along.iter().map(|(other, with)| {
        let wrong = |problem: String| format!("along.\"{other}\": {problem}");
        if with.len() != values.len() {
            let problem = format!("found {} values; expected {}, one for each of {name}", with.len(), values.len());
            return Err(wrong(problem));
        }
        let index = checked_index(other, with, declared, assignments).map_err(wrong)?;
        Ok(Companion { parameter: declared[index].clone(), values: with.clone(), index })
    });
    let along = along.collect::<Result<_, String>>()?;
    let is_logarithmic = file.spacing == Spacing::Logarithmic;
    Ok(SweepAxis { parameter: declared[index].clone(), values, is_logarithmic, along, index })
}

/// The index of a parameter that a grid may give these values.
fn checked_index(
    name: &str,
    values: &[f64],
    declared: &[Parameter],
    assignments: &[Assignment],
) -> Result<usize, String> {
    let index = index_of(declared, name)?;
    let parameter = &declared[index];
    if let Role::Tied { terms, .. } = &assignments[index].role {
        let others: Vec<&str> = terms.iter().map(|(other, _)| declared[*other].name.as_str()).collect();
        let instead = if others.is_empty() { String::new() } else { format!("sweep {}, or ", others.join(" or ")) };
        return Err(format!("it is tied and follows other parameters; {instead}take the tie away"));
    }
    for value in values {
        check_inside(parameter, *value)?;
    }
    Ok(index)
}

fn values(file: &AxisFile) -> Result<Vec<f64>, String> {
    match file {
        AxisFile { values: Some(values), from: None, to: None, steps: None, spacing, along: _ } => {
            if *spacing != Spacing::Linear {
                return Err("`spacing` goes with `from`, `to` and `steps`, not with a list of values".into());
            }
            match values.len() {
                0 => Err("the list of values is empty; give at least one".into()),
                many if many > MOST_STEPS => Err(format!("found {many} values; expected at most {MOST_STEPS}")),
                _ => Ok(values.clone()),
            }
        }
        AxisFile { values: None, from: Some(from), to: Some(to), steps: Some(steps), spacing, along: _ } => {
            if *steps < 2 {
                return Err(format!(
                    "found {steps} steps; expected 2 or more (for a single value write `{{ values = [{from}] }}`)"
                ));
            }
            if *steps > MOST_STEPS {
                return Err(format!("found {steps} steps; expected at most {MOST_STEPS}"));
            }
            if !(from.is_finite() && to.is_finite() && from < to) {
                return Err(format!("found from = {from} and to = {to}; expected `from` below `to`"));
            }
            if *spacing == Spacing::Logarithmic && *from <= 0.0 {
                return Err(format!("found from = {from}; logarithmic spacing needs values above 0"));
            }
            let last = steps - 1;
            let place = |step: usize| match (step, spacing) {
                // The ends exactly, as typed.
                (0, _) => *from,
                (step, _) if step == last => *to,
                (_, Spacing::Linear) => from + (to - from) * (as_f64(step) / as_f64(last)),
                (_, Spacing::Logarithmic) => from * (to / from).powf(as_f64(step) / as_f64(last)),
            };
            Ok((0..*steps).map(place).collect())
        }
        _ => Err("expected either `from`, `to` and `steps`, or `values` alone".into()),
    }
}

#[expect(clippy::cast_precision_loss, reason = "a number of steps, at most MOST_STEPS")]
fn as_f64(steps: usize) -> f64 {
    steps as f64
}
