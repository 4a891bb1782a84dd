//! JSON Schema of scenes, made from the types themselves.

use schemars::schema_for;

use super::SceneFile;

/// File name and text of each schema.
pub fn schemas() -> Vec<(&'static str, String)> {
    vec![("scene.schema.json", format!("{:#}\n", schema_for!(SceneFile).as_value()))]
}
