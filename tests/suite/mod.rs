//! Table of contents.

mod coated_base;
mod colour;
mod command_line;
mod coverage;
mod data;
mod desk;
mod engine;
mod jobs;
mod nist;
mod optics;
mod report;
mod schema;
mod tables;
mod twins;
