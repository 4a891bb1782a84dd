//! The models that a job can name, with the parameters that each declares.

use std::fmt;

use super::JobError;
use super::case::coated_base;
use super::file::ModelFile;
use crate::measure::{PeakModel, ThinFilmLaw};
use crate::parameter::Parameter;

/// A model as `barbule models` lists it.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelEntry {
    /// Name in a job: `model.kind`.
    pub kind: &'static str,
    /// What it is and what it reads.
    pub text: &'static str,
    /// A `[model]` section to start from.
    pub example: &'static str,
    /// Parameters that the example declares.
    pub parameters: Vec<Parameter>,
}

/// Kind, text and example of every model.
const MODELS: [(&str, &str, &str); 2] = [
    (
        "coated-base",
        "A film, a stack of layers or a plain interface inside a rough surface (Beckmann), over a diffuse base. Reads\n\
         spectra at any four angles, and peak wavelengths (then without roughness and base, which do not move a peak).\n\
         Its parameters are named after the layers and materials of the job.",
        "kind = \"coated-base\"\n\
         layers = [{ name = \"cortex\", material = \"keratin\", thickness_nm = 330.0 }]\n\
         substrate = \"bird melanin\"",
    ),
    (
        "thin-film-law",
        "The closed law of a single film's peaks, m λ = 2 d √(n² − sin²θ). Reads peak wavelengths only.",
        "kind = \"thin-film-law\"",
    ),
];

/// Every model that a job can name.
pub fn models() -> Result<Vec<ModelEntry>, JobError> {
    MODELS
        .into_iter()
        .map(|(kind, text, example)| {
            let model = toml::from_str(example)
                .map_err(|error| JobError::key(format!("example of {kind}"), error.to_string()))?;
            Ok(ModelEntry { kind, text, example, parameters: declared(&model)? })
        })
        .collect()
}

/// Wavelength for which a listing declares its parameters; only scan steps hang on it.
const LISTING_NM: f64 = 500.0;

fn declared(model: &ModelFile) -> Result<Vec<Parameter>, JobError> {
    Ok(match model {
        ModelFile::CoatedBase(design) => coated_base(design, &[LISTING_NM])?.parameters().to_vec(),
        ModelFile::ThinFilmLaw(design) => ThinFilmLaw::new(design.clone(), LISTING_NM).parameters().to_vec(),
    })
}

impl fmt::Display for ModelEntry {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        writeln!(formatter, "{}\n", self.kind)?;
        for line in self.text.lines() {
            writeln!(formatter, "  {line}")?;
        }
        writeln!(formatter, "\n  Example:\n")?;
        for line in self.example.lines() {
            writeln!(formatter, "    {line}")?;
        }
        writeln!(formatter, "\n  Its parameters (default, range, unit):\n")?;
        for parameter in &self.parameters {
            let range =
                format!("{} [{} to {}] {}", parameter.default, parameter.lower, parameter.upper, parameter.unit);
            writeln!(formatter, "    {:<28} {:<28} {}", parameter.name, range.trim_end(), parameter.text)?;
        }
        Ok(())
    }
}
