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
use crate::nearest::suggestion;

/// Parses a job, or says in which line and key it goes wrong.
pub(super) fn parse(text: &str, path: &Path) -> Result<JobFile, JobError> {
    let refused = |line, message| JobError::Syntax { path: path.to_owned(), line, message };
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let table = toml::from_str(text).map_err(|error| refused(None, error.to_string().trim().to_owned()))?;
    let value = toml::Value::Table(table);
    deserialise(value.clone()).map_err(|slip| {
        let slip = in_model(&value, &slip).unwrap_or(slip);
        let section = if slip.keys.is_empty() { String::new() } else { format!("{}: ", written(&slip.keys)) };
        refused(line_of(text, &slip.keys), format!("{section}{}", in_words(&slip.message)))
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

/// Nested keys as a person types them.
pub(crate) fn written(keys: &[String]) -> String {
    let plain = |key: &str| key.chars().all(|letter| letter.is_ascii_alphanumeric() || "_-".contains(letter));
    let mut text = String::new();
    for key in keys {
        text += &match key.parse::<usize>() {
            Ok(index) => format!("[{}]", index + 1),
            Err(_) if plain(key) => format!(".{key}"),
            Err(_) => format!(".\"{key}\""),
        };
    }
    text.trim_start_matches('.').to_owned()
}

/// Serde's message in words for people who know no serde. What it does not know it leaves as it is.
pub(crate) fn in_words(message: &str) -> String {
    let message = message.trim();
    let names: Vec<String> = message.split('`').skip(1).step_by(2).map(str::to_owned).collect();
    let known = |names: &[String]| names.join(", ");
    let meant = |name: &String, names: &[String]| suggestion(name, names.iter().map(String::as_str));
    match names.as_slice() {
        [name, others @ ..] if message.starts_with("unknown field") => {
            format!("there is no key `{name}` here; known are {}{}", known(others), meant(name, others))
        }
        [name, others @ ..] if message.starts_with("unknown variant") => {
            format!("found `{name}`; expected one of {}{}", known(others), meant(name, others))
        }
        [name] if message.starts_with("missing field") => format!("the key `{name}` is missing; add it"),
        _ => {
            let length =
                message.strip_prefix("invalid length ").and_then(|m| m.split_once(", expected an array of length "));
            if let Some((found, expected)) = length {
                return format!("found a list of {found}; expected one of {expected}");
            }
            let found = message.strip_prefix("invalid type: ").or_else(|| message.strip_prefix("invalid value: "));
            match found.and_then(|found| found.split_once(", expected ")) {
                Some((found, expected)) => format!("found {}; expected {}", thing(found), wanted(expected)),
                None => message.to_owned(),
            }
        }
    }
}

fn thing(found: &str) -> String {
    match found.split_once(' ') {
        Some(("string", text)) => format!("the text {text}"),
        Some(("integer" | "boolean", value)) => value.replace('`', ""),
        Some(("floating", value)) => value.replace("point ", "").replace('`', ""),
        _ if found == "sequence" => "a list".to_owned(),
        _ if found == "map" => "a table".to_owned(),
        _ => found.to_owned(),
    }
}

fn wanted(expected: &str) -> &str {
    match expected {
        "usize" | "u64" | "u32" => "a whole number from 0 up",
        "f64" => "a number, without quotes",
        "a string" => "a text in quotes",
        "a boolean" => "true or false, without quotes",
        "a sequence" => "a list in square brackets",
        "path string" => "a path in quotes",
        _ if expected.starts_with("struct ") || expected == "a map" => "a table, as `{ key = value }` or under `[key]`",
        _ => expected,
    }
}
