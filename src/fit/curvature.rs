//! What the Jacobian at a minimum says of it: covariance, open directions, volume.

use nalgebra::{Cholesky, DMatrix, SVD};

use super::differences::{Accuracy, Bounds, Differences};
use super::least_squares::FULL;
use super::objective::Objective;
use super::outcome::Bound;
use super::step::{Damping, LinearModel};

/// Singular values below this share of the largest are noise of the differences, not data.
const RANK: f64 = 1e-9;

/// The local shape of the cost at one minimum.
#[derive(Debug, Clone)]
pub(super) struct Curvature {
    /// The bound that each free parameter is on.
    pub(super) at_bound: Vec<Option<Bound>>,
    /// Half the gradient of the cost, for the parameters on a bound.
    pub(super) gradient: Vec<f64>,
    /// Positions of the parameters that are on no bound.
    pub(super) inner: Vec<usize>,
    /// Rows before the loss.
    pub(super) rows: Vec<f64>,
    /// Jacobian before the loss, column-major.
    pub(super) jacobian: Vec<f64>,
    /// Jacobian's triangle after the loss, all columns.
    pub(super) triangle: DMatrix<f64>,
    model: LinearModel,
}

/// Inverse of a Gram matrix, for σ = 1, with the directions in which there is none.
#[derive(Debug, Clone)]
pub(super) struct Inverse {
    /// (JᵀJ)⁻¹ over the columns asked for, leaving out directions of no rank.
    pub(super) covariance: DMatrix<f64>,
    /// Directions of no rank, per unit of each column.
    pub(super) missing: Vec<Vec<f64>>,
    /// ln of the product of the columns' lengths, which turns a volume per scaled unit into one per unit.
    ln_lengths: f64,
    /// Singular value and direction of each scaled combination.
    directions: Vec<(f64, Vec<f64>)>,
    lengths: Vec<f64>,
}

impl Inverse {
    /// ½ ln det of the covariance for this σ, each principal width cut at the width of the box, as a Gaussian's
    /// integral is when the data leave it wider than that.
    pub(super) fn half_ln_det(&self, sigma: f64, ranges: &[f64]) -> f64 {
        let width = |(value, direction): &(f64, Vec<f64>)| {
            let reach = |(k, share): (usize, &f64)| ranges[k] * self.lengths[k] / share.abs();
            let box_width = direction.iter().enumerate().map(reach).fold(f64::INFINITY, f64::min);
            let gaussian = if *value <= RANK { f64::INFINITY } else { sigma / value };
            let width = gaussian.min(box_width / (2.0 * std::f64::consts::PI).sqrt());
            // An open direction without bounds has no width at all; it weighs the same in every minimum.
            if width.is_finite() && width > 0.0 { width.ln() } else { 0.0 }
        };
        self.directions.iter().map(width).sum::<f64>() - self.ln_lengths
    }
}

impl Curvature {
    /// Differentiates at `free`; None where the model is not finite around it.
    pub(super) fn new(
        objective: &Objective<'_>,
        differences: &mut Differences,
        bounds: &Bounds,
        free: &[f64],
        accuracy: Accuracy,
    ) -> Option<Self> {
        let (count, size) = (objective.rows(), free.len());
        let mut values = vec![0.0; objective.residuals.parameters().len()];
        let mut rows = vec![0.0; count];
        if !objective.evaluate(free, &mut values, &mut rows) {
            return None;
        }
        let mut jacobian = vec![0.0; count * size];
        if !differences.jacobian(objective, bounds, free, &rows, accuracy, &mut jacobian) {
            return None;
        }
        let (mut weighed, mut right) = (jacobian.clone(), rows.clone());
        if !objective.loss.is_squares() {
            for (row, value) in right[..objective.readings].iter_mut().enumerate() {
                let slope = objective.loss.slope(*value);
                *value = objective.loss.transformed(*value);
                weighed.chunks_exact_mut(count).for_each(|column| column[row] *= slope);
            }
        }
        let model = LinearModel::new(&mut weighed, &mut right);
        let at_bound = (0..size).map(|j| on_bound(bounds, free, j)).collect::<Vec<_>>();
        let inner = (0..size).filter(|&j| at_bound[j].is_none()).collect();
        let triangle = DMatrix::from_column_slice(size, size, model.triangle());
        Some(Self { at_bound, gradient: model.gradient(), inner, rows, jacobian, triangle, model })
    }

    /// The fall of the cost that a full step inside the bounds promises, as a share of the cost per row.
    pub(super) fn promise(&self, bounds: &Bounds, free: &[f64], cost: f64) -> f64 {
        let held: Vec<bool> = (0..free.len()).map(|j| bounds.keeps(j, free[j], self.gradient[j])).collect();
        let damping = Damping { factor: FULL, scale: &self.model.lengths() };
        let step = self.model.step(free, bounds, &held, damping);
        #[expect(clippy::cast_precision_loss, reason = "a number of rows is far below 2^53")]
        let rows = self.rows.len() as f64;
        if cost > 0.0 { step.predicted / cost * rows } else { 0.0 }
    }

    /// The triangle's columns of these parameters.
    pub(super) fn columns(&self, positions: &[usize]) -> DMatrix<f64> {
        self.triangle.select_columns(positions)
    }

    /// Covariance with a robust loss, the sandwich A⁻¹BA⁻¹·N/(N−p) with A = Σψ′·jjᵀ and B = Σψ²·jjᵀ (Huber 1967), which
    /// asks of the readings only that they be independent, not that they have one σ. A prior's row has A = B/σ² = jjᵀ.
    /// None where A is not positive definite.
    pub(super) fn sandwich(&self, objective: &Objective<'_>, positions: &[usize]) -> Option<DMatrix<f64>> {
        let (size, count) = (positions.len(), self.rows.len());
        let lengths: Vec<f64> = positions.iter().map(|&j| self.triangle.column(j).norm()).collect();
        let mut a = DMatrix::<f64>::zeros(size, size);
        let mut b = a.clone();
        for (row, &value) in self.rows.iter().enumerate() {
            let (slope, square) = if row < objective.readings {
                (objective.loss.psi_slope(value), objective.loss.psi(value).powi(2))
            } else {
                (1.0, objective.sigma * objective.sigma)
            };
            let entry = |k: usize| self.jacobian[positions[k] * count + row] / lengths[k];
            for i in 0..size {
                for j in 0..size {
                    let product = entry(i) * entry(j);
                    a[(i, j)] += slope * product;
                    b[(i, j)] += square * product;
                }
            }
        }
        let a = Cholesky::new(a)?.inverse();
        #[expect(clippy::cast_precision_loss, reason = "a number of rows is far below 2^53")]
        let small_sample = count as f64 / count.saturating_sub(size).max(1) as f64;
        let mut covariance = &a * b * &a * small_sample;
        for i in 0..size {
            for j in 0..size {
                covariance[(i, j)] /= lengths[i] * lengths[j];
            }
        }
        Some(covariance)
    }

    /// (JᵀJ)⁻¹ over these parameters.
    pub(super) fn inverse(&self, positions: &[usize]) -> Inverse {
        let matrix = self.columns(positions);
        // Columns of unit length, so that the rank does not depend on units.
        let lengths: Vec<f64> = matrix.column_iter().map(|column| column.norm()).collect();
        let mut scaled = matrix;
        for (mut column, &length) in scaled.column_iter_mut().zip(&lengths) {
            if length > 0.0 {
                column /= length;
            }
        }
        let size = positions.len();
        let lengths: Vec<f64> = lengths.into_iter().map(|length| if length > 0.0 { length } else { 1.0 }).collect();
        let directions = directions(scaled);
        let mut covariance = DMatrix::zeros(size, size);
        let mut missing = Vec::new();
        for (value, direction) in &directions {
            if *value <= RANK {
                missing.push((0..size).map(|k| direction[k] / lengths[k]).collect());
                continue;
            }
            for a in 0..size {
                for b in 0..size {
                    covariance[(a, b)] += direction[a] * direction[b] / (value * value * lengths[a] * lengths[b]);
                }
            }
        }
        let ln_lengths = lengths.iter().map(|length| length.ln()).sum();
        Inverse { covariance, missing, ln_lengths, directions, lengths }
    }
}

/// Singular values and right singular vectors, largest first.
pub(super) fn directions(matrix: DMatrix<f64>) -> Vec<(f64, Vec<f64>)> {
    if matrix.ncols() == 0 {
        return Vec::new();
    }
    let decomposition = SVD::new(matrix, false, true);
    let Some(right) = decomposition.v_t else { return Vec::new() };
    let mut pairs: Vec<(f64, Vec<f64>)> = decomposition
        .singular_values
        .iter()
        .zip(right.row_iter())
        .map(|(&value, row)| (value, row.iter().copied().collect()))
        .collect();
    pairs.sort_by(|a, b| b.0.total_cmp(&a.0));
    pairs
}

fn on_bound(bounds: &Bounds, free: &[f64], j: usize) -> Option<Bound> {
    if free[j] <= bounds.lower[j] {
        Some(Bound::Lower)
    } else if free[j] >= bounds.upper[j] {
        Some(Bound::Upper)
    } else {
        None
    }
}
