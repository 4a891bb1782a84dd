//! How the Jacobian's columns are computed must not show in the result: together or one by one, on one thread or more.
#![expect(clippy::unwrap_used, reason = "a helper of a test fails by panicking")]

use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Duration;

use barbule::fit::{Assignment, Control, Fit, Residuals, Role, Settings, fit};
use barbule::parameter::{Parameter, Spread};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Spectra y = gain·exp(−rate·x) + slope·x, each with a gain of its own, and rate and slope for all.
struct Decays {
    parameters: Vec<Parameter>,
    /// Rows of each spectrum, with its readings.
    spectra: Vec<(Range<usize>, Vec<f64>)>,
    /// Whether the problem says which rows a gain touches.
    tells: bool,
    /// Whether an evaluation takes milliseconds.
    slow: bool,
    running: AtomicUsize,
    most_at_once: AtomicUsize,
}

impl Decays {
    fn new(seed: u64, tells: bool, slow: bool) -> Self {
        let parameter = |name: String| Parameter {
            symbol: name.clone(),
            name,
            unit: "",
            default: 0.0,
            lower: f64::NEG_INFINITY,
            upper: f64::INFINITY,
            spread: Spread::Linear,
            scan_step: None,
            text: String::new(),
        };
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut parameters = vec![parameter("rate".to_owned()), parameter("slope".to_owned())];
        let mut spectra = Vec::new();
        let (rate, slope) = (random.random_range(0.2..2.0), random.random_range(-0.5..0.5));
        let mut first = 0;
        for index in 0..random.random_range(2..6) {
            parameters.push(parameter(format!("gain{index}")));
            let count = random.random_range(4..12);
            let gain: f64 = random.random_range(0.5..3.0);
            let noisy = |k| value(rate, slope, gain, k) + random.random_range(-0.02..0.02);
            spectra.push((first..first + count, (0..count).map(noisy).collect()));
            first += count;
        }
        let (running, most_at_once) = (AtomicUsize::new(0), AtomicUsize::new(0));
        Self { parameters, spectra, tells, slow, running, most_at_once }
    }

    fn fit(&self, threads: usize) -> Fit {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let free = |start, lower, upper| Assignment { role: Role::Free { start, lower, upper }, prior: None };
        let mut assignments = vec![free(1.0, 0.01, 10.0), free(0.0, -5.0, 5.0)];
        assignments.resize(self.parameters.len(), free(1.0, 0.0, 9.0));
        let interrupt = AtomicBool::new(false);
        let control = Control { interrupt: &interrupt, progress: &|_, _| {}, checkpoint: None };
        let settings = Settings { starts: 1, ..Settings::default() };
        pool.install(|| fit(self, &assignments, &settings, &control)).unwrap()
    }
}

fn value(rate: f64, slope: f64, gain: f64, k: usize) -> f64 {
    let x = 0.3 * k as f64;
    gain * (-rate * x).exp() + slope * x
}

impl Residuals for Decays {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn count(&self) -> usize {
        self.spectra.last().unwrap().0.end
    }

    fn evaluate(&self, values: &[f64], residuals: &mut [f64]) {
        let at_once = 1 + self.running.fetch_add(1, Ordering::SeqCst);
        self.most_at_once.fetch_max(at_once, Ordering::SeqCst);
        for ((rows, readings), gain) in self.spectra.iter().zip(&values[2..]) {
            for (k, (residual, reading)) in residuals[rows.clone()].iter_mut().zip(readings).enumerate() {
                *residual = (value(values[0], values[1], *gain, k) - reading) / 0.01;
            }
        }
        if self.slow {
            std::thread::sleep(Duration::from_millis(2));
        }
        self.running.fetch_sub(1, Ordering::SeqCst);
    }

    fn touched(&self, parameter: usize) -> Range<usize> {
        match parameter.checked_sub(2) {
            Some(spectrum) if self.tells => self.spectra[spectrum].0.clone(),
            _ => 0..self.count(),
        }
    }

    fn sigma_known(&self) -> bool {
        true
    }
}

#[test]
fn columns_on_two_threads_are_those_on_one() {
    let (quick, slow) = (Decays::new(3, true, false), Decays::new(3, true, true));
    let (serial, parallel) = (quick.fit(2), slow.fit(2));
    assert_eq!(serde_json::to_string(&serial).unwrap(), serde_json::to_string(&parallel).unwrap());
    // There is one start, so that nothing but columns can meet.
    assert_eq!(quick.most_at_once.into_inner(), 1, "a quick evaluation is not handed to another thread");
    assert_eq!(slow.most_at_once.into_inner(), 2, "a slow evaluation shares the threads with others");
}

proptest::proptest! {
    #![proptest_config(proptest::prelude::ProptestConfig::with_cases(32))]

    /// Gains of different spectra moved together give the columns that they give one by one (Curtis, Powell & Reid 1974):
    /// the covariance is made of the Jacobian and nothing else.
    #[test]
    fn columns_that_share_evaluations_are_those_that_do_not(seed in 0_u64..1_000_000) {
        let (together, apart) = (Decays::new(seed, true, false).fit(1), Decays::new(seed, false, false).fit(1));
        proptest::prop_assert!(together.evaluations < apart.evaluations, "nothing was shared");
        for (a, b) in together.estimates.iter().zip(&apart.estimates) {
            // The steps of extrapolated differences are chosen by sums over other rows, and may differ where two are
            // equally good: both are then right to their own 1e-11 of a column.
            proptest::prop_assert!((a.value - b.value).abs() <= 1e-9 * b.value.abs().max(1.0), "{a:?} and {b:?}");
        }
        for (a, b) in together.covariance.iter().flatten().zip(apart.covariance.iter().flatten()) {
            let (a, b) = (a.unwrap_or(f64::NAN), b.unwrap_or(f64::NAN));
            let same = a.is_nan() && b.is_nan() || (a - b).abs() <= 1e-8 * b.abs().max(1e-6);
            proptest::prop_assert!(same, "covariance {a} and {b}");
        }
    }
}
