//! The fit engine: parameters, residuals, solvers, starts, uncertainty. It knows nothing of feathers.

mod assignment;
mod outcome;
mod residuals;

pub use assignment::{Assignment, Prior, Role};
pub use outcome::{
    Bound, Estimate, Fit, Goodness, Loss, Minimum, OpenDirection, ProfilePoint, Settings, SigmaSource, Solver,
    StopReason, TracePoint,
};
pub use residuals::Residuals;
