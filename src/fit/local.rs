//! One local solve from one start, in argmin's executor, which may have begun in an earlier run.

use std::fmt::Arguments;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use argmin::core::checkpointing::{Checkpoint, CheckpointingFrequency};
use argmin::core::observers::{Observe, ObserverMode};
use argmin::core::{Error, Executor, KV, State};
use nalgebra::DVector;
use serde::{Deserialize, Serialize};

use super::checkpoint::{Progress, Record, Running, Solve, digest};
use super::differences::{Bounds, Differences};
use super::least_squares::{Finish, LeastSquares, LocalState};
use super::objective::{Counters, Objective};
use super::outcome::StopReason;

/// Where a solver ended.
#[derive(Debug, Clone, Serialize, Deserialize)]
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
    differences: Differences,
    bounds: &Bounds,
    start: &[f64],
    finish: Finish,
    max_iterations: u64,
) -> Option<LocalFit> {
    let task = (start, bounds, differences.steps().to_vec(), finish, max_iterations);
    once(objective, format_args!("least squares {task:?}"), |objective, place| {
        let solver = LeastSquares::new(objective, differences, bounds.clone(), finish);
        let path = Path::default();
        let saving = place.map(|place| Saving::new(place, &solver, &path, max_iterations));
        let mut executor = Executor::new(objective, solver)
            .configure(|state: LocalState| state.param(DVector::from_column_slice(start)).max_iters(max_iterations))
            .add_observer(path.clone(), ObserverMode::Always);
        if let Some(saving) = saving {
            executor = executor.checkpointing(saving);
        }
        let result = executor.run().ok()?;
        let stop = result.solver.stop();
        let free: Vec<f64> = result.state.get_param()?.data.as_vec().clone();
        let cost = result.state.get_cost();
        cost.is_finite().then(|| LocalFit { free, cost, stop, path: path.take() })
    })
}

/// Where a running solve saves itself.
#[derive(Debug)]
pub(super) struct Place {
    record: Arc<Record>,
    key: String,
    counters: Arc<Counters>,
}

/// Solves what `task` describes in full, or takes its end from an earlier run.
pub(super) fn once<F>(objective: &Objective<'_>, task: Arguments<'_>, solve: F) -> Option<LocalFit>
where
    F: FnOnce(&Objective<'_>, Option<Place>) -> Option<LocalFit>,
{
    let Some(record) = objective.record else { return solve(objective, None) };
    let key = digest(&format!("{task} coarse {} σ {:?}", objective.coarse, objective.sigma));
    let counters = Arc::new(Counters::default());
    if let Some(Solve { counts, progress }) = record.find(&key) {
        counters.add(counts);
        if let Progress::Ended(end) = progress {
            objective.counters.add(counts);
            return end;
        }
    }
    let place = Place { record: Arc::clone(record), key: key.clone(), counters: Arc::clone(&counters) };
    let end = solve(&objective.counted_by(&counters), Some(place));
    objective.counters.add(counters.counts());
    // What the user stopped has not ended.
    if !objective.control.interrupted() {
        record.note(&key, Solve { counts: counters.counts(), progress: Progress::Ended(end.clone()) });
    }
    end
}

/// argmin's checkpoint of one solve of least squares.
struct Saving {
    place: Place,
    /// What a saved solver is completed from.
    fresh: LeastSquares,
    path: Path,
    max_iterations: u64,
    last: Mutex<Instant>,
}

impl Saving {
    fn new(place: Place, fresh: &LeastSquares, path: &Path, max_iterations: u64) -> Self {
        Self { place, fresh: fresh.clone(), path: path.clone(), max_iterations, last: Mutex::new(Instant::now()) }
    }
}

impl Checkpoint<LeastSquares, LocalState> for Saving {
    fn save(&self, solver: &LeastSquares, state: &LocalState) -> Result<(), Error> {
        let Some(free) = state.get_param() else { return Ok(()) };
        let running = Running {
            solver: solver.clone(),
            free: free.data.as_vec().clone(),
            cost: state.get_cost(),
            iteration: state.get_iter(),
            path: self.path.points(),
        };
        let solve = Solve { counts: self.place.counters.counts(), progress: Progress::Running(Box::new(running)) };
        self.place.record.note(&self.place.key, solve);
        Ok(())
    }

    /// By the clock, where argmin counts iterations: one of them takes from a microsecond to minutes.
    fn save_cond(&self, solver: &LeastSquares, state: &LocalState, _iteration: u64) -> Result<(), Error> {
        let mut last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        // A solver that has stopped is about to be noted as ended, or was interrupted in the middle of an iteration.
        if solver.runs() && last.elapsed() >= self.place.record.interval {
            *last = Instant::now();
            self.save(solver, state)?;
        }
        Ok(())
    }

    fn load(&self) -> Result<Option<(LeastSquares, LocalState)>, Error> {
        let Some(Solve { progress: Progress::Running(running), .. }) = self.place.record.find(&self.place.key) else {
            return Ok(None);
        };
        self.path.set(running.path);
        let state = LocalState::new().param(DVector::from_vec(running.free)).cost(running.cost);
        let state = LocalState { iter: running.iteration, ..state.max_iters(self.max_iterations) };
        Ok(Some((self.fresh.resumed(running.solver), state)))
    }

    fn frequency(&self) -> CheckpointingFrequency {
        CheckpointingFrequency::Always
    }
}

/// An observer that remembers the points of a run.
#[derive(Debug, Clone, Default)]
struct Path(Arc<Mutex<Vec<Vec<f64>>>>);

impl Path {
    fn take(&self) -> Vec<Vec<f64>> {
        std::mem::take(&mut *self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }

    fn points(&self) -> Vec<Vec<f64>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    fn set(&self, points: Vec<Vec<f64>>) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = points;
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
