//! The compared part of both pictures and the map of their differences, as PNG files.

use image::codecs::png::PngEncoder;
use image::imageops::{self, FilterType};
use image::{Rgb, RgbImage};

use super::figures::scale_to;
use crate::compare::Comparison;
use crate::measure::colour::LinearRgb;
use crate::report::palette::PALE;
use crate::report::{Picture, ReportError};

/// Widest picture that is shown; wider ones are scaled down, and the numbers are of the whole ones.
const WIDEST_PX: u32 = 1400;
/// White between two pictures.
const GAP_PX: u32 = 12;

/// PNG files.
pub(super) struct Shown {
    pub(super) first: Vec<u8>,
    pub(super) second: Vec<u8>,
    pub(super) side_by_side: Vec<u8>,
    /// The map with its scale below it.
    pub(super) difference: Vec<u8>,
    /// The map alone.
    pub(super) map: Vec<u8>,
}

impl Shown {
    pub(super) fn new(comparison: &Comparison, high: f64, scale: &Picture) -> Result<Self, ReportError> {
        let pixels = &comparison.pixels;
        let painted = |colours: Vec<[u8; 3]>| {
            let (width, height) = (side(pixels.width)?, side(colours.len() / pixels.width)?);
            RgbImage::from_raw(width, height, colours.concat()).ok_or_else(|| failed("its rows are not whole"))
        };
        let [first, second] = pixels
            .light
            .each_ref()
            .map(|light| light.iter().map(|pixel| LinearRgb(pixel.map(f64::from)).bytes()).collect());
        let colours = scale_to(high);
        let map = pixels.difference.iter().map(|difference| {
            let colour = difference.map_or(PALE, |value| colours.colour(value.into()));
            [colour.0, colour.1, colour.2]
        });
        // Left out is a colour of its own, which must not be blended.
        let map = shrunk(painted(map.collect())?, FilterType::Nearest);
        let [first, second] =
            [shrunk(painted(first)?, FilterType::Triangle), shrunk(painted(second)?, FilterType::Triangle)];
        Ok(Self {
            side_by_side: png(&beside(&first, &second))?,
            first: png(&first)?,
            second: png(&second)?,
            difference: png(&above(&map, &decoded(&scale.png)?))?,
            map: png(&map)?,
        })
    }
}

fn shrunk(picture: RgbImage, filter: FilterType) -> RgbImage {
    if picture.width() <= WIDEST_PX {
        return picture;
    }
    let height = u64::from(picture.height()) * u64::from(WIDEST_PX) / u64::from(picture.width());
    let height = u32::try_from(height).unwrap_or(u32::MAX).max(1);
    imageops::resize(&picture, WIDEST_PX, height, filter)
}

fn beside(left: &RgbImage, right: &RgbImage) -> RgbImage {
    let mut both = white(left.width() + GAP_PX + right.width(), left.height().max(right.height()));
    imageops::replace(&mut both, left, 0, 0);
    imageops::replace(&mut both, right, (left.width() + GAP_PX).into(), 0);
    both
}

/// The map above its scale; a map narrower than the scale is enlarged by a whole factor, so that its pixels are seen.
fn above(map: &RgbImage, scale: &RgbImage) -> RgbImage {
    let factor = (scale.width() / map.width()).max(1);
    let map = imageops::resize(map, map.width() * factor, map.height() * factor, FilterType::Nearest);
    let mut both = white(map.width().max(scale.width()), map.height() + GAP_PX + scale.height());
    imageops::replace(&mut both, &map, 0, 0);
    imageops::replace(&mut both, scale, 0, (map.height() + GAP_PX).into());
    both
}

fn white(width: u32, height: u32) -> RgbImage {
    RgbImage::from_pixel(width, height, Rgb([255; 3]))
}

fn png(picture: &RgbImage) -> Result<Vec<u8>, ReportError> {
    let mut bytes = Vec::new();
    picture.write_with_encoder(PngEncoder::new(&mut bytes)).map_err(failed)?;
    Ok(bytes)
}

fn decoded(bytes: &[u8]) -> Result<RgbImage, ReportError> {
    Ok(image::load_from_memory(bytes).map_err(failed)?.to_rgb8())
}

fn side(pixels: usize) -> Result<u32, ReportError> {
    u32::try_from(pixels).map_err(failed)
}

fn failed(error: impl std::fmt::Display) -> ReportError {
    ReportError::Paint { figure: "pictures".to_owned(), text: error.to_string() }
}
