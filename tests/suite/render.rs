//! The renderer against closed forms, quadrature, and the theory of its own estimators.
//!
//! Most scenes show one point of one surface to every pixel: the pixels are then equal and independent estimates, whose
//! spread is the standard error of their mean.

mod estimators;
mod feathers;
mod files;
mod paint;
mod sources;
mod species;

use std::f64::consts::{PI, TAU};
use std::sync::atomic::AtomicBool;

use barbule::bsdf::{Direction, Model};
use barbule::render::{
    Camera, Control, Light, Material, Picture, Projection, Rectangle, Resolution, Sampler, Scene, Settings, Strategies,
    Vector, render,
};

use super::directions::{RGB_NM, values};

pub(super) const DIRECT: Settings =
    Settings { scatterings: 1, strategies: Strategies::Both, sampler: Sampler::Sobol, seed: 1 };

/// A picture without interruption, progress or checkpoint.
pub(super) fn picture(scene: &Scene, resolution: Resolution, settings: Settings) -> Picture {
    let control = Control { interrupt: &AtomicBool::new(false), progress: &|_, _| (), checkpoint: None };
    render(scene, resolution, settings, &control).unwrap()
}

/// A model made for the picture's channels, with some of its parameters changed.
pub(super) fn material(model: impl Model + 'static, changes: &[(&str, f64)]) -> Material {
    let values = values(&model, changes);
    Material::plain(Box::new(model), values).unwrap()
}

pub(super) fn lambertian(albedo: f64) -> Material {
    let model = barbule::bsdf::Lambertian::new(&Default::default(), &RGB_NM).unwrap();
    material(model, &[("albedo", albedo)])
}

/// A camera that shows the origin alone, from this direction.
pub(super) fn at_origin(direction: Direction) -> Camera {
    let up = if direction.z.abs() < 0.9 { Vector::z() } else { Vector::y() };
    Camera::new(direction * 10.0, Vector::zeros(), up, Projection::Orthographic { height_mm: 1e-9 }).unwrap()
}

/// A large square about the origin in the plane z = 0, the normal upwards and the tangent along x.
pub(super) fn ground() -> Rectangle {
    Rectangle::new(Vector::new(-1e3, -1e3, 0.0), Vector::new(2e3, 0.0, 0.0), Vector::new(0.0, 2e3, 0.0)).unwrap()
}

/// Ground of a material at the origin, seen at this inclination (degrees) along the tangent, under lights.
pub(super) fn patch(material: Material, inclination_deg: f64, lights: Vec<Light>) -> Scene {
    let (sin, cos) = inclination_deg.to_radians().sin_cos();
    let scene = Scene::new(at_origin(Direction::new(sin, 0.0, cos)), vec![material]).with_rectangle(ground(), 0);
    lights.into_iter().fold(scene, Scene::with_light)
}

/// Mean and standard error of each channel over the pixels, which must show the same.
pub(super) fn estimate(picture: &Picture) -> [(f64, f64); 3] {
    let count = picture.pixels.len() as f64;
    [0, 1, 2].map(|channel| {
        let values = || picture.pixels.iter().map(|pixel| f64::from(pixel[channel]));
        let mean = values().sum::<f64>() / count;
        let variance = values().map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0);
        (mean, (variance / count).sqrt())
    })
}

/// The estimate agrees with a value: within 3 standard errors and an absolute slack for 32-bit pixels.
#[track_caller]
pub(super) fn assert_estimates(picture: &Picture, expected: [f64; 3], what: &str) {
    for (channel, ((mean, error), expected)) in estimate(picture).into_iter().zip(expected).enumerate() {
        let slack = 1e-6 * expected.max(1.0);
        assert!(
            (mean - expected).abs() <= 3.0 * error + slack,
            "{what}, channel {channel}: found {mean} ± {error}, expected {expected}, {:+.1} errors away",
            (mean - expected) / error
        );
    }
}

pub(super) fn resolution(width: u32, height: u32, samples: u32) -> Resolution {
    Resolution { width, height, samples }
}

/// ∫ f |cosθi| dωi over the whole sphere for one viewer, by midpoints in the azimuth and in √cosθ, and its error: what
/// halving the steps changed.
pub(super) fn albedo_of_viewer(material: &dyn Model, values: &[f64], outgoing: &Direction) -> [(f64, f64); 3] {
    let bound = material.bind(values);
    let at = |steps: u32| {
        let mut sums = [0.0; 3];
        let mut value = [0.0; 3];
        for i in 0..2 * steps {
            // Denser at the horizon, where some models bend: cosθ = ± t².
            let t = (f64::from(i) + 0.5) / f64::from(steps) - 1.0;
            let (z, weight) = (t * t.abs(), 2.0 * t.abs() / f64::from(steps));
            let sine = (1.0 - z * z).sqrt();
            for j in 0..2 * steps {
                let (sin, cos) = (TAU * (f64::from(j) + 0.5) / f64::from(2 * steps)).sin_cos();
                bound.evaluate(&Direction::new(sine * cos, sine * sin, z), outgoing, &mut value);
                for (sum, value) in sums.iter_mut().zip(value) {
                    *sum += value * z.abs() * weight * TAU / f64::from(2 * steps);
                }
            }
        }
        sums
    };
    let (coarse, fine) = (at(150), at(300));
    [0, 1, 2].map(|channel| {
        let error = (coarse[channel] - fine[channel]).abs();
        assert!(error < 3e-4, "the quadrature has not converged: {coarse:?} and {fine:?}");
        (fine[channel], error)
    })
}

/// Radiance of a white Lambertian surface under an irradiance of 1.
pub(super) const LAMBERT: f64 = 1.0 / PI;
