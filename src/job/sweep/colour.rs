//! Whether and how the readings of a sweep have a colour.

use super::outcome::{Colour, View};
use crate::measure::Quantity;
use crate::measure::colour::{LinearRgb, Xyz, covers_visible};

/// How readings become colours.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum ColourMaker {
    /// Spectra of at least 400 to 700 nm, under D65 for the 2° observer.
    Spectra,
    /// Three channels as linear Rec. 709.
    Channels,
    /// The readings have no colour, for the reason that this sentence gives.
    None(String),
}

/// The part of the spectrum without which there is no colour: of a white, 0.03 % of Y and 0.2 % of X and Z lie outside.
const LEAST_WINDOW_NM: [f64; 2] = [400.0, 700.0];
/// The widest step over which a spectrum is interpolated (CIE 15:2018, 7.2 allows up to 20 nm).
const WIDEST_STEP_NM: f64 = 20.0;
/// Where the blue, the green and the red of three channels may lie, nm.
const CHANNELS_NM: [[f64; 2]; 3] = [[380.0, 500.0], [480.0, 600.0], [580.0, 780.0]];

impl ColourMaker {
    pub(super) fn new(views: &[View]) -> Self {
        let is_channels = |view: &View| match view.wavelengths_nm.as_slice() {
            nm @ [_, _, _] => nm.iter().zip(CHANNELS_NM).all(|(nm, [from, to])| (from..=to).contains(nm)),
            _ => false,
        };
        if views.iter().all(is_channels) {
            return Self::Channels;
        }
        match views.iter().find_map(why_colourless) {
            Some(reason) => Self::None(reason),
            None => Self::Spectra,
        }
    }

    /// What a reader must know of the colours.
    pub(super) fn note(&self, views: &[View], exposure: f64) -> String {
        let mut sentences = Vec::new();
        match self {
            Self::None(reason) => return reason.clone(),
            Self::Spectra => {
                sentences.push(
                    "Colours are those of each spectrum for the CIE 1931 2° observer under illuminant D65; the white \
                     standard has Y = 1 and L* = 100."
                        .to_owned(),
                );
                if views.iter().any(|view| !covers_visible(&view.wavelengths_nm)) {
                    let text = "The spectra do not reach over 380 to 780 nm; their ends stand in for the rest.";
                    sentences.push(text.to_owned());
                }
            }
            Self::Channels => {
                let nm: Vec<String> = views[0].wavelengths_nm.iter().rev().map(f64::to_string).collect();
                sentences.push(format!(
                    "The three wavelengths ({} nm) are taken as the linear red, green and blue of Rec. 709 with its D65 \
                     white: a renderer's colours, not those of a spectrum.",
                    nm.join(", ")
                ));
            }
        }
        if exposure < 1.0 {
            sentences.push(format!(
                "All colours were darkened by the factor {}, so that the brightest of the grid is as bright as the white \
                 standard; differences are those of the darkened colours.",
                crate::number::significant(exposure, 3)
            ));
        }
        sentences.join(" ")
    }

    /// The luminance of a view's readings; None where they have no colour.
    pub(super) fn luminance(&self, view: &View, quantity: Quantity, readings: &[f64]) -> Option<f64> {
        Some(self.light(view, quantity, readings, 1.0)?.0.y)
    }

    /// The colour of a view's readings.
    pub(super) fn colour(&self, view: &View, quantity: Quantity, readings: &[f64], exposure: f64) -> Option<Colour> {
        let (xyz, rgb) = self.light(view, quantity, readings, exposure)?;
        let lab = if *self == Self::Channels { rgb.to_lab() } else { xyz.to_lab() };
        let (hex, clipped) = rgb.on_screen();
        Some(Colour { xyz, lab, hex, clipped })
    }

    fn light(&self, view: &View, quantity: Quantity, readings: &[f64], exposure: f64) -> Option<(Xyz, LinearRgb)> {
        let factor = |reading: &f64| exposure * quantity.reflectance_factor(*reading, &view.geometry);
        let factors: Vec<f64> = readings.iter().map(factor).collect();
        match (self, factors.as_slice()) {
            (Self::Channels, &[blue, green, red]) => {
                let rgb = LinearRgb([red, green, blue]);
                Some((rgb.to_xyz(), rgb))
            }
            (Self::Spectra, factors) => {
                let xyz = Xyz::of_reflectance(&view.wavelengths_nm, factors)?;
                Some((xyz, xyz.to_linear_rgb()))
            }
            (Self::Channels | Self::None(_), _) => None,
        }
    }
}

/// A sentence where a view has too little of the visible spectrum for a colour.
fn why_colourless(view: &View) -> Option<String> {
    let nm = &view.wavelengths_nm;
    let (first, last) = (nm.first()?, nm.last()?);
    let [from, to] = LEAST_WINDOW_NM;
    if *first > from || *last < to {
        return Some(format!(
            "There are no colours: the spectrum {} reaches from {first} to {last} nm, and a colour needs {from} to {to} nm, \
             or three channels in the blue, the green and the red.",
            view.id
        ));
    }
    let visible = nm.windows(2).filter(|pair| pair[1] > from && pair[0] < to);
    let widest = visible.map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
    (widest > WIDEST_STEP_NM).then(|| {
        format!(
            "There are no colours: the spectrum {} has a gap of {widest} nm, and a colour needs steps of at most \
             {WIDEST_STEP_NM} nm.",
            view.id
        )
    })
}
