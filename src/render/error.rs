//! Why a render came to no picture.

use std::path::PathBuf;

use thiserror::Error;

/// Why a render came to no picture.
#[derive(Debug, Error)]
pub enum RenderError {
    /// The caller asked it to stop.
    #[error("the render was stopped with {done} of {total} tiles done")]
    Interrupted {
        /// Tiles that were finished.
        done: usize,
        /// All tiles.
        total: usize,
    },
    /// A model gave something that is no number.
    #[error(
        "pixel ({x}, {y}), counted from the upper left corner, came out as no finite number; a material there gives none for these directions: change its parameters, or report it with the scene"
    )]
    NotFinite {
        /// Column.
        x: u32,
        /// Row.
        y: u32,
    },
    /// The checkpoint belongs to something else.
    #[error(
        "{} is the checkpoint of another picture: its scene, size, samples, seed or version differ; give another folder, or remove this file to begin anew",
        .path.display()
    )]
    AnotherPicture {
        /// The file.
        path: PathBuf,
    },
    /// The system refuses a checkpoint.
    #[error("{} cannot be {done}: {reason}; give a folder for the checkpoint that can be written to", .path.display())]
    Checkpoint {
        /// The file.
        path: PathBuf,
        /// `read`, `written` or `removed`.
        done: &'static str,
        /// What the system said.
        reason: String,
    },
}
