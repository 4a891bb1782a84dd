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
mod mask;
mod material;
mod paint;
mod paint_file;
mod read;
mod schema;
mod species;
mod studio;

pub use crate::measure::photograph::Encoding;
pub use check::CheckedScene;
pub use contact_sheet::{ContactSheet, ContactSheetError, contact_sheet};
pub use error::{SceneError, SceneProblem};
pub use file::{
    CameraFile, DirectionalLightFile, EnvironmentFile, FeatherSheetFile, ImageFile, LightFile, MaterialFile, MeshFile,
    ObjectFile, OrthographicFile, PatternFile, PerspectiveFile, PointLightFile, RectangleFile, RectangleLightFile,
    SceneFile, SpeciesSheetFile, SphereFile, SphereLightFile, TextureFile,
};
pub use paint_file::{BarbsShown, BarsFile, LayerFile, MaskFile, MottleFile, StripFile, VaneSide};
pub use schema::schemas;
pub use species::{SpeciesFile, SpeciesStatus};
pub use studio::{PIXELS_PER_BARB, View, picture_wavelengths_nm, studio};
