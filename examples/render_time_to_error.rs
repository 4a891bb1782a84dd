//! How long the renderer takes to a picture whose error is 1 %, with each of its samplers, in the scenes of its benchmark.
//!
//! `cargo run --release --example render_time_to_error`; the release profile's own checks cost some of the speed that
//! `cargo bench --bench render` shows. The error is the root mean square over pixels and channels, as a share of their mean.
//! It is taken from two pictures with different seeds, whose difference has twice the variance of either. Samples are doubled
//! until the error is small enough, and the time at 1 % lies on the straight line between the last two in logarithms.
//!
//! Pictures are a quarter as wide and high as the benchmark's; the seconds are sixteen times the measured ones, as if for
//! its size. Edges have a larger share in a small picture: in the boxes the lamp's make most of the error, so that the
//! benchmark's own size needs fewer samples. All of it takes some minutes.

#[path = "../benches/render/scenes.rs"]
mod scenes;

use std::sync::atomic::AtomicBool;
use std::time::Instant;

use barbule::render::{Control, Picture, Resolution, Sampler, Scene, Settings, Strategies, render};

use self::scenes::{lambertian_room, plastic_room, textured_rectangle};

/// The error that is waited for.
const ERROR: f64 = 0.01;

/// Pixels of the benchmark's picture for one of the picture here.
const PIXELS: f64 = 16.0;

/// Where doubling ends.
const MOST_SAMPLES: u32 = 16_384;

fn main() {
    println!("scene, sampler: samples a pixel and seconds to an error of 1 %, million samples a second");
    for (name, scene, [width, height], scatterings) in [
        ("direct light on a textured rectangle", textured_rectangle(), [256, 128], 1),
        ("box of rough plastic", plastic_room(), [64, 64], 8),
        ("Lambertian box", lambertian_room(), [64, 64], 8),
    ] {
        for sampler in [Sampler::Sobol, Sampler::Independent] {
            let settings = Settings { scatterings, strategies: Strategies::Both, sampler, seed: 1 };
            match time_to_error(&scene, [width, height], settings) {
                Some((samples, seconds)) => {
                    let speed = samples * f64::from(width * height) / seconds * 1e-6;
                    println!("{name}, {sampler:?}: {samples:.1} samples, {:.2} s, {speed:.2} M/s", seconds * PIXELS);
                }
                None => println!("{name}, {sampler:?}: not with {MOST_SAMPLES} samples"),
            }
        }
    }
}

/// Samples a pixel and seconds.
fn time_to_error(scene: &Scene, [width, height]: [u32; 2], settings: Settings) -> Option<(f64, f64)> {
    let mut before: Option<f64> = None;
    let mut samples = 1;
    while samples <= MOST_SAMPLES {
        let resolution = Resolution { width, height, samples };
        let start = Instant::now();
        let first = picture(scene, resolution, settings);
        let seconds = start.elapsed().as_secs_f64();
        let second = picture(scene, resolution, Settings { seed: settings.seed + 1, ..settings });
        let error = relative_error(&first, &second);
        if error <= ERROR {
            let share = before.map_or(1.0, |error_before| (error_before / ERROR).ln() / (error_before / error).ln());
            let scale = (share - 1.0).exp2();
            return Some((f64::from(samples) * scale, seconds * scale));
        }
        before = Some(error);
        samples *= 2;
    }
    None
}

fn picture(scene: &Scene, resolution: Resolution, settings: Settings) -> Picture {
    let control = Control { interrupt: &AtomicBool::new(false), progress: &|_, _| (), checkpoint: None };
    render(scene, resolution, settings, &control).expect("nothing stops it")
}

fn relative_error(a: &Picture, b: &Picture) -> f64 {
    let (mut squares, mut sum) = (0.0, 0.0);
    for (a, b) in a.pixels.iter().flatten().zip(b.pixels.iter().flatten()) {
        squares += f64::from(a - b).powi(2);
        sum += 0.5 * f64::from(a + b);
    }
    let count = (3 * a.pixels.len()) as f64;
    (0.5 * squares / count).sqrt() / (sum / count)
}
