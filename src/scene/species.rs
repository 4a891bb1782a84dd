//! A kept feather of a species: its shape, what it is made of, and how all that is known.

use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::file::MaterialFile;
use super::paint_file::{BarbsShown, LayerFile};
use crate::geometry::FeatherFile;
use crate::json_file::{self, JsonFileError};

/// Folder in which the entries stand, from where the program runs.
const FOLDER: &str = "fits/species";

/// A feather of a species, kept to be rendered by name. Colours come from named absorbers, bands and thicknesses, never from
/// red, green and blue.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SpeciesFile {
    /// How its values were found. Every output repeats it.
    pub status: SpeciesStatus,
    /// The bird's English name and which feather it is.
    pub title: String,
    /// The bird's scientific name.
    pub species: String,
    /// Remarks.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub about: String,
    /// Works that the values come from.
    pub sources: Vec<String>,
    /// Its shape, as `barbule geometry` reads it.
    pub geometry: FeatherFile,
    /// What calamus and rachis are made of.
    pub shaft: MaterialFile,
    /// What the vanes are made of, below all paint.
    pub vane: MaterialFile,
    /// How barbs and barbules are told apart.
    #[serde(default)]
    pub barbs: BarbsShown,
    /// Layers of paint on the vanes.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub paint: Vec<LayerFile>,
}

/// How the values of an entry were found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SpeciesStatus {
    /// Chosen from published descriptions: no measurement stands behind them, and no uncertainty.
    Composed,
}

impl SpeciesStatus {
    /// The word for it.
    pub fn word(self) -> &'static str {
        match self {
            Self::Composed => "composed",
        }
    }
}

impl SpeciesFile {
    /// The file of an entry: itself, or the one that is kept under this name.
    pub fn find(name: &Path) -> PathBuf {
        if name.exists() { name.to_owned() } else { Path::new(FOLDER).join(name).with_extension("json") }
    }

    /// Reads an entry.
    ///
    /// # Errors
    /// A file that is not there, or what it says is no entry.
    pub fn read(path: &Path) -> Result<Self, JsonFileError> {
        json_file::read(path, "species.json")
    }
}
