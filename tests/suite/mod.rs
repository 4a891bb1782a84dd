//! Table of contents.

mod coated_base;
mod colour;
mod coverage;
mod data;
mod nist;
mod optics;
mod report;
mod tables;
mod twins;
