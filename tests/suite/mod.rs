//! Table of contents.

mod checkpoint;
mod coated_base;
mod colour;
mod coverage;
mod data;
mod engine;
mod jacobian;
mod nist;
mod optics;
mod report;
mod tables;
mod twins;
