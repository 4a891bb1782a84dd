//! The `[sweep]` section of a job as it is typed.

use std::collections::BTreeMap;
use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Which parameters `sweep` moves and over which values.
///
/// All other parameters keep the job's own values: the start of a free one, the value of a fixed one. Ties follow.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SweepFile {
    /// One or two parameters and the values of each; two make a grid of all pairs.
    pub grid: BTreeMap<String, AxisFile>,
    /// How the shares of the variance (Sobol indices) over the ranges of the free parameters are estimated. They are
    /// estimated without this section too where `parameters` frees any.
    pub sobol: Option<SobolFile>,
    /// Pictures of every cell, on one contact sheet; `[sweep.render]` alone shows a sphere between a window and a lamp.
    pub render: Option<RenderFile>,
}

/// What the pictures of a sweep's cells show.
///
/// A picture has three channels. Where the job's data have three wavelengths, the pictures are made at those, else at the
/// scene's.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RenderFile {
    /// A scene (JSON) beside the job, with the size, the samples and the exposure of each picture; without it a sphere.
    pub scene: Option<PathBuf>,
    /// The scene's material in whose place the job's model stands, with the values of each cell.
    pub material: Option<String>,
}

/// The values of one parameter: `from`, `to` and `steps`, or a list.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AxisFile {
    /// First value.
    pub from: Option<f64>,
    /// Last value.
    pub to: Option<f64>,
    /// Number of values, the first and the last among them.
    pub steps: Option<usize>,
    /// How they are spread between the first and the last.
    #[serde(default)]
    pub spacing: Spacing,
    /// The values themselves, instead of the above.
    pub values: Option<Vec<f64>>,
    /// Other parameters that move along, with as many values each: the first goes with the first. Where they follow by
    /// sums and factors, tie them under `parameters` instead.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub along: BTreeMap<String, Vec<f64>>,
}

/// How values are spread.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Spacing {
    /// Evenly.
    #[default]
    Linear,
    /// Evenly in the logarithm; needs values above 0.
    Logarithmic,
}

/// How Sobol indices are estimated.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct SobolFile {
    /// Points in each sequence: a power of two from 16 to 65536.
    pub samples: u32,
    /// Sequences under independent scrambles, 4 to 1000; their spread gives the errors.
    pub replicates: u32,
    /// Seed of the scrambles.
    pub seed: u64,
}

impl Default for SobolFile {
    fn default() -> Self {
        Self { samples: 256, replicates: 16, seed: 1 }
    }
}
