//! Between the vector that a solver moves and the values that a model takes.

use super::assignment::{Assignment, Role};
use super::error::FitError;
use crate::parameter::{Parameter, Spread};

/// One free parameter.
#[derive(Debug, Clone)]
pub(super) struct FreeParameter {
    /// Its index among all parameters.
    pub(super) index: usize,
    pub(super) start: f64,
    pub(super) lower: f64,
    pub(super) upper: f64,
    pub(super) spread: Spread,
    pub(super) scan_step: Option<f64>,
    /// A typical size, where its value happens to be 0.
    pub(super) scale: f64,
}

/// A value that follows from the free ones: `constant + Σ factor · free`.
#[derive(Debug, Clone)]
struct Tie {
    index: usize,
    constant: f64,
    terms: Vec<(usize, f64)>,
    lower: f64,
    upper: f64,
}

/// The checked roles of all parameters.
#[derive(Debug, Clone)]
pub(super) struct Mapping {
    pub(super) free: Vec<FreeParameter>,
    fixed: Vec<f64>,
    ties: Vec<Tie>,
}

impl Mapping {
    /// Checks the assignments and resolves ties to fixed parameters.
    pub(super) fn new(parameters: &[Parameter], assignments: &[Assignment]) -> Result<Self, FitError> {
        if parameters.len() != assignments.len() {
            return Err(FitError::AssignmentCount { expected: parameters.len(), found: assignments.len() });
        }
        let mut free = Vec::new();
        let mut fixed = vec![0.0; parameters.len()];
        let mut place = vec![None; parameters.len()];
        for (index, (parameter, assignment)) in parameters.iter().zip(assignments).enumerate() {
            check_prior(parameter, assignment)?;
            match assignment.role {
                Role::Free { start, lower, upper } => {
                    place[index] = Some(free.len());
                    free.push(check_free(index, parameter, start, lower, upper)?);
                }
                Role::Fixed(value) => fixed[index] = check_finite("fixed value", &parameter.name, value)?,
                Role::Tied { .. } => {}
            }
        }
        let mut ties = Vec::new();
        for (index, assignment) in assignments.iter().enumerate() {
            if let Role::Tied { constant, terms } = &assignment.role {
                ties.push(resolve(index, *constant, terms, parameters, assignments, &fixed, &place)?);
            }
        }
        let mapping = Self { free, fixed, ties };
        mapping.check_ties(parameters)?;
        // Last, since a caller may have use for roles of which nothing else is wrong.
        if mapping.free.is_empty() { Err(FitError::NothingFree) } else { Ok(mapping) }
    }

    /// Writes all values for these free ones; false where a tied value leaves its declared range.
    pub(super) fn expand(&self, free: &[f64], values: &mut [f64]) -> bool {
        values.copy_from_slice(&self.fixed);
        for (parameter, &value) in self.free.iter().zip(free) {
            values[parameter.index] = value;
        }
        let mut inside = true;
        for tie in &self.ties {
            let value = tie.value(free);
            values[tie.index] = value;
            inside &= value >= tie.lower && value <= tie.upper;
        }
        inside
    }

    /// How the value of parameter `index` follows from the free ones: its constant, and its factors.
    pub(super) fn linear_form(&self, index: usize) -> (f64, Vec<(usize, f64)>) {
        if let Some(position) = self.free.iter().position(|parameter| parameter.index == index) {
            (0.0, vec![(position, 1.0)])
        } else if let Some(tie) = self.ties.iter().find(|tie| tie.index == index) {
            (tie.constant, tie.terms.clone())
        } else {
            (self.fixed[index], Vec::new())
        }
    }

    /// Indices among all parameters whose values move with free parameter `position`.
    pub(super) fn followers(&self, position: usize) -> impl Iterator<Item = usize> + '_ {
        let tied = self.ties.iter().filter(move |tie| tie.terms.iter().any(|term| term.0 == position));
        std::iter::once(self.free[position].index).chain(tied.map(|tie| tie.index))
    }

    /// The job's own start.
    pub(super) fn start(&self) -> Vec<f64> {
        self.free.iter().map(|parameter| parameter.start).collect()
    }

    fn check_ties(&self, parameters: &[Parameter]) -> Result<(), FitError> {
        let start = self.start();
        for tie in &self.ties {
            let value = tie.value(&start);
            if !(value >= tie.lower && value <= tie.upper) {
                let name = parameters[tie.index].name.clone();
                return Err(FitError::TieOutOfRange { name, value, lower: tie.lower, upper: tie.upper });
            }
        }
        Ok(())
    }
}

impl Tie {
    fn value(&self, free: &[f64]) -> f64 {
        self.terms.iter().fold(self.constant, |sum, &(position, factor)| sum + factor * free[position])
    }
}

fn check_finite(what: &'static str, name: &str, value: f64) -> Result<f64, FitError> {
    if value.is_finite() { Ok(value) } else { Err(FitError::NotFinite { what, name: name.to_owned(), value, and: "" }) }
}

fn check_prior(parameter: &Parameter, assignment: &Assignment) -> Result<(), FitError> {
    let Some(prior) = assignment.prior else { return Ok(()) };
    check_finite("prior's mean", &parameter.name, prior.mean)?;
    if prior.sigma.is_finite() && prior.sigma > 0.0 {
        return Ok(());
    }
    let name = parameter.name.clone();
    Err(FitError::NotFinite { what: "prior's standard deviation", name, value: prior.sigma, and: " above 0" })
}

fn check_free(
    index: usize,
    parameter: &Parameter,
    start: f64,
    lower: f64,
    upper: f64,
) -> Result<FreeParameter, FitError> {
    let name = || parameter.name.clone();
    if lower.is_nan() || upper.is_nan() || lower >= upper {
        return Err(FitError::Bounds { name: name(), lower, upper });
    }
    if !(start.is_finite() && start >= lower && start <= upper) {
        return Err(FitError::Start { name: name(), start, lower, upper });
    }
    let range = upper - lower;
    let scale = [start.abs(), if range.is_finite() { range } else { 0.0 }, 1.0];
    let scale = scale.into_iter().find(|&size| size > 0.0).unwrap_or(1.0);
    let FreeStyle { spread, scan_step } = FreeStyle::of(parameter, lower);
    Ok(FreeParameter { index, start, lower, upper, spread, scan_step, scale })
}

/// What the declaration says of spreading starts, as far as the bounds allow it.
struct FreeStyle {
    spread: Spread,
    scan_step: Option<f64>,
}

impl FreeStyle {
    fn of(parameter: &Parameter, lower: f64) -> Self {
        let spread = if lower > 0.0 { parameter.spread } else { Spread::Linear };
        Self { spread, scan_step: parameter.scan_step.filter(|step| step.is_finite() && *step > 0.0) }
    }
}

fn resolve(
    index: usize,
    constant: f64,
    terms: &[(usize, f64)],
    parameters: &[Parameter],
    assignments: &[Assignment],
    fixed: &[f64],
    place: &[Option<usize>],
) -> Result<Tie, FitError> {
    let name = &parameters[index].name;
    let mut tie = Tie {
        index,
        constant: check_finite("tie's constant", name, constant)?,
        terms: Vec::new(),
        lower: parameters[index].lower,
        upper: parameters[index].upper,
    };
    for &(other, factor) in terms {
        check_finite("tie's factor", name, factor)?;
        let Some(role) = assignments.get(other).map(|assignment| &assignment.role) else {
            return Err(FitError::TiedToNothing { name: name.clone(), index: other, count: parameters.len() });
        };
        match (role, place[other]) {
            (Role::Tied { .. }, _) => {
                let other = parameters[other].name.clone();
                return Err(FitError::TiedToTied { name: name.clone(), other });
            }
            (_, Some(position)) => tie.terms.push((position, factor)),
            (_, None) => tie.constant += factor * fixed[other],
        }
    }
    Ok(tie)
}
