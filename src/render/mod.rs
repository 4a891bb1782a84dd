//! Pictures of scenes: a Monte Carlo path tracer (Kajiya 1986; Veach 1997) for the scattering models of [`crate::bsdf`].
//!
//! A [`Scene`] holds a [`Camera`], shapes with a [`Material`] each, and [`Light`]s. [`render`] makes a [`Picture`] of it.
//! Lengths are mm. Light has three channels, the wavelengths for which the materials' models were made, and they are shown
//! as linear Rec. 709: three samples of a spectrum stand for its colour. Radiance has no absolute unit: 1 is the
//! screen's white, which a white Lambertian surface shows under an irradiance of π.
//!
//! Left out: participating media, the time that light takes, polarisation, dispersion of refracted rays (all channels
//! take one path), depth of field, motion.

mod camera;
mod checkpoint;
mod environment;
mod error;
mod integrator;
mod light;
mod material;
mod mesh;
mod picture;
mod ray;
mod rectangles;
mod sampler;
mod scene;
mod shape;
mod sheet;
mod texture;
mod tiles;

pub use camera::{Camera, Projection};
pub use environment::EnvironmentMap;
pub use error::RenderError;
pub use integrator::{Settings, Strategies};
pub use light::Light;
pub use material::Material;
pub use mesh::{Corner, Mesh, MeshPoint};
pub use picture::{Picture, ToneCurve, ToneMapping};
pub use ray::{Colour, Frame, Hit, Ray, Vector};
pub use sampler::Sampler;
pub use scene::Scene;
pub use shape::{Rectangle, Sphere};
pub use sheet::{Blend, Pattern, Sheet, Vanes};
pub use texture::Texture;
pub use tiles::{Checkpoint, Control, Resolution, render};

pub(crate) use sampler::{MOST_SAMPLES, mixed, unit};
