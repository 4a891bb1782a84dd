//! Table of contents.

mod engine;
mod nist;
