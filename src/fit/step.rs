//! One damped step of least squares inside bounds, on the triangle of the Jacobian.

use super::differences::Bounds;
use super::linear::{back_substitute, dot, reflect, triangularise};

/// The linear model of the rows at a point: ‖R·δ + q‖² plus what no step can change.
#[derive(Debug, Clone)]
pub(super) struct LinearModel {
    /// Upper triangle, column-major, `size` × `size`.
    triangle: Vec<f64>,
    /// First entries of Qᵀ·rows.
    right: Vec<f64>,
    size: usize,
    /// First components of the reflections, for [`LinearModel::project`].
    heads: Vec<f64>,
}

/// λ, and what it measures each parameter by.
#[derive(Debug, Clone, Copy)]
pub(super) struct Damping<'a> {
    pub(super) factor: f64,
    pub(super) scale: &'a [f64],
}

/// A step and what the linear model says of it.
#[derive(Debug, Clone)]
pub(super) struct Step {
    pub(super) change: Vec<f64>,
    /// The bound that each parameter is put on exactly, if it is.
    pub(super) landing: Vec<Option<f64>>,
    /// Parameters that moved freely.
    open: Vec<usize>,
    /// Predicted fall of ‖rows‖².
    pub(super) predicted: f64,
}

impl Step {
    /// The point that the step aims at, inside the bounds to the last bit.
    pub(super) fn aim(&self, free: &[f64], bounds: &Bounds) -> Vec<f64> {
        let aim = |j: usize| {
            self.landing[j].unwrap_or_else(|| (free[j] + self.change[j]).clamp(bounds.lower[j], bounds.upper[j]))
        };
        (0..free.len()).map(aim).collect()
    }
}

impl LinearModel {
    /// Factorises a Jacobian (column-major), which is spoilt, as are the rows.
    pub(super) fn new(jacobian: &mut [f64], rows: &mut [f64]) -> Self {
        let (count, size) = (rows.len(), jacobian.len() / rows.len());
        debug_assert!(count >= size, "{count} rows cannot determine {size} parameters");
        let heads = triangularise(jacobian, count, rows);
        let mut triangle = vec![0.0; size * size];
        for j in 0..size {
            triangle[j * size..j * size + j + 1].copy_from_slice(&jacobian[j * count..j * count + j + 1]);
        }
        Self { triangle, right: rows[..size].to_vec(), size, heads }
    }

    /// Upper triangle, column-major.
    pub(super) fn triangle(&self) -> &[f64] {
        &self.triangle
    }

    /// Lengths of the Jacobian's columns.
    pub(super) fn lengths(&self) -> Vec<f64> {
        self.triangle.chunks_exact(self.size).map(|column| dot(column, column).sqrt()).collect()
    }

    /// Half the gradient of the cost, Jᵀ·rows.
    pub(super) fn gradient(&self) -> Vec<f64> {
        self.triangle.chunks_exact(self.size).map(|column| dot(column, &self.right)).collect()
    }

    /// Minimises ‖R·δ + q‖² + λ·Σ(scaleⱼδⱼ)² within the bounds, beginning with the `held` parameters where they are.
    ///
    /// This is the active-set method for bounded linear least squares (Stark & Parker 1995): on each face of the box the
    /// unbounded solution is aimed at; what it meets on the way is put on its bound; where the face's own minimum is
    /// reached, the parameter that most wants back inside is released. The sum falls at every turn, so that no face comes
    /// twice. Clamping the unbounded solution instead would leave the others aimed at a point that is not reached.
    pub(super) fn step(&self, free: &[f64], bounds: &Bounds, held: &[bool], damping: Damping<'_>) -> Step {
        let size = self.size;
        let mut change = vec![0.0; size];
        let mut landing = vec![None; size];
        let mut settled = held.to_vec();
        // A generous limit: rounding could make two faces take turns.
        for _ in 0..8 * size + 8 {
            let open: Vec<usize> = (0..size).filter(|&j| !settled[j]).collect();
            let aim = self.solve(&open, &self.pull(&change, &settled), damping);
            let bound = |j: usize, aim: f64| if aim < 0.0 { bounds.lower[j] } else { bounds.upper[j] };
            let way = |j: usize, aim: f64, change: f64| {
                let outside = free[j] + aim < bounds.lower[j] || free[j] + aim > bounds.upper[j];
                if outside { ((bound(j, aim) - free[j] - change) / (aim - change)).max(0.0) } else { f64::INFINITY }
            };
            let ways: Vec<f64> = open.iter().zip(&aim).map(|(&j, &aim)| way(j, aim, change[j])).collect();
            let share = ways.iter().copied().fold(1.0, f64::min);
            for ((&j, &aim), &way) in open.iter().zip(&aim).zip(&ways) {
                change[j] += share * (aim - change[j]);
                if way <= share {
                    landing[j] = Some(bound(j, aim));
                    change[j] = bound(j, aim) - free[j];
                    settled[j] = true;
                }
            }
            if ways.iter().any(|&way| way <= share) {
                continue;
            }
            let places: Vec<f64> = (0..size).map(|j| landing[j].unwrap_or(free[j])).collect();
            match self.wants_back(&places, bounds, &change, &settled, damping) {
                Some(j) => (settled[j], landing[j]) = (false, None),
                None => break,
            }
        }
        let open = (0..size).filter(|&j| !settled[j]).collect();
        let predicted = self.fall(&change);
        Step { change, landing, predicted, open }
    }

    /// The settled parameter, at these places, whose release lowers the sum fastest, if any does.
    fn wants_back(
        &self,
        places: &[f64],
        bounds: &Bounds,
        change: &[f64],
        settled: &[bool],
        damping: Damping<'_>,
    ) -> Option<usize> {
        let mut rows = self.image(change);
        rows.iter_mut().zip(&self.right).for_each(|(row, right)| *row += right);
        let pull = |j: usize| {
            let column = &self.triangle[j * self.size..(j + 1) * self.size];
            let slope = dot(column, &rows) + damping.factor * damping.scale[j] * damping.scale[j] * change[j];
            let length = dot(column, column).sqrt();
            // Rounding of a sum of products of this size is no slope.
            let inward = slope.abs() > 1e-13 * length * dot(&self.right, &self.right).sqrt()
                && !bounds.keeps(j, places[j], slope);
            if inward { slope.abs() / length } else { 0.0 }
        };
        let candidates = (0..self.size).filter(|&j| settled[j] && !bounds.holds(j)).map(|j| (j, pull(j)));
        candidates.filter(|candidate| candidate.1 > 0.0).max_by(|a, b| a.1.total_cmp(&b.1)).map(|candidate| candidate.0)
    }

    /// Curves a step towards where the rows bend (geodesic acceleration; Transtrum & Sethna 2012): `there` are the rows
    /// at share `share` of the step, `here` those at its foot, `factor` the factorised Jacobian. Returns the length of
    /// the bend relative to that of the step, in the damping's scale; the step is only bent where that is small.
    pub(super) fn bend(
        &self,
        step: &mut Step,
        factor: &[f64],
        here: &[f64],
        there: &mut [f64],
        share: f64,
        damping: Damping<'_>,
    ) -> f64 {
        for (there, here) in there.iter_mut().zip(here) {
            *there = (*there - here) / share;
        }
        reflect(factor, there.len(), &self.heads, there);
        // Second derivative along the step, halved: (Δr/share − J·δ)/share.
        let linear = self.image(&step.change);
        let curve: Vec<f64> = there.iter().zip(&linear).map(|(a, b)| (a - b) / share).collect();
        let bend = self.solve(&step.open, &curve, damping);
        let length = |value: f64, j: usize| (value * damping.scale[j]).powi(2);
        let bent: f64 = step.open.iter().zip(&bend).map(|(&j, &value)| length(value, j)).sum();
        let straight: f64 = step.change.iter().enumerate().map(|(j, &value)| length(value, j)).sum();
        for (&j, value) in step.open.iter().zip(&bend) {
            step.change[j] += value;
        }
        (bent / straight).sqrt()
    }

    /// Slope of the cost along a step.
    pub(super) fn slope(&self, change: &[f64]) -> f64 {
        2.0 * dot(&self.image(change), &self.right)
    }

    /// R·change.
    fn image(&self, change: &[f64]) -> Vec<f64> {
        let mut moved = vec![0.0; self.size];
        for (column, &value) in self.triangle.chunks_exact(self.size).zip(change) {
            for (sum, entry) in moved.iter_mut().zip(column) {
                *sum += entry * value;
            }
        }
        moved
    }

    /// What the open parameters still have to match: q and what the settled ones add to it.
    fn pull(&self, change: &[f64], settled: &[bool]) -> Vec<f64> {
        let mut right = self.right.clone();
        for j in (0..self.size).filter(|&j| settled[j] && change[j] != 0.0) {
            for (value, entry) in right.iter_mut().zip(&self.triangle[j * self.size..(j + 1) * self.size]) {
                *value += entry * change[j];
            }
        }
        right
    }

    /// ‖q‖² − ‖R·δ + q‖².
    fn fall(&self, change: &[f64]) -> f64 {
        let moved = self.image(change);
        // −‖Rδ‖² − 2 (Rδ)·q, which keeps its digits where the difference of two squares would not.
        -dot(&moved, &moved) - 2.0 * dot(&moved, &self.right)
    }

    /// The open parameters that minimise ‖R·x + pull‖² + λ·‖scale·x‖².
    fn solve(&self, open: &[usize], pull: &[f64], damping: Damping<'_>) -> Vec<f64> {
        if open.is_empty() {
            return Vec::new();
        }
        let (size, rows) = (self.size, self.size + open.len());
        let mut matrix = vec![0.0; rows * open.len()];
        let mut right = vec![0.0; rows];
        right[..size].copy_from_slice(pull);
        for (k, &j) in open.iter().enumerate() {
            matrix[k * rows..k * rows + size].copy_from_slice(&self.triangle[j * size..(j + 1) * size]);
            matrix[k * rows + size + k] = damping.factor.sqrt() * damping.scale[j];
        }
        triangularise(&mut matrix, rows, &mut right);
        let mut solution = vec![0.0; open.len()];
        back_substitute(&matrix, rows, &right, &mut solution);
        for value in &mut solution {
            *value = -*value;
        }
        solution
    }
}
