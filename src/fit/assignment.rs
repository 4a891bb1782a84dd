//! What a job says of each parameter: free, fixed, tied, and what is known of it beforehand.

/// What the engine does with a parameter.
#[derive(Debug, Clone, PartialEq)]
pub enum Role {
    /// Fitted, between bounds that it may touch.
    Free {
        /// First start point.
        start: f64,
        /// Smallest allowed value.
        lower: f64,
        /// Largest allowed value.
        upper: f64,
    },
    /// Kept at this value.
    Fixed(f64),
    /// `constant + Σ factor · parameter`, over parameters that are not tied themselves.
    Tied {
        /// The constant term.
        constant: f64,
        /// Index of a parameter and its factor.
        terms: Vec<(usize, f64)>,
    },
}

/// A Gaussian prior, one more residual (value − mean)/σ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prior {
    /// Expected value.
    pub mean: f64,
    /// Its standard deviation.
    pub sigma: f64,
}

/// Every parameter's value before anything is fitted: first starts, fixed values, and the ties to those.
///
/// # Panics
/// If a tie's index is beyond the list, which [`check`](super::check) refuses.
pub fn first_values(assignments: &[Assignment]) -> Vec<f64> {
    let own = |assignment: &Assignment| match assignment.role {
        Role::Free { start, .. } => start,
        Role::Fixed(value) => value,
        Role::Tied { constant, .. } => constant,
    };
    let own: Vec<f64> = assignments.iter().map(own).collect();
    let with_ties = assignments.iter().zip(&own).map(|(assignment, value)| match &assignment.role {
        Role::Tied { terms, .. } => value + terms.iter().map(|(index, factor)| factor * own[*index]).sum::<f64>(),
        _ => *value,
    });
    with_ties.collect()
}

/// One parameter's role and prior.
#[derive(Debug, Clone, PartialEq)]
pub struct Assignment {
    /// Free, fixed or tied.
    pub role: Role,
    /// What is known beforehand, if anything.
    pub prior: Option<Prior>,
}
