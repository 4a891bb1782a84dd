//! A feather's geometry as its author types it, before anything in it has been checked.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A feather: a shaft, the outlines of its two vanes, and the barbs between them. Lengths are mm in one plane, x to the
/// right, y up; *left* and *right* are those of someone who looks from the shaft's base to its tip.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FeatherFile {
    /// One line for people.
    pub title: String,
    /// Remarks on the feather and on where its numbers come from.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub about: String,
    /// The axis: calamus and rachis.
    pub shaft: ShaftFile,
    /// The vane on the left.
    pub left_vane: VaneFile,
    /// The vane on the right.
    pub right_vane: VaneFile,
    /// The barbs of both vanes.
    pub barbs: BarbsFile,
    /// Random variation of the barbs; without this key every barb is as planned.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub variation: Option<VariationFile>,
}

/// The axis of a feather.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ShaftFile {
    /// Control points of one Bézier curve from the base of the calamus to the tip of the rachis, mm; two or more.
    pub control_points_mm: Vec<[f64; 2]>,
    /// Width at the base, mm. It falls (or grows) evenly along the shaft's length.
    pub base_width_mm: f64,
    /// Width at the tip, mm.
    pub tip_width_mm: f64,
    /// Length of the calamus, which carries no barbs, mm along the shaft.
    pub calamus_length_mm: f64,
}

/// A vane.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VaneFile {
    /// Inner control points of the outline, mm: a Bézier curve that begins where the rachis begins and ends at its tip,
    /// which are not repeated here.
    pub control_points_mm: Vec<[f64; 2]>,
    /// Angle between the rachis, towards its tip, and the line from a barb's root to its end, degrees; above 0, below 90.
    pub barb_angle_deg: f64,
}

/// The barbs of both vanes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BarbsFile {
    /// Number of barbs in each vane, spaced evenly along the rachis.
    pub count_per_vane: u32,
    /// Width of a barb, µm.
    pub width_um: f64,
    /// How far the second control point lies along the line from root to end, as a share of its length d.
    #[serde(default = "third")]
    pub v1: f64,
    /// How far the second control point lies off that line, towards the feather's tip, as a share of d.
    #[serde(default)]
    pub v2: f64,
    /// How far the third control point lies before the end along the line, as a share of d; v1 + v3 ≤ 1.
    #[serde(default = "third")]
    pub v3: f64,
    /// How far the third control point lies off that line, towards the feather's tip, as a share of d.
    #[serde(default)]
    pub v4: f64,
    /// What lies between two neighbouring barbs.
    #[serde(default)]
    pub between: BetweenBarbs,
}

fn third() -> f64 {
    1.0 / 3.0
}

/// What lies between two neighbouring barbs of a vane.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum BetweenBarbs {
    /// Interlocked barbules: the vane is closed from the first barb to the last.
    #[default]
    Barbules,
    /// Nothing: the barbs are loose, and only they are drawn.
    Nothing,
}

/// Random variation of the barbs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VariationFile {
    /// Seed: the same seed gives the same feather.
    pub seed: u64,
    /// Standard deviation of a root's place, as a share of the spacing of roots; 0 to 0.3. A root never passes another.
    #[serde(default)]
    pub root: f64,
    /// Standard deviation of a barb's angle, degrees.
    #[serde(default)]
    pub angle_deg: f64,
    /// Length along the rachis over which the angles of barbs go together, mm: barbs that hold on to each other turn
    /// together. At this distance their correlation is exp(−1/4) = 0.78.
    #[serde(default = "five")]
    pub angle_reach_mm: f64,
}

fn five() -> f64 {
    5.0
}
