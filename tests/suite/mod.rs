//! Table of contents.

mod coverage;
mod data;
mod nist;
mod optics;
mod tables;
mod twins;
