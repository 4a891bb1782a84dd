//! From light to reflectance: a patch or a background whose reflectance is known, and exposures by EXIF.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::error::{PhotographError, PhotographProblem};
use super::rectangle::Rectangle;
use super::{Photograph, Validity};
use crate::number::significant;

/// What in a photograph has a known reflectance.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Reference {
    /// A white or grey patch.
    Patch {
        /// Where.
        rectangle: Rectangle,
        /// Its reflectance in all channels, above 0 and at most 1: what is white or grey has no colour.
        reflectance: f64,
    },
    /// All that is not the feather, where it is even and not black.
    Background {
        /// Its reflectance in all channels, above 0 and at most 1.
        reflectance: f64,
    },
    /// Nothing: the exposure is a free parameter of the fit.
    Free,
}

/// What the light of a photograph is multiplied with to become reflectance.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ReferenceGain {
    /// Factor of each channel: reflectance over the reference's mean light. It also takes out the light's colour.
    pub gain: [f64; 3],
    /// Standard deviation over the mean of the reference's pixels, by channel: unevenness, texture and noise.
    pub spread: [f64; 3],
    /// Pixels of the reference that were averaged.
    pub pixels: usize,
    /// Pixels of it that were left out, since they cannot be trusted.
    pub left_out: usize,
}

impl Reference {
    /// The gain of a photograph; None where the exposure is free. `is_background` has one entry a pixel.
    ///
    /// # Errors
    ///
    /// Where the patch reaches out of the picture, a tenth or more of the reference is clipped or transparent (its mean
    /// would be too low), it gives no light, its reflectance is none, or the background is not known.
    pub fn gain(
        &self,
        photograph: &Photograph,
        is_background: Option<&[bool]>,
    ) -> Result<Option<ReferenceGain>, PhotographError> {
        let refused = |reason: String| PhotographError::new(&photograph.file, PhotographProblem::Reference(reason));
        let (reflectance, places): (f64, Vec<usize>) = match self {
            Self::Free => return Ok(None),
            Self::Patch { rectangle, reflectance } => {
                photograph.check(*rectangle)?;
                (*reflectance, rectangle.places(photograph.width).collect())
            }
            Self::Background { reflectance } => {
                let marked =
                    is_background.filter(|marked| marked.len() == photograph.pixels.len()).ok_or_else(|| {
                        refused("is the background, and what is background is not known here; give a patch".into())
                    })?;
                (
                    *reflectance,
                    marked.iter().enumerate().filter(|(_, marked)| **marked).map(|(place, _)| place).collect(),
                )
            }
        };
        if !(reflectance > 0.0 && reflectance <= 1.0) {
            return Err(refused(format!("has the reflectance {reflectance}, expected a number above 0 and at most 1")));
        }
        let trusted: Vec<[f64; 3]> = places
            .iter()
            .filter(|place| photograph.validity[**place] == Validity::Valid)
            .map(|place| photograph.pixels[*place].map(f64::from))
            .collect();
        let left_out = places.len() - trusted.len();
        if left_out * 10 >= places.len() {
            return Err(refused(format!(
                "has {} pixels, of which {left_out} are clipped, transparent or no numbers; give a place where fewer than a tenth are",
                places.len()
            )));
        }
        let [red, green, blue] = [0, 1, 2].map(|channel| mean_and_spread(&trusted, channel));
        let means = [red.0, green.0, blue.0];
        if means.iter().any(|mean| *mean <= 0.0) {
            return Err(refused("is black in a channel; give a place that is white or grey".into()));
        }
        Ok(Some(ReferenceGain {
            gain: means.map(|mean| reflectance / mean),
            spread: [red.1, green.1, blue.1],
            pixels: trusted.len(),
            left_out,
        }))
    }
}

impl Photograph {
    /// The photograph with each channel multiplied, as by the gain of a reference.
    #[must_use]
    pub fn scaled(mut self, gain: [f64; 3]) -> Self {
        #[expect(clippy::cast_possible_truncation, reason = "a picture holds 32-bit numbers")]
        for pixel in &mut self.pixels {
            *pixel = std::array::from_fn(|channel| (f64::from(pixel[channel]) * gain[channel]) as f32);
        }
        let [red, green, blue] = gain.map(|factor| significant(factor, 4));
        self.notes.push(format!("Its channels were multiplied by {red}, {green} and {blue}."));
        self
    }
}

/// Exposure of each photograph over the first one's, from EXIF: time × ISO / N². They hold for one camera with one curve.
///
/// # Errors
///
/// Names the first photograph whose EXIF lacks a part.
pub fn relative_exposures(photographs: &[&Photograph]) -> Result<Vec<f64>, PhotographError> {
    let exposures: Vec<f64> = photographs
        .iter()
        .map(|photograph| {
            photograph.exif.relative_exposure().ok_or_else(|| {
                let problem = PhotographProblem::Exposure(photograph.exif.lacks_for_exposure());
                PhotographError::new(&photograph.file, problem)
            })
        })
        .collect::<Result<_, _>>()?;
    Ok(exposures.iter().map(|exposure| exposure / exposures[0]).collect())
}

/// Mean of a channel, and its standard deviation over it.
#[expect(clippy::cast_precision_loss, reason = "a count of pixels is far below 2^53")]
fn mean_and_spread(pixels: &[[f64; 3]], channel: usize) -> (f64, f64) {
    let count = pixels.len() as f64;
    let mean = pixels.iter().map(|pixel| pixel[channel]).sum::<f64>() / count;
    let variance = pixels.iter().map(|pixel| (pixel[channel] - mean).powi(2)).sum::<f64>() / count;
    (mean, variance.sqrt() / mean)
}
