//! Computes the shipped table of rough transmittances anew and writes it to the path given.
//!
//! `cargo run --release --example tabulate_rough_transmittance src/optics/rough_transmittance.f32`

use std::process::ExitCode;

use barbule::optics::RoughTransmittance;

fn main() -> ExitCode {
    let Some(path) = std::env::args().nth(1) else {
        eprintln!("Name the file to write: src/optics/rough_transmittance.f32");
        return ExitCode::from(2);
    };
    match std::fs::write(&path, RoughTransmittance::tabulate()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{path} cannot be written: {error}.");
            ExitCode::FAILURE
        }
    }
}
