//! What can be wrong with a feather's geometry, each in a sentence that says how to mend it.

use std::path::PathBuf;

use thiserror::Error;

use crate::json_file::JsonFileError;

/// A feather that cannot be made, or a map that cannot be read.
#[derive(Debug, Error)]
pub enum GeometryError {
    /// The file.
    #[error(transparent)]
    File(#[from] JsonFileError),
    /// A value of a feather that makes no sense.
    #[error("{}: {mistake}", .path.display())]
    Mistake {
        /// The feather's file.
        path: PathBuf,
        /// Key, what was found, what was expected, and how to mend it.
        mistake: FeatherMistake,
    },
    /// A resolution at which no map can be made.
    #[error("--pixels-per-mm: {0}")]
    Resolution(String),
    /// An image that is no feather map.
    #[error("{}: {problem}", .path.display())]
    Map {
        /// The image.
        path: PathBuf,
        /// What was found, what was expected, and how to mend it.
        problem: String,
    },
}

/// A value of a feather that makes no sense.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{key}: {problem}")]
pub struct FeatherMistake {
    /// The key as a person types it: `shaft.base_width_mm`.
    pub key: String,
    /// What was found, what was expected, and how to mend it.
    pub problem: String,
}

impl FeatherMistake {
    pub(super) fn new(key: impl Into<String>, problem: impl Into<String>) -> Self {
        Self { key: key.into(), problem: problem.into() }
    }
}
