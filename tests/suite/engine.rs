//! The fit engine on problems whose answer is known otherwise.
#![expect(clippy::unwrap_used, reason = "a helper of a test fails by panicking")]
#![expect(clippy::float_cmp, reason = "an active bound is met exactly")]

use std::f64::consts::PI;
use std::sync::atomic::AtomicBool;

use barbule::fit::{
    Assignment, Bound, Control, Fit, FitError, Loss, Prior, Residuals, Role, Settings, StopReason, fit, parse_tie,
};
use barbule::parameter::{Parameter, Spread};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// ψ of a loss.
type Slope = fn(f64) -> f64;
type Evaluate<'a> = Box<dyn Fn(&[f64], &mut [f64]) + Sync + 'a>;

/// A problem from a closure.
struct Closure<'a> {
    parameters: Vec<Parameter>,
    count: usize,
    known: bool,
    evaluate: Evaluate<'a>,
}

impl Residuals for Closure<'_> {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn count(&self) -> usize {
        self.count
    }

    fn evaluate(&self, values: &[f64], residuals: &mut [f64]) {
        (self.evaluate)(values, residuals);
    }

    fn sigma_known(&self) -> bool {
        self.known
    }
}

fn parameter(name: &str) -> Parameter {
    Parameter {
        name: name.to_owned(),
        symbol: name.to_owned(),
        unit: "",
        default: 0.0,
        lower: f64::NEG_INFINITY,
        upper: f64::INFINITY,
        spread: Spread::Linear,
        scan_step: None,
        text: String::new(),
    }
}

fn free(start: f64, lower: f64, upper: f64) -> Assignment {
    Assignment { role: Role::Free { start, lower, upper }, prior: None }
}

fn run(residuals: &dyn Residuals, assignments: &[Assignment], settings: &Settings) -> Result<Fit, FitError> {
    let interrupt = AtomicBool::new(false);
    fit(residuals, assignments, settings, &Control { interrupt: &interrupt, progress: &|_, _| {}, checkpoint: None })
}

/// A single film between air and a darker substrate at normal to 60°: the cosine fringes of a real one.
struct Film {
    parameters: Vec<Parameter>,
    /// cos θ inside and λ of each reading.
    geometry: Vec<(f64, f64)>,
    readings: Vec<f64>,
    coarse: Option<Box<Film>>,
}

impl Film {
    fn reflectance(cosine: f64, wavelength: f64, thickness: f64, offset: f64) -> f64 {
        let index = 1.55 + offset + 6000.0 / (wavelength * wavelength);
        let (r1, r2) = ((1.0 - index) / (1.0 + index), (index - 2.0) / (index + 2.0));
        let c = (4.0 * PI * index * thickness * cosine / wavelength).cos();
        (r1 * r1 + r2 * r2 + 2.0 * r1 * r2 * c) / (1.0 + r1 * r1 * r2 * r2 + 2.0 * r1 * r2 * c)
    }

    fn new(angles: usize, wavelengths: usize, truth: [f64; 3], seed: u64) -> Self {
        let mut parameters = vec![parameter("thickness"), parameter("offset"), parameter("gain")];
        parameters[0].spread = Spread::Logarithmic;
        parameters[0].scan_step = Some(15.0);
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut geometry = Vec::new();
        let mut readings = Vec::new();
        for angle in 0..angles {
            let cosine = (1.0 - (f64::from(u32::try_from(angle).unwrap()) * 0.07).sin().powi(2) / 2.4).sqrt();
            for k in 0..wavelengths {
                let wavelength = 300.0 + 400.0 * k as f64 / (wavelengths - 1) as f64;
                geometry.push((cosine, wavelength));
                let value = truth[2] * Self::reflectance(cosine, wavelength, truth[0], truth[1]);
                readings.push(value * (1.0 + 0.01 * normal(&mut random)));
            }
        }
        let chosen = || (0..readings.len()).filter(|k| k.is_multiple_of(13));
        let coarse = Self {
            parameters: parameters.clone(),
            geometry: chosen().map(|k| geometry[k]).collect(),
            readings: chosen().map(|k| readings[k]).collect(),
            coarse: None,
        };
        Self { parameters, geometry, readings, coarse: Some(Box::new(coarse)) }
    }
}

fn normal(random: &mut ChaCha8Rng) -> f64 {
    let (u, v): (f64, f64) = (1.0 - random.random::<f64>(), random.random());
    (-2.0 * u.ln()).sqrt() * (2.0 * PI * v).cos()
}

impl Residuals for Film {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn count(&self) -> usize {
        self.readings.len()
    }

    fn evaluate(&self, values: &[f64], residuals: &mut [f64]) {
        for ((residual, &(cosine, wavelength)), reading) in residuals.iter_mut().zip(&self.geometry).zip(&self.readings)
        {
            *residual = (values[2] * Self::reflectance(cosine, wavelength, values[0], values[1]) - reading) / 0.002;
        }
    }

    fn coarse(&self) -> Option<&dyn Residuals> {
        self.coarse.as_deref().map(|film| film as &dyn Residuals)
    }

    fn sigma_known(&self) -> bool {
        false
    }
}

/// A default gain thirty times off, as an uncalibrated spectrometer's is.
fn film_assignments() -> [Assignment; 3] {
    [free(600.0, 100.0, 1500.0), free(0.0, -0.1, 0.1), free(30.0, 1e-3, 1e3)]
}

#[test]
fn film_of_the_right_order() {
    let mut random = ChaCha8Rng::seed_from_u64(7);
    for seed in 0..20 {
        let thickness = (100.0_f64.ln() + random.random::<f64>() * 15.0_f64.ln()).exp();
        let truth = [thickness, random.random_range(-0.05..0.05), random.random_range(0.5..2.0)];
        let film = Film::new(13, 101, truth, seed);
        let result = run(&film, &film_assignments(), &Settings::default()).unwrap();
        let found = result.estimates[0].value;
        // 300 nm / (4 · 1.7) is the distance of half an order.
        assert!((found - thickness).abs() < 44.0, "seed {seed}: truth {thickness}, found {found}");
        assert!(result.minima.len() > 4, "seed {seed}: only {} minima", result.minima.len());
        assert!(result.minima[0].weight > 0.999, "seed {seed}: {:?}", result.minima[0]);
        assert_eq!(result.profiles.len(), 1, "the thickness is scanned");
        assert!(result.profiles[0].1.len() > 90, "1400 nm in steps of 15");
    }
}

#[test]
fn same_bytes_on_one_thread_and_two() {
    let film = Film::new(3, 41, [330.0, 0.01, 1.2], 3);
    let text = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let result = pool.install(|| run(&film, &film_assignments(), &Settings::default()).unwrap());
        serde_json::to_string(&result).unwrap()
    };
    assert_eq!(text(1), text(2), "the number of threads must not show");
}

/// y = a + b·x at n points with noise of σ = 0.5: everything is known in closed form.
fn line<'a>(x: &'a [f64], y: &'a [f64], sigma: f64, known: bool) -> Closure<'a> {
    Closure {
        parameters: vec![parameter("a"), parameter("b")],
        count: x.len(),
        known,
        evaluate: Box::new(move |values, residuals| {
            for ((residual, x), y) in residuals.iter_mut().zip(x).zip(y) {
                *residual = (values[0] + values[1] * x - y) / sigma;
            }
        }),
    }
}

fn close(found: f64, expected: f64, relative: f64) {
    let difference = (found - expected).abs();
    assert!(
        difference <= relative * expected.abs(),
        "expected {expected}, found {found}, relative difference {}",
        difference / expected.abs()
    );
}

fn line_data() -> (Vec<f64>, Vec<f64>) {
    let mut random = ChaCha8Rng::seed_from_u64(11);
    let x: Vec<f64> = (0..20).map(|k| 0.3 * f64::from(k)).collect();
    let y = x.iter().map(|x| 2.0 - 0.7 * x + 0.5 * normal(&mut random)).collect();
    (x, y)
}

/// Textbook regression: estimates, and Var = σ²(XᵀX)⁻¹.
fn regression(x: &[f64], y: &[f64]) -> ([f64; 2], [f64; 3], f64) {
    let n = x.len() as f64;
    let (sx, sy): (f64, f64) = (x.iter().sum(), y.iter().sum());
    let sxx: f64 = x.iter().map(|x| (x - sx / n).powi(2)).sum();
    let b = x.iter().zip(y).map(|(x, y)| (x - sx / n) * (y - sy / n)).sum::<f64>() / sxx;
    let a = (sy - b * sx) / n;
    let rss: f64 = x.iter().zip(y).map(|(x, y)| (a + b * x - y).powi(2)).sum();
    let mean = sx / n;
    ([a, b], [1.0 / n + mean * mean / sxx, -mean / sxx, 1.0 / sxx], rss)
}

#[test]
fn a_line_has_the_textbook_covariance() {
    let (x, y) = line_data();
    let ([a, b], [vaa, vab, vbb], rss) = regression(&x, &y);
    let wide = [free(0.0, -1e3, 1e3), free(0.0, -1e3, 1e3)];
    let settings = Settings { starts: 4, ..Settings::default() };

    let known = run(&line(&x, &y, 0.5, true), &wide, &settings).unwrap();
    // Exact arithmetic would give all digits; differences over a range of 1 leave some 1e-10.
    close(known.estimates[0].value, a, 1e-10);
    close(known.estimates[1].value, b, 1e-10);
    close(known.covariance[0][0].unwrap(), 0.25 * vaa, 1e-9);
    close(known.covariance[0][1].unwrap(), 0.25 * vab, 1e-9);
    close(known.covariance[1][1].unwrap(), 0.25 * vbb, 1e-9);
    close(known.correlations[0][1].unwrap(), vab / (vaa * vbb).sqrt(), 1e-9);
    close(known.minima[0].cost, rss / 0.25, 1e-10);
    let [low, high] = known.estimates[1].interval_95.unwrap();
    close(high - low, 2.0 * 1.959_963_984_540_054 * 0.5 * vbb.sqrt(), 1e-9);
    assert_eq!((known.minima.len(), known.minima[0].hits), (1, 4), "one minimum, from every start");

    let unknown = run(&line(&x, &y, 0.5, false), &wide, &settings).unwrap();
    let variance = rss / 18.0;
    close(unknown.covariance[1][1].unwrap(), variance * vbb, 1e-9);
    close(unknown.goodness.sigma_scale, variance.sqrt() / 0.5, 1e-9);
    let [low, high] = unknown.estimates[1].interval_95.unwrap();
    // Student's 97.5 % quantile at 18 degrees of freedom, from any table.
    close(high - low, 2.0 * 2.100_922 * (variance * vbb).sqrt(), 1e-6);
    assert_eq!(unknown.goodness.degrees_of_freedom, 18, "20 readings, 2 parameters");
}

#[test]
fn every_solver_finds_the_line() {
    let (x, y) = line_data();
    let ([a, b], ..) = regression(&x, &y);
    use barbule::fit::Solver::{LBfgs, LeastSquares, NelderMead, ParticleSwarm};
    // The simplex knows costs alone, and those are level to rounding over 1e-8 of a parameter.
    for (solver, relative) in [(LeastSquares, 1e-10), (LBfgs, 1e-6), (NelderMead, 1e-5), (ParticleSwarm, 1e-10)] {
        let settings = Settings { solver, starts: 2, ..Settings::default() };
        let result = run(&line(&x, &y, 0.5, true), &[free(1.0, -9.0, 9.0), free(1.0, -9.0, 9.0)], &settings).unwrap();
        close(result.estimates[0].value, a, relative);
        close(result.estimates[1].value, b, relative);
        assert_eq!(result.stop, StopReason::Converged, "{solver:?}");
    }
}

#[test]
fn every_solver_survives_a_model_without_numbers() {
    use barbule::fit::Solver::{LBfgs, LeastSquares, NelderMead, ParticleSwarm};
    // √(x − 2) is no number left of 2, where half of the box lies; its answer is 3.
    let problem = Closure {
        parameters: vec![parameter("x")],
        count: 2,
        known: true,
        evaluate: Box::new(|values, residuals| {
            residuals[0] = (values[0] - 2.0).sqrt() - 1.0;
            residuals[1] = 0.1 * (values[0] - 3.0);
        }),
    };
    for solver in [LeastSquares, LBfgs, NelderMead, ParticleSwarm] {
        let settings = Settings { solver, starts: 8, ..Settings::default() };
        let result = run(&problem, &[free(2.5, 0.0, 4.0)], &settings).unwrap();
        close(result.estimates[0].value, 3.0, 1e-4);
        assert!(result.not_finite > 0 || solver == LBfgs || solver == NelderMead, "{solver:?}");
    }
    let nowhere = Closure {
        parameters: vec![parameter("x")],
        count: 2,
        known: true,
        evaluate: Box::new(|_, residuals| residuals.fill(f64::NAN)),
    };
    for solver in [LeastSquares, LBfgs, NelderMead, ParticleSwarm] {
        let settings = Settings { solver, starts: 8, ..Settings::default() };
        let error = run(&nowhere, &[free(2.5, 0.0, 4.0)], &settings).unwrap_err();
        assert_eq!(
            error.to_string(),
            format!(
                "the model gives no finite residuals at any of the {} start points (the first has x = 2.5); \
                 check the start values, the bounds and the readings.",
                if solver == ParticleSwarm { 1 } else { 8 }
            )
        );
    }
}

#[test]
fn a_prior_is_one_more_reading() {
    // Three readings of m, and a prior: the weighted mean.
    let readings = [1.0, 1.3, 1.1];
    let sigma = 0.2;
    let problem = |known| Closure {
        parameters: vec![parameter("m")],
        count: 3,
        known,
        evaluate: Box::new(move |values: &[f64], residuals: &mut [f64]| {
            for (residual, reading) in residuals.iter_mut().zip(readings) {
                *residual = (values[0] - reading) / sigma;
            }
        }),
    };
    let prior = Some(Prior { mean: 2.0, sigma: 0.1 });
    let assignment = [Assignment { prior, ..free(0.0, -10.0, 10.0) }];
    let settings = Settings { starts: 1, ..Settings::default() };
    let known = run(&problem(true), &assignment, &settings).unwrap();
    let (w, p): (f64, f64) = (1.0 / 0.04, 1.0 / 0.01);
    close(known.estimates[0].value, (3.4 * w + 2.0 * p) / (3.0 * w + p), 1e-11);
    close(known.estimates[0].standard_error.unwrap(), (3.0 * w + p).recip().sqrt(), 1e-9);

    // With σ unknown its estimate s solves s² = (Σ(m − y)² + s²(m − 2)²/0.01)/(3 + 1 − 1) together with m.
    let unknown = run(&problem(false), &assignment, &settings).unwrap();
    let s = unknown.goodness.sigma_scale * sigma;
    let m = unknown.estimates[0].value;
    let w = 1.0 / (s * s);
    close(m, (3.4 * w + 2.0 * p) / (3.0 * w + p), 1e-9);
    let squares: f64 = readings.iter().map(|y| (m - y).powi(2)).sum();
    close(s * s, (squares + s * s * (m - 2.0).powi(2) * p) / 3.0, 1e-9);
}

#[test]
fn ties_follow_and_share_the_error() {
    let (x, y) = line_data();
    let ([a, b], [_, _, vbb], _) = regression(&x, &y);
    let mut problem = line(&x, &y, 0.5, true);
    problem.parameters.push(parameter("twice"));
    let role =
        parse_tie("twice = 2*b + 1", |name| ["a", "b", "twice"].iter().position(|known| *known == name)).unwrap();
    let assignments = [free(0.0, -1e3, 1e3), free(0.0, -1e3, 1e3), Assignment { role, prior: None }];
    let result = run(&problem, &assignments, &Settings { starts: 1, ..Settings::default() }).unwrap();
    close(result.estimates[0].value, a, 1e-10);
    close(result.estimates[2].value, 2.0 * b + 1.0, 1e-10);
    close(result.estimates[2].standard_error.unwrap(), 2.0 * 0.5 * vbb.sqrt(), 1e-9);
    assert_eq!(result.estimates[2].role, "tied");
}

#[test]
fn robust_losses_resist_an_outlier_as_published() {
    let mut readings = vec![0.1, -0.2, 0.3, 0.0, -0.1, 0.25, -0.3, 0.15];
    readings.push(50.0);
    let readings = &readings;
    let problem = Closure {
        parameters: vec![parameter("m")],
        count: readings.len(),
        known: true,
        evaluate: Box::new(move |values, residuals| {
            for (residual, reading) in residuals.iter_mut().zip(readings) {
                *residual = values[0] - reading;
            }
        }),
    };
    // ψ of each loss, so that Σψ(m − y) = 0 can be solved by bisection.
    let cases: [(Loss, Slope); 3] = [
        (Loss::SoftL1, |u| u / (1.0 + u * u).sqrt()),
        (Loss::Huber, |u| u.clamp(-1.0, 1.0)),
        (Loss::Cauchy, |u| u / (1.0 + u * u)),
    ];
    for (loss, psi) in cases {
        let scale = 0.7;
        let total = |m: f64| readings.iter().map(|y| psi((m - y) / scale)).sum::<f64>();
        let (mut low, mut high) = (-1.0, 3.0);
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if total(middle) < 0.0 { low = middle } else { high = middle }
        }
        let settings = Settings { loss, loss_scale: scale, starts: 1, ..Settings::default() };
        let result = run(&problem, &[free(0.2, -100.0, 100.0)], &settings).unwrap();
        let found = result.estimates[0].value;
        assert!((found - low).abs() < 1e-9, "{loss:?}: expected {low}, found {found}");
        // The sandwich, with derivatives of ψ by differences.
        let slope: f64 =
            readings.iter().map(|y| (psi((found - y + 1e-6) / scale) - psi((found - y - 1e-6) / scale)) / 2e-6).sum();
        let square: f64 = readings.iter().map(|y| psi((found - y) / scale).powi(2)).sum();
        close(result.estimates[0].standard_error.unwrap(), (square * 9.0 / 8.0).sqrt() / slope, 1e-6);
    }
}

#[test]
fn a_parameter_on_its_bound_gets_one_side() {
    let (x, y) = line_data();
    let problem = line(&x, &y, 0.5, true);
    let b = regression(&x, &y).0[1];
    let assignments = [free(0.0, -1e3, 1e3), free(0.0, b + 0.1, 5.0)];
    let result = run(&problem, &assignments, &Settings::default()).unwrap();
    let slope = &result.estimates[1];
    assert_eq!(slope.at_bound, Some(Bound::Lower));
    assert_eq!(slope.value, b + 0.1, "exactly on the bound");
    assert_eq!(slope.standard_error, None);
    let [low, high] = slope.interval_95.unwrap();
    assert_eq!(low, b + 0.1);
    // The likelihood of b is a Gaussian about its unbounded estimate; 95 % of what is left beyond the bound, by sums.
    let width = 0.5 * regression(&x, &y).1[2].sqrt();
    let density = |t: f64| (-0.5 * ((t - b) / width).powi(2)).exp();
    let step = width / 10_000.0;
    let values: Vec<f64> = (0..100_000).map(|k| density(b + 0.1 + (f64::from(k) + 0.5) * step)).collect();
    let total: f64 = values.iter().sum();
    let mut sum = 0.0;
    let count = values
        .iter()
        .take_while(|value| {
            sum += *value;
            sum < 0.95 * total
        })
        .count();
    close(high - low, (count as f64 + 0.5) * step, 1e-3);
    assert!(result.covariance[1].iter().all(Option::is_none), "no row for a parameter on a bound");
    assert!(result.warnings.iter().any(|text| text.contains("`b` lies on its lower bound")), "{:?}", result.warnings);
}

#[test]
fn a_product_is_open_and_said_so() {
    let (x, y) = line_data();
    let problem = Closure {
        parameters: vec![parameter("index"), parameter("thickness"), parameter("offset")],
        count: x.len(),
        known: true,
        evaluate: Box::new(|values, residuals| {
            for ((residual, x), y) in residuals.iter_mut().zip(&x).zip(&y) {
                *residual = (values[2] - values[0] * values[1] * x - y) / 0.5;
            }
        }),
    };
    let assignments = [free(1.0, 0.1, 10.0), free(1.0, 0.1, 10.0), free(0.0, -9.0, 9.0)];
    let result = run(&problem, &assignments, &Settings { starts: 1, ..Settings::default() }).unwrap();
    assert_eq!(result.open_directions.len(), 1);
    let text = &result.open_directions[0].text;
    assert!(text.contains("`index` and `thickness` only as a combination"), "{text}");
    assert!(result.estimates[0].open && result.estimates[1].open && !result.estimates[2].open);
    assert_eq!((result.estimates[0].standard_error, result.estimates[1].standard_error), (None, None));
    assert!(result.estimates[2].standard_error.is_some(), "what the data do give keeps its error");
}

/// Wells at the minima of cos 5x + 0.3x against y = −0.4, ten readings each; integrated well by well on a fine grid.
#[test]
fn laplace_weights_agree_with_integration() {
    let readings: Vec<f64> = {
        let mut random = ChaCha8Rng::seed_from_u64(5);
        (0..10).map(|_| -0.4 + 0.05 * normal(&mut random)).collect()
    };
    let curve = |x: f64| (5.0 * x).cos() + 0.3 * x;
    let (lower, upper) = (0.2, 4.0);
    // Nothing known beforehand is an even density, or one even in the logarithm where starts are spread so.
    let cases = [(true, Spread::Linear), (false, Spread::Linear), (true, Spread::Logarithmic)];
    for (known, spread) in cases {
        let data = &readings;
        let problem = Closure {
            parameters: vec![Parameter { spread, ..parameter("x") }],
            count: data.len(),
            known,
            evaluate: Box::new(move |values, residuals| {
                for (residual, y) in residuals.iter_mut().zip(data) {
                    *residual = (curve(values[0]) - y) / 0.05;
                }
            }),
        };
        let settings = Settings { starts: 64, ..Settings::default() };
        let result = run(&problem, &[free(1.0, lower, upper)], &settings).unwrap();
        let squares = |x: f64| data.iter().map(|y| ((curve(x) - y) / 0.05).powi(2)).sum::<f64>();
        let prior = |x: f64| if spread == Spread::Logarithmic { 1.0 / x } else { 1.0 };
        let density = |x: f64| prior(x) * if known { (-0.5 * squares(x)).exp() } else { squares(x).powf(-5.0) };
        // Every point of the grid belongs to the nearest minimum; wells are narrow, so that borders carry nothing.
        let mut mass = vec![0.0; result.minima.len()];
        for k in 0..400_000 {
            let x = lower + (upper - lower) * (f64::from(k) + 0.5) / 400_000.0;
            let distance = |m: usize| (result.minima[m].values[0] - x).abs();
            let nearest = (0..mass.len()).min_by(|&a, &b| distance(a).total_cmp(&distance(b))).unwrap();
            mass[nearest] += density(x);
        }
        let total: f64 = mass.iter().sum();
        assert!(result.minima.len() >= 4, "{:?}", result.minima);
        for (minimum, mass) in result.minima.iter().zip(&mass) {
            // Laplace leaves out what is not Gaussian: percents with ten readings, more in the tails without σ, and the
            // slope of 1/x over a well.
            let (found, expected) = (minimum.weight, mass / total);
            assert!(
                (found - expected).abs() < 0.025,
                "known {known}, x = {}: {found} for {expected}",
                minimum.values[0]
            );
        }
        assert!(
            result.warnings.iter().any(|text| text.contains("more than 5 % of the weight")),
            "{:?}",
            result.warnings
        );
    }
}

#[test]
fn an_interrupt_keeps_the_best_so_far() {
    let (x, y) = line_data();
    use barbule::fit::Solver::{LBfgs, LeastSquares, NelderMead, ParticleSwarm};
    for solver in [LeastSquares, LBfgs, NelderMead, ParticleSwarm] {
        let interrupt = AtomicBool::new(true);
        let control = Control { interrupt: &interrupt, progress: &|_, _| {}, checkpoint: None };
        let settings = Settings { solver, ..Settings::default() };
        let assignments = [free(1.0, -9.0, 9.0), free(1.0, -9.0, 9.0)];
        let result = fit(&line(&x, &y, 0.5, true), &assignments, &settings, &control).unwrap();
        assert_eq!(result.stop, StopReason::Cancelled, "{solver:?}");
        assert!(result.warnings[0].contains("interrupted"), "{:?}", result.warnings);
    }
}

#[test]
fn mistakes_are_sentences() {
    let (x, y) = line_data();
    let problem = line(&x, &y, 0.5, true);
    let settings = Settings::default();
    let text = |assignments: &[Assignment]| run(&problem, assignments, &settings).unwrap_err().to_string();
    let good = free(0.0, -1.0, 1.0);
    let role = |role: Role| Assignment { role, prior: None };
    let tied = |terms: &[(usize, f64)]| role(Role::Tied { constant: 0.0, terms: terms.to_vec() });
    let cases = [
        (vec![good.clone()], "1 assignments were given for 2 parameters"),
        (vec![good.clone(), free(0.0, 1.0, -1.0)], "bounds of `b` leave no room: lower 1, upper -1"),
        (vec![good.clone(), free(2.0, -1.0, 1.0)], "start value 2 of `b` must be a finite number between"),
        (vec![good.clone(), free(f64::NAN, -1.0, 1.0)], "start value NaN of `b`"),
        (vec![role(Role::Fixed(1.0)), role(Role::Fixed(1.0))], "no parameter is free"),
        (vec![good.clone(), role(Role::Fixed(f64::INFINITY))], "fixed value of `b` is inf"),
        (vec![tied(&[(1, 1.0)]), tied(&[(0, 1.0)])], "`a` is tied to `b`, which is tied itself"),
        (vec![good.clone(), tied(&[(1, 1.0)])], "`b` is tied to `b`, which is tied itself"),
        (vec![good.clone(), tied(&[(7, 1.0)])], "`b` is tied to parameter number 7, but there are only 2"),
        (
            vec![good.clone(), Assignment { prior: Some(Prior { mean: 0.0, sigma: 0.0 }), ..good.clone() }],
            "prior's standard deviation of `b` is 0; it must be a finite number above 0",
        ),
    ];
    for (assignments, expected) in cases {
        let found = text(&assignments);
        assert!(found.contains(expected) && found.ends_with('.'), "expected `{expected}` in `{found}`");
    }
    let few = line(&x[..1], &y[..1], 0.5, true);
    let found = run(&few, &[good.clone(), good.clone()], &settings).unwrap_err().to_string();
    assert!(found.contains("2 free parameters (`a`, `b`) cannot be found from 1 readings"), "{found}");
    let none = Settings { starts: 0, ..Settings::default() };
    let found = run(&problem, &[good.clone(), good], &none).unwrap_err().to_string();
    assert!(found.contains("`starts` is 0; it must be from 1 to 65536"), "{found}");
}

#[test]
fn as_many_parameters_as_readings() {
    let (x, y) = ([0.0, 1.0], [1.0, 3.0]);
    for known in [true, false] {
        let wide = [free(0.0, -9.0, 9.0), free(0.0, -9.0, 9.0)];
        let result = run(&line(&x, &y, 0.5, known), &wide, &Settings::default()).unwrap();
        close(result.estimates[0].value, 1.0, 1e-9);
        close(result.estimates[1].value, 2.0, 1e-9);
        assert_eq!(result.estimates[0].standard_error.is_some(), known, "σ must come from somewhere");
        assert_eq!(result.minima.len(), 1);
        let text = serde_json::to_string(&result).unwrap();
        assert_eq!(serde_json::from_str::<Fit>(&text).unwrap(), result, "every number is finite and comes back");
    }
}

/// A decay with an offset, for the crate that is MINPACK to the bit.
struct Decay {
    values: nalgebra::Vector3<f64>,
}

const DECAY: [f64; 8] = [3.1, 2.2, 1.75, 1.3, 1.2, 0.95, 0.99, 0.9];

impl levenberg_marquardt::LeastSquaresProblem<f64, nalgebra::U8, nalgebra::U3> for Decay {
    type ResidualStorage = nalgebra::Owned<f64, nalgebra::U8>;
    type JacobianStorage = nalgebra::Owned<f64, nalgebra::U8, nalgebra::U3>;
    type ParameterStorage = nalgebra::Owned<f64, nalgebra::U3>;

    fn set_params(&mut self, values: &nalgebra::Vector3<f64>) {
        self.values = *values;
    }

    fn params(&self) -> nalgebra::Vector3<f64> {
        self.values
    }

    fn residuals(&self) -> Option<nalgebra::SVector<f64, 8>> {
        let [a, b, c] = self.values.into();
        Some(nalgebra::SVector::from_fn(|k, _| a * (-b * k as f64).exp() + c - DECAY[k]))
    }

    fn jacobian(&self) -> Option<nalgebra::SMatrix<f64, 8, 3>> {
        let [a, b, _] = self.values.into();
        Some(nalgebra::SMatrix::from_fn(|k, j| {
            let t = k as f64;
            [(-b * t).exp(), -a * t * (-b * t).exp(), 1.0][j]
        }))
    }
}

#[test]
fn without_bounds_it_ends_where_minpack_does() {
    let start = [1.0, 1.0, 0.0];
    let solver = levenberg_marquardt::LevenbergMarquardt::new().with_tol(1e-15);
    let (theirs, report) = solver.minimize(Decay { values: start.into() });
    assert!(report.termination.was_successful(), "{report:?}");
    let problem = Closure {
        parameters: vec![parameter("a"), parameter("b"), parameter("c")],
        count: 8,
        known: false,
        evaluate: Box::new(|values, residuals| {
            for (k, residual) in residuals.iter_mut().enumerate() {
                *residual = values[0] * (-values[1] * k as f64).exp() + values[2] - DECAY[k];
            }
        }),
    };
    let wide = start.map(|start| free(start, f64::NEG_INFINITY, f64::INFINITY));
    let ours = run(&problem, &wide, &Settings { starts: 1, ..Settings::default() }).unwrap();
    for (ours, theirs) in ours.estimates.iter().zip(theirs.values.iter()) {
        // Its own stop, by the cost, leaves the parameters good to the root of rounding.
        close(ours.value, *theirs, 1e-7);
    }
}

proptest::proptest! {
    /// min ‖A·x − b‖² in a box: at the solution the gradient vanishes inside and points outwards on the faces (Karush,
    /// Kuhn & Tucker), and since the problem is convex nothing else is one. The model panics outside of the box.
    #[test]
    fn linear_problems_in_a_box_meet_their_conditions(seed in 0_u64..1_000_000, size in 1_usize..6) {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let rows = size + 3;
        let matrix: Vec<f64> = (0..rows * size).map(|_| normal(&mut random)).collect();
        let right: Vec<f64> = (0..rows).map(|_| 2.0 * normal(&mut random)).collect();
        let bounds: Vec<(f64, f64)> = (0..size)
            .map(|_| { let low = 0.5 * normal(&mut random); (low, low + 0.1 + random.random::<f64>()) })
            .collect();
        let product = |x: &[f64], row: usize| -> f64 { (0..size).map(|j| matrix[row * size + j] * x[j]).sum::<f64>() - right[row] };
        let box_of = bounds.clone();
        let problem = Closure {
            parameters: (0..size).map(|j| parameter(&format!("x{j}"))).collect(),
            count: rows,
            known: true,
            evaluate: Box::new(move |x, residuals| {
                for (x, (low, high)) in x.iter().zip(&box_of) {
                    assert!(x >= low && x <= high, "{x} is outside {low} to {high}");
                }
                for (row, residual) in residuals.iter_mut().enumerate() {
                    *residual = product(x, row);
                }
            }),
        };
        let assignments: Vec<Assignment> = bounds.iter().map(|&(low, high)| free(0.5 * (low + high), low, high)).collect();
        let result = run(&problem, &assignments, &Settings { starts: 3, ..Settings::default() }).unwrap();
        proptest::prop_assert_eq!(result.stop, StopReason::Converged);
        proptest::prop_assert_eq!(result.minima.len(), 1);
        let x = &result.minima[0].values;
        let gradient = |j: usize| (0..rows).map(|row| matrix[row * size + j] * product(x, row)).sum::<f64>();
        for j in 0..size {
            let slope = gradient(j);
            let (low, high) = bounds[j];
            let on_low = x[j] == low && slope >= -1e-9;
            let on_high = x[j] == high && slope <= 1e-9;
            // Sums of some ten products of size one: 1e-9 is far above rounding and differences, far below a wrong face.
            proptest::prop_assert!(on_low || on_high || slope.abs() < 1e-9, "x{} = {} in {:?}, slope {}", j, x[j], (low, high), slope);
        }
    }
}
