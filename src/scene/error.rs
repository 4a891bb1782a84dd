//! What can be wrong with a scene, each in a sentence that names the file and key and says how to mend it.

use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::bsdf::ModelError;

/// A scene that cannot be rendered as it is written.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{}: {problem}", .path.display())]
pub struct SceneError {
    /// The scene's file.
    pub path: PathBuf,
    /// What is wrong in it.
    pub problem: SceneProblem,
}

/// What is wrong with a scene.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SceneProblem {
    /// The file is not there or cannot be read.
    #[error("{reason}; give a scene's JSON file, or a folder with a scene.json in it")]
    Unreadable {
        /// What the system said.
        reason: String,
    },
    /// The text is not a scene: bad JSON, an unknown key, a value of the wrong kind.
    #[error("{message}")]
    Syntax {
        /// Line or key, what was found and what was expected.
        message: String,
    },
    /// A key whose value makes no sense.
    #[error("{key}: {problem}")]
    Key {
        /// The key: `objects[2].radius_mm`.
        key: String,
        /// What was found, what was expected, and how to mend it.
        problem: String,
    },
    /// A model that cannot be made.
    #[error("{key}: {problem}")]
    Model {
        /// The key: `materials.vane.model`.
        key: String,
        /// What the model says.
        problem: Box<ModelError>,
    },
}

impl SceneProblem {
    /// A key whose value makes no sense.
    pub(super) fn key(key: impl Into<String>, problem: impl Into<String>) -> Self {
        Self::Key { key: key.into(), problem: problem.into() }
    }

    /// The same with the file in which it stands.
    pub(super) fn of(self, path: &Path) -> SceneError {
        SceneError { path: path.to_owned(), problem: self }
    }
}
