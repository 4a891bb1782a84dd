//! Paint on a feather's vanes as its author types it: layers that move parameters of the vane's model, and where.

use std::collections::BTreeMap;
use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A layer of paint. It moves some parameters of the vane's model towards values of its own, wholly where its mask is 1 and not
/// at all where it is 0; the layers lie on each other in their order. Any parameter can be painted: the amount of a
/// pigment, the band of a sponge, a roughness.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LayerFile {
    /// What it shows, and where that is described.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub about: String,
    /// The parameters and their values where the mask is 1.
    pub set: BTreeMap<String, f64>,
    /// Where it lies; without this key, everywhere.
    #[serde(default, rename = "where")]
    pub mask: MaskFile,
}

/// Where a layer lies: the product of what is given here, each from 0 to 1.
///
/// Places on a vane are `along`, from 0 where the rachis begins to 1 at its tip, and `across`, from 0 at the rachis to 1 at the
/// margin. Lengths along are shares of the rachis, too.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct MaskFile {
    /// One vane alone, of someone who looks from base to tip.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub vane: Option<VaneSide>,
    /// A part of the feather's length.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub along: Option<StripFile>,
    /// A part of the vane's width.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub across: Option<StripFile>,
    /// Bars across the vane.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bars: Option<BarsFile>,
    /// Irregular flecks and streaks.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mottle: Option<MottleFile>,
    /// A picture over the feather's whole map, beside the scene: its red channel, linear from 0 to 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub picture: Option<PathBuf>,
    /// What all this is multiplied by, 0 to 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub strength: Option<f64>,
}

/// One of the two vanes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum VaneSide {
    /// The left one.
    Left,
    /// The right one.
    Right,
}

/// A part of a length: 1 inside, 0 outside.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct StripFile {
    /// Where it begins; without this key, before everything.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub from: Option<f64>,
    /// Where it ends; without this key, after everything.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub to: Option<f64>,
    /// Length over which an edge goes from 0 to 1, half of it on each side.
    pub soft: f64,
    /// How far an edge strays from its place, from barb to barb.
    pub stray: f64,
}

/// Bars square to the rachis, evenly spaced along it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BarsFile {
    /// Where the middle of one of them meets the rachis.
    #[serde(default)]
    pub first: f64,
    /// From one bar to the next.
    pub period: f64,
    /// Width of a bar.
    pub width: f64,
    /// How far a bar lies nearer to the tip at the margin than at the rachis.
    #[serde(default)]
    pub lean: f64,
    /// Length over which an edge goes from 0 to 1, half of it on each side.
    #[serde(default)]
    pub soft: f64,
    /// How far an edge strays from its place, from barb to barb.
    #[serde(default)]
    pub stray: f64,
}

/// Irregular flecks: a random field, smooth over cells of a given size, and two of its values between which the mask goes
/// from 0 to 1. Half of the field lies below 0.5.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MottleFile {
    /// Size of a cell along the feather.
    pub along: f64,
    /// Size of a cell across the vane. Large cells make streaks along the barbs.
    pub across: f64,
    /// The field's value below which there is none.
    pub from: f64,
    /// The field's value above which there is all of it.
    pub to: f64,
}

/// How barbs and barbules are told apart on a vane.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum BarbsShown {
    /// Everywhere the mixture that the model's `barb_share` says.
    #[default]
    Averaged,
    /// The barb where the feather's geometry has one, the barbules elsewhere, each with its share of a texel: `barb_share` is
    /// not used. The model is a `feather`.
    Resolved,
}
