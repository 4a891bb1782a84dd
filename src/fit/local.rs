//! One local solve from one start, in argmin's executor.

use std::sync::{Arc, Mutex, PoisonError};

use argmin::core::observers::{Observe, ObserverMode};
use argmin::core::{Error, Executor, KV, State};
use nalgebra::DVector;

use super::differences::{Bounds, Differences};
use super::least_squares::{Finish, LeastSquares, LocalState};
use super::objective::Objective;
use super::outcome::StopReason;

/// Where a solver ended.
#[derive(Debug, Clone)]
pub(super) struct LocalFit {
    pub(super) free: Vec<f64>,
    pub(super) cost: f64,
    pub(super) stop: StopReason,
    /// The points it went through, first to last.
    pub(super) path: Vec<Vec<f64>>,
}

/// Runs Levenberg–Marquardt from `start`; None where not even the start is finite.
pub(super) fn least_squares(
    objective: &Objective<'_>,
    differences: Differences<'_>,
    bounds: &Bounds,
    start: &[f64],
    finish: Finish,
    max_iterations: u64,
) -> Option<LocalFit> {
    let solver = LeastSquares::new(objective, differences, bounds.clone(), finish);
    let path = Path::default();
    let result = Executor::new(objective, solver)
        .configure(|state: LocalState| state.param(DVector::from_column_slice(start)).max_iters(max_iterations))
        .add_observer(path.clone(), ObserverMode::Always)
        .run()
        .ok()?;
    let stop = result.solver.stop();
    let free: Vec<f64> = result.state.get_param()?.data.as_vec().clone();
    let cost = result.state.get_cost();
    cost.is_finite().then(|| LocalFit { free, cost, stop, path: path.take() })
}

/// An observer that remembers the points of a run.
#[derive(Debug, Clone, Default)]
struct Path(Arc<Mutex<Vec<Vec<f64>>>>);

impl Path {
    fn take(&self) -> Vec<Vec<f64>> {
        std::mem::take(&mut *self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }

    fn push(&self, state: &LocalState) {
        if let Some(free) = state.get_param() {
            self.0.lock().unwrap_or_else(PoisonError::into_inner).push(free.data.as_vec().clone());
        }
    }
}

impl Observe<LocalState> for Path {
    fn observe_init(&mut self, _name: &str, state: &LocalState, _log: &KV) -> Result<(), Error> {
        self.push(state);
        Ok(())
    }

    fn observe_iter(&mut self, state: &LocalState, _log: &KV) -> Result<(), Error> {
        self.push(state);
        Ok(())
    }
}
