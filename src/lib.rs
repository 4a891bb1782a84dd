//! Barbule fits a physical model of how a feather looks to measurements of real feathers, and shows how good the fit is.
//!
//! The rooms, from the bottom up: [`optics`] and [`pigment`], [`bsdf`], [`geometry`] and [`measure`], [`render`], [`job`],
//! [`scene`], [`report`]; each may use what stands before it. [`compare`] stands on `measure` alone. [`fit`] stands beside
//! them on [`parameter`] alone and knows nothing of feathers; `job` is where a measurement, a model and the engine meet.
//! [`sensitivity`] stands beside `fit` and knows nothing but numbers.

pub mod bsdf;
pub mod compare;
pub mod fit;
pub mod geometry;
pub mod job;
mod json_file;
pub mod measure;
mod nearest;
mod number;
pub mod optics;
pub mod parameter;
pub mod pigment;
pub mod render;
pub mod report;
pub mod scene;
pub mod sensitivity;
mod slip;
