//! From the codes in a file to linear light of the Rec. 709 primaries.

use moxcms::{ColorProfile, DataColorSpace, ToneCurveEvaluator, ToneReprCurve};
use nalgebra::{Matrix3, Vector3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::error::PhotographProblem;
use super::exif_facts::ExifColourSpace;
use crate::measure::colour::decode;
use crate::number::significant;

/// What the numbers of a picture are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Encoding {
    /// Coded for screens.
    Srgb,
    /// Proportional to what they stand for.
    Linear,
}

/// What a file says of its colours.
#[derive(Debug, Default)]
pub(super) struct ColourFacts {
    pub(super) icc_profile: Option<Vec<u8>>,
    /// Exponent that a PNG's gAMA chunk means: light = code^exponent.
    pub(super) exponent: Option<f64>,
    /// Chromaticities of white, red, green and blue in a PNG's cHRM chunk.
    pub(super) chromaticities: Option<[[f64; 2]; 4]>,
    /// A PNG's sRGB chunk.
    pub(super) says_srgb: bool,
    /// A PNG's cICP chunk, which is not applied.
    pub(super) has_code_points: bool,
    pub(super) exif: Option<ExifColourSpace>,
    /// Whether its numbers are floating.
    pub(super) is_float: bool,
    /// Whether it has one channel instead of three.
    pub(super) is_grey: bool,
}

/// How codes become light.
pub(super) struct Coding {
    curves: Curves,
    /// From the picture's primaries to those of Rec. 709; none where they are the same.
    pub(super) matrix: Option<[[f64; 3]; 3]>,
    /// One sentence that says which curve and primaries were taken.
    pub(super) sentence: String,
}

enum Curves {
    Srgb,
    Linear,
    Power(f64),
    Profile([Box<dyn ToneCurveEvaluator + Send + Sync>; 3]),
}

/// Chromaticities of Rec. 709 and of D65, in the order of a cHRM chunk.
const REC_709: [[f64; 2]; 4] = [[0.3127, 0.3290], [0.64, 0.33], [0.30, 0.60], [0.15, 0.06]];

impl Coding {
    /// What the file says, unless the user said otherwise; what had to be guessed goes to `notes`.
    ///
    /// The first of these counts: the user's word, an ICC profile, a PNG's sRGB chunk, its gAMA and cHRM chunks, EXIF.
    pub(super) fn of(
        facts: &ColourFacts,
        asked: Option<Encoding>,
        notes: &mut Vec<String>,
    ) -> Result<Self, PhotographProblem> {
        if facts.has_code_points && facts.icc_profile.is_none() {
            notes.push("Its cICP chunk is not applied.".into());
        }
        if let Some(encoding) = asked {
            if facts.icc_profile.is_some() {
                notes.push("Its ICC profile was set aside, since the encoding was given.".into());
            }
            return Ok(match encoding {
                Encoding::Srgb => Self::plain(Curves::Srgb, "Codes were read as sRGB, as was asked."),
                Encoding::Linear => Self::plain(
                    Curves::Linear,
                    "Codes were read as linear light of the Rec. 709 primaries, as was asked.",
                ),
            });
        }
        if let Some(profile) = &facts.icc_profile {
            return Self::of_profile(profile, facts.is_grey);
        }
        if facts.is_float {
            notes.push(
                "It names no colour space; its numbers were taken as linear light of the Rec. 709 primaries.".into(),
            );
            return Ok(Self::plain(Curves::Linear, "Numbers were read as linear light."));
        }
        if facts.says_srgb {
            return Ok(Self::plain(Curves::Srgb, "The file says that it is sRGB."));
        }
        if facts.exponent.is_some() || facts.chromaticities.is_some() {
            return Self::of_chunks(facts, notes);
        }
        match facts.exif {
            Some(ExifColourSpace::Srgb) => Ok(Self::plain(Curves::Srgb, "No colour profile; EXIF says sRGB.")),
            Some(ExifColourSpace::AdobeRgb) => {
                let mut coding = Self::of_matrix_profile(&ColorProfile::new_adobe_rgb())?;
                coding.sentence = "No colour profile; EXIF says Adobe RGB (interoperability index R03).".into();
                Ok(coding)
            }
            Some(ExifColourSpace::Uncalibrated) => {
                notes.push(
                    "No colour profile, and EXIF says that the colours are uncalibrated: they were taken as sRGB."
                        .into(),
                );
                Ok(Self::plain(Curves::Srgb, "Codes were read as sRGB."))
            }
            None => {
                notes.push("Nothing in the file says what its colours mean: they were taken as sRGB.".into());
                Ok(Self::plain(Curves::Srgb, "Codes were read as sRGB."))
            }
        }
    }

    fn plain(curves: Curves, sentence: &str) -> Self {
        Self { curves, matrix: None, sentence: sentence.to_owned() }
    }

    fn of_profile(bytes: &[u8], is_grey: bool) -> Result<Self, PhotographProblem> {
        let profile = ColorProfile::new_from_slice(bytes)
            .map_err(|error| PhotographProblem::Profile(format!("cannot be read ({error:?})")))?;
        let name = description(&profile).map(|name| format!(" \"{name}\"")).unwrap_or_default();
        let mut coding = match (profile.color_space, is_grey) {
            (DataColorSpace::Gray, true) => {
                let curve = || evaluator(profile.gray_trc.as_ref());
                Self { curves: Curves::Profile([curve()?, curve()?, curve()?]), matrix: None, sentence: String::new() }
            }
            (DataColorSpace::Rgb, false) => Self::of_matrix_profile(&profile)?,
            (space, _) => {
                let channels = if is_grey { "one channel" } else { "three channels" };
                let reason = format!("is for {space:?} colours, and the picture has {channels}");
                return Err(PhotographProblem::Profile(reason));
            }
        };
        coding.sentence = format!("Its ICC profile{name} was applied.");
        Ok(coding)
    }

    /// The model of three curves and a matrix (ICC.1:2022, annex F.3). The profile's white becomes Rec. 709's: both are
    /// adapted to D50 by their profiles.
    fn of_matrix_profile(profile: &ColorProfile) -> Result<Self, PhotographProblem> {
        if !profile.is_matrix_shaper() {
            return Err(PhotographProblem::Profile("is made of tables instead of three curves and a matrix".into()));
        }
        let curves = [&profile.red_trc, &profile.green_trc, &profile.blue_trc].map(|curve| evaluator(curve.as_ref()));
        let [red, green, blue] = curves;
        let matrix = profile.transform_matrix(&ColorProfile::new_srgb()).v;
        if matrix.iter().flatten().any(|number| !number.is_finite()) {
            return Err(PhotographProblem::Profile("has a matrix that is none".into()));
        }
        Ok(Self { curves: Curves::Profile([red?, green?, blue?]), matrix: Some(matrix), sentence: String::new() })
    }

    fn of_chunks(facts: &ColourFacts, notes: &mut Vec<String>) -> Result<Self, PhotographProblem> {
        let curves = match facts.exponent {
            Some(exponent) => Curves::Power(exponent),
            None => {
                notes.push("It names its primaries (cHRM) and not its curve: sRGB's was taken.".into());
                Curves::Srgb
            }
        };
        let curve = match &curves {
            Curves::Power(exponent) => format!("the power {} (gAMA)", significant(*exponent, 4)),
            _ => "sRGB's curve".to_owned(),
        };
        let matrix = match facts.chromaticities {
            Some(points) if !agree(points, REC_709) => Some(matrix_of(points)?),
            Some(_) => None,
            None => {
                notes.push("It names its curve (gAMA) and not its primaries: those of Rec. 709 were taken.".into());
                None
            }
        };
        let primaries = if matrix.is_some() { "the primaries of its cHRM chunk" } else { "the primaries of Rec. 709" };
        Ok(Self { curves, matrix, sentence: format!("Codes were read by {curve} with {primaries}.") })
    }

    /// Whether codes are light already.
    pub(super) fn is_linear(&self) -> bool {
        matches!(self.curves, Curves::Linear)
    }

    /// Light that a code of a channel (0, 1, 2) means, before the matrix; codes of integers run from 0 to 1.
    #[expect(clippy::cast_possible_truncation, reason = "pictures hold 32-bit numbers")]
    pub(super) fn light(&self, channel: usize, code: f64) -> f64 {
        match &self.curves {
            Curves::Srgb => decode(code),
            Curves::Linear => code,
            Curves::Power(exponent) => code.abs().powf(*exponent).copysign(code),
            Curves::Profile(curves) => curves[channel].evaluate_value(code as f32).into(),
        }
    }
}

fn evaluator(curve: Option<&ToneReprCurve>) -> Result<Box<dyn ToneCurveEvaluator + Send + Sync>, PhotographProblem> {
    let curve = curve.ok_or_else(|| PhotographProblem::Profile("has no tone curve".into()))?;
    curve.make_linear_evaluator().map_err(|_| PhotographProblem::Profile("has a tone curve that is none".into()))
}

/// The profile's name for people, in any language.
fn description(profile: &ColorProfile) -> Option<String> {
    let name = match profile.description.as_ref()? {
        moxcms::ProfileText::PlainString(text) => text.clone(),
        moxcms::ProfileText::Localizable(texts) => texts.first()?.value.clone(),
        moxcms::ProfileText::Description(text) => text.ascii_string.clone(),
    };
    let name: String = name.chars().filter(|c| !c.is_control()).take(100).collect();
    (!name.trim().is_empty()).then(|| name.trim().to_owned())
}

/// Whether chromaticities are the same but for rounding: files carry five decimals, standards three or four.
fn agree(some: [[f64; 2]; 4], others: [[f64; 2]; 4]) -> bool {
    some.iter().flatten().zip(others.iter().flatten()).all(|(a, b)| (a - b).abs() < 1e-3)
}

/// The cone responses in which white is adapted (Bradford; Lam 1985, as in ICC.1:2022, annex E).
const CONES: Matrix3<f64> = Matrix3::new(0.8951, 0.2664, -0.1614, -0.7502, 1.7135, 0.0367, 0.0389, -0.0685, 1.0296);

/// From primaries of these chromaticities to those of Rec. 709, white to white.
fn matrix_of(points: [[f64; 2]; 4]) -> Result<[[f64; 3]; 3], PhotographProblem> {
    let made = || {
        let adapted = {
            let [own, rec_709] = [points[0], REC_709[0]].map(|white| CONES * of_luminance_1(white));
            CONES.try_inverse()? * Matrix3::from_diagonal(&rec_709.component_div(&own)) * CONES
        };
        let matrix = to_xyz(REC_709)?.try_inverse()? * adapted * to_xyz(points)?;
        matrix.iter().all(|number| number.is_finite()).then_some(matrix)
    };
    let matrix = made().ok_or_else(|| {
        let detail = "the colours of its cHRM chunk span no space".to_owned();
        PhotographProblem::Damaged { format: "PNG", detail }
    })?;
    Ok([0, 1, 2].map(|row| [0, 1, 2].map(|column| matrix[(row, column)])))
}

/// From RGB of these primaries to XYZ: the columns are the primaries, scaled so that their sum is the white.
fn to_xyz([white, red, green, blue]: [[f64; 2]; 4]) -> Option<Matrix3<f64>> {
    let primaries = Matrix3::from_columns(&[red, green, blue].map(of_luminance_1));
    let scale = primaries.try_inverse()? * of_luminance_1(white);
    Some(primaries * Matrix3::from_diagonal(&scale))
}

/// XYZ of a chromaticity, Y being 1.
fn of_luminance_1([x, y]: [f64; 2]) -> Vector3<f64> {
    Vector3::new(x / y, 1.0, (1.0 - x - y) / y)
}
