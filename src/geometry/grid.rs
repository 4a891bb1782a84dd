//! The texels of a map in the feather's plane.

use kurbo::{Point, Rect};

use super::GeometryError;
use super::bezier::as_f64;
use super::map::{LARGEST_SIDE, LARGEST_TEXEL_COUNT, per_metre};
use crate::number;

/// Resolutions that a map may have, texels a millimetre.
const RESOLUTIONS: std::ops::RangeInclusive<f64> = 0.01..=10_000.0;

/// Texels along the longer side where nobody says a resolution.
const USUAL_SIDE: f64 = 2048.0;

/// Texels left free around the feather on each side, so that its edge is whole.
const FREE: f64 = 1.0;

/// A grid of square texels around a feather, its middle that of the feather.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Grid {
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) pixels_per_mm: f64,
    /// Upper left corner, mm.
    corner: Point,
}

impl Grid {
    /// The grid at this resolution, rounded to whole texels a metre, which is what a PNG can say.
    pub(super) fn new(bounds_mm: Rect, pixels_per_mm: Option<f64>) -> Result<Self, GeometryError> {
        let longer_mm = bounds_mm.width().max(bounds_mm.height());
        let usual = (USUAL_SIDE - 2.0 * FREE - 2.0) / longer_mm;
        let asked = pixels_per_mm.unwrap_or(usual.clamp(*RESOLUTIONS.start(), *RESOLUTIONS.end()));
        if !RESOLUTIONS.contains(&asked) {
            return Err(GeometryError::Resolution(format!(
                "found {asked}; expected from {} to {} texels a millimetre",
                RESOLUTIONS.start(),
                RESOLUTIONS.end()
            )));
        }
        let pixels_per_mm = f64::from(per_metre(asked)) / 1000.0;
        let sides = [bounds_mm.width(), bounds_mm.height()].map(|mm| even_side(mm * pixels_per_mm));
        let [width, height] = sides;
        if width > f64::from(LARGEST_SIDE)
            || height > f64::from(LARGEST_SIDE)
            || width * height > f64::from(LARGEST_TEXEL_COUNT)
        {
            let by_side = f64::from(LARGEST_SIDE) / width.max(height);
            let by_count = (f64::from(LARGEST_TEXEL_COUNT) / (width * height)).sqrt();
            return Err(GeometryError::Resolution(format!(
                "found {}, which makes a map of {width} × {height} texels; a map has {LARGEST_SIDE} a side and \
                 {LARGEST_TEXEL_COUNT} in all at most: expected {} or less for this feather",
                number::plain(pixels_per_mm),
                number::plain((0.99 * pixels_per_mm * by_side.min(by_count) * 100.0).floor() / 100.0)
            )));
        }
        let middle = bounds_mm.center();
        let half = 0.5 / pixels_per_mm;
        Ok(Self {
            width: whole(width),
            height: whole(height),
            pixels_per_mm,
            corner: Point::new(middle.x - half * width, middle.y + half * height),
        })
    }

    /// A place in texels from the upper left corner, to the right and down.
    pub(super) fn in_texels(&self, mm: Point) -> Point {
        Point::new((mm.x - self.corner.x) * self.pixels_per_mm, (self.corner.y - mm.y) * self.pixels_per_mm)
    }

    /// The centre of a texel, mm.
    pub(super) fn centre_mm(&self, column: usize, row: usize) -> Point {
        let (x, y) = (as_f64(column) + 0.5, as_f64(row) + 0.5);
        Point::new(self.corner.x + x / self.pixels_per_mm, self.corner.y - y / self.pixels_per_mm)
    }
}

/// An even number of texels that holds so many and the free ones. Even, so that a symmetric feather has its axis between two
/// columns and its map mirrors.
fn even_side(texels: f64) -> f64 {
    2.0 * (0.5 * texels + FREE).ceil()
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked against the largest side")]
fn whole(side: f64) -> u32 {
    side as u32
}
