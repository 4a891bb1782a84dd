//! The fit engine: parameters, residuals, solvers, starts, uncertainty. It knows nothing of feathers.

mod assignment;
mod checkpoint;
mod control;
mod curvature;
mod differences;
mod engine;
mod error;
mod expression;
mod least_squares;
mod linear;
mod local;
mod loss;
mod mapping;
mod minima;
mod objective;
mod open;
mod outcome;
mod profile;
mod random_effects;
mod residuals;
mod search;
mod smooth;
mod starts;
mod statistics;
mod step;
mod summary;
mod warnings;

pub use assignment::{Assignment, Prior, Role, first_values};
pub use checkpoint::{CheckpointError, Checkpoints};
pub use control::Control;
pub use engine::{check, fit};
pub use error::FitError;
pub use expression::{ExpressionError, parse_tie};
pub use outcome::{
    Bound, Estimate, Fit, Goodness, Loss, Minimum, OpenDirection, ProfilePoint, RIVAL_SHARE, Settings, SigmaSource,
    Solver, StopReason, TracePoint,
};
pub use random_effects::{RandomEffects, random_effects};
pub use residuals::Residuals;
pub use statistics::effective_readings;
pub use warnings::misfit;
