//! Photographs that no camera took: light that is known, through a camera that is known.
//!
//! What a fit finds in such a file can be held against the truth. The file says in its EXIF that it is synthetic.

use std::io::Cursor;

use exif::experimental::Writer;
use exif::{Field, In, Rational, Tag, Value};
use image::codecs::jpeg::JpegEncoder;
use image::{ExtendedColorType, ImageEncoder, ImageError};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::measure::colour::{encode, screen_byte};

/// What EXIF says of such a picture.
pub(super) const DESCRIPTION: &str = "Synthetic photograph, made by Barbule; no camera took it";

/// A camera that never was.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Camera {
    /// Exposure time in s, for EXIF alone, as the next three.
    pub exposure_time_s: f64,
    /// Focal length over the aperture's diameter.
    pub f_number: f64,
    /// Sensitivity.
    pub iso: u16,
    /// Focal length in mm.
    pub focal_length_mm: f64,
    /// Code value of the sensor, 1 at its white, for light 1.
    pub exposure: f64,
    /// Share of the light that the corners lose; it grows with the square of the distance from the middle.
    pub vignetting: f64,
    /// Electrons of a pixel at white: their number scatters by its square root. 0 for a sensor without noise.
    pub white_electrons: f64,
    /// Standard deviation in electrons of reading a pixel.
    pub read_noise_electrons: f64,
    /// How the camera renders its picture: sRGB's code c becomes c − k sin(2πc)/2π. Above 0 shadows darken and lights
    /// brighten; 0 is sRGB itself.
    pub contrast: f64,
    /// Quality of the JPEG, 1 to 100.
    pub jpeg_quality: u8,
    /// Seed of the noise.
    pub seed: u64,
}

impl Default for Camera {
    fn default() -> Self {
        Self {
            exposure_time_s: 0.0125,
            f_number: 8.0,
            iso: 100,
            focal_length_mm: 60.0,
            exposure: 1.0,
            vignetting: 0.0,
            white_electrons: 0.0,
            read_noise_electrons: 0.0,
            contrast: 0.0,
            jpeg_quality: 92,
            seed: 1,
        }
    }
}

/// Why a synthetic photograph could not be made.
#[derive(Debug, Error)]
pub enum SyntheticError {
    /// A setting of the camera that makes no sense.
    #[error("the camera's {key}: found {found}, expected {expected}")]
    Setting {
        /// Its key.
        key: &'static str,
        /// Its value.
        found: f64,
        /// What may stand there.
        expected: &'static str,
    },
    /// The light is no picture.
    #[error(
        "found {pixels} pixels in rows of {width}, expected whole rows of 1 to 65535 pixels, at most 65535 of them"
    )]
    Size {
        /// Pixels in all.
        pixels: usize,
        /// Pixels a row.
        width: usize,
    },
    /// The EXIF block could not be written.
    #[error("its EXIF could not be written ({0})")]
    Exif(#[from] exif::Error),
    /// The encoder failed; it only writes to memory.
    #[error("the JPEG could not be written ({0})")]
    Jpeg(#[from] ImageError),
}

impl Camera {
    /// Takes a picture of this light (linear, Rec. 709 primaries, in rows from the top): a JPEG file with EXIF.
    ///
    /// In this order: exposure and vignetting, noise of photons and reading (each channel on its own, as after demosaicing
    /// without its blur), clipping at white, the camera's curve, JPEG.
    ///
    /// # Errors
    ///
    /// Where a setting makes no sense or the light is no picture.
    pub fn photograph(&self, light: &[[f32; 3]], width: usize) -> Result<Vec<u8>, SyntheticError> {
        self.check()?;
        let size = SyntheticError::Size { pixels: light.len(), width };
        if width == 0 || light.is_empty() || !light.len().is_multiple_of(width) {
            return Err(size);
        }
        let height = light.len() / width;
        let (Ok(columns), Ok(rows)) = (u16::try_from(width), u16::try_from(height)) else { return Err(size) };

        let middle = [f64::from(columns) / 2.0, f64::from(rows) / 2.0];
        let corner = middle[0].powi(2) + middle[1].powi(2);
        let mut codes = Vec::with_capacity(3 * light.len());
        for (y, row) in (0..rows).zip(light.chunks_exact(width)) {
            // A row has its own numbers.
            let mut random = ChaCha8Rng::seed_from_u64(self.seed);
            random.set_stream(y.into());
            for (x, pixel) in (0..columns).zip(row) {
                let from_middle = [f64::from(x) + 0.5 - middle[0], f64::from(y) + 0.5 - middle[1]];
                let distance = (from_middle[0].powi(2) + from_middle[1].powi(2)) / corner;
                let fallen = self.exposure * (1.0 - self.vignetting * distance);
                codes.extend(pixel.map(|channel| self.code(f64::from(channel) * fallen, &mut random)));
            }
        }
        let mut file = Vec::new();
        let mut encoder = JpegEncoder::new_with_quality(&mut file, self.jpeg_quality);
        encoder.set_exif_metadata(self.exif()?).map_err(ImageError::Unsupported)?;
        encoder.write_image(&codes, columns.into(), rows.into(), ExtendedColorType::Rgb8)?;
        Ok(file)
    }

    /// Light at the sensor to the byte that the JPEG encoder gets.
    fn code(&self, light: f64, random: &mut ChaCha8Rng) -> u8 {
        let counted = if self.white_electrons > 0.0 {
            let electrons = light.max(0.0) * self.white_electrons;
            let deviation = (electrons + self.read_noise_electrons.powi(2)).sqrt();
            let scatter: f64 = StandardNormal.sample(random);
            (electrons + deviation * scatter) / self.white_electrons
        } else {
            light
        };
        let code = encode(counted.clamp(0.0, 1.0));
        let turn = std::f64::consts::TAU;
        let rendered = code - self.contrast * (turn * code).sin() / turn;
        screen_byte(rendered)
    }

    fn check(&self) -> Result<(), SyntheticError> {
        let within = |key, found: f64, fits: bool, expected| {
            if fits { Ok(()) } else { Err(SyntheticError::Setting { key, found, expected }) }
        };
        // EXIF holds fractions of millionths in 32 bits.
        let is_fraction = |value: f64| (1e-6..=4000.0).contains(&value);
        let is_count = |value: f64| (0.0..=1e12).contains(&value);
        within("exposure_time_s", self.exposure_time_s, is_fraction(self.exposure_time_s), "0.000001 to 4000 s")?;
        within("f_number", self.f_number, is_fraction(self.f_number), "a number from 0.000001 to 4000")?;
        within("focal_length_mm", self.focal_length_mm, is_fraction(self.focal_length_mm), "0.000001 to 4000 mm")?;
        let exposure_fits = self.exposure > 0.0 && self.exposure.is_finite();
        within("exposure", self.exposure, exposure_fits, "a number above 0")?;
        within("vignetting", self.vignetting, (0.0..=1.0).contains(&self.vignetting), "a share from 0 to 1")?;
        within("white_electrons", self.white_electrons, is_count(self.white_electrons), "a count of electrons from 0")?;
        let read = self.read_noise_electrons;
        within("read_noise_electrons", read, is_count(read), "a count of electrons from 0")?;
        let is_curve = self.contrast > -1.0 && self.contrast < 1.0;
        within(
            "contrast",
            self.contrast,
            is_curve,
            "a number between -1 and 1, so that brighter light has a brighter code",
        )?;
        let quality = self.jpeg_quality;
        within("jpeg_quality", quality.into(), (1..=100).contains(&quality), "1 to 100")
    }

    fn exif(&self) -> Result<Vec<u8>, SyntheticError> {
        let text = |text: &str| Value::Ascii(vec![text.as_bytes().to_vec()]);
        let field = |tag, value| Field { tag, ifd_num: In::PRIMARY, value };
        let fields = [
            field(Tag::ImageDescription, text(DESCRIPTION)),
            field(Tag::Make, text("Barbule")),
            field(Tag::Model, text("synthetic camera")),
            field(Tag::Software, text(concat!("Barbule ", env!("CARGO_PKG_VERSION")))),
            field(Tag::Orientation, Value::Short(vec![1])),
            field(Tag::ExposureTime, fraction(self.exposure_time_s)),
            field(Tag::FNumber, fraction(self.f_number)),
            field(Tag::PhotographicSensitivity, Value::Short(vec![self.iso])),
            field(Tag::FocalLength, fraction(self.focal_length_mm)),
            field(Tag::ColorSpace, Value::Short(vec![1])),
        ];
        let mut writer = Writer::new();
        for field in &fields {
            writer.push_field(field);
        }
        let mut chunk = Cursor::new(Vec::new());
        writer.write(&mut chunk, true)?;
        Ok(chunk.into_inner())
    }
}

/// A number as millionths.
fn fraction(value: f64) -> Value {
    const DENOMINATOR: u32 = 1_000_000;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked to be from 1 to 4e9")]
    let num = (value * f64::from(DENOMINATOR)).round() as u32;
    Value::Rational(vec![Rational { num, denom: DENOMINATOR }])
}
