//! Mistakes in what the user asked for, which no solver can mend.

use thiserror::Error;

use super::checkpoint::CheckpointError;

/// Why a fit could not begin. Numerical trouble is never an error: it ends in a [`Fit`](super::Fit) whose
/// [`StopReason`](super::StopReason) says so.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum FitError {
    /// One assignment a parameter is needed.
    #[error("{found} assignments were given for {expected} parameters; give exactly one for each parameter.")]
    AssignmentCount {
        /// Number of parameters.
        expected: usize,
        /// Number of assignments.
        found: usize,
    },
    /// Nothing to fit.
    #[error("no parameter is free; let at least one parameter be fitted.")]
    NothingFree,
    /// The bounds leave no room.
    #[error(
        "the bounds of `{name}` leave no room: lower {lower}, upper {upper}; the lower one must be smaller (to hold a parameter, fix it)."
    )]
    Bounds {
        /// Parameter.
        name: String,
        /// Lower bound as given.
        lower: f64,
        /// Upper bound as given.
        upper: f64,
    },
    /// The start lies outside the bounds or is no number.
    #[error("the start value {start} of `{name}` must be a finite number between its bounds {lower} and {upper}.")]
    Start {
        /// Parameter.
        name: String,
        /// Start as given.
        start: f64,
        /// Lower bound.
        lower: f64,
        /// Upper bound.
        upper: f64,
    },
    /// A fixed value, tie or prior that is no number.
    #[error("the {what} of `{name}` is {value}; it must be a finite number{and}.")]
    NotFinite {
        /// What it is: `fixed value`, `prior's mean`.
        what: &'static str,
        /// Parameter.
        name: String,
        /// Value as given.
        value: f64,
        /// Further demand, as the end of the sentence: ` above 0`.
        and: &'static str,
    },
    /// A tie to something that is itself tied.
    #[error("`{name}` is tied to `{other}`, which is tied itself; tie it to what `{other}` is tied to.")]
    TiedToTied {
        /// The tied parameter.
        name: String,
        /// The one it refers to.
        other: String,
    },
    /// A tie to a parameter that does not exist.
    #[error("`{name}` is tied to parameter number {index}, but there are only {count} (counted from 0).")]
    TiedToNothing {
        /// The tied parameter.
        name: String,
        /// Index as given.
        index: usize,
        /// Number of parameters.
        count: usize,
    },
    /// A tie that starts outside the range of the tied parameter.
    #[error(
        "at the start values the tie gives `{name}` the value {value}, outside its range {lower} to {upper}; change the tie or the start values."
    )]
    TieOutOfRange {
        /// The tied parameter.
        name: String,
        /// Its value at the start.
        value: f64,
        /// Its declared lower bound.
        lower: f64,
        /// Its declared upper bound.
        upper: f64,
    },
    /// More unknowns than data, and nothing known beforehand.
    #[error(
        "{free} free parameters ({names}) cannot be found from {rows} readings and priors; fix some of them, or give them priors."
    )]
    TooFewReadings {
        /// Number of free parameters.
        free: usize,
        /// Their names, separated by commas.
        names: String,
        /// Readings and priors together.
        rows: usize,
    },
    /// A setting outside its range.
    #[error("the setting `{name}` is {value}; it must be {expected}.")]
    Setting {
        /// Name of the setting.
        name: &'static str,
        /// Value as given.
        value: String,
        /// Allowed range.
        expected: &'static str,
    },
    /// The checkpoint of an earlier run.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// No start gave a finite residual.
    #[error(
        "the model gives no finite residuals at any of the {starts} start points (the first has {first}); check the start values, the bounds and the readings."
    )]
    NoFiniteStart {
        /// How many were tried.
        starts: usize,
        /// The first start in words, `d = 300, gain = 1`.
        first: String,
    },
}
