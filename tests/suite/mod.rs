//! Table of contents.

mod nist;
mod optics;
