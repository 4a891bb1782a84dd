//! argmin's own L-BFGS, Nelder–Mead and particle swarm, behind the guard.
//!
//! L-BFGS and Nelder–Mead know no bounds; they move u, of which every value is allowed: x = middle + half·sin u between two
//! bounds, x = bound ± s(√(1 + u²) − 1) at one, x = start + s·u without any (James & Roos 1975). The map is smooth and
//! meets the bounds; its slope vanishes there, so that a start on a bound is moved a little inwards.
//!
//! What they see is the cost as a share of the cost at the start. A value that is not finite becomes a million times that,
//! which all three take as a bad step: NaN would hang the line search of Moré and Thuente, end Nelder–Mead and panic the
//! swarm. Whatever they return, the best point is the guard's, and whether it is a minimum is judged by the gradient:
//! argmin's L-BFGS says "stopped" in many words, and a simplex that has collapsed says "converged" anywhere.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use argmin::core::{
    CostFunction, Error, Executor, Gradient, IterState, KV, PopulationState, Problem, Solver, State, TerminationReason,
    TerminationStatus,
};
use argmin::solver::linesearch::MoreThuenteLineSearch;
use argmin::solver::neldermead::NelderMead;
use argmin::solver::particleswarm::{Particle, ParticleSwarm};
use argmin::solver::quasinewton::LBFGS;
use nalgebra::DVector;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::curvature::Curvature;
use super::differences::{Accuracy, Bounds, Differences, Pattern};
use super::local::{LocalFit, once};
use super::objective::{BestSoFar, Objective, Point};
use super::outcome::StopReason;
use super::starts::range;

/// Cost of what is not finite, in units of the cost at the start.
const REFUSED: f64 = 1e6;
/// Pairs of gradients that L-BFGS remembers (Nocedal & Wright 2006, section 7.2: 3 to 20).
const MEMORY: usize = 10;
/// Evaluations of the cost in one iteration beyond which a line search is lost.
const LINE_SEARCH: u64 = 100;
/// Smallest swarm.
const PARTICLES: usize = 16;

/// Which of the two solvers in u.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Method {
    LBfgs,
    NelderMead,
}

/// One parameter's change of variable.
#[derive(Debug, Clone, Copy)]
enum Change {
    Box {
        middle: f64,
        half: f64,
    },
    /// The bound, and the signed size on its inner side.
    Half {
        bound: f64,
        size: f64,
    },
    Line {
        start: f64,
        size: f64,
    },
}

impl Change {
    fn new(lower: f64, upper: f64, start: f64, scale: f64) -> Self {
        match (lower.is_finite(), upper.is_finite()) {
            (true, true) => Self::Box { middle: 0.5 * (lower + upper), half: 0.5 * (upper - lower) },
            (true, false) => Self::Half { bound: lower, size: scale },
            (false, true) => Self::Half { bound: upper, size: -scale },
            (false, false) => Self::Line { start, size: scale },
        }
    }

    /// x and dx/du.
    fn value(self, u: f64) -> (f64, f64) {
        match self {
            Self::Box { middle, half } => (middle + half * u.sin(), half * u.cos()),
            Self::Half { bound, size } => {
                let root = u.hypot(1.0);
                // √(1 + u²) − 1 without cancellation.
                (bound + size * (u * u / (root + 1.0)), size * u / root)
            }
            Self::Line { start, size } => (start + size * u, size),
        }
    }

    /// u of a start, a thousandth inside any bound.
    fn inverse(self, x: f64) -> f64 {
        match self {
            Self::Box { middle, half } => ((x - middle) / half).clamp(-0.999, 0.999).asin(),
            Self::Half { bound, size } => {
                let reach = ((x - bound) / size).max(1e-3);
                (reach * (reach + 2.0)).sqrt()
            }
            Self::Line { start, size } => (x - start) / size,
        }
    }
}

/// The guard as argmin's solvers see it.
struct Guarded<'a> {
    objective: &'a Objective<'a>,
    bounds: &'a Bounds,
    pattern: &'a Pattern,
    changes: Vec<Change>,
    unit: f64,
    best: &'a BestSoFar,
    /// Calls of the cost since the last iteration; an error ends a line search that this says is lost.
    calls: AtomicU64,
    /// Whether an error may be returned: Nelder–Mead's first simplex unwraps it.
    may_fail: bool,
}

impl Guarded<'_> {
    fn point(&self, u: &DVector<f64>) -> Vec<f64> {
        let value =
            |(j, &u): (usize, &f64)| self.changes[j].value(u).0.clamp(self.bounds.lower[j], self.bounds.upper[j]);
        u.iter().enumerate().map(value).collect()
    }

    /// Rows before the loss at x, and the cost; None where not finite.
    fn rows(&self, free: &[f64]) -> Option<(Vec<f64>, f64)> {
        let mut values = vec![0.0; self.objective.residuals.parameters().len()];
        let mut rows = vec![0.0; self.objective.rows()];
        if !self.objective.evaluate(free, &mut values, &mut rows) {
            return None;
        }
        let cost = self.objective.cost(&rows);
        self.best.offer(free, cost);
        Some((rows, cost))
    }
}

impl CostFunction for &Guarded<'_> {
    type Param = DVector<f64>;
    type Output = f64;

    fn cost(&self, u: &DVector<f64>) -> Result<f64, Error> {
        let lost = self.calls.fetch_add(1, Ordering::Relaxed) > LINE_SEARCH || self.objective.control.interrupted();
        if self.may_fail && lost {
            return Err(Error::msg("ended by the guard"));
        }
        Ok(self.rows(&self.point(u)).map_or(REFUSED, |(_, cost)| cost / self.unit))
    }
}

impl Gradient for &Guarded<'_> {
    type Param = DVector<f64>;
    type Gradient = DVector<f64>;

    fn gradient(&self, u: &DVector<f64>) -> Result<DVector<f64>, Error> {
        let free = self.point(u);
        let mut gradient = DVector::zeros(u.len());
        let Some((rows, _)) = self.rows(&free) else { return Ok(gradient) };
        let mut jacobian = vec![0.0; rows.len() * u.len()];
        let mut differences = Differences::new(self.pattern);
        differences.jacobian(self.objective, self.bounds, &free, &rows, Accuracy::Settled, &mut jacobian);
        let psi = self.objective.psi(&rows);
        for (j, column) in jacobian.chunks_exact(rows.len()).enumerate() {
            gradient[j] = 2.0 * super::linear::dot(column, &psi) * self.changes[j].value(u[j]).1 / self.unit;
        }
        Ok(gradient)
    }
}

/// Runs one of argmin's bound-free solvers from `start`; None where the model is finite nowhere on its way.
pub(super) fn bound_free(
    objective: &Objective<'_>,
    pattern: &Pattern,
    bounds: &Bounds,
    start: &[f64],
    method: Method,
    max_iterations: u64,
) -> Option<LocalFit> {
    let task = (start, method, max_iterations);
    once(objective, format_args!("bound-free {task:?}"), |objective, _| {
        bound_free_anew(objective, pattern, bounds, start, method, max_iterations)
    })
}

fn bound_free_anew(
    objective: &Objective<'_>,
    pattern: &Pattern,
    bounds: &Bounds,
    start: &[f64],
    method: Method,
    max_iterations: u64,
) -> Option<LocalFit> {
    let changes: Vec<Change> = (0..start.len())
        .map(|j| Change::new(bounds.lower[j], bounds.upper[j], start[j], objective.mapping.free[j].scale))
        .collect();
    let u = DVector::from_iterator(start.len(), changes.iter().zip(start).map(|(change, &x)| change.inverse(x)));
    let best = BestSoFar::default();
    let calls = AtomicU64::new(0);
    let may_fail = method == Method::LBfgs;
    let mut guarded = Guarded { objective, bounds, pattern, changes, unit: 1.0, best: &best, calls, may_fail };
    let (_, cost) = guarded.rows(&guarded.point(&u))?;
    guarded.unit = if cost > 0.0 { cost } else { 1.0 };
    let limit = match method {
        Method::LBfgs => {
            let solver: LBFGS<_, DVector<f64>, DVector<f64>, f64> = LBFGS::new(MoreThuenteLineSearch::new(), MEMORY);
            // Both in units of the cost at the start; the judge below decides what they are worth.
            let solver = solver.with_tolerance_grad(1e-13).and_then(|solver| solver.with_tolerance_cost(1e-16)).ok()?;
            let solver = Watched { inner: solver, interrupt: objective.control.interrupt, calls: &guarded.calls };
            let executor = Executor::new(&guarded, solver).configure(
                |state: IterState<DVector<f64>, DVector<f64>, (), (), (), f64>| {
                    state.param(u).max_iters(max_iterations)
                },
            );
            executor.run().is_ok_and(|result| at_limit(&result.state))
        }
        Method::NelderMead => {
            let corners = (0..=u.len()).map(|corner| {
                let mut vertex = u.clone();
                if corner > 0 {
                    vertex[corner - 1] += 0.1;
                }
                vertex
            });
            let solver = NelderMead::new(corners.collect()).with_sd_tolerance(1e-15).ok()?;
            let solver = Watched { inner: solver, interrupt: objective.control.interrupt, calls: &guarded.calls };
            // A simplex moves one vertex an iteration, so that one for each parameter is one of the other solvers'.
            let iterations = max_iterations.saturating_mul(start.len() as u64);
            let executor = Executor::new(&guarded, solver)
                .configure(|state: IterState<DVector<f64>, (), (), (), (), f64>| state.max_iters(iterations));
            executor.run().is_ok_and(|result| at_limit(&result.state))
        }
    };
    let Point { free, cost } = best.take()?;
    let stop = judge(objective, pattern, bounds, &free, cost, limit);
    Some(LocalFit { path: vec![start.to_vec(), free.clone()], free, cost, stop })
}

/// The best point of a swarm over the box; None where the model is finite nowhere.
pub(super) fn swarm(
    objective: &Objective<'_>,
    pattern: &Pattern,
    bounds: &Bounds,
    particles: usize,
    seed: u64,
    max_iterations: u64,
) -> Option<LocalFit> {
    once(objective, format_args!("swarm"), |objective, _| {
        swarm_anew(objective, pattern, bounds, particles, seed, max_iterations)
    })
}

fn swarm_anew(
    objective: &Objective<'_>,
    pattern: &Pattern,
    bounds: &Bounds,
    particles: usize,
    seed: u64,
    max_iterations: u64,
) -> Option<LocalFit> {
    let ranges: Vec<(f64, f64)> = objective.mapping.free.iter().map(range).collect();
    let best = BestSoFar::default();
    let changes = ranges.iter().map(|&(lower, upper)| Change::Line { start: lower, size: upper - lower }).collect();
    let calls = AtomicU64::new(0);
    let (_, unit) = rows_at_start(objective)?;
    let guarded = Guarded { objective, bounds, pattern, changes, unit, best: &best, calls, may_fail: false };
    let corners = (DVector::zeros(ranges.len()), DVector::from_element(ranges.len(), 1.0));
    let solver: ParticleSwarm<DVector<f64>, f64, _> =
        ParticleSwarm::new(corners, particles.max(PARTICLES)).with_rng_generator(ChaCha8Rng::seed_from_u64(seed));
    let solver = Watched { inner: solver, interrupt: objective.control.interrupt, calls: &guarded.calls };
    let executor = Executor::new(&guarded, solver)
        .configure(|state: PopulationState<Particle<DVector<f64>, f64>, f64>| state.max_iters(max_iterations));
    // An error could only be the guard's, whose best point is kept.
    drop(executor.run());
    let Point { free, cost } = best.take()?;
    // Not judged: it is polished before anything is made of it.
    Some(LocalFit { path: vec![free.clone()], free, cost, stop: StopReason::Limit })
}

fn rows_at_start(objective: &Objective<'_>) -> Option<(Vec<f64>, f64)> {
    let mut values = vec![0.0; objective.residuals.parameters().len()];
    let mut rows = vec![0.0; objective.rows()];
    let finite = objective.evaluate(&objective.mapping.start(), &mut values, &mut rows);
    let cost = if finite { objective.cost(&rows) } else { 1.0 };
    Some((rows, if cost > 0.0 { cost } else { 1.0 }))
}

fn at_limit(state: &impl State) -> bool {
    matches!(state.get_termination_reason(), Some(TerminationReason::MaxItersReached))
}

/// What the gradient says of a point, whatever its solver said: converged where a full step promises less than a
/// hundredth of a standard error.
fn judge(
    objective: &Objective<'_>,
    pattern: &Pattern,
    bounds: &Bounds,
    free: &[f64],
    cost: f64,
    limit: bool,
) -> StopReason {
    if objective.control.interrupted() {
        return StopReason::Cancelled;
    }
    let mut differences = Differences::new(pattern);
    match Curvature::new(objective, &mut differences, bounds, free, Accuracy::Settled) {
        None => StopReason::Failed,
        Some(curvature) if curvature.promise(bounds, free, cost) <= 1e-4 => StopReason::Converged,
        Some(_) if limit => StopReason::Limit,
        Some(_) => StopReason::Stalled,
    }
}

/// A solver that hears the interrupt between iterations.
struct Watched<'a, S> {
    inner: S,
    interrupt: &'a AtomicBool,
    calls: &'a AtomicU64,
}

impl<O, I: State, S: Solver<O, I>> Solver<O, I> for Watched<'_, S> {
    fn name(&self) -> &str {
        self.inner.name()
    }

    fn init(&mut self, problem: &mut Problem<O>, state: I) -> Result<(I, Option<KV>), Error> {
        self.inner.init(problem, state)
    }

    fn next_iter(&mut self, problem: &mut Problem<O>, state: I) -> Result<(I, Option<KV>), Error> {
        self.calls.store(0, Ordering::Relaxed);
        self.inner.next_iter(problem, state)
    }

    fn terminate(&mut self, state: &I) -> TerminationStatus {
        if self.interrupt.load(Ordering::Relaxed) {
            return TerminationStatus::Terminated(TerminationReason::Interrupt);
        }
        self.inner.terminate(state)
    }
}
