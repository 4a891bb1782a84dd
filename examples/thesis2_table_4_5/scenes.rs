//! The scenes of Table 4.5: the knot on a table in direct light, and in a room in global light, of either model.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use anyhow::Result;
use barbule::render::{Control, render};
use barbule::scene::{CheckedScene, SceneFile};
use serde_json::{Value, json};

/// Size of the pictures.
const SIZE: [u32; 2] = [256, 144];

/// Which of the two models.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Model {
    /// That of Granier and Heidrich (2003).
    Granier,
    /// The second thesis's own.
    IridescentPlastic,
}

/// What light is followed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Lighting {
    /// One scattering, on the table.
    Direct,
    /// Up to twelve, in the room.
    Global,
}

/// The scene with one of the models on the knot. Parameters are those of Tables 4.3 and 4.4, weights those of Figure 4.5 here.
pub(crate) fn scene(model: Model, lighting: Lighting, samples: u32) -> Result<CheckedScene> {
    let folder = match lighting {
        Lighting::Direct => "fits/scene-table",
        Lighting::Global => "fits/scene-room",
    };
    let (mut file, path) = SceneFile::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join(folder))?;
    [file.image.width, file.image.height] = SIZE;
    file.image.samples = samples;
    file.materials.insert("object".to_owned(), serde_json::from_value(material(model))?);
    Ok(CheckedScene::new(&file, &path)?)
}

fn material(model: Model) -> Value {
    match model {
        Model::Granier => json!({
            "model": { "kind": "granier-heidrich", "per_channel": ["eta"], "outer_normal": "spherical" },
            "parameters": {
                "thickness_nm": 76, "outer_tilt_deg": 10, "outer_exponent": 130, "inner_exponent": 130,
                "eta_r": 1.5, "eta_g": 1.6, "eta_b": 1.8, "specular": 0.5, "diffuse": 0.15
            }
        }),
        Model::IridescentPlastic => json!({
            "model": { "kind": "iridescent-plastic", "per_channel": ["eta"] },
            "parameters": {
                "thickness_nm": 76, "roughness": 0.124, "eta_r": 1.5, "eta_g": 1.6, "eta_b": 1.8, "specular": 0.5,
                "diffuse": 0.5
            }
        }),
    }
}

/// Renders it, from its materials' tables to the last pixel.
pub(crate) fn picture(scene: &CheckedScene) -> Result<()> {
    let control = Control { interrupt: &AtomicBool::new(false), progress: &|_, _| (), checkpoint: None };
    std::hint::black_box(render(&scene.scene, scene.resolution, scene.settings, &control)?);
    Ok(())
}
