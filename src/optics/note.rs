//! What a report says of where numbers come from.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A material used, with how well it is known.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MaterialNote {
    /// Name in the job.
    pub name: String,
    /// Formula or table, range, source, and how well known, a sentence.
    pub text: String,
}

/// A work to cite.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Reference {
    /// Key in the text: `Yeh 1988`.
    pub key: String,
    /// Full citation.
    pub citation: String,
}

impl Reference {
    /// A reference from its key and full citation.
    pub fn new(key: &str, citation: &str) -> Self {
        Self { key: key.to_owned(), citation: citation.to_owned() }
    }
}
