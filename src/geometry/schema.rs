//! JSON Schemas of the files of a feather's geometry, made from the types themselves.

use schemars::schema_for;

use super::{FeatherFile, GeometrySummary};

/// File name and text of each schema.
pub fn schemas() -> Vec<(&'static str, String)> {
    [("feather.schema.json", schema_for!(FeatherFile)), ("geometry.schema.json", schema_for!(GeometrySummary))]
        .map(|(name, schema)| (name, format!("{:#}\n", schema.as_value())))
        .into()
}
