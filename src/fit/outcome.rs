//! What a fit was asked and what it found, as it is written to the result file.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Which solver runs from each start.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Solver {
    /// Levenberg–Marquardt for bounded parameters.
    #[default]
    LeastSquares,
    /// L-BFGS through a change of variable.
    LBfgs,
    /// Nelder–Mead through a change of variable.
    NelderMead,
    /// Particle swarm in the box, polished by least squares.
    ParticleSwarm,
}

/// How a residual r, in units of its σ, enters the cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Loss {
    /// r².
    #[default]
    Squares,
    /// 2(√(1 + r²) − 1).
    SoftL1,
    /// r² up to 1, then 2|r| − 1.
    Huber,
    /// ln(1 + r²).
    Cauchy,
}

/// How the fit is run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Settings {
    /// Solver that runs from each start.
    pub solver: Solver,
    /// Cost of a residual.
    pub loss: Loss,
    /// Residual, in units of σ, beyond which a robust loss takes over.
    pub loss_scale: f64,
    /// Number of start points; 1 is the job's own start alone.
    pub starts: usize,
    /// Iterations allowed from each start.
    pub max_iterations: u64,
    /// Seed of everything random.
    pub seed: u64,
    /// Whether standard errors grow by √(N/Nₑ) where neighbouring residuals err together. Without it they are the
    /// textbook's for independent readings.
    pub correlated_errors: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            solver: Solver::default(),
            loss: Loss::default(),
            loss_scale: 1.0,
            starts: 32,
            max_iterations: 500,
            seed: 1,
            correlated_errors: true,
        }
    }
}

/// Why a solver stopped. Said of the test that passed, not of the truth.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum StopReason {
    /// Neither the cost nor the parameters change any more.
    Converged,
    /// The iteration limit was reached.
    Limit,
    /// No step lowers the cost, yet the gradient is not small.
    Stalled,
    /// The model gave no finite number near the best point.
    Failed,
    /// The user stopped it; the best so far is kept.
    Cancelled,
}

/// A bound that an estimate touches.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Bound {
    /// The smallest allowed value.
    Lower,
    /// The largest allowed value.
    Upper,
}

/// One parameter of the result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Estimate {
    /// Name in the job.
    pub name: String,
    /// Symbol on plots.
    pub symbol: String,
    /// Unit, empty for a pure number.
    pub unit: String,
    /// What it means.
    pub text: String,
    /// `free`, `fixed` or `tied`.
    pub role: String,
    /// Value at the best minimum.
    pub value: f64,
    /// First start, where free.
    pub start: Option<f64>,
    /// Allowed range, where free.
    pub bounds: Option<[f64; 2]>,
    /// Mean and σ of the prior, where there is one.
    pub prior: Option<[f64; 2]>,
    /// Standard error, where the data give one.
    pub standard_error: Option<f64>,
    /// 95 % interval around the best minimum, cut at the bounds; one-sided when the value touches a bound. It is the value ±
    /// so many standard errors where the cost is a parabola that far, and otherwise reaches to where the lowest cost with
    /// this parameter held has risen by as much, farther to one side than to the other.
    pub interval_95: Option<[f64; 2]>,
    /// The bound that the value touches.
    pub at_bound: Option<Bound>,
    /// The data leave this parameter open: its value and error mean little.
    pub open: bool,
}

/// One distinct minimum of the cost.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Minimum {
    /// Values of all parameters, in the order of [`Fit::estimates`].
    pub values: Vec<f64>,
    /// Standard errors of all parameters in the same order, where the data give one.
    pub standard_errors: Vec<Option<f64>>,
    /// Σρ(r) over readings and priors, which is χ² for plain squares and known σ.
    pub cost: f64,
    /// Root mean square of the unweighted residuals (r as the problem gives them), priors left out.
    pub rms: f64,
    /// Share of the posterior weight by Laplace's approximation, 0 to 1 over all minima.
    pub weight: f64,
    /// How many starts ended here.
    pub hits: usize,
    /// Why the best of them stopped.
    pub stop: StopReason,
}

/// A direction in parameter space that the data leave open.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct OpenDirection {
    /// Names and shares of the parameters in it, largest first, the largest share being positive; shares are per
    /// relative change of each parameter (or per unit of its range where it is 0).
    pub shares: Vec<(String, f64)>,
    /// Singular value relative to the largest.
    pub relative_singular_value: f64,
    /// Sentence by names: "η and d only as their product".
    pub text: String,
}

/// Where σ comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SigmaSource {
    /// From the table or the job.
    Known,
    /// From the residuals of this very fit.
    Estimated,
}

/// How well the best minimum fits.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Goodness {
    /// Number of readings.
    pub readings: usize,
    /// Readings that would carry the same information if they were independent (from the lag-1 correlation of
    /// residuals in the order of the problem).
    pub effective_readings: f64,
    /// Number of free parameters.
    pub free_parameters: usize,
    /// Readings + priors − free parameters.
    pub degrees_of_freedom: i64,
    /// Σr² over readings, r in units of σ (of the constant that stands for it, where σ is unknown).
    pub chi_squared: f64,
    /// χ²/degrees of freedom, where σ is known and degrees are left.
    pub reduced_chi_squared: Option<f64>,
    /// Where σ comes from.
    pub sigma_source: SigmaSource,
    /// The factor by which σ was scaled from the residuals, 1 where it is known.
    pub sigma_scale: f64,
    /// Factor by which standard errors were widened because neighbouring residuals err together; 1 where they do not.
    pub error_widening: f64,
    /// Akaike's criterion with small-sample correction, on the effective number of readings.
    pub aicc: Option<f64>,
}

impl Goodness {
    /// Akaike's criterion with small-sample correction (Hurvich and Tsai 1989) as if this many readings were independent;
    /// None where they are too few, or the misfit is no positive number.
    pub fn aicc_on(&self, effective_readings: f64) -> Option<f64> {
        #[expect(clippy::cast_precision_loss, reason = "numbers of readings and parameters are far below 2^53")]
        let (count, free) = (self.readings as f64, self.free_parameters as f64);
        let (parameters, misfit) = match self.sigma_source {
            SigmaSource::Known => (free, self.chi_squared * effective_readings / count),
            SigmaSource::Estimated => (free + 1.0, effective_readings * (self.chi_squared / count).ln()),
        };
        let room = effective_readings - parameters - 1.0;
        (room > 0.0 && misfit.is_finite())
            .then(|| misfit + 2.0 * parameters + 2.0 * parameters * (parameters + 1.0) / room)
    }
}

/// One iteration of the start that won.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TracePoint {
    /// Iteration, from 0.
    pub iteration: u64,
    /// Cost there.
    pub cost: f64,
}

/// The lowest cost found with one parameter held.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ProfilePoint {
    /// Value of the held parameter.
    pub value: f64,
    /// Cost there (of the coarse problem, scaled to the full number of readings, where one was used).
    pub cost: f64,
}

/// What a fit found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Fit {
    /// How it was run.
    pub settings: Settings,
    /// All parameters at the best minimum.
    pub estimates: Vec<Estimate>,
    /// Every distinct minimum, lowest cost first.
    pub minima: Vec<Minimum>,
    /// Names of the parameters of `covariance`, the free ones.
    pub free: Vec<String>,
    /// Covariance of the free parameters at the best minimum; rows of parameters on a bound, or in a
    /// combination that the readings do not determine at all, are None.
    pub covariance: Vec<Vec<Option<f64>>>,
    /// Correlations, likewise.
    pub correlations: Vec<Vec<Option<f64>>>,
    /// Directions that the data leave open.
    pub open_directions: Vec<OpenDirection>,
    /// How well the best minimum fits.
    pub goodness: Goodness,
    /// Cost over each scanned parameter, by name.
    pub profiles: Vec<(String, Vec<ProfilePoint>)>,
    /// Convergence of the start that won.
    pub trace: Vec<TracePoint>,
    /// Why the best minimum's solver stopped.
    pub stop: StopReason,
    /// Residual evaluations in all.
    pub evaluations: u64,
    /// Evaluations with a value that was not finite.
    pub not_finite: u64,
    /// What a reader must know, each a sentence.
    pub warnings: Vec<String>,
}

/// A minimum is ruled out beside the best one where it has no more than this share of its weight.
pub const RIVAL_SHARE: f64 = 0.05;

impl Fit {
    /// Minima that the readings do not rule out beside the best one, each with its place in [`Fit::minima`].
    pub fn rivals(&self) -> impl Iterator<Item = (usize, &Minimum)> {
        let least = self.minima.first().map_or(f64::INFINITY, |best| RIVAL_SHARE * best.weight);
        self.minima.iter().enumerate().skip(1).filter(move |(_, minimum)| minimum.weight > least)
    }
}
