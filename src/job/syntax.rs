//! From TOML text to a job, and from a slip in it to a sentence: line, key, what was found, what was expected.
//!
//! Serde's own words (`expected f64`, `missing field`) speak to programmers, and of the model, whose kind decides its
//! keys, serde does not say where it went wrong. So a slip is looked up once more, and said in words.

use std::path::Path;

use serde::de::DeserializeOwned;
use serde_path_to_error::Segment;
use toml::de::{DeTable, DeValue};

use super::{JobError, JobFile};
use crate::bsdf::cylinder::{CylinderDesign, FilmedCylinderDesign};
use crate::bsdf::{
    Design, FeatherDesign, FilmAtUnknownAngleDesign, GranierHeidrichDesign, IridescentPlasticDesign, LambertianDesign,
    MicrofacetDesign, PigmentedBaseDesign, RoughPlasticDesign,
};
use crate::measure::ThinFilmLawDesign;
use crate::slip::{in_words, written};

/// Parses a job, or says in which line and key it goes wrong.
pub(super) fn parse(text: &str, path: &Path) -> Result<JobFile, JobError> {
    let refused = |line, message| JobError::Syntax { path: path.to_owned(), line, message };
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let table = toml::from_str(text).map_err(|error| refused(None, error.to_string().trim().to_owned()))?;
    let value = toml::Value::Table(table);
    deserialise(value.clone()).map_err(|slip| {
        let slip = in_model(&value, &slip).unwrap_or(slip);
        let section = if slip.keys.is_empty() { String::new() } else { format!("{}: ", written(&slip.keys)) };
        refused(line_of(text, &slip.keys), format!("{section}{}", in_words(&slip.message, TABLE)))
    })
}

/// The line, counted from 1, of the deepest of these nested keys that the text has.
pub(super) fn line_of(text: &str, keys: &[String]) -> Option<usize> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let root = DeTable::parse(text).ok()?;
    let mut value = DeValue::Table(root.into_inner());
    let mut place = None;
    for key in keys {
        let found = match &value {
            DeValue::Table(table) => {
                table.iter().find(|(name, _)| name.get_ref() == key).map(|(name, inner)| (name.span(), inner))
            }
            DeValue::Array(list) => {
                key.parse().ok().and_then(|index: usize| list.get(index)).map(|inner| (inner.span(), inner))
            }
            _ => None,
        };
        let Some((span, inner)) = found else { break };
        place = Some(span.start);
        value = inner.get_ref().clone();
    }
    place.map(|start| text[..start].matches('\n').count() + 1)
}

/// The single keys of a nested one as messages write it: `data.synthetic.truth."film.index"`.
pub(super) fn keys_of(nested: &str) -> Vec<String> {
    let mut keys = Vec::new();
    let mut table = toml::from_str::<toml::Table>(&format!("{nested} = 0")).unwrap_or_default();
    while let Some((key, inner)) = table.into_iter().next() {
        keys.push(key);
        table = if let toml::Value::Table(inner) = inner { inner } else { break };
    }
    keys
}

/// What TOML calls a group of keys.
const TABLE: &str = "a table, as `{ key = value }` or under `[key]`";

/// Where serde gave up, and in which words.
struct Slip {
    keys: Vec<String>,
    message: String,
}

fn deserialise<T: DeserializeOwned>(value: toml::Value) -> Result<T, Slip> {
    serde_path_to_error::deserialize(value).map_err(|error| {
        let keys = error.path().iter().filter_map(|segment| match segment {
            Segment::Seq { index } => Some(index.to_string()),
            Segment::Map { key } => Some(key.clone()),
            Segment::Enum { .. } | Segment::Unknown => None,
        });
        let keys = keys.collect();
        Slip { keys, message: error.into_inner().message().to_owned() }
    })
}

/// The same slip inside a model, whose keys hang on its kind.
fn in_model(job: &toml::Value, slip: &Slip) -> Option<Slip> {
    let model = slip.keys.iter().try_fold(job, |value, key| match key.parse::<usize>() {
        Ok(index) if value.is_array() => value.get(index),
        _ => value.get(key),
    })?;
    let mut model = slip.keys.last().filter(|last| *last == "model").and(model.as_table())?.clone();
    let kind = model.remove("kind")?;
    let (keys, message) = model_slip(kind.as_str()?, toml::Value::Table(model))?;
    Some(Slip { keys: slip.keys.iter().cloned().chain(keys).collect(), message })
}

/// The first slip in a model of this kind, whose other keys are given: its keys below the model, and serde's words.
pub(crate) fn model_slip(kind: &str, model: toml::Value) -> Option<(Vec<String>, String)> {
    let slip = match kind {
        "coated-base" => deserialise::<Design>(model).err()?,
        "microfacet" => deserialise::<MicrofacetDesign>(model).err()?,
        "rough-plastic" => deserialise::<RoughPlasticDesign>(model).err()?,
        "iridescent-plastic" => deserialise::<IridescentPlasticDesign>(model).err()?,
        "granier-heidrich" => deserialise::<GranierHeidrichDesign>(model).err()?,
        "lambertian" => deserialise::<LambertianDesign>(model).err()?,
        "cylinder" | "near-field-cylinder" | "spongy-barb" => deserialise::<CylinderDesign>(model).err()?,
        "filmed-cylinder" => deserialise::<FilmedCylinderDesign>(model).err()?,
        "feather" => deserialise::<FeatherDesign>(model).err()?,
        "pigmented-base" => deserialise::<PigmentedBaseDesign>(model).err()?,
        "film-at-unknown-angle" => deserialise::<FilmAtUnknownAngleDesign>(model).err()?,
        "thin-film-law" => deserialise::<ThinFilmLawDesign>(model).err()?,
        _ => return None,
    };
    Some((slip.keys, slip.message))
}
