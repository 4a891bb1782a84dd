//! The fit engine on problems whose answer is known otherwise.

use std::f64::consts::PI;
use std::sync::atomic::{AtomicBool, Ordering};

use barbule::fit::{Assignment, Control, Fit, FitError, Prior, Residuals, Role, Settings, fit};
use barbule::parameter::{Parameter, Spread};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

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
    fit(residuals, assignments, settings, &Control { interrupt: &interrupt, progress: &|_, _| {} })
}

/// A single film between air and a darker substrate at normal to 60°: the cosine fringes of a real one.
struct Film {
    parameters: Vec<Parameter>,
    /// cos θ inside and λ of each reading.
    geometry: Vec<(f64, f64)>,
    readings: Vec<f64>,
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
        Self { parameters, geometry, readings }
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

    fn coarse(&self) -> Option<Box<dyn Residuals + '_>> {
        let pick = |k: &usize| k % 13 == 0;
        let chosen: Vec<usize> = (0..self.readings.len()).filter(pick).collect();
        Some(Box::new(Self {
            parameters: self.parameters.clone(),
            geometry: chosen.iter().map(|&k| self.geometry[k]).collect(),
            readings: chosen.iter().map(|&k| self.readings[k]).collect(),
        }))
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
    let mut slowest: f64 = 0.0;
    for seed in 0..40 {
        let thickness = (100.0_f64.ln() + random.random::<f64>() * 15.0_f64.ln()).exp();
        let truth = [thickness, random.random_range(-0.05..0.05), random.random_range(0.5..2.0)];
        let film = Film::new(13, 401, truth, seed);
        let begin = std::time::Instant::now();
        let result = run(&film, &film_assignments(), &Settings::default()).unwrap();
        slowest = slowest.max(begin.elapsed().as_secs_f64());
        let found = result.estimates[0].value;
        if seed < 3 {
            println!(
                "{truth:?} {found} {} minima {} eval {:?}",
                result.minima.len(),
                result.evaluations,
                begin.elapsed()
            );
            for m in &result.minima {
                println!("   {:?} cost {:.4e} w {:.2e} hits {} {:?}", m.values, m.cost, m.weight, m.hits, m.stop);
            }
            println!("{:?}", result.warnings);
        }
        // 300 nm / (4 · 1.7) is the distance of half an order.
        assert!((found - thickness).abs() < 44.0, "seed {seed}: truth {thickness}, found {found}");
    }
    println!("slowest {slowest}");
    let film = Film::new(13, 401, [400.0, 0.0, 1.0], 1);
    let mut out = vec![0.0; film.count()];
    let begin = std::time::Instant::now();
    for k in 0..100 {
        film.evaluate(&[400.0 + f64::from(k), 0.0, 1.0], &mut out);
    }
    println!("one evaluation {:?}", begin.elapsed() / 100);
}
