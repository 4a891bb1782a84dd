//! The guard between model and solver: the one place where residuals are evaluated.
//!
//! It maps the free vector to all values, appends the priors as residual rows, applies the robust loss, refuses what is
//! not finite, counts, remembers the best point of all, and hears the interrupt. Solvers behind it may fail, panic-free,
//! in any way they like: the best point is not theirs to lose.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};

use serde::{Deserialize, Serialize};

use super::assignment::Assignment;
use super::checkpoint::Record;
use super::control::Control;
use super::linear::dot;
use super::loss::RobustLoss;
use super::mapping::Mapping;
use super::outcome::Settings;
use super::residuals::Residuals;

/// A prior on one parameter, as a linear form of the free ones: (constant + Σ factor·free)/σ.
#[derive(Debug, Clone)]
pub(super) struct PriorRow {
    constant: f64,
    pub(super) terms: Vec<(usize, f64)>,
}

/// Evaluations so far.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub(super) struct Counts {
    pub(super) evaluations: u64,
    pub(super) not_finite: u64,
}

/// Evaluations of all objectives of one fit, or of one of its solves.
#[derive(Debug, Default)]
pub(super) struct Counters {
    evaluations: AtomicU64,
    not_finite: AtomicU64,
}

impl Counters {
    pub(super) fn counts(&self) -> Counts {
        Counts {
            evaluations: self.evaluations.load(Ordering::Relaxed),
            not_finite: self.not_finite.load(Ordering::Relaxed),
        }
    }

    pub(super) fn add(&self, counts: Counts) {
        self.evaluations.fetch_add(counts.evaluations, Ordering::Relaxed);
        self.not_finite.fetch_add(counts.not_finite, Ordering::Relaxed);
    }
}

/// A point and its cost.
#[derive(Debug, Clone)]
pub(super) struct Point {
    pub(super) free: Vec<f64>,
    pub(super) cost: f64,
}

/// What a solver minimises: Σρ(r) over readings plus the squares of the priors.
pub(super) struct Objective<'a> {
    pub(super) residuals: &'a dyn Residuals,
    pub(super) mapping: &'a Mapping,
    pub(super) loss: RobustLoss,
    pub(super) priors: Vec<PriorRow>,
    pub(super) readings: usize,
    /// What one σ of the readings is in units of the residuals: 1 where σ is known. Priors are multiplied by it.
    pub(super) sigma: f64,
    pub(super) control: &'a Control<'a>,
    pub(super) counters: &'a Counters,
    /// Where solves are saved, if anywhere.
    pub(super) record: Option<&'a Arc<Record>>,
    /// Whether its readings are a selection of the fit's.
    pub(super) coarse: bool,
}

impl<'a> Objective<'a> {
    pub(super) fn new(
        residuals: &'a dyn Residuals,
        mapping: &'a Mapping,
        assignments: &[Assignment],
        settings: &Settings,
        control: &'a Control<'a>,
        counters: &'a Counters,
    ) -> Self {
        let priors = assignments.iter().enumerate().filter_map(|(index, assignment)| {
            let prior = assignment.prior?;
            let (constant, terms) = mapping.linear_form(index);
            let terms = terms.into_iter().map(|(position, factor)| (position, factor / prior.sigma)).collect();
            Some(PriorRow { constant: (constant - prior.mean) / prior.sigma, terms })
        });
        let priors = priors.collect();
        let loss = RobustLoss::new(settings);
        let readings = residuals.count();
        Self { residuals, mapping, loss, priors, readings, sigma: 1.0, control, counters, record: None, coarse: false }
    }

    /// The same objective on a selection of the readings.
    pub(super) fn on(&self, residuals: &'a dyn Residuals) -> Self {
        Self {
            residuals,
            mapping: self.mapping,
            loss: self.loss,
            priors: self.priors.clone(),
            readings: residuals.count(),
            sigma: self.sigma,
            control: self.control,
            counters: self.counters,
            record: self.record,
            coarse: true,
        }
    }

    /// The same objective, its evaluations counted elsewhere.
    pub(super) fn counted_by<'b>(&'b self, counters: &'b Counters) -> Objective<'b> {
        Objective { counters, coarse: self.coarse, ..self.on(self.residuals) }
    }

    /// Rows at a point, before any loss; the evaluation is not counted.
    pub(super) fn rows_uncounted(&self, free: &[f64]) -> Vec<f64> {
        let mut values = vec![0.0; self.residuals.parameters().len()];
        let mut rows = vec![0.0; self.rows()];
        self.counted_by(&Counters::default()).evaluate(free, &mut values, &mut rows);
        rows
    }

    /// Whether there are priors to be weighed against a σ that only the fit can tell.
    pub(super) fn weighs_priors(&self) -> bool {
        !self.priors.is_empty() && !self.residuals.sigma_known()
    }

    /// Number of rows: readings, then priors.
    pub(super) fn rows(&self) -> usize {
        self.readings + self.priors.len()
    }

    /// Writes residuals and prior rows, before any loss; false, and counted, where one of them is not finite.
    pub(super) fn evaluate(&self, free: &[f64], values: &mut [f64], rows: &mut [f64]) -> bool {
        self.counters.evaluations.fetch_add(1, Ordering::Relaxed);
        if !self.mapping.expand(free, values) {
            return false;
        }
        let (readings, priors) = rows.split_at_mut(self.readings);
        self.residuals.evaluate(values, readings);
        for (row, prior) in priors.iter_mut().zip(&self.priors) {
            *row = self.sigma
                * prior.terms.iter().fold(prior.constant, |sum, &(position, factor)| sum + factor * free[position]);
        }
        // The sum of squares is finite exactly if every residual is and none is so large that the cost overflows.
        let finite = dot(rows, rows).is_finite();
        if !finite {
            self.counters.not_finite.fetch_add(1, Ordering::Relaxed);
        }
        finite
    }

    /// Cost of rows as [`Objective::evaluate`] gives them.
    pub(super) fn cost(&self, rows: &[f64]) -> f64 {
        if self.loss.is_squares() {
            return dot(rows, rows);
        }
        let (readings, priors) = rows.split_at(self.readings);
        readings.iter().map(|&r| self.loss.rho(r)).sum::<f64>() + dot(priors, priors)
    }

    /// Puts rows through the loss, priors excepted.
    pub(super) fn transform(&self, rows: &mut [f64]) {
        if !self.loss.is_squares() {
            rows[..self.readings].iter_mut().for_each(|row| *row = self.loss.transformed(*row));
        }
    }

    /// Half the derivative of each row's cost: the row itself for squares and priors.
    pub(super) fn psi(&self, rows: &[f64]) -> Vec<f64> {
        let mut psi = rows.to_vec();
        psi[..self.readings].iter_mut().for_each(|row| *row = self.loss.psi(*row));
        psi
    }

    /// Evaluations so far, and how many were not finite.
    pub(super) fn counts(&self) -> (u64, u64) {
        let Counts { evaluations, not_finite } = self.counters.counts();
        (evaluations, not_finite)
    }
}

/// Order of two points of one length, value by value.
fn by_value(a: &[f64], b: &[f64]) -> std::cmp::Ordering {
    a.iter().zip(b).map(|(a, b)| a.total_cmp(b)).find(|order| order.is_ne()).unwrap_or(std::cmp::Ordering::Equal)
}

/// The best point that a solver has seen, kept outside of it.
#[derive(Debug, Default)]
pub(super) struct BestSoFar(Mutex<Option<Point>>);

impl BestSoFar {
    /// Remembers the point if it is better; of two equal ones the smaller vector, so that the order of calls from
    /// several threads does not matter.
    pub(super) fn offer(&self, free: &[f64], cost: f64) {
        let mut best = self.0.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let better = best
            .as_ref()
            .is_none_or(|best| cost.total_cmp(&best.cost).then_with(|| by_value(free, &best.free)).is_lt());
        if better {
            *best = Some(Point { free: free.to_vec(), cost });
        }
    }

    /// The best point, if any was finite.
    pub(super) fn take(&self) -> Option<Point> {
        self.0.lock().unwrap_or_else(std::sync::PoisonError::into_inner).take()
    }
}
