//! Estimates of one quantity on several individuals, each with its own error: their mean, and how much the individuals differ.
//!
//! **Model.** yᵢ = μ + uᵢ + eᵢ, uᵢ of variance τ² between individuals, eᵢ of the known variance vᵢ within one. With weights
//! wᵢ = 1/(vᵢ + τ²), μ is the weighted mean.
//!
//! **Between.** τ² by restricted maximum likelihood (Viechtbauer 2005), found as the highest of all maxima, not below 0. Its
//! standard error is √(2/tr PP), from the Fisher information. The 95 % interval is that of the Q profile (Viechtbauer
//! 2007): all τ² for which Σ wᵢ (yᵢ − μ)² lies between the 2.5 % and the 97.5 % quantile of χ² with k − 1 degrees of freedom. It
//! is exact for normal u and e, and for five individuals it is wide: so little do they tell of a spread.
//!
//! **Mean.** The standard error is that of Knapp and Hartung (2003), with their factor not below 1 (Röver, Knapp and Friede
//! 2015), and the interval Student's with k − 1 degrees of freedom.
//!
//! **What it needs.** Individuals drawn from the population that is spoken of, and errors vᵢ that are right: one that is too
//! small counts as difference between individuals.

use statrs::distribution::{ChiSquared, ContinuousCDF, StudentsT};

/// What several individuals tell of a population.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RandomEffects {
    /// Number of individuals.
    pub count: usize,
    /// Mean of the population.
    pub mean: f64,
    /// Standard error of the mean.
    pub mean_standard_error: f64,
    /// 95 % interval of the mean.
    pub mean_interval_95: [f64; 2],
    /// Variance between individuals, τ².
    pub variance: f64,
    /// Standard error of τ².
    pub variance_standard_error: f64,
    /// 95 % interval of τ².
    pub variance_interval_95: [f64; 2],
    /// Σ (yᵢ − μ)²/vᵢ at τ² = 0 (Cochran's Q): about k − 1 if all individuals are alike.
    pub q: f64,
}

/// Random effects of these estimates with their standard errors; None for fewer than two, for an error that is not above
/// 0, or where a number is not finite.
pub fn random_effects(values: &[f64], standard_errors: &[f64]) -> Option<RandomEffects> {
    let sample = Sample::new(values, standard_errors)?;
    let freedom = sample.freedom();
    let variance = sample.restricted_maximum();
    let at = sample.at(variance);
    let factor = (at.q / freedom).max(1.0);
    let mean_standard_error = (factor / at.sum_weights).sqrt();
    let reach = StudentsT::new(0.0, 1.0, freedom).ok()?.inverse_cdf(0.975) * mean_standard_error;
    let chi_squared = ChiSquared::new(freedom).ok()?;
    Some(RandomEffects {
        count: values.len(),
        mean: at.mean,
        mean_standard_error,
        mean_interval_95: [at.mean - reach, at.mean + reach],
        variance,
        variance_standard_error: (2.0 / at.trace).sqrt(),
        variance_interval_95: [
            sample.variance_of_q(chi_squared.inverse_cdf(0.975)),
            sample.variance_of_q(chi_squared.inverse_cdf(0.025)),
        ],
        q: sample.at(0.0).q,
    })
}

/// Estimates and their variances.
struct Sample<'a> {
    values: &'a [f64],
    variances: Vec<f64>,
}

/// What the sample says for one τ².
struct At {
    sum_weights: f64,
    mean: f64,
    /// Σ w (y − μ)².
    q: f64,
    /// tr PP, twice the Fisher information of τ².
    trace: f64,
    /// ∂ℓ/∂τ² of the restricted log-likelihood.
    slope: f64,
    /// The restricted log-likelihood but for a constant.
    log_likelihood: f64,
}

impl<'a> Sample<'a> {
    fn new(values: &'a [f64], standard_errors: &[f64]) -> Option<Self> {
        let fine = values.len() == standard_errors.len()
            && values.len() > 1
            && values.iter().all(|value| value.is_finite())
            && standard_errors.iter().all(|error| error.is_finite() && *error > 0.0);
        fine.then(|| Self { values, variances: standard_errors.iter().map(|error| error * error).collect() })
    }

    fn freedom(&self) -> f64 {
        f64::from(u32::try_from(self.values.len() - 1).unwrap_or(u32::MAX))
    }

    fn at(&self, variance: f64) -> At {
        let weights: Vec<f64> = self.variances.iter().map(|within| 1.0 / (within + variance)).collect();
        let sum = |power: i32| weights.iter().map(|weight| weight.powi(power)).sum::<f64>();
        let (first, second, third) = (sum(1), sum(2), sum(3));
        let weighted = weights.iter().zip(self.values);
        let mean = weighted.clone().map(|(weight, value)| weight * value).sum::<f64>() / first;
        let q = weighted.clone().map(|(weight, value)| weight * (value - mean).powi(2)).sum();
        let steep: f64 = weighted.map(|(weight, value)| (weight * (value - mean)).powi(2)).sum();
        let logarithms: f64 = weights.iter().map(|weight| weight.ln()).sum();
        At {
            sum_weights: first,
            mean,
            q,
            trace: second - 2.0 * third / first + (second / first).powi(2),
            slope: 0.5 * (steep - first + second / first),
            log_likelihood: 0.5 * (logarithms - first.ln() - q),
        }
    }

    /// A size of τ² to look around: what the values and their errors vary by.
    fn scale(&self) -> f64 {
        let count = self.freedom() + 1.0;
        let mean = self.values.iter().sum::<f64>() / count;
        let spread = self.values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / self.freedom();
        spread + self.variances.iter().sum::<f64>() / count
    }

    /// The τ² ≥ 0 of highest restricted likelihood: the best point of a grid, then its slope's root between its neighbours.
    fn restricted_maximum(&self) -> f64 {
        // From a 1e-10th of the scale to 100 of it, eleven points a decade: finer than any two maxima lie apart.
        let scale = self.scale();
        let grid: Vec<f64> =
            std::iter::once(0.0).chain((0..=132).map(|k| scale * 10_f64.powf(-10.0 + f64::from(k) / 11.0))).collect();
        let best = (0..grid.len())
            .max_by(|a, b| self.at(grid[*a]).log_likelihood.total_cmp(&self.at(grid[*b]).log_likelihood))
            .unwrap_or(0);
        let (mut low, mut high) = (grid[best.saturating_sub(1)], grid[(best + 1).min(grid.len() - 1)]);
        if self.at(low).slope <= 0.0 {
            return low;
        }
        // 200 halvings end at neighbouring numbers.
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if self.at(middle).slope > 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    }

    /// The τ² at which Q, which falls with it, has this value; 0 where it is below it already there.
    fn variance_of_q(&self, wanted: f64) -> f64 {
        if self.at(0.0).q <= wanted {
            return 0.0;
        }
        let (mut low, mut high) = (0.0, self.scale());
        while self.at(high).q > wanted {
            low = high;
            high *= 2.0;
        }
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if self.at(middle).q > wanted {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    }
}
