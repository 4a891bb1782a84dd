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
use super::outcome::Bound;

/// A Gaussian's end is kept where the cost has risen there by what a parabola would, up to this share of it. It moves the end
/// by half of that, and the 2.5 % beyond it by 0.6 %.
const PARABOLA: f64 = 0.1;
/// How near an end comes to the rise asked for, as a share of the distance: a fiftieth of a standard error.
const END: f64 = 0.01;
/// Most points of a profile for one end; it most often takes three.
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
        let rise = (self.quantile * self.sigma).powi(2);
        if !(first > 0.0 && rise > 0.0 && self.objective.loss.is_squares()) {
            return first;
        }
        let (aim, inside) = self.ahead(position, side * first);
        let found = self.rise(&aim);
        let expected = rise * (first / gaussian).powi(2);
        let parabola = inside && (found - expected).abs() <= PARABOLA * rise;
        // The lowest cost there is no higher than this one.
        let whole = first >= room && found <= rise;
        if parabola || whole {
            first
        } else {
            self.search(position, side, (first, aim), room, rise.sqrt()).unwrap_or(first)
        }
    }

    /// Where the parabola has its lowest point with one parameter moved, and whether that is true of the bounds too: no
    /// other parameter would leave them, or come off the one that it is on.
    fn ahead(&self, position: usize, change: f64) -> (Vec<f64>, bool) {
        let variance = self.covariance[position][position].unwrap_or(f64::NAN);
        let slope = |k: usize| self.covariance[k][position].map_or(0.0, |shared| shared / variance);
        let changes: Vec<f64> = (0..self.best.free.len()).map(|k| change * slope(k)).collect();
        let mut inside = true;
        let mut aim = self.best.free.clone();
        for (k, (value, change)) in aim.iter_mut().zip(&changes).enumerate() {
            let wanted = *value + change;
            *value = wanted.clamp(self.bounds.lower[k], self.bounds.upper[k]);
            inside &= k == position || value.to_bits() == wanted.to_bits();
        }
        if let Some(curvature) = &self.best.curvature {
            let moved = &curvature.triangle * nalgebra::DVector::from_vec(changes);
            for (k, side) in curvature.at_bound.iter().enumerate() {
                let gradient = curvature.gradient[k] + curvature.triangle.column(k).dot(&moved);
                inside &= match side {
                    None => true,
                    Some(Bound::Lower) => gradient >= 0.0,
                    Some(Bound::Upper) => gradient <= 0.0,
                };
            }
        }
        (aim, inside)
    }

    fn rise(&self, free: &[f64]) -> f64 {
        let mut values = vec![0.0; self.objective.residuals.parameters().len()];
        let mut rows = vec![0.0; self.objective.rows()];
        let finite = self.objective.evaluate(free, &mut values, &mut rows);
        if finite { self.objective.cost(&rows) - self.best.cost } else { f64::INFINITY }
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
