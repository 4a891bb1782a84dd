//! Table of contents.

mod coverage;
mod data;
mod nist;
mod optics;
mod report;
mod tables;
mod twins;
