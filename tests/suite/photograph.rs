//! Photographs: what is read from files that the tests write themselves, bit by bit where that is possible.

mod bad;
mod colours;
mod files;
mod real;
mod references;
mod synthetic;

use std::path::Path;

use barbule::measure::photograph::{Photograph, PhotographOptions};

/// Reads bytes as a file of this name.
fn read(bytes: &[u8], name: &str) -> Photograph {
    Photograph::from_bytes(bytes, Path::new(name), &PhotographOptions::default())
        .unwrap_or_else(|error| panic!("{error}"))
}

/// The sentence by which bytes are refused.
fn refusal(bytes: &[u8], name: &str) -> String {
    match Photograph::from_bytes(bytes, Path::new(name), &PhotographOptions::default()) {
        Ok(photograph) => panic!("{name} was read: {:?}", photograph.notes),
        Err(error) => error.to_string(),
    }
}

#[track_caller]
fn assert_close(found: [f32; 3], expected: [f64; 3], tolerance: f64) {
    for (found, expected) in found.into_iter().zip(expected) {
        let off = (f64::from(found) - expected).abs();
        assert!(off <= tolerance, "found {found}, expected {expected}, off by {off:e}, allowed {tolerance:e}");
    }
}
