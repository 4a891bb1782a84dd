//! Photographs: from a file to linear light, with what is not to be trusted masked and what was assumed said.
//!
//! JPEG, PNG, TIFF and EXR are read, told by their first bytes. EXIF turns the picture upright and tells exposure and
//! camera; an ICC profile (three curves and a matrix, or one curve for grey) or a PNG's own chunks say what the codes mean.
//! Without any of them sRGB is assumed, and the notes say so. What comes out has the Rec. 709 primaries and D65 white, may
//! be negative or above 1 where the file's colours are wider, and is no reflectance yet: see [`Reference`].

mod coding;
mod decode;
mod error;
mod exif_facts;
mod jpeg_markers;
mod rectangle;
mod reference;
mod synthetic;

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use image::DynamicImage;
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

pub use coding::Encoding;
pub use error::{PhotographError, PhotographProblem};
pub use exif_facts::{ExifColourSpace, ExifFacts};
pub use rectangle::{Rectangle, Region, RegionError, Regions};
pub use reference::{Reference, ReferenceGain, relative_exposures};
pub use synthetic::{Camera, SyntheticError};

use coding::Coding;
use decode::Decoded;

/// What the user says of a photograph beyond what its file does.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct PhotographOptions {
    /// What the numbers are, instead of what the file says. Pictures that a raw converter left linear need `linear`, if they
    /// have no profile.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub encoding: Option<Encoding>,
    /// How large a pixel is; without this key it stays open.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scale: Option<Scale>,
}

/// How large a pixel is.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Scale {
    /// Pixels a millimetre, measured on a ruler in the picture.
    PixelsPerMm(f64),
    /// The file's own resolution holds: the picture is a scan. In other pictures that number means nothing.
    Scan,
}

/// A photograph in linear light.
#[derive(Debug, Clone, PartialEq)]
pub struct Photograph {
    /// Where it came from.
    pub file: PathBuf,
    /// `JPEG`, `PNG`, `TIFF` or `EXR`, by the file's first bytes.
    pub format: &'static str,
    /// Size of the file in bytes.
    pub bytes: u64,
    /// SHA-256 of the file, in hexadecimal.
    pub sha256: String,
    /// Pixels a row, upright.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Linear light of each pixel, Rec. 709 primaries, in rows from the top; 1 is the file's white.
    pub pixels: Vec<[f32; 3]>,
    /// Whether each pixel can be trusted.
    pub validity: Vec<Validity>,
    /// Pixels a millimetre, if the options gave a scale.
    pub pixels_per_mm: Option<f64>,
    /// What the camera wrote.
    pub exif: ExifFacts,
    /// How codes became light, one sentence.
    pub coding: String,
    /// What was assumed or left out, in sentences.
    pub notes: Vec<String>,
}

/// Whether a pixel can be trusted, and if not, why.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Validity {
    /// It can.
    Valid,
    /// A channel is at the largest code: there was as much light as that, or more.
    Clipped,
    /// Not wholly opaque: what is seen is mixed with nothing, or hidden.
    Transparent,
    /// A channel is not a finite number.
    NotANumber,
}

/// How many pixels of each validity there are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct ValidityCounts {
    /// Pixels that can be trusted.
    pub valid: usize,
    /// Pixels at the largest code.
    pub clipped: usize,
    /// Pixels that are not opaque.
    pub transparent: usize,
    /// Pixels that are no finite numbers.
    pub not_a_number: usize,
}

impl Photograph {
    /// Reads a photograph from a file.
    ///
    /// # Errors
    ///
    /// A sentence for everything that the file may be instead of a whole picture of light.
    pub fn read(path: &Path, options: &PhotographOptions) -> Result<Self, PhotographError> {
        let refused = |problem| PhotographError::new(path, problem);
        let unreadable = |error: std::io::Error| {
            refused(match error.kind() {
                ErrorKind::NotFound => PhotographProblem::NotThere,
                _ => PhotographProblem::Unreadable(
                    error.to_string().split(" (os error").next().unwrap_or_default().to_owned(),
                ),
            })
        };
        let about = fs::metadata(path).map_err(unreadable)?;
        if !about.is_file() {
            return Err(refused(PhotographProblem::NotAFile));
        }
        if about.len() > decode::MOST_BYTES {
            return Err(refused(PhotographProblem::TooManyBytes { bytes: about.len(), limit: decode::MOST_BYTES }));
        }
        let bytes = fs::read(path).map_err(unreadable)?;
        Self::from_bytes(&bytes, path, options)
    }

    /// Reads a photograph from the bytes of a file of this name.
    ///
    /// # Errors
    ///
    /// As [`Self::read`].
    pub fn from_bytes(bytes: &[u8], path: &Path, options: &PhotographOptions) -> Result<Self, PhotographError> {
        let refused = |problem| PhotographError::new(path, problem);
        let mut notes = Vec::new();
        let decoded = decode::decode(bytes, path, &mut notes).map_err(refused)?;
        let coding = Coding::of(&decoded.colours, options.encoding, &mut notes).map_err(refused)?;
        if !coding.is_linear() {
            notes.push(
                "The camera's own tone curve is not known: this is light as it was rendered for a screen.".into(),
            );
        }
        let pixels_per_mm = pixels_per_mm(&decoded, options.scale).map_err(refused)?;
        let (pixels, validity) = light(&decoded.codes, &coding);
        Ok(Self {
            file: path.to_owned(),
            format: decoded.format,
            bytes: bytes.len() as u64,
            sha256: Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect(),
            width: decoded.codes.width() as usize,
            height: decoded.codes.height() as usize,
            pixels,
            validity,
            pixels_per_mm,
            exif: decoded.exif,
            coding: coding.sentence,
            notes,
        })
    }

    /// Whether Barbule made it, as its EXIF says.
    pub fn is_synthetic(&self) -> bool {
        self.exif.description.as_deref() == Some(synthetic::DESCRIPTION)
    }

    /// How many pixels can be trusted, and how many cannot for which reason.
    pub fn counts(&self) -> ValidityCounts {
        let mut counts = ValidityCounts::default();
        for validity in &self.validity {
            match validity {
                Validity::Valid => counts.valid += 1,
                Validity::Clipped => counts.clipped += 1,
                Validity::Transparent => counts.transparent += 1,
                Validity::NotANumber => counts.not_a_number += 1,
            }
        }
        counts
    }

    /// The part of the picture within a rectangle, which must lie in it.
    ///
    /// # Errors
    ///
    /// Where the rectangle reaches out of the picture.
    pub fn cut(&self, rectangle: Rectangle) -> Result<Self, PhotographError> {
        self.check(rectangle)?;
        let rows = rectangle.y_px..rectangle.y_px + rectangle.height_px;
        let spans = || {
            rows.clone().map(|y| {
                let start = y * self.width + rectangle.x_px;
                start..start + rectangle.width_px
            })
        };
        Ok(Self {
            width: rectangle.width_px,
            height: rectangle.height_px,
            pixels: spans().flat_map(|span| &self.pixels[span]).copied().collect(),
            validity: spans().flat_map(|span| &self.validity[span]).copied().collect(),
            ..self.clone_without_pixels()
        })
    }

    /// Refuses a rectangle that reaches out of the picture.
    pub(super) fn check(&self, rectangle: Rectangle) -> Result<(), PhotographError> {
        if rectangle.lies_in(self.width, self.height) {
            return Ok(());
        }
        let (rectangle, width, height) = (rectangle.to_string(), self.width, self.height);
        Err(PhotographError::new(&self.file, PhotographProblem::OutOfPicture { rectangle, width, height }))
    }

    fn clone_without_pixels(&self) -> Self {
        Self {
            file: self.file.clone(),
            format: self.format,
            bytes: self.bytes,
            sha256: self.sha256.clone(),
            width: 0,
            height: 0,
            pixels: Vec::new(),
            validity: Vec::new(),
            pixels_per_mm: self.pixels_per_mm,
            exif: self.exif.clone(),
            coding: self.coding.clone(),
            notes: self.notes.clone(),
        }
    }
}

fn pixels_per_mm(decoded: &Decoded, scale: Option<Scale>) -> Result<Option<f64>, PhotographProblem> {
    /// Along x and y a scanner's pixels differ by rounding alone.
    const SQUARE: f64 = 1e-3;
    match scale {
        None => Ok(None),
        Some(Scale::PixelsPerMm(number)) if number > 0.0 && number.is_finite() => Ok(Some(number)),
        Some(Scale::PixelsPerMm(number)) => Err(PhotographProblem::Scale(number)),
        Some(Scale::Scan) => match decoded.pixels_per_mm {
            Some([x, y]) if x > 0.0 && (x - y).abs() <= SQUARE * x => Ok(Some(x)),
            _ => Err(PhotographProblem::NoResolution),
        },
    }
}

/// The light of each pixel, and whether it can be trusted.
fn light(codes: &DynamicImage, coding: &Coding) -> (Vec<[f32; 3]>, Vec<Validity>) {
    let channels = usize::from(codes.color().channel_count());
    match codes {
        DynamicImage::ImageLuma8(image) => bytes(image, channels, coding),
        DynamicImage::ImageLumaA8(image) => bytes(image, channels, coding),
        DynamicImage::ImageRgb8(image) => bytes(image, channels, coding),
        DynamicImage::ImageRgba8(image) => bytes(image, channels, coding),
        DynamicImage::ImageLuma16(image) => words(image, channels, coding),
        DynamicImage::ImageLumaA16(image) => words(image, channels, coding),
        DynamicImage::ImageRgb16(image) => words(image, channels, coding),
        DynamicImage::ImageRgba16(image) => words(image, channels, coding),
        // The rest is floating: where it has no largest code, nothing is clipped.
        other => {
            let image = other.to_rgba32f();
            let code = |channel, code: f32| coding.light(channel, code.into());
            converted(&image, 4, coding, code, |_| false, |alpha| alpha >= 1.0)
        }
    }
}

fn bytes(codes: &[u8], channels: usize, coding: &Coding) -> (Vec<[f32; 3]>, Vec<Validity>) {
    let tables = [0, 1, 2].map(|channel| {
        (0..=u8::MAX).map(|code| coding.light(channel, f64::from(code) / f64::from(u8::MAX))).collect::<Vec<_>>()
    });
    let light = |channel: usize, code: u8| tables[channel][usize::from(code)];
    converted(codes, channels, coding, light, |code| code == u8::MAX, |alpha| alpha == u8::MAX)
}

fn words(codes: &[u16], channels: usize, coding: &Coding) -> (Vec<[f32; 3]>, Vec<Validity>) {
    let tables = [0, 1, 2].map(|channel| {
        (0..=u16::MAX).map(|code| coding.light(channel, f64::from(code) / f64::from(u16::MAX))).collect::<Vec<_>>()
    });
    let light = |channel: usize, code: u16| tables[channel][usize::from(code)];
    converted(codes, channels, coding, light, |code| code == u16::MAX, |alpha| alpha == u16::MAX)
}

/// Converts all pixels; of one or two channels the first is grey, of two or four the last is opacity.
fn converted<T: Copy + Sync>(
    codes: &[T],
    channels: usize,
    coding: &Coding,
    light: impl Fn(usize, T) -> f64 + Sync,
    is_largest: impl Fn(T) -> bool + Sync,
    is_opaque: impl Fn(T) -> bool + Sync,
) -> (Vec<[f32; 3]>, Vec<Validity>) {
    /// Pixels that a thread takes at a time.
    const BLOCK: usize = 1 << 14;
    let count = codes.len() / channels;
    let (mut pixels, mut validity) = (vec![[0.0; 3]; count], vec![Validity::Valid; count]);
    let blocks =
        pixels.par_chunks_mut(BLOCK).zip(validity.par_chunks_mut(BLOCK)).zip(codes.par_chunks(BLOCK * channels));
    blocks.for_each(|((pixels, validity), codes)| {
        for ((pixel, valid), code) in pixels.iter_mut().zip(validity).zip(codes.chunks_exact(channels)) {
            let (colour, alpha) = match code {
                [grey] => ([*grey; 3], None),
                [grey, alpha] => ([*grey; 3], Some(*alpha)),
                [red, green, blue] => ([*red, *green, *blue], None),
                [red, green, blue, rest @ ..] => ([*red, *green, *blue], rest.first().copied()),
                [] => continue,
            };
            let own = [light(0, colour[0]), light(1, colour[1]), light(2, colour[2])];
            let rec_709 = match &coding.matrix {
                Some(matrix) => matrix.map(|[r, g, b]| r * own[0] + g * own[1] + b * own[2]),
                None => own,
            };
            #[expect(clippy::cast_possible_truncation, reason = "a picture holds 32-bit numbers")]
            let rec_709 = rec_709.map(|channel| channel as f32);
            *pixel = rec_709;
            *valid = if alpha.is_some_and(|alpha| !is_opaque(alpha)) {
                Validity::Transparent
            } else if rec_709.iter().any(|channel| !channel.is_finite()) {
                Validity::NotANumber
            } else if colour.into_iter().any(&is_largest) {
                Validity::Clipped
            } else {
                Validity::Valid
            };
        }
    });
    (pixels, validity)
}
