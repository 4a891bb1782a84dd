//! The Jacobian by finite differences.
//!
//! A solver travels with one-sided differences, one evaluation a column, good to some seven digits. Where the answer is
//! settled, and for the covariance, three central differences are extrapolated (Richardson 1911), six evaluations a
//! column, good to some eleven. Their step is found once for each parameter, by halving until two successive
//! extrapolations agree best: too long a step errs by the model's curvature, too short a one by rounding (Ridders 1982).
//! No step leaves the bounds. Parameters that touch different readings share evaluations (Curtis, Powell & Reid 1974).

use std::ops::Range;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::linear::dot;
use super::objective::Objective;

/// Allowed values of each free parameter in one run. Equal bounds hold a parameter.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Bounds {
    pub(super) lower: Vec<f64>,
    pub(super) upper: Vec<f64>,
}

impl Bounds {
    /// Whether parameter `j` cannot move at all.
    pub(super) fn holds(&self, j: usize) -> bool {
        self.lower[j] >= self.upper[j]
    }

    /// Whether parameter `j` stays at `value`: held, or on a bound and pushed outwards by the cost's gradient.
    pub(super) fn keeps(&self, j: usize, value: f64, gradient: f64) -> bool {
        self.holds(j) || (value <= self.lower[j] && gradient >= 0.0) || (value >= self.upper[j] && gradient <= 0.0)
    }
}

/// How exact a Jacobian is wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Accuracy {
    /// One-sided differences: about 1e-7 of a column's length.
    Travel,
    /// Extrapolated central differences: about 1e-11.
    Settled,
}

/// What the differences of one problem share: which rows each parameter touches, and which parameters go together.
#[derive(Debug, Clone, Default)]
pub(super) struct Pattern {
    touched: Vec<Range<usize>>,
    groups: Vec<Vec<usize>>,
    /// Columns are computed in parallel where one evaluation takes longer than handing it to another thread.
    parallel: bool,
}

impl Pattern {
    /// Groups free parameters whose rows do not overlap, first fit.
    pub(super) fn new(objective: &Objective<'_>, parallel: bool) -> Self {
        let count = objective.mapping.free.len();
        let touched: Vec<Range<usize>> = (0..count).map(|j| touched(objective, j)).collect();
        let mut groups: Vec<Vec<usize>> = Vec::new();
        for (j, range) in touched.iter().enumerate() {
            let fits = |group: &&mut Vec<usize>| group.iter().all(|&k| disjoint(range, &touched[k]));
            match groups.iter_mut().find(fits) {
                Some(group) => group.push(j),
                None => groups.push(vec![j]),
            }
        }
        Self { touched, groups, parallel }
    }
}

/// The hull of all rows that free parameter `j` can change, itself or through ties.
fn touched(objective: &Objective<'_>, j: usize) -> Range<usize> {
    let ranges = objective.mapping.followers(j).map(|index| objective.residuals.touched(index));
    let hull = ranges.reduce(|a, b| a.start.min(b.start)..a.end.max(b.end)).unwrap_or(0..objective.readings);
    hull.start.min(objective.readings)..hull.end.min(objective.readings)
}

fn disjoint(a: &Range<usize>, b: &Range<usize>) -> bool {
    a.end <= b.start || b.end <= a.start
}

/// A parameter's finite difference as a weighted sum of residuals at `value + offset·step`.
struct Stencil {
    offsets: &'static [f64],
    /// Weights of the residuals at the offsets, in units of 1/step; the rest to zero stands at offset 0.
    weights: &'static [f64],
}

static ONE_SIDED: Stencil = Stencil { offsets: &[1.0], weights: &[1.0] };
/// Central differences at h, 2h and 4h, extrapolated twice: (64 D(h) − 20 D(2h) + D(4h))/45, error of order h⁶.
static EXTRAPOLATED: Stencil = Stencil {
    offsets: &[1.0, -1.0, 2.0, -2.0, 4.0, -4.0],
    weights: &[32.0 / 45.0, -32.0 / 45.0, -5.0 / 45.0, 5.0 / 45.0, 1.0 / 360.0, -1.0 / 360.0],
};
/// At a bound, where there is one side only: forward differences through four points, error of order h⁴.
static ONE_SIDED_LONG: Stencil = Stencil { offsets: &[1.0, 2.0, 3.0, 4.0], weights: &[4.0, -3.0, 4.0 / 3.0, -0.25] };

/// One column to be filled: where it is not zero.
struct Part<'a> {
    j: usize,
    step: f64,
    stencil: &'static Stencil,
    entries: &'a mut [f64],
}

/// Differences in one run: the steps found so far.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Differences {
    #[serde(skip)]
    pattern: Pattern,
    /// Step of the extrapolated differences relative to the parameter's size, once found.
    settled: Vec<Option<f64>>,
}

impl Differences {
    pub(super) fn new(pattern: &Pattern) -> Self {
        Self { pattern: pattern.clone(), settled: vec![None; pattern.touched.len()] }
    }

    /// These differences with the steps that others have found.
    pub(super) fn with_steps_of(&self, others: Self) -> Self {
        Self { pattern: self.pattern.clone(), settled: others.settled }
    }

    /// Steps found so far, which decide what the next Jacobian is.
    pub(super) fn steps(&self) -> &[Option<f64>] {
        &self.settled
    }

    /// Writes ∂rows/∂free (column-major, before any loss) at `free`, where the rows are `base`. Columns of held
    /// parameters are zero, and so is what could not be evaluated; false if any could not.
    pub(super) fn jacobian(
        &mut self,
        objective: &Objective<'_>,
        bounds: &Bounds,
        free: &[f64],
        base: &[f64],
        accuracy: Accuracy,
        jacobian: &mut [f64],
    ) -> bool {
        if accuracy == Accuracy::Settled {
            self.find_steps(objective, bounds, free, base);
        }
        jacobian.fill(0.0);
        let rows = objective.rows();
        let steps: Vec<(f64, &'static Stencil)> =
            (0..free.len()).map(|j| self.step(objective, bounds, free, j, accuracy)).collect();
        let mut columns: Vec<Option<&mut [f64]>> = jacobian.chunks_exact_mut(rows).map(Some).collect();
        let mut part = |&j: &usize| {
            let column = columns[j].take().filter(|_| !bounds.holds(j))?;
            let (step, stencil) = steps[j];
            Some(Part { j, step, stencil, entries: &mut column[self.pattern.touched[j].clone()] })
        };
        let work: Vec<Vec<Part<'_>>> =
            self.pattern.groups.iter().map(|group| group.iter().filter_map(&mut part).collect()).collect();
        let fill = |parts: Vec<Part<'_>>| self.fill(objective, bounds, free, base, parts);
        let complete = if self.pattern.parallel {
            work.into_par_iter().map(fill).reduce(|| true, |a, b| a & b)
        } else {
            work.into_iter().map(fill).fold(true, |a, b| a & b)
        };
        for (row, prior) in objective.priors.iter().enumerate() {
            for &(j, factor) in prior.terms.iter().filter(|term| !bounds.holds(term.0)) {
                jacobian[j * rows + objective.readings + row] += objective.sigma * factor;
            }
        }
        complete
    }

    /// Fills the columns of one group, whose parameters move together; false where an evaluation was not finite.
    fn fill(
        &self,
        objective: &Objective<'_>,
        bounds: &Bounds,
        free: &[f64],
        base: &[f64],
        mut parts: Vec<Part<'_>>,
    ) -> bool {
        let mut values = vec![0.0; objective.residuals.parameters().len()];
        let mut rows = vec![0.0; objective.rows()];
        let longest = parts.iter().map(|part| part.stencil.offsets.len()).max().unwrap_or(0);
        let mut complete = true;
        for k in 0..longest {
            let mut moved = free.to_vec();
            for part in &parts {
                if let Some(offset) = part.stencil.offsets.get(k) {
                    let aim = free[part.j] + offset * part.step;
                    moved[part.j] = aim.clamp(bounds.lower[part.j], bounds.upper[part.j]);
                }
            }
            if !objective.evaluate(&moved, &mut values, &mut rows) {
                complete = false;
                continue;
            }
            for part in &mut parts {
                let Some(&weight) = part.stencil.weights.get(k) else { continue };
                // The step as it was really made, after rounding.
                let made = (moved[part.j] - free[part.j]) / part.stencil.offsets[k];
                let factor = if made == 0.0 { 0.0 } else { weight / made };
                let range = self.pattern.touched[part.j].clone();
                for ((entry, there), here) in part.entries.iter_mut().zip(&rows[range.clone()]).zip(&base[range]) {
                    *entry += factor * (there - here);
                }
            }
        }
        complete
    }

    /// Step and stencil of parameter `j`, inside the bounds.
    fn step(
        &self,
        objective: &Objective<'_>,
        bounds: &Bounds,
        free: &[f64],
        j: usize,
        accuracy: Accuracy,
    ) -> (f64, &'static Stencil) {
        let (below, above) = (free[j] - bounds.lower[j], bounds.upper[j] - free[j]);
        let size = self.size(objective, free, j);
        match accuracy {
            Accuracy::Travel => {
                let step = f64::EPSILON.sqrt() * size;
                // Towards the roomier side where the bound is closer than the step.
                if step <= above { (step, &ONE_SIDED) } else { (-step.min(below), &ONE_SIDED) }
            }
            Accuracy::Settled => {
                let step = self.settled[j].unwrap_or(1e-3) * size;
                if 4.0 * step <= below.min(above) {
                    (step, &EXTRAPOLATED)
                } else if above >= below {
                    (step.min(above / 4.0), &ONE_SIDED_LONG)
                } else {
                    (-step.min(below / 4.0), &ONE_SIDED_LONG)
                }
            }
        }
    }

    fn size(&self, objective: &Objective<'_>, free: &[f64], j: usize) -> f64 {
        if free[j] == 0.0 { objective.mapping.free[j].scale } else { free[j].abs() }
    }

    /// Finds the step of each parameter's extrapolated differences where it is not known yet.
    fn find_steps(&mut self, objective: &Objective<'_>, bounds: &Bounds, free: &[f64], base: &[f64]) {
        for j in 0..free.len() {
            if self.settled[j].is_none() && !bounds.holds(j) {
                self.settled[j] = Some(self.find_step(objective, bounds, free, base, j));
            }
        }
    }

    fn find_step(&self, objective: &Objective<'_>, bounds: &Bounds, free: &[f64], base: &[f64], j: usize) -> f64 {
        let size = self.size(objective, free, j);
        let room = (free[j] - bounds.lower[j]).min(bounds.upper[j] - free[j]) / size;
        let mut relative = f64::min(0.064, room);
        let range = self.pattern.touched[j].clone();
        let mut central: Vec<Vec<f64>> = Vec::new();
        let (mut best, mut least, mut previous): (f64, f64, Option<Vec<f64>>) = (1e-3, f64::INFINITY, None);
        let mut values = vec![0.0; objective.residuals.parameters().len()];
        let (mut plus, mut minus) = (vec![0.0; base.len()], vec![0.0; base.len()]);
        // From 0.064 in halves to about 1e-6; a model whose scale is finer than that has no derivative to speak of.
        for _ in 0..17 {
            let mut moved = free.to_vec();
            moved[j] = free[j] + relative * size;
            let mut finite = objective.evaluate(&moved, &mut values, &mut plus);
            let up = moved[j];
            moved[j] = free[j] - relative * size;
            finite &= objective.evaluate(&moved, &mut values, &mut minus);
            if finite && up > moved[j] {
                let span = up - moved[j];
                let pairs = plus[range.clone()].iter().zip(&minus[range.clone()]);
                central.push(pairs.map(|(p, m)| (p - m) / span).collect());
            } else {
                central.clear();
                previous = None;
            }
            if let [.., d4, d2, d1] = central.as_slice() {
                let extrapolated: Vec<f64> =
                    d1.iter().zip(d2).zip(d4).map(|((d1, d2), d4)| (64.0 * d1 - 20.0 * d2 + d4) / 45.0).collect();
                if let Some(previous) = previous {
                    let change: Vec<f64> = extrapolated.iter().zip(&previous).map(|(a, b)| a - b).collect();
                    let change = dot(&change, &change);
                    if change < least {
                        (best, least) = (relative, change);
                    } else if change > 1e4 * least {
                        // Rounding has taken over for good.
                        break;
                    }
                }
                previous = Some(extrapolated);
            }
            relative /= 2.0;
        }
        best
    }
}
