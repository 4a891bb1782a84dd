//! How much a number changes with what it is computed from: slopes at a point, and shares of the variance over ranges.
//!
//! Like [`fit`](crate::fit) it knows nothing of feathers: a function of numbers goes in, and every answer comes with its
//! own error.

mod derivative;
mod sobol;

pub use derivative::{Derivative, DerivativeError, Range, Side, derivative};
pub use sobol::{Estimate, Indices, Shares, SobolSettings, sobol_indices};
