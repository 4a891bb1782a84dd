//! Table of contents.

mod data;
mod nist;
mod optics;
mod tables;
