//! Two pictures, laid over each other.

use super::{CompareError, RegionColours, Registration};
use crate::measure::colour::{LinearRgb, encode};
use crate::measure::photograph::{Photograph, Rectangle, Region, Validity};

/// The part that both pictures show.
pub(super) struct Pair {
    /// Where it lies in the first picture.
    pub(super) part: Rectangle,
    /// Linear light of both.
    pub(super) light: [Vec<[f32; 3]>; 2],
    /// Luminance of both as a screen's code, 0 to 1.
    pub(super) codes: [Vec<f64>; 2],
    /// Whether both can be trusted.
    pub(super) is_trusted: Vec<bool>,
}

impl Pair {
    /// Lays the second picture over the first as it lies, or as it was registered.
    pub(super) fn new(
        first: &Photograph,
        second: &Photograph,
        registration: Option<&Registration>,
    ) -> Result<Self, CompareError> {
        let part = match registration {
            None if (first.width, first.height) == (second.width, second.height) => {
                Rectangle { x_px: 0, y_px: 0, width_px: first.width, height_px: first.height }
            }
            None => {
                let of = |photograph: &Photograph| (photograph.file.clone(), photograph.width, photograph.height);
                return Err(CompareError::Sizes { first: of(first), second: of(second) });
            }
            Some(registration) => registration.part(first, second)?,
        };
        let shift = registration.map_or([0.0; 2], |registration| registration.shift_px);
        let (mut one, mut other) = (Vec::new(), Vec::new());
        let mut is_trusted = Vec::new();
        for y in part.y_px..part.y_px + part.height_px {
            for x in part.x_px..part.x_px + part.width_px {
                let place = y * first.width + x;
                let (light, other_is_trusted) = sampled(second, [x, y], shift);
                one.push(first.pixels[place]);
                other.push(light);
                is_trusted.push(first.validity[place] == Validity::Valid && other_is_trusted);
            }
        }
        let codes = [&one, &other].map(|light| light.iter().map(|pixel| luminance_code(*pixel)).collect());
        Ok(Self { part, light: [one, other], codes, is_trusted })
    }

    pub(super) fn len(&self) -> usize {
        self.is_trusted.len()
    }

    /// Mean colours of a region of the first picture.
    #[expect(clippy::cast_precision_loss, reason = "a count of pixels is far below 2^53")]
    pub(super) fn region(&self, region: &Region) -> RegionColours {
        let rectangle = region.rectangle;
        let mut sums = [[0.0; 3]; 2];
        let mut pixels = 0;
        for y in rectangle.y_px..rectangle.y_px + rectangle.height_px {
            for x in rectangle.x_px..rectangle.x_px + rectangle.width_px {
                let Some(place) = self.place(x, y).filter(|place| self.is_trusted[*place]) else { continue };
                pixels += 1;
                for (sum, light) in sums.iter_mut().zip(&self.light) {
                    for (sum, channel) in sum.iter_mut().zip(light[place]) {
                        *sum += f64::from(channel);
                    }
                }
            }
        }
        let light = (pixels > 0).then(|| sums.map(|sum| sum.map(|channel| channel / pixels as f64)));
        let difference = light.map(|both| {
            let [one, other] = both.map(|light| LinearRgb(light).to_lab());
            one.delta_e_2000(other)
        });
        let left_out = rectangle.width_px * rectangle.height_px - pixels;
        RegionColours { name: region.name.clone(), rectangle, light, difference, pixels, left_out }
    }

    /// Place of a pixel of the first picture in the part; None where it lies outside.
    fn place(&self, x: usize, y: usize) -> Option<usize> {
        let [x, y] = [x.checked_sub(self.part.x_px)?, y.checked_sub(self.part.y_px)?];
        (x < self.part.width_px && y < self.part.height_px).then(|| y * self.part.width_px + x)
    }
}

/// Luminance (Rec. 709) as a screen's code, cut to 0…1.
pub(super) fn luminance_code(light: [f32; 3]) -> f64 {
    encode(LinearRgb(light.map(f64::from)).to_xyz().y.clamp(0.0, 1.0))
}

/// Light of a picture at a place moved by a shift, linear between its four neighbours, and whether all of them can be trusted.
fn sampled(picture: &Photograph, [x, y]: [usize; 2], [right, down]: [f64; 2]) -> ([f32; 3], bool) {
    let (columns, rows) = (weights(x, right, picture.width), weights(y, down, picture.height));
    let mut light = [0.0; 3];
    let mut is_trusted = true;
    for (row, row_share) in rows {
        for (column, column_share) in columns {
            let share = row_share * column_share;
            if share == 0.0 {
                continue;
            }
            let place = row * picture.width + column;
            is_trusted &= picture.validity[place] == Validity::Valid;
            for (sum, channel) in light.iter_mut().zip(picture.pixels[place]) {
                *sum += share * f64::from(channel);
            }
        }
    }
    #[expect(clippy::cast_possible_truncation, reason = "pictures hold 32-bit numbers")]
    (light.map(|channel| channel as f32), is_trusted)
}

/// The two pixels beside a moved place, with their shares; within a picture of this length.
fn weights(at: usize, shift: f64, length: usize) -> [(usize, f64); 2] {
    #[expect(clippy::cast_precision_loss, reason = "a picture's sides are far below 2^53")]
    let (at, last) = (at as f64, (length - 1) as f64);
    let place = (at + shift).clamp(0.0, last);
    let low = place.floor();
    let share = place - low;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and the picture's side")]
    let low = low as usize;
    [(low, 1.0 - share), ((low + 1).min(length - 1), share)]
}
