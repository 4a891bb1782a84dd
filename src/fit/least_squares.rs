//! Levenberg–Marquardt for bounded parameters, as a solver of argmin.
//!
//! # What it is
//!
//! From a point x the rows are replaced by their linear model, and the step δ minimises ‖J·δ + r‖² + λ‖D·δ‖² inside the
//! bounds (Levenberg 1944, Marquardt 1963), D holding the lengths of J's columns so that no unit of a parameter matters.
//! The damping λ follows the ratio of true to predicted fall (Nielsen 1999). Steps come from a QR factorisation of J, not
//! from Jᵀ·J, whose condition number is the square. The cost is ‖r‖², not half of it.
//!
//! A damped step is bent towards where the rows bend, or refused where they bend too much (geodesic acceleration), and
//! stretched where the cost falls faster than promised, as it does far from zero residuals.
//!
//! Bounds are kept by an active set: a parameter on a bound whose gradient points outwards is held, the others move as if
//! it were fixed, and it is released when its gradient turns. Nothing is ever evaluated outside the bounds.
//!
//! It travels with one-sided differences until the undamped step promises next to nothing, and then settles with
//! extrapolated ones, with full Gauss–Newton steps, until steps shrink no more: there the cost has long stopped to change
//! in its last digit, and only the gradient still knows where the minimum is.
//!
//! # Settings
//!
//! [`Finish`] says whether to stop after travelling or to settle; the number of iterations is argmin's own.
//!
//! # What the problem must offer
//!
//! [`Objective`]: rows at a point, or the word that they are not finite, which counts as a rejected step.
//!
//! # How it reduces to Gauss–Newton
//!
//! Without bounds and with λ = 0; such a step is taken once it promises next to nothing. A linear problem is solved by its first step to some seven digits, and by its first settled one to all.
//!
//! # How it fails, and what you then get
//!
//! Always the best point so far. Where λ grows past any use without a better point, the solver has stalled; where not
//! even the start is finite, it has failed.
//!
//! # What its convergence does not prove
//!
//! That the minimum is the lowest one, or a minimum at all rather than a saddle or a valley that is level to rounding.
//!
//! # References
//!
//! Levenberg 1944, Quart. Appl. Math. 2, 164. Marquardt 1963, J. SIAM 11, 431. Nielsen 1999, IMM-REP-1999-05.
//! Transtrum & Sethna 2012, arXiv:1201.5885. Moré 1978, Lecture Notes in Mathematics 630, 105 (column scaling).

use argmin::core::{Error, IterState, KV, Problem, Solver, TerminationReason, TerminationStatus};
use argmin::kv;
use nalgebra::DVector;
use serde::{Deserialize, Serialize};

use super::differences::{Accuracy, Bounds, Differences};
use super::objective::{Objective, Point};
use super::outcome::StopReason;
use super::step::{Damping, LinearModel, Step};

/// State that argmin carries: the free vector and its cost.
pub(super) type LocalState = IterState<DVector<f64>, (), (), (), (), f64>;

/// When to stop.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) enum Finish {
    /// When a full step promises less than this share of the cost per row: 1e-4 is a hundredth of a standard error.
    Travelled(f64),
    /// When steps shrink no more.
    Settled,
}

/// λ at the beginning: nearly Gauss–Newton, and soon raised where that is too bold.
const FIRST_DAMPING: f64 = 1e-4;
/// λ of a full step: nothing to what the readings determine, and enough to leave alone what they do not.
pub(super) const FULL: f64 = 1e-14;
/// Beyond this λ a step is lost in rounding.
const LAST_DAMPING: f64 = 1e24;
/// Promise, per row, below which travelling ends.
const SETTLING: f64 = 1e-5;

/// A change of a parameter by its own size is damped at least as much as this share of the rows' length.
const RELATIVE_CHANGE: f64 = 0.3;
/// Share of a step at which the rows are probed for their bend.
const PROBE: f64 = 0.1;
/// A step whose bend is longer than this share of it leaves the region in which the linear model is any guide
/// (Transtrum & Sethna 2012, section 4: 0.75 for twice the ratio).
const MOST_BEND: f64 = 0.375;

/// A step is stretched at most by this much, and not at all by less than that.
const MOST_STRETCH: f64 = 8.0;
const LEAST_STRETCH: f64 = 1.3;

/// The solver with its buffers. What is skipped in a checkpoint is the same for every iteration, or made anew.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct LeastSquares {
    differences: Differences,
    #[serde(skip)]
    bounds: Bounds,
    finish: Finish,
    accuracy: Accuracy,
    damping: f64,
    growth: f64,
    /// Damping of the last step that helped.
    helpful: f64,
    /// Rows at the present point, before the loss; empty where they are not known, after a checkpoint.
    #[serde(skip)]
    rows: Vec<f64>,
    #[serde(skip)]
    trial: Vec<f64>,
    #[serde(skip)]
    values: Vec<f64>,
    #[serde(skip)]
    jacobian: Vec<f64>,
    #[serde(skip)]
    right: Vec<f64>,
    #[serde(skip)]
    here: Vec<f64>,
    #[serde(skip)]
    scale: Vec<f64>,
    /// Smallest settled step so far, relative, and how many have not been smaller since.
    smallest: Option<f64>,
    idle: usize,
    stop: Option<StopReason>,
}

impl LeastSquares {
    pub(super) fn new(objective: &Objective<'_>, differences: Differences, bounds: Bounds, finish: Finish) -> Self {
        let (rows, free) = (objective.rows(), bounds.lower.len());
        Self {
            differences,
            bounds,
            finish,
            accuracy: Accuracy::Travel,
            damping: FIRST_DAMPING,
            growth: 2.0,
            helpful: FIRST_DAMPING,
            rows: vec![0.0; rows],
            trial: vec![0.0; rows],
            values: vec![0.0; objective.residuals.parameters().len()],
            jacobian: vec![0.0; rows * free],
            right: vec![0.0; rows],
            here: vec![0.0; rows],
            scale: vec![0.0; free],
            smallest: None,
            idle: 0,
            stop: None,
        }
    }

    /// A saved solver, with the surroundings and buffers of this one.
    pub(super) fn resumed(&self, saved: Self) -> Self {
        let Self { bounds, trial, values, jacobian, right, here, scale, .. } = self.clone();
        let differences = self.differences.with_steps_of(saved.differences);
        Self { differences, bounds, trial, values, jacobian, right, here, scale, ..saved }
    }

    /// Whether it is still on its way.
    pub(super) fn runs(&self) -> bool {
        self.stop.is_none()
    }

    /// Why it stopped; a run that argmin ended was at its limit.
    pub(super) fn stop(&self) -> StopReason {
        self.stop.unwrap_or(StopReason::Limit)
    }

    /// Jacobian and rows after the loss, factorised.
    fn linearise(&mut self, objective: &Objective<'_>, free: &[f64]) -> LinearModel {
        let count = self.rows.len();
        self.differences.jacobian(objective, &self.bounds, free, &self.rows, self.accuracy, &mut self.jacobian);
        self.right.copy_from_slice(&self.rows);
        if !objective.loss.is_squares() {
            for (row, value) in self.right[..objective.readings].iter_mut().enumerate() {
                let slope = objective.loss.slope(*value);
                *value = objective.loss.transformed(*value);
                for column in self.jacobian.chunks_exact_mut(count) {
                    column[row] *= slope;
                }
            }
        }
        LinearModel::new(&mut self.jacobian, &mut self.right)
    }

    /// Makes the damping see at least relative changes: where a column vanishes (an exponential that has died out), its
    /// length alone would let its parameter run away to where nothing brings it back.
    fn limit_relative_change(&mut self, objective: &Objective<'_>, point: &Point) {
        for ((scale, x), parameter) in self.scale.iter_mut().zip(&point.free).zip(&objective.mapping.free) {
            *scale = scale.max(RELATIVE_CHANGE * point.cost.sqrt() / x.abs().max(parameter.scale));
        }
    }

    /// One iteration: linearise, then shorten the step until it helps.
    fn iterate(&mut self, objective: &Objective<'_>, point: &mut Point) {
        let model = self.linearise(objective, &point.free);
        for (scale, &length) in self.scale.iter_mut().zip(&model.lengths()) {
            *scale = if length > 0.0 { length } else { 1.0 };
        }
        self.limit_relative_change(objective, point);
        let gradient = model.gradient();
        let held: Vec<bool> = (0..point.free.len()).map(|j| self.bounds.keeps(j, point.free[j], gradient[j])).collect();
        if point.cost == 0.0 || held.iter().all(|&held| held) {
            self.stop = Some(StopReason::Converged);
            return;
        }
        let full = model.step(&point.free, &self.bounds, &held, Damping { factor: FULL, scale: &self.scale });
        #[expect(clippy::cast_precision_loss, reason = "a number of rows is far below 2^53")]
        let promise = full.predicted / point.cost * self.rows.len() as f64;
        match (self.finish, self.accuracy) {
            (Finish::Travelled(enough), _) if promise <= enough => self.stop = Some(StopReason::Converged),
            (Finish::Settled, Accuracy::Travel) if promise <= SETTLING => self.accuracy = Accuracy::Settled,
            (Finish::Settled, Accuracy::Settled) if promise <= SETTLING && self.settle(objective, point, &full) => {}
            _ => self.descend(objective, point, &model, &held),
        }
    }

    /// A full step near the minimum, or the end; false where a full step makes the cost worse than rounding can.
    fn settle(&mut self, objective: &Objective<'_>, point: &mut Point, step: &Step) -> bool {
        let relative = |(x, change): (&f64, &f64)| change.abs() / x.abs().max(f64::MIN_POSITIVE);
        let size = point.free.iter().zip(&step.change).map(relative).fold(0.0, f64::max);
        if size <= 4.0 * f64::EPSILON || self.idle >= 3 {
            self.stop = Some(StopReason::Converged);
            return true;
        }
        let there = self.evaluate(objective, step.aim(&point.free, &self.bounds));
        if there.cost > point.cost * (1.0 + 1e-9) {
            return false;
        }
        if self.smallest.is_none_or(|smallest| size < 0.9 * smallest) {
            (self.smallest, self.idle) = (Some(size), 0);
        } else {
            self.idle += 1;
        }
        self.accept(point, there);
        true
    }

    /// Damped steps, shorter and shorter, until one lowers the cost.
    fn descend(&mut self, objective: &Objective<'_>, point: &mut Point, model: &LinearModel, held: &[bool]) {
        loop {
            if objective.control.interrupted() {
                self.stop = Some(StopReason::Cancelled);
                return;
            }
            let damping = Damping { factor: self.damping, scale: &self.scale };
            let mut step = model.step(&point.free, &self.bounds, held, damping);
            if self.bend(objective, &point.free, model, &mut step) {
                let there = self.evaluate(objective, step.aim(&point.free, &self.bounds));
                let ratio = (point.cost - there.cost) / step.predicted;
                if there.cost < point.cost && ratio > 1e-4 {
                    self.helpful = self.damping;
                    self.damping *= (1.0 - (2.0 * ratio.min(1.0) - 1.0).powi(3)).max(1.0 / 3.0);
                    self.damping = self.damping.max(FIRST_DAMPING * 1e-16);
                    self.growth = 2.0;
                    let foot = point.clone();
                    self.accept(point, there);
                    return self.stretch(objective, &foot, point, model, &step);
                }
            }
            self.damping *= self.growth;
            self.growth *= 2.0;
            if self.damping > LAST_DAMPING {
                return self.exhausted();
            }
        }
    }

    /// Goes further along a step that helped more than the linear model said, to where a parabola through both costs and
    /// the slope has its minimum. Far from zero residuals Gauss–Newton steps are too short by a constant factor, and
    /// would creep.
    fn stretch(
        &mut self,
        objective: &Objective<'_>,
        foot: &Point,
        point: &mut Point,
        model: &LinearModel,
        step: &Step,
    ) {
        let slope = model.slope(&step.change);
        let bend = point.cost - foot.cost - slope;
        let factor = if bend > 0.0 { (-0.5 * slope / bend).min(MOST_STRETCH) } else { MOST_STRETCH };
        if factor < LEAST_STRETCH {
            return;
        }
        let aim = (0..foot.free.len())
            .map(|j| (foot.free[j] + factor * step.change[j]).clamp(self.bounds.lower[j], self.bounds.upper[j]));
        let there = self.evaluate(objective, aim.collect());
        if there.cost < point.cost {
            self.accept(point, there);
        }
    }

    /// Bends the step where the rows do; false where they bend too much for a step of this length.
    fn bend(&mut self, objective: &Objective<'_>, free: &[f64], model: &LinearModel, step: &mut Step) -> bool {
        let probe: Vec<f64> = (0..free.len())
            .map(|j| (free[j] + PROBE * step.change[j]).clamp(self.bounds.lower[j], self.bounds.upper[j]))
            .collect();
        if !objective.evaluate(&probe, &mut self.values, &mut self.trial) {
            return false;
        }
        objective.transform(&mut self.trial);
        self.here.copy_from_slice(&self.rows);
        objective.transform(&mut self.here);
        let damping = Damping { factor: self.damping, scale: &self.scale };
        model.bend(step, &self.jacobian, &self.here, &mut self.trial, PROBE, damping) <= MOST_BEND
    }

    /// Evaluates a trial point; what is not finite costs infinity.
    fn evaluate(&mut self, objective: &Objective<'_>, free: Vec<f64>) -> Point {
        let finite = objective.evaluate(&free, &mut self.values, &mut self.trial);
        let cost = if finite { objective.cost(&self.trial) } else { f64::INFINITY };
        Point { free, cost }
    }

    /// Makes the rows anew after a checkpoint. That evaluation has been counted before it.
    fn know_rows(&mut self, objective: &Objective<'_>, free: &[f64]) {
        if self.rows.is_empty() {
            self.rows = objective.rows_uncounted(free);
        }
    }

    /// Moves to the trial point just evaluated.
    fn accept(&mut self, point: &mut Point, there: Point) {
        std::mem::swap(&mut self.rows, &mut self.trial);
        *point = there;
    }

    /// No step helped: with better derivatives one may; with the best ones the solver has stalled.
    fn exhausted(&mut self) {
        if self.accuracy == Accuracy::Travel && self.finish == Finish::Settled {
            self.accuracy = Accuracy::Settled;
            (self.damping, self.growth) = (self.helpful, 2.0);
        } else {
            self.stop = Some(StopReason::Stalled);
        }
    }
}

impl<'o> Solver<&'o Objective<'o>, LocalState> for LeastSquares {
    fn name(&self) -> &'static str {
        "bounded Levenberg–Marquardt"
    }

    fn init(
        &mut self,
        problem: &mut Problem<&'o Objective<'o>>,
        mut state: LocalState,
    ) -> Result<(LocalState, Option<KV>), Error> {
        let free = state.take_param().unwrap_or_default();
        let finite = problem
            .problem("rows", |objective| Ok(objective.evaluate(free.as_slice(), &mut self.values, &mut self.rows)))?;
        let cost = problem.problem("cost", |objective| Ok(objective.cost(&self.rows)))?;
        if finite {
            return Ok((state.param(free).cost(cost), None));
        }
        self.stop = Some(StopReason::Failed);
        Ok((state.param(free).cost(f64::INFINITY), None))
    }

    fn next_iter(
        &mut self,
        problem: &mut Problem<&'o Objective<'o>>,
        mut state: LocalState,
    ) -> Result<(LocalState, Option<KV>), Error> {
        let free: Vec<f64> = state.take_param().unwrap_or_default().data.into();
        let mut point = Point { free, cost: state.get_cost() };
        problem.problem("iteration", |objective| {
            if objective.control.interrupted() {
                self.stop = Some(StopReason::Cancelled);
            } else {
                self.know_rows(objective, &point.free);
                self.iterate(objective, &mut point);
            }
            Ok(())
        })?;
        let log = kv!("damping" => self.damping;);
        Ok((state.param(DVector::from_vec(point.free)).cost(point.cost), Some(log)))
    }

    fn terminate(&mut self, _state: &LocalState) -> TerminationStatus {
        match self.stop {
            Some(StopReason::Converged) => TerminationStatus::Terminated(TerminationReason::SolverConverged),
            Some(StopReason::Cancelled) => TerminationStatus::Terminated(TerminationReason::Interrupt),
            Some(_) => TerminationStatus::Terminated(TerminationReason::SolverExit("no better point".to_owned())),
            None => TerminationStatus::NotTerminated,
        }
    }
}
