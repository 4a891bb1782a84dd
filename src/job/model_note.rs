//! What a methods section says of a case's model and instrument.

use super::JobError;
use super::case::CheckedCase;
use super::file::ModelFile;
use super::outcome::ModelNote;
use crate::bsdf::CoatedBase;
use crate::measure::{Calibration, Instrument, PhaseJumps};
use crate::pigment::PigmentDesign;

/// Sentences, materials and works to cite.
pub(super) fn model_note(case: &CheckedCase) -> Result<ModelNote, JobError> {
    let file = &case.file;
    let card = file.model.card();
    let (text, materials, references) = match &file.model {
        ModelFile::ThinFilmLaw(design) => {
            let law = match design.phase_jumps {
                PhaseJumps::Both => {
                    "2 d √(n² − sin²θ) = m λ, as for a film on a base of higher index, where both reflections turn the phase"
                }
                PhaseJumps::One => {
                    "2 d √(n² − sin²θ) = (m − ½) λ, as for a film on a base of lower index, where one reflection turns the phase"
                }
            };
            let text = format!(
                "Peak wavelengths λ at inclination θ were fitted by the law of a single film of thickness d and constant \
                 refractive index n under air, {law} (Born & Wolf 1999). The law leaves out absorption, dispersion and \
                 the dependence of a reflection's phase on wavelength."
            );
            (text, Vec::new(), card.references())
        }
        ModelFile::CoatedBase(design) => {
            // The ends of the readings say which materials are used beyond what is known of them.
            let described = CoatedBase::new(design, &case.comparison.wavelengths_nm())?.describe();
            (described.text, described.materials, described.references)
        }
        ModelFile::PigmentedBase(design) => {
            let names: Vec<&str> = design.pigments.iter().map(PigmentDesign::name).collect();
            let pigments = if names.is_empty() {
                "It holds no pigment.".to_owned()
            } else {
                format!("What absorbs in it: {}.", names.join(", "))
            };
            let sponge = if design.sponge { " It scatters one band of wavelengths more than the rest." } else { "" };
            (format!("{} {pigments}{sponge}", card.text), Vec::new(), card.references())
        }
        _ => (card.text.to_owned(), Vec::new(), card.references()),
    };
    let text = format!("{text} {}", instrument_text(&file.instrument));
    Ok(ModelNote { kind: card.kind.to_owned(), text: text.trim().to_owned(), materials, references })
}

/// The instrument in a sentence; empty for an ideal one with known gain.
fn instrument_text(instrument: &Instrument) -> String {
    let mut parts = Vec::new();
    if instrument.light_half_angle_deg > 0.0 || instrument.viewer_half_angle_deg > 0.0 {
        parts.push(format!(
            "averaged over cones of half-angle {}° (light) and {}° (viewer)",
            instrument.light_half_angle_deg, instrument.viewer_half_angle_deg
        ));
    }
    if instrument.bandwidth_nm > 0.0 {
        parts.push(format!("smoothed to a bandwidth of {} nm (full width at half maximum)", instrument.bandwidth_nm));
    }
    for (word, calibration) in [("gain", instrument.gain), ("offset", instrument.offset)] {
        match calibration {
            Calibration::Fixed => {}
            Calibration::Shared => parts.push(format!("given one free {word} for all spectra")),
            Calibration::PerSpectrum => parts.push(format!("given a free {word} for each spectrum")),
        }
    }
    if parts.is_empty() { String::new() } else { format!("The model's readings were {}.", parts.join(", ")) }
}
