//! What stands between physics and fitting.

use std::ops::Range;

use crate::parameter::Parameter;

/// Measurement and model together, as the engine sees them: parameter values in, weighted residuals out.
///
/// The engine decides which parameters are free, where to start and when to stop; an implementation knows only how to
/// compare its model with its readings. Residuals are (model − reading)/σ, or (model − reading) over any constant where
/// σ is unknown; priors and robust losses are the engine's and never appear here.
pub trait Residuals: Sync {
    /// All parameters, in the order in which [`Residuals::evaluate`] takes their values.
    fn parameters(&self) -> &[Parameter];

    /// Number of residuals.
    fn count(&self) -> usize;

    /// Writes the residuals at these parameter values. Called from several threads at once; a value that makes no sense
    /// may give NaN, which the engine's guard turns into a rejected step.
    fn evaluate(&self, values: &[f64], residuals: &mut [f64]);

    /// Rows that this parameter can change. A gain of one spectrum touches that spectrum only, and the engine then
    /// differentiates the gains of all spectra in one evaluation.
    fn touched(&self, parameter: usize) -> Range<usize> {
        let _ = parameter;
        0..self.count()
    }

    /// The same comparison on fewer readings, with the same parameters and about the same minima: what starts are
    /// screened with. None where there is nothing to save.
    fn coarse(&self) -> Option<&dyn Residuals> {
        None
    }

    /// Whether each σ is a measured one, so that χ² has a meaning of its own.
    fn sigma_known(&self) -> bool;
}
