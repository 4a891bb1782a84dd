//! JSON Schemas of the files that Barbule reads and writes, made from the types themselves.

use schemars::{Schema, schema_for};

use super::{JobFile, Outcome};

/// File name and text of each schema.
pub fn schemas() -> Vec<(&'static str, String)> {
    let text = |schema: &Schema| format!("{:#}\n", schema.as_value());
    vec![("job.schema.json", text(&schema_for!(JobFile))), ("result.schema.json", text(&schema_for!(Outcome)))]
}
