//! The job's model run forward at any parameter values.

use super::outcome::View;
use crate::fit::{Assignment, Residuals, Role, first_values};
use crate::job::JobError;
use crate::job::case::{CheckedCase, Comparison, spectra_problem};
use crate::job::file::ParameterFile;
use crate::job::spectra::SpectraProblem;
use crate::job::values::{Values, check_inside, checked};
use crate::measure::Quantity;
use crate::number::plain;
use crate::parameter::Parameter;

/// A case that is run forward.
#[derive(Debug)]
pub(super) struct Forward {
    problem: SpectraProblem,
    /// Each parameter's role.
    pub(super) assignments: Vec<Assignment>,
    /// The job's own values.
    pub(super) own: Vec<f64>,
    /// Which spectra are read.
    pub(super) views: Vec<View>,
    /// What a reading means.
    pub(super) quantity: Quantity,
}

/// Why the model gives no reading: a sentence that names the values.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{0}")]
pub(super) struct Refusal(pub(super) String);

impl Refusal {
    /// The same as an error of this key.
    pub(super) fn at(self, key: &str) -> JobError {
        JobError::key(key, self.0)
    }
}

impl Forward {
    /// The case with these parameters set; `least_roughness` is the smallest roughness that will be asked for.
    pub(super) fn new(case: &CheckedCase, set: &Values, least_roughness: Option<f64>) -> Result<Self, JobError> {
        let Comparison::Spectra(table, ..) = &case.comparison else {
            let problem = "a sweep needs spectra, and this job's data are peak wavelengths; give it geometry and \
                           wavelengths by `data.synthetic` and a model that has spectra, as `coated-base`";
            return Err(JobError::key("data", problem));
        };
        let mut file = case.file.clone();
        if let Some(roughness) = least_roughness {
            // How finely open cones are summed hangs on the narrowest lobe.
            file.parameters.insert("roughness".to_owned(), ParameterFile::Fixed(roughness));
        }
        let problem = spectra_problem(&file, table, &vec![true; table.spectra.len()])?;
        let mut assignments = case.assignments.clone();
        for (name, &value) in set {
            let places = checked(problem.parameters(), name, value)
                .map_err(|problem| JobError::Option { option: "--set", problem: format!("{name}: {problem}") })?;
            for index in places {
                assignments[index].role = match assignments[index].role {
                    // A free parameter keeps its range.
                    Role::Free { lower, upper, .. } => Role::Free { start: value, lower, upper },
                    Role::Fixed(_) | Role::Tied { .. } => Role::Fixed(value),
                };
            }
        }
        let views = table.spectra.iter().map(|spectrum| View {
            id: spectrum.id.clone(),
            geometry: spectrum.geometry,
            wavelengths_nm: spectrum.wavelengths_nm.clone(),
        });
        Ok(Self {
            problem,
            own: first_values(&assignments),
            assignments,
            views: views.collect(),
            quantity: table.quantity,
        })
    }

    pub(super) fn parameters(&self) -> &[Parameter] {
        self.problem.parameters()
    }

    /// Number of readings at one point.
    pub(super) fn reading_count(&self) -> usize {
        self.views.iter().map(|view| view.wavelengths_nm.len()).sum()
    }

    /// All values with some parameters moved from the job's own.
    pub(super) fn values(&self, moved: &[(usize, f64)]) -> Result<Vec<f64>, Refusal> {
        let mut values = self.own.clone();
        for &(index, value) in moved {
            values[index] = value;
        }
        for (index, assignment) in self.assignments.iter().enumerate() {
            if let Role::Tied { constant, terms } = &assignment.role {
                values[index] = terms.iter().fold(*constant, |sum, (other, factor)| sum + factor * values[*other]);
            }
        }
        for (parameter, value) in self.parameters().iter().zip(&values) {
            check_inside(parameter, *value)
                .map_err(|problem| Refusal(format!("{}, {}: {problem}", self.place(moved), parameter.name)))?;
        }
        Ok(values)
    }

    /// The model's readings with some parameters moved from the job's own values, one list a view.
    pub(super) fn readings(&self, moved: &[(usize, f64)]) -> Result<Vec<Vec<f64>>, Refusal> {
        let values = self.values(moved)?;
        let readings = self.problem.readings(&values);
        for (view, readings) in self.views.iter().zip(&readings) {
            if let Some(bad) = readings.iter().position(|reading| !reading.is_finite()) {
                let nm = view.wavelengths_nm[bad];
                let what = format!("the model's reading of {} at {nm} nm is {}", view.id, readings[bad]);
                return Err(Refusal(format!("{}, {what}; narrow the range", self.place(moved))));
            }
        }
        Ok(readings)
    }

    /// Between which values a parameter may move while the others keep the job's own: its declaration and its ties say.
    pub(super) fn range(&self, index: usize) -> (f64, f64) {
        let parameter = &self.parameters()[index];
        let (mut lower, mut upper) = (parameter.lower, parameter.upper);
        for (assignment, tied) in self.assignments.iter().zip(self.parameters()) {
            let Role::Tied { constant, terms } = &assignment.role else { continue };
            let Some((_, factor)) = terms.iter().find(|(other, factor)| *other == index && *factor != 0.0) else {
                continue;
            };
            let others = terms.iter().filter(|(other, _)| *other != index);
            let rest = others.fold(*constant, |sum, (other, factor)| sum + factor * self.own[*other]);
            let ends = [(tied.lower - rest) / factor, (tied.upper - rest) / factor];
            lower = lower.max(ends[0].min(ends[1]));
            upper = upper.min(ends[0].max(ends[1]));
        }
        (lower, upper)
    }

    /// `at cortex.thickness_nm = 330` of the moved parameters.
    fn place(&self, moved: &[(usize, f64)]) -> String {
        if moved.is_empty() {
            return "at the job's own values".to_owned();
        }
        let parts =
            moved.iter().map(|(index, value)| format!("{} = {}", self.parameters()[*index].name, plain(*value)));
        format!("at {}", parts.collect::<Vec<_>>().join(", "))
    }
}
