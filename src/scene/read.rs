//! From JSON text to a typed scene, and from a slip in it to a sentence: key, what was found, what was expected.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;
use serde_json::Value;
use serde_path_to_error::Segment;

use super::error::{SceneError, SceneProblem};
use super::file::{
    DirectionalLightFile, EnvironmentFile, FeatherSheetFile, MeshFile, OrthographicFile, PerspectiveFile,
    PointLightFile, RectangleFile, RectangleLightFile, SceneFile, SpeciesSheetFile, SphereFile, SphereLightFile,
};
use crate::job::model_slip;
use crate::json_file::OBJECT;
use crate::slip::{in_words, written};

/// A scene is typed by people; what is larger than this is something else.
const LARGEST_FILE: u64 = 16 << 20;

impl SceneFile {
    /// Reads a scene: its JSON file, or a folder with a `scene.json` in it.
    ///
    /// # Errors
    /// A file that is not there, is no JSON, or whose keys or values are not those of a scene.
    pub fn read(path: &Path) -> Result<(Self, PathBuf), SceneError> {
        let path = if path.is_dir() { path.join("scene.json") } else { path.to_owned() };
        let unreadable = |reason: String| SceneProblem::Unreadable { reason }.of(&path);
        let length = fs::metadata(&path).map(|about| about.len());
        let text = match length {
            Ok(length) if length > LARGEST_FILE => {
                return Err(unreadable(format!("a file of {length} bytes is no scene")));
            }
            _ => fs::read(&path),
        };
        let text = text.map_err(|error| match error.kind() {
            ErrorKind::NotFound => unreadable("there is no such file".to_owned()),
            _ => unreadable(error.to_string().split(" (os error").next().unwrap_or_default().to_owned()),
        })?;
        let text = String::from_utf8(text).map_err(|_| unreadable("it is not UTF-8 text".to_owned()))?;
        let scene = Self::parse(&text).map_err(|problem| problem.of(&path))?;
        Ok((scene, path))
    }

    /// A scene from its text.
    pub(super) fn parse(text: &str) -> Result<Self, SceneProblem> {
        parse(text).map_err(|message| SceneProblem::Syntax { message })
    }
}

/// Parses a scene, or says where it goes wrong.
fn parse(text: &str) -> Result<SceneFile, String> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let value: Value = serde_json::from_str(text).map_err(|error| format!("this is no JSON: {error}"))?;
    deserialise(value.clone()).map_err(|slip| {
        let slip = within(&value, &slip).unwrap_or(slip);
        let place = if slip.keys.is_empty() { String::new() } else { format!("{}: ", written(&slip.keys)) };
        format!("{place}{}", in_words(&slip.message, OBJECT))
    })
}

/// Where serde gave up, and in which words.
struct Slip {
    keys: Vec<String>,
    message: String,
}

fn deserialise<T: DeserializeOwned>(value: Value) -> Result<T, Slip> {
    serde_path_to_error::deserialize(value).map_err(|error| {
        let keys = error.path().iter().filter_map(|segment| match segment {
            Segment::Seq { index } => Some(index.to_string()),
            Segment::Map { key } => Some(key.clone()),
            Segment::Enum { .. } | Segment::Unknown => None,
        });
        let keys = keys.collect();
        Slip { keys, message: error.into_inner().to_string() }
    })
}

/// The same slip inside a thing whose keys hang on its kind, where serde does not say where it went wrong.
fn within(scene: &Value, slip: &Slip) -> Option<Slip> {
    let thing = slip.keys.iter().try_fold(scene, |value, key| match key.parse::<usize>() {
        Ok(index) if value.is_array() => value.get(index),
        _ => value.get(key),
    })?;
    let mut table = thing.as_object()?.clone();
    let kind = table.remove("kind")?;
    let kind = kind.as_str()?;
    let rest = Value::Object(table);
    let keys: Vec<&str> = slip.keys.iter().map(String::as_str).collect();
    let mut inner = match (keys.as_slice(), kind) {
        (["camera"], "perspective") => deserialise::<PerspectiveFile>(rest).err()?,
        (["camera"], "orthographic") => deserialise::<OrthographicFile>(rest).err()?,
        (["objects", _], "sphere") => deserialise::<SphereFile>(rest).err()?,
        (["objects", _], "rectangle") => deserialise::<RectangleFile>(rest).err()?,
        (["objects", _], "mesh") => deserialise::<MeshFile>(rest).err()?,
        (["objects", _], "feather") => deserialise::<FeatherSheetFile>(rest).err()?,
        (["objects", _], "species") => deserialise::<SpeciesSheetFile>(rest).err()?,
        (["lights", _], "point") => deserialise::<PointLightFile>(rest).err()?,
        (["lights", _], "directional") => deserialise::<DirectionalLightFile>(rest).err()?,
        (["lights", _], "rectangle") => deserialise::<RectangleLightFile>(rest).err()?,
        (["lights", _], "sphere") => deserialise::<SphereLightFile>(rest).err()?,
        (["lights", _], "environment") => deserialise::<EnvironmentFile>(rest).err()?,
        (["materials", _, "model"], _) => {
            let (keys, message) = model_slip(kind, toml::Value::try_from(rest).ok()?)?;
            Slip { keys, message }
        }
        _ => return None,
    };
    inner.keys.splice(0..0, slip.keys.iter().cloned());
    Some(inner)
}
