//! Scenes as people type them, and as [`crate::render`] takes them.
//!
//! [`SceneFile`] is what stands in a JSON file; [`CheckedScene`] is what was meant, and cannot be wrong. Each thing that
//! makes no sense is a sentence with its key.

mod check;
mod contact_sheet;
mod error;
mod feather;
mod file;
mod inputs;
mod material;
mod read;
mod schema;

pub use crate::measure::photograph::Encoding;
pub use check::CheckedScene;
pub use contact_sheet::{ContactSheet, ContactSheetError, contact_sheet};
pub use error::{SceneError, SceneProblem};
pub use file::{
    CameraFile, DirectionalLightFile, EnvironmentFile, FeatherSheetFile, ImageFile, LightFile, MaterialFile, MeshFile,
    ObjectFile, OrthographicFile, PatternFile, PerspectiveFile, PointLightFile, RectangleFile, RectangleLightFile,
    SceneFile, SphereFile, SphereLightFile, TextureFile,
};
pub use schema::schemas;
