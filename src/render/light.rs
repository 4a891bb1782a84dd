//! Light sources: what a point receives from them, and how directions towards them are drawn.

use std::f64::consts::{FRAC_1_PI, PI, TAU};

use super::environment::EnvironmentMap;
use super::ray::{Colour, Vector, luminance};
use super::shape::{Rectangle, Sphere};

/// A light source.
#[derive(Debug, Clone)]
pub enum Light {
    /// A point that shines alike on all sides.
    Point {
        /// Where it is.
        position: Vector,
        /// Radiant intensity, per sr.
        intensity: Colour,
    },
    /// Parallel light.
    Directional {
        /// Towards the light, a unit vector.
        direction: Vector,
        /// What falls on a surface that faces it.
        irradiance: Colour,
    },
    /// A rectangle that shines on the side of its normal, alike in all directions.
    Rectangle {
        /// The rectangle.
        shape: Rectangle,
        /// Radiance.
        radiance: Colour,
    },
    /// A sphere that shines outwards, alike in all directions.
    Sphere {
        /// The sphere.
        shape: Sphere,
        /// Radiance.
        radiance: Colour,
    },
    /// Light from far away, the same on all sides.
    Constant {
        /// Radiance.
        radiance: Colour,
    },
    /// Light from far away, as in a picture of all sides.
    Map(Box<EnvironmentMap>),
}

/// A direction drawn towards a light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LightSample {
    /// Towards the light.
    pub(super) direction: Vector,
    /// To the light, infinite for what is far away.
    pub(super) distance: f64,
    /// Radiance over `density`; for a source without size, what a surface that faces it receives.
    pub(super) weight: Colour,
    /// 1/sr; None for a source that no drawn direction can meet.
    pub(super) density: Option<f64>,
}

impl Light {
    /// Draws a direction towards it from a point; None where it does not shine there.
    #[inline]
    pub(super) fn sample(&self, point: &Vector, random: [f64; 2]) -> Option<LightSample> {
        match self {
            Self::Point { position, intensity } => {
                let to_light = position - point;
                let distance = to_light.norm();
                let fall_off = 1.0 / (distance * distance);
                Some(LightSample {
                    direction: to_light / distance,
                    distance,
                    weight: intensity.map(|channel| channel * fall_off),
                    density: None,
                })
            }
            Self::Directional { direction, irradiance } => {
                Some(LightSample { direction: *direction, distance: f64::INFINITY, weight: *irradiance, density: None })
            }
            Self::Rectangle { shape, radiance } => {
                let to_light = shape.at(random) - point;
                let distance = to_light.norm();
                let direction = to_light * (1.0 / distance);
                let density = area_density(shape, &direction, distance);
                let solid_angle = 1.0 / density;
                (density > 0.0).then(|| LightSample {
                    direction,
                    distance,
                    weight: radiance.map(|channel| channel * solid_angle),
                    density: Some(density),
                })
            }
            Self::Sphere { shape, radiance } => {
                let direction = shape.direction_towards(point, random)?;
                let density = shape.density_towards(point);
                let ray = super::ray::Ray { origin: *point, direction };
                // A direction along the rim may miss by a rounding: then it touches.
                let distance =
                    shape.distance(&ray, 0.0, f64::INFINITY).unwrap_or_else(|| (shape.centre - point).dot(&direction));
                Some(LightSample {
                    direction,
                    distance,
                    weight: radiance.map(|channel| channel / density),
                    density: Some(density),
                })
            }
            Self::Constant { radiance } => {
                let cosine = 1.0 - 2.0 * random[0];
                let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
                let (sin, cos) = (TAU * random[1]).sin_cos();
                Some(LightSample {
                    direction: Vector::new(sine * cos, sine * sin, cosine),
                    distance: f64::INFINITY,
                    weight: radiance.map(|channel| channel * 4.0 * PI),
                    density: Some(0.25 * FRAC_1_PI),
                })
            }
            Self::Map(map) => {
                let direction = map.draw(random);
                let density = map.density(&direction);
                (density > 0.0).then(|| LightSample {
                    direction,
                    distance: f64::INFINITY,
                    weight: map.radiance(&direction).map(|channel| channel / density),
                    density: Some(density),
                })
            }
        }
    }

    /// Density with which [`Light::sample`] draws, from `point`, a direction that meets the light at `distance`; 1/sr.
    #[inline]
    pub(super) fn density(&self, point: &Vector, direction: &Vector, distance: f64) -> f64 {
        match self {
            Self::Point { .. } | Self::Directional { .. } => 0.0,
            Self::Rectangle { shape, .. } => area_density(shape, direction, distance),
            Self::Sphere { shape, .. } => shape.density_towards(point),
            Self::Constant { .. } => 0.25 * FRAC_1_PI,
            Self::Map(map) => map.density(direction),
        }
    }

    /// Radiance that a ray which travels in this direction meets; 0 on the dark side of a rectangle.
    #[inline]
    pub(super) fn radiance(&self, direction: &Vector) -> Colour {
        match self {
            Self::Point { .. } | Self::Directional { .. } => [0.0; 3],
            Self::Rectangle { shape, radiance } => {
                if shape.normal().dot(direction) < 0.0 {
                    *radiance
                } else {
                    [0.0; 3]
                }
            }
            Self::Sphere { radiance, .. } | Self::Constant { radiance } => *radiance,
            Self::Map(map) => map.radiance(direction),
        }
    }

    /// Whether it has no size, so that only drawing it finds it.
    pub(super) fn is_without_size(&self) -> bool {
        matches!(self, Self::Point { .. } | Self::Directional { .. })
    }

    /// Whether it shines alike from everywhere: then no directions suit a surface better than those that it draws itself.
    pub(super) fn is_constant(&self) -> bool {
        matches!(self, Self::Constant { .. })
    }

    /// Whether it surrounds the scene.
    pub(super) fn is_environment(&self) -> bool {
        matches!(self, Self::Constant { .. } | Self::Map(_))
    }

    /// Luminous power that it sends into a scene of this radius, mm: how often it is worth drawing.
    pub(super) fn power(&self, scene_radius: f64) -> f64 {
        let disc = PI * scene_radius * scene_radius;
        match self {
            Self::Point { intensity, .. } => 4.0 * PI * luminance(*intensity),
            Self::Directional { irradiance, .. } => disc * luminance(*irradiance),
            Self::Rectangle { shape, radiance } => PI * shape.area() * luminance(*radiance),
            Self::Sphere { shape, radiance } => 4.0 * PI * PI * shape.radius.powi(2) * luminance(*radiance),
            Self::Constant { radiance } => 4.0 * PI * disc * luminance(*radiance),
            Self::Map(map) => disc * map.flux(),
        }
    }
}

/// Density of directions of points that lie evenly over a rectangle, 1/sr; 0 on its dark side.
#[inline]
fn area_density(shape: &Rectangle, direction: &Vector, distance: f64) -> f64 {
    let cosine = -shape.normal().dot(direction);
    if cosine > 0.0 { distance * distance / (cosine * shape.area()) } else { 0.0 }
}
