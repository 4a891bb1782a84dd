//! The finished picture, and how it becomes a file.

use std::io::Cursor;

use image::codecs::openexr::OpenExrEncoder;
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder, ImageError};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::ray::luminance;
use crate::measure::colour::{encode, screen_byte};

/// Linear radiance of each pixel, in rows from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// Pixels a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Rec. 709 channels of each pixel.
    pub pixels: Vec<[f32; 3]>,
}

/// How radiance becomes a shade on a screen.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ToneMapping {
    /// Stops: each doubles the picture's brightness before the curve.
    pub exposure_stops: f64,
    /// The curve.
    pub curve: ToneCurve,
}

/// From luminance, 1 at the screen's white, to a shade between black and white.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ToneCurve {
    /// As it is; what is brighter than white is cut off. Colours are true.
    #[default]
    Linear,
    /// L (1 + L/16)/(1 + L): bright parts are pressed together, L = 4 becomes white (Reinhard et al. 2002, equation 4).
    Reinhard,
}

/// Luminance that Reinhard's curve makes white.
const REINHARD_WHITE: f64 = 4.0;

impl ToneMapping {
    /// The byte of each channel: exposure, curve (on luminance, so that hues stay), cut to 0…1, sRGB's transfer function
    /// (IEC 61966-2-1).
    pub fn bytes(&self, pixel: [f32; 3]) -> [u8; 3] {
        let exposed = pixel.map(|channel| f64::from(channel) * self.exposure_stops.exp2());
        let scale = match self.curve {
            ToneCurve::Linear => 1.0,
            ToneCurve::Reinhard => {
                let bright = luminance(exposed);
                (1.0 + bright / (REINHARD_WHITE * REINHARD_WHITE)) / (1.0 + bright)
            }
        };
        exposed.map(|channel| screen_byte(encode((channel * scale).clamp(0.0, 1.0))))
    }
}

impl Picture {
    /// An 8-bit PNG for screens.
    ///
    /// # Errors
    /// What the encoder says; it only writes to memory.
    pub fn to_png(&self, tone: &ToneMapping) -> Result<Vec<u8>, ImageError> {
        let bytes: Vec<u8> = self.pixels.iter().flat_map(|pixel| tone.bytes(*pixel)).collect();
        let mut file = Vec::new();
        PngEncoder::new(&mut file).write_image(&bytes, self.width, self.height, ExtendedColorType::Rgb8)?;
        Ok(file)
    }

    /// A linear `OpenEXR` file of 32-bit numbers.
    ///
    /// # Errors
    /// What the encoder says; it only writes to memory.
    pub fn to_exr(&self) -> Result<Vec<u8>, ImageError> {
        let bytes: Vec<u8> = self.pixels.iter().flatten().flat_map(|channel| channel.to_ne_bytes()).collect();
        let mut file = Cursor::new(Vec::new());
        OpenExrEncoder::new(&mut file).write_image(&bytes, self.width, self.height, ExtendedColorType::Rgb32F)?;
        Ok(file.into_inner())
    }
}
