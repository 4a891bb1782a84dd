//! A feather in numbers: what its file did not say, but follows.

use kurbo::Rect;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::feather::{Feather, Vane};
use super::map::{FeatherMap, TexelClass};

/// What follows from a feather's file, and where its map lies.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct GeometrySummary {
    /// The feather's title.
    pub title: String,
    /// Version of Barbule that made it.
    pub barbule_version: String,
    /// Length of the whole shaft, mm.
    pub shaft_length_mm: f64,
    /// Length of its part without barbs, mm.
    pub calamus_length_mm: f64,
    /// The left vane.
    pub left_vane: VaneSummary,
    /// The right vane.
    pub right_vane: VaneSummary,
    /// The map.
    pub map: MapSummary,
}

/// A vane in numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct VaneSummary {
    /// Number of barbs.
    pub barb_count: usize,
    /// Mean length of a barb from the rachis's axis to the outline, mm.
    pub mean_barb_length_mm: f64,
    /// Distance between the edges of neighbouring barbs as planned, square to them, µm.
    pub barb_spacing_um: f64,
    /// Share of the area that barbs cover, width/(width + spacing): the scattering model's `barb_share`.
    pub barb_share: f64,
    /// Barbs that bulge out of the vane and were cut where they leave it.
    pub clipped_barb_count: usize,
}

/// A map in numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MapSummary {
    /// Texels from left to right.
    pub width: u32,
    /// Texels from bottom to top.
    pub height: u32,
    /// Texels a millimetre.
    pub pixels_per_mm: f64,
    /// Left edge of the map in the feather's coordinates, mm.
    pub left_mm: f64,
    /// Lower edge, mm.
    pub bottom_mm: f64,
    /// Right edge, mm.
    pub right_mm: f64,
    /// Upper edge, mm.
    pub top_mm: f64,
    /// Texels of class shaft.
    pub shaft_texel_count: usize,
    /// Texels of class barb.
    pub barb_texel_count: usize,
    /// Area that the feather covers, mm².
    pub covered_mm2: f64,
}

impl GeometrySummary {
    /// The numbers of a feather and of the map drawn of it.
    pub fn new(feather: &Feather, map: &FeatherMap) -> Self {
        let [left, right] = &feather.vanes;
        Self {
            title: feather.title.clone(),
            barbule_version: env!("CARGO_PKG_VERSION").to_owned(),
            shaft_length_mm: feather.shaft.length_mm,
            calamus_length_mm: feather.shaft.calamus_length_mm,
            left_vane: vane_summary(feather, left),
            right_vane: vane_summary(feather, right),
            map: map_summary(feather, map),
        }
    }
}

fn vane_summary(feather: &Feather, vane: &Vane) -> VaneSummary {
    VaneSummary {
        barb_count: vane.barbs.len(),
        mean_barb_length_mm: vane.mean_barb_length_mm(),
        barb_spacing_um: 1000.0 * (feather.barb_pitch_mm(vane) - feather.barb_width_mm),
        barb_share: feather.barb_share(vane),
        clipped_barb_count: vane.barbs.iter().filter(|barb| barb.curve != barb.planned).count(),
    }
}

fn map_summary(feather: &Feather, map: &FeatherMap) -> MapSummary {
    let count = |class| map.texels().filter(|(_, _, texel)| texel.class == class).count();
    let covered: f64 = map.texels().map(|(_, _, texel)| texel.coverage).sum();
    let resolution = map.pixels_per_mm();
    let size = (f64::from(map.width()) / resolution, f64::from(map.height()) / resolution);
    let Rect { x0, y0, x1, y1 } = Rect::from_center_size(feather.bounds_mm().center(), size);
    MapSummary {
        width: map.width(),
        height: map.height(),
        pixels_per_mm: resolution,
        left_mm: x0,
        bottom_mm: y0,
        right_mm: x1,
        top_mm: y1,
        shaft_texel_count: count(TexelClass::Shaft),
        barb_texel_count: count(TexelClass::Barb),
        covered_mm2: covered / (resolution * resolution),
    }
}
