//! JSON Schemas of scenes and kept species, made from the types themselves.

use schemars::schema_for;

use super::{SceneFile, SpeciesFile};

/// File name and text of each schema.
pub fn schemas() -> Vec<(&'static str, String)> {
    vec![
        ("scene.schema.json", format!("{:#}\n", schema_for!(SceneFile).as_value())),
        ("species.schema.json", format!("{:#}\n", schema_for!(SpeciesFile).as_value())),
    ]
}
