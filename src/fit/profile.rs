//! 95 % intervals where the cost is no parabola: to where the lowest cost with one parameter held has risen enough.
//!
//! A Gaussian's interval reaches as many standard errors to either side as its quantile q says, and there the cost has risen
//! by (qσ)². Where two or more parameters nearly stand for each other (an index, the weight of a gloss and an albedo), the
//! valley between them is long and bent, the standard error hangs on where in it the minimum happens to lie, and the
//! Gaussian's interval holds the truth too seldom: 87 times in 100 where it should 95, for a rough coat's index seen from
//! six directions. So too where another parameter is on a bound that it would leave. The profile's interval asks for the same
//! rise of the cost itself, minimised over the other parameters inside their bounds; it knows nothing of how the parameters
//! are written (Venzon & Moolgavkar 1988, Appl. Statist. 37, 87). Where the cost is a parabola the two are one.
//!
//! What it does not do: it stays around one minimum, and tells nothing of others; and it takes the cost for the likelihood's
//! logarithm, which a robust loss is not.

use rayon::prelude::*;

use super::differences::{Bounds, Differences, Pattern};
use super::least_squares::Finish;
use super::local::least_squares;
use super::minima::Found;
use super::objective::Objective;

/// How near the root of the cost's rise comes to the one asked for, as a share of it; a Gaussian's end that is as near is
/// kept. It moves the 2.5 % of tables beyond an end by less than 0.3 %.
const END: f64 = 0.02;
/// Most points of a profile for one end; a parabola takes one, a bent valley three or so.
const MOST_POINTS: usize = 30;
/// Promise, per row, at which the other parameters have arrived: 1e-3 σ² is nothing beside a rise of 3.8 σ².
const ARRIVED: Finish = Finish::Travelled(1e-3);

/// A minimum whose surroundings are asked for.
pub(super) struct Surroundings<'a> {
    pub(super) objective: &'a Objective<'a>,
    pub(super) pattern: &'a Pattern,
    pub(super) bounds: Bounds,
    pub(super) best: &'a Found,
    /// Covariance of the free parameters, with holes where there is no number.
    pub(super) covariance: &'a [Vec<Option<f64>>],
    /// Half of an interval's width in standard errors.
    pub(super) quantile: f64,
    /// σ of the readings in units of the cost's rows, with whatever widens it.
    pub(super) sigma: f64,
    pub(super) max_iterations: u64,
}

impl Surroundings<'_> {
    /// The interval of each free parameter; None where it has no standard error, or is on a bound.
    pub(super) fn intervals(&self) -> Vec<Option<[f64; 2]>> {
        let at_bound = |position: usize| {
            self.best.curvature.as_ref().is_none_or(|curvature| curvature.at_bound[position].is_some())
        };
        let interval = |position: usize| {
            let error = self.covariance[position][position].filter(|_| !at_bound(position))?.max(0.0).sqrt();
            let value = self.best.free[position];
            let reach = |side| self.reach(position, side, self.quantile * error);
            let (below, above) = rayon::join(|| reach(-1.0), || reach(1.0));
            Some([value - below, value + above])
        };
        (0..self.best.free.len()).into_par_iter().map(interval).collect()
    }

    /// How far the interval reaches to one side, given how far a Gaussian's would.
    fn reach(&self, position: usize, side: f64, gaussian: f64) -> f64 {
        let value = self.best.free[position];
        let room = if side < 0.0 { value - self.bounds.lower[position] } else { self.bounds.upper[position] - value };
        let first = gaussian.min(room);
        let goal = self.quantile * self.sigma;
        if !(first > 0.0 && goal > 0.0 && self.objective.loss.is_squares()) {
            return first;
        }
        // The cost on the straight way there would not do: in a bent valley it can meet a parabola's by chance, where the
        // lowest one is far below.
        self.search(position, side, (first, self.ahead(position, side * first)), room, goal).unwrap_or(first)
    }

    /// Where a parabola has its lowest point with one parameter moved, drawn back inside the bounds.
    fn ahead(&self, position: usize, change: f64) -> Vec<f64> {
        let variance = self.covariance[position][position].unwrap_or(f64::NAN);
        let moved = |(k, value): (usize, &f64)| {
            let slope = self.covariance[k][position].map_or(0.0, |shared| shared / variance);
            (value + change * slope).clamp(self.bounds.lower[k], self.bounds.upper[k])
        };
        self.best.free.iter().enumerate().map(moved).collect()
    }

    /// Distance at which the root of the profile's rise, which is nearly a straight line, meets its goal; at most `room`.
    /// None once interrupted.
    fn search(
        &self,
        position: usize,
        side: f64,
        (mut distance, mut others): (f64, Vec<f64>),
        room: f64,
        goal: f64,
    ) -> Option<f64> {
        let (mut near, mut far): ((f64, f64), Option<(f64, f64)>) = ((0.0, 0.0), None);
        for _ in 0..MOST_POINTS {
            let held_at = (self.best.free[position] + side * distance)
                .clamp(self.bounds.lower[position], self.bounds.upper[position]);
            let mut held = self.bounds.clone();
            (held.lower[position], held.upper[position]) = (held_at, held_at);
            others[position] = held_at;
            let differences = Differences::new(self.pattern);
            let end = least_squares(self.objective, differences, &held, &others, ARRIVED, self.max_iterations);
            if self.objective.control.interrupted() {
                return None;
            }
            // Where the model is not finite the interval has ended before.
            let height = end.as_ref().map_or(f64::INFINITY, |end| (end.cost - self.best.cost).max(0.0).sqrt());
            if (height - goal).abs() <= END * goal || (height < goal && distance >= room) {
                return Some(distance);
            }
            if height < goal {
                near = (distance, height);
                others = end.map_or(others, |end| end.free);
            } else {
                far = Some((distance, height));
            }
            distance = match far {
                // Not beyond twice as far, so that no other minimum's valley is taken for this one's.
                None => (near.0 * (goal / near.1).clamp(1.1, 2.0)).min(room),
                Some((far, height)) if height.is_finite() => {
                    near.0 + (far - near.0) * ((goal - near.1) / (height - near.1)).clamp(0.1, 0.9)
                }
                Some((far, _)) => 0.5 * (near.0 + far),
            };
        }
        Some(distance)
    }
}
