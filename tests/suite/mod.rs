//! Table of contents.

mod coated_base;
mod colour;
mod coverage;
mod data;
mod engine;
mod nist;
mod optics;
mod order;
mod paints;
mod report;
mod tables;
mod twins;
