//! Colours that stay apart for every reader: the eight of Okabe and Ito (2008), viridis, and a blue–orange scale.

use plotters::style::RGBColor;
use plotters::style::colors::colormaps::{ColorMap, ViridisRGB};

/// A colour of a plot.
pub(crate) type Colour = RGBColor;

pub(crate) const BLACK: Colour = RGBColor(0, 0, 0);
pub(crate) const WHITE: Colour = RGBColor(255, 255, 255);
pub(crate) const INK: Colour = RGBColor(34, 34, 34);
pub(crate) const GREY: Colour = RGBColor(140, 140, 140);
pub(crate) const PALE: Colour = RGBColor(228, 228, 228);
pub(crate) const SKY: Colour = RGBColor(86, 180, 233);
pub(crate) const BLUE: Colour = RGBColor(0, 114, 178);
pub(crate) const GREEN: Colour = RGBColor(0, 158, 115);
pub(crate) const VERMILION: Colour = RGBColor(213, 94, 0);
pub(crate) const PURPLE: Colour = RGBColor(204, 121, 167);

/// What a map's colours mean.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Scale {
    /// From dark to light over the range.
    Sequential {
        /// Value of the darkest colour.
        low: f64,
        /// Value of the lightest.
        high: f64,
    },
    /// From blue by white to orange over −limit to limit.
    Diverging {
        /// Size of the value with the strongest colour.
        limit: f64,
    },
}

impl Scale {
    /// The values at the two ends.
    pub(crate) fn range(self) -> (f64, f64) {
        match self {
            Self::Sequential { low, high } => (low, high),
            Self::Diverging { limit } => (-limit, limit),
        }
    }

    /// The colour of a value; values beyond the range take the colour of its end.
    pub(crate) fn colour(self, value: f64) -> Colour {
        let (low, high) = self.range();
        let share = if high > low { ((value - low) / (high - low)).clamp(0.0, 1.0) } else { 0.5 };
        match self {
            Self::Sequential { .. } => sequential(share),
            Self::Diverging { .. } => diverging(share),
        }
    }
}

fn sequential(share: f64) -> Colour {
    #[expect(clippy::cast_possible_truncation, reason = "a share of a colour scale, good to 1e-7 in single precision")]
    ViridisRGB.get_color(share as f32)
}

fn diverging(share: f64) -> Colour {
    const STOPS: [[f64; 3]; 5] =
        [[33.0, 102.0, 172.0], [146.0, 197.0, 222.0], [247.0, 247.0, 247.0], [253.0, 184.0, 99.0], [179.0, 88.0, 6.0]];
    let position = share * 4.0;
    let lower = position.floor().clamp(0.0, 3.0);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0, 1, 2 or 3")]
    let index = lower as usize;
    let (from, to) = (STOPS[index], STOPS[index + 1]);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between two stops of 0 to 255")]
    let channel = |c: usize| (from[c] + (to[c] - from[c]) * (position - lower)).round() as u8;
    RGBColor(channel(0), channel(1), channel(2))
}

/// Whether black text is easier to read on this colour than white.
pub(crate) fn is_light(colour: Colour) -> bool {
    let RGBColor(red, green, blue) = colour;
    0.299 * f64::from(red) + 0.587 * f64::from(green) + 0.114 * f64::from(blue) > 140.0
}
