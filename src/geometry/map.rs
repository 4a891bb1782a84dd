//! A feather as a texture: what lies at each texel, which way it runs, and how much of the texel it covers.
//!
//! As a file it is a 16-bit RGBA PNG (after the first thesis's section 4.3, whose JPEG would ruin it):
//!
//! | channel | holds |
//! | --- | --- |
//! | R, G | (t + 1)/2, t the unit tangent: x to the right, y **up**; from base to tip on the shaft, from shaft to margin on a barb |
//! | B | the class: 0 nothing, 32768 shaft, 65535 barb. Never blended: a texel belongs to what covers more of it |
//! | A | share of the texel that the feather covers |
//!
//! R and G hold the tangent of the class in B. A texture of classes and directions cannot be interpolated, so that
//! [`FeatherMap::lookup`] takes the nearest texel. The file says its resolution (the PNG's pHYs
//! chunk, texels a metre).
//!
//! **Between two barbs** of a closed vane lie their barbules, which no texture resolves: the scattering model spreads them
//! over the area between barbs (its shares sum to 1), about the barb's direction. So a texel there is of class barb, has the
//! tangent of the barb that is nearest to its centre, and is covered. The thesis draws barbs only, and leaves open what lies
//! between them; [`BetweenBarbs::Nothing`](super::BetweenBarbs) draws that, a plume of loose barbs.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use super::GeometryError;

/// Texels that one map may have: 128 MiB.
pub(super) const LARGEST_TEXEL_COUNT: u32 = 1 << 24;

/// Texels that a side of a map may have.
pub(super) const LARGEST_SIDE: u32 = 1 << 14;

/// What lies at a texel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum TexelClass {
    /// Nothing of the feather.
    Nothing,
    /// The shaft: rachis or calamus.
    Shaft,
    /// A barb, or the barbules beside it.
    Barb,
}

impl TexelClass {
    /// The value in the blue channel.
    pub fn code(self) -> u16 {
        match self {
            Self::Nothing => 0,
            Self::Shaft => 32768,
            Self::Barb => 65535,
        }
    }

    /// The class of a value in the blue channel; none for a value that is none of the three.
    pub fn of_code(code: u16) -> Option<Self> {
        [Self::Nothing, Self::Shaft, Self::Barb].into_iter().find(|class| class.code() == code)
    }
}

/// A texel as the scattering model needs it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Texel {
    /// What lies there.
    pub class: TexelClass,
    /// Unit vector along it in the map's plane, x to the right and y up: from base to tip on the shaft, from shaft to
    /// margin on a barb. Zero where nothing lies.
    pub tangent: [f64; 2],
    /// Share of the texel that the feather covers, 0 to 1. The rest is open.
    pub coverage: f64,
}

/// A feather as a texture.
#[derive(Debug, Clone, PartialEq)]
pub struct FeatherMap {
    width: u32,
    height: u32,
    pixels_per_mm: f64,
    /// Rows from the top, as in the file.
    texels: Vec<[u16; 4]>,
}

/// Where nothing lies.
pub(super) const NOTHING: [u16; 4] = [32768, 32768, 0, 0];

impl FeatherMap {
    /// A map of texels in rows from the top, each as in the file.
    pub(super) fn from_texels(width: u32, pixels_per_mm: f64, texels: Vec<[u16; 4]>) -> Self {
        let height = u32::try_from(texels.len() / width as usize).unwrap_or(0);
        Self { width, height, pixels_per_mm, texels }
    }

    /// Texels from left to right.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Texels from bottom to top.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Texels a millimetre.
    pub fn pixels_per_mm(&self) -> f64 {
        self.pixels_per_mm
    }

    /// Width and height of the whole map, mm.
    pub fn size_mm(&self) -> [f64; 2] {
        [self.width, self.height].map(|side| f64::from(side) / self.pixels_per_mm)
    }

    /// The texel at a column from the left and a row from the **top**.
    ///
    /// # Panics
    /// If it lies outside.
    pub fn texel(&self, column: u32, row: u32) -> Texel {
        assert!(column < self.width && row < self.height, "texel ({column}, {row}) lies outside the map");
        decoded(self.texels[row as usize * self.width as usize + column as usize])
    }

    /// The texel nearest to a place: `u` from 0 at the left to 1 at the right, `v` from 0 at the bottom to 1 at the top.
    /// Outside lies nothing.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked to lie inside the map")]
    pub fn lookup(&self, u: f64, v: f64) -> Texel {
        if !((0.0..=1.0).contains(&u) && (0.0..=1.0).contains(&v)) {
            return decoded(NOTHING);
        }
        let column = ((u * f64::from(self.width)) as u32).min(self.width - 1);
        let row = (((1.0 - v) * f64::from(self.height)) as u32).min(self.height - 1);
        self.texel(column, row)
    }

    /// Every texel in rows from the top, with its column and its row.
    pub fn texels(&self) -> impl Iterator<Item = (u32, u32, Texel)> {
        let places = (0..self.height).flat_map(move |row| (0..self.width).map(move |column| (column, row)));
        places.zip(&self.texels).map(|((column, row), texel)| (column, row, decoded(*texel)))
    }

    /// Reads a map that [`png`](Self::png) wrote.
    ///
    /// # Errors
    /// A sentence if there is no such file, if it is no 16-bit RGBA PNG, is larger than a map may be, or has a class that is
    /// none: then it was resized or saved by a program that blends.
    pub fn read(path: &Path) -> Result<Self, GeometryError> {
        let refused = |problem: String| GeometryError::Map { path: path.to_owned(), problem };
        let file = File::open(path).map_err(|error| {
            refused(match error.kind() {
                std::io::ErrorKind::NotFound => "there is no such file; `barbule geometry` makes a map".to_owned(),
                _ => error.to_string().split(" (os error").next().unwrap_or_default().to_owned(),
            })
        })?;
        let broken = |error: png::DecodingError| refused(format!("this is no whole PNG: {error}"));
        let mut reader = png::Decoder::new(BufReader::new(file)).read_info().map_err(broken)?;
        let about = reader.info();
        let (width, height) = (about.width, about.height);
        if (about.color_type, about.bit_depth) != (png::ColorType::Rgba, png::BitDepth::Sixteen) {
            return Err(refused(format!(
                "found a PNG of {} bits with channels {:?}; a feather map has 16 bits and RGBA, as `barbule geometry` \
                 writes it",
                about.bit_depth as u8, about.color_type
            )));
        }
        if u64::from(width) * u64::from(height) > u64::from(LARGEST_TEXEL_COUNT) {
            return Err(refused(format!(
                "it has {width} × {height} texels; a feather map has {LARGEST_TEXEL_COUNT} at most: make it again with \
                 fewer --pixels-per-mm"
            )));
        }
        let pixels_per_mm = about
            .pixel_dims
            .filter(|dims| dims.unit == png::Unit::Meter && dims.xppu == dims.yppu && dims.xppu > 0)
            .map(|dims| f64::from(dims.xppu) / 1000.0)
            .ok_or_else(|| {
                refused(
                    "it does not say how many texels a metre has (a PNG's pHYs chunk); make it again with `barbule geometry`"
                        .to_owned(),
                )
            })?;
        let mut bytes = vec![0; reader.output_buffer_size().unwrap_or(0)];
        reader.next_frame(&mut bytes).map_err(broken)?;
        let texels: Vec<[u16; 4]> = bytes
            .chunks_exact(8)
            .map(|texel| [0, 2, 4, 6].map(|at| u16::from_be_bytes([texel[at], texel[at + 1]])))
            .collect();
        if let Some(at) = texels.iter().position(|texel| TexelClass::of_code(texel[2]).is_none()) {
            return Err(refused(format!(
                "the texel in column {}, row {} has {} in its blue channel, where a class (0, 32768 or 65535) was \
                 expected: was the map resized? make it again with `barbule geometry`",
                at % width as usize,
                at / width as usize,
                texels[at][2]
            )));
        }
        Ok(Self { width, height, pixels_per_mm, texels })
    }

    /// The map as a PNG file.
    ///
    /// # Errors
    /// If it has no texels.
    pub fn png(&self) -> Result<Vec<u8>, png::EncodingError> {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, self.width, self.height);
        encoder.set_color(png::ColorType::Rgba);
        encoder.set_depth(png::BitDepth::Sixteen);
        let per_metre = per_metre(self.pixels_per_mm);
        let dimensions = png::PixelDimensions { xppu: per_metre, yppu: per_metre, unit: png::Unit::Meter };
        encoder.set_pixel_dims(Some(dimensions));
        let bytes: Vec<u8> = self.texels.iter().flatten().flat_map(|value| value.to_be_bytes()).collect();
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&bytes)?;
        writer.finish()?;
        Ok(file)
    }
}

/// A resolution as the PNG holds it, a whole number of texels a metre.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a resolution is checked before")]
pub(super) fn per_metre(pixels_per_mm: f64) -> u32 {
    (pixels_per_mm * 1000.0).round() as u32
}

/// A texel of a class along a unit vector, as the file holds it.
pub(super) fn coded(class: TexelClass, tangent: kurbo::Vec2, coverage: f64) -> [u16; 4] {
    let direction = |component: f64| whole(0.5 * (component + 1.0));
    [direction(tangent.x), direction(tangent.y), class.code(), whole(coverage)]
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to the channel's range")]
fn whole(share: f64) -> u16 {
    (share.clamp(0.0, 1.0) * 65535.0).round() as u16
}

fn decoded(texel: [u16; 4]) -> Texel {
    let [red, green, blue, alpha] = texel;
    // The reader refuses other codes.
    let class = TexelClass::of_code(blue).unwrap_or(TexelClass::Nothing);
    let component = |value: u16| 2.0 * f64::from(value) / 65535.0 - 1.0;
    let [x, y] = [red, green].map(component);
    let length = (x * x + y * y).sqrt();
    // A map that someone painted may hold no direction where it claims a class; its tangent is 0 then, too.
    let known = class != TexelClass::Nothing && length > 0.5;
    let tangent = if known { [x / length, y / length] } else { [0.0, 0.0] };
    Texel { class, tangent, coverage: f64::from(alpha) / 65535.0 }
}
