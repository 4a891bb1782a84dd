//! Two pictures of one thing against each other: two photographs, or a render and a photograph.
//!
//! Colours are compared as eyes judge them (CIEDE2000 of every pixel), structure by SSIM, codes by PSNR, and named regions
//! by their mean light. What cannot be trusted in either picture is left out and counted.

mod pair;
mod register;
mod similarity;

use std::path::PathBuf;

use rayon::prelude::*;
use serde::Serialize;
use thiserror::Error;

use crate::measure::colour::{Lab, LinearRgb};
use crate::measure::photograph::{Photograph, Rectangle, Region, ValidityCounts};
use crate::number::significant;
use pair::Pair;

pub use register::Registration;
pub use similarity::{Similarity, peak_signal_to_noise_db, structural_similarity};

/// Why two pictures cannot be compared.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum CompareError {
    /// Their sizes differ, and they were said to be aligned.
    #[error(
        "{} has {} × {} pixels and {} has {} × {}; to compare them pixel by pixel they must be alike: scale or cut one, or have them registered (--register), which moves one over the other",
        first.0.display(), first.1, first.2, second.0.display(), second.1, second.2
    )]
    Sizes {
        /// File, pixels a row and rows of the first.
        first: (PathBuf, usize, usize),
        /// The same of the second.
        second: (PathBuf, usize, usize),
    },
    /// No place was found where one looks like the other.
    #[error(
        "the pictures could not be laid over each other: {0}; cut them to what both show at one scale, or compare them as they lie"
    )]
    NotRegistered(String),
    /// Nothing left.
    #[error("no pixel can be trusted in both pictures ({0}); nothing is left to compare")]
    Nothing(String),
    /// A region that reaches out of what both show.
    #[error(
        "the region {name} ({rectangle}) reaches out of the first picture, which has {width} × {height} pixels; correct it"
    )]
    Region {
        /// Its name.
        name: String,
        /// Where it was said to be.
        rectangle: Rectangle,
        /// Pixels a row of the first picture.
        width: usize,
        /// Rows of it.
        height: usize,
    },
}

/// Where a picture comes from, as far as its file tells.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum PictureKind {
    /// Barbule wrote it as a photograph with known truth.
    SyntheticPhotograph,
    /// A camera wrote how it exposed.
    CameraPhotograph,
    /// Linear numbers, as renders and developed raw files are.
    LinearNumbers,
    /// The file does not tell.
    Unknown,
}

impl PictureKind {
    /// What the file tells.
    pub fn of(photograph: &Photograph) -> Self {
        if photograph.is_synthetic() {
            Self::SyntheticPhotograph
        } else if photograph.exif.exposure_time_s.is_some() {
            Self::CameraPhotograph
        } else if photograph.format == "EXR" {
            Self::LinearNumbers
        } else {
            Self::Unknown
        }
    }

    /// The kind in words.
    pub fn text(self) -> &'static str {
        match self {
            Self::SyntheticPhotograph => "synthetic photograph, made by Barbule",
            Self::CameraPhotograph => "photograph by a camera, which wrote how it exposed",
            Self::LinearNumbers => "linear numbers, as a render or a developed raw file has",
            Self::Unknown => "picture whose file does not tell whether it is a photograph or a render",
        }
    }
}

/// What is kept of a picture.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PictureFacts {
    /// Its file.
    pub file: PathBuf,
    /// Where it comes from.
    pub kind: PictureKind,
    /// SHA-256 of the file.
    pub sha256: String,
    /// Size of the file in bytes.
    pub bytes: u64,
    /// Format by its first bytes.
    pub format: &'static str,
    /// Pixels a row, upright.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// How its codes became light.
    pub coding: String,
    /// What was assumed.
    pub notes: Vec<String>,
    /// How many of its pixels can be trusted.
    pub counts: ValidityCounts,
}

/// ΔE₀₀ over all pixels that were compared.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DifferenceSummary {
    /// Half of all pixels differ by less.
    pub median: f64,
    /// Mean.
    pub mean: f64,
    /// 95 % of all pixels differ by less.
    pub percentile_95: f64,
    /// Largest.
    pub largest: f64,
}

/// The mean colours of a region.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RegionColours {
    /// Its name.
    pub name: String,
    /// Where it lies in the first picture.
    pub rectangle: Rectangle,
    /// Mean linear light in the first picture and in the second; none where no pixel of it was compared.
    pub light: Option<[[f64; 3]; 2]>,
    /// ΔE₀₀ between the two means.
    pub difference: Option<f64>,
    /// Pixels of it that were compared.
    pub pixels: usize,
    /// Pixels of it that were left out.
    pub left_out: usize,
}

impl RegionColours {
    /// CIELAB of both means.
    pub fn lab(&self) -> Option<[Lab; 2]> {
        self.light.map(|both| both.map(|light| LinearRgb(light).to_lab()))
    }
}

/// What came of a comparison.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// The first picture.
    pub first: PictureFacts,
    /// The second.
    pub second: PictureFacts,
    /// How the second was moved over the first; none where they were taken as they lie.
    pub registration: Option<Registration>,
    /// Where the compared part lies in the first picture.
    pub part: Rectangle,
    /// Pixels that were compared.
    pub compared: usize,
    /// Pixels of the part that were left out, since one of the pictures cannot be trusted there.
    pub left_out: usize,
    /// ΔE₀₀ over the pixels.
    pub difference: DifferenceSummary,
    /// Structural similarity; none where no whole window can be trusted.
    pub similarity: Option<Similarity>,
    /// Peak signal to noise ratio in dB; none where the pictures are equal.
    pub psnr_db: Option<f64>,
    /// Mean colours of the regions.
    pub regions: Vec<RegionColours>,
    /// The answer in sentences.
    pub answer: String,
    /// The part of both pictures and their difference, pixel by pixel.
    #[serde(skip)]
    pub pixels: ComparedPixels,
}

/// The compared part, pixel by pixel, in rows from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct ComparedPixels {
    /// Pixels a row.
    pub width: usize,
    /// Linear light in the first picture and in the second.
    pub light: [Vec<[f32; 3]>; 2],
    /// ΔE₀₀; none where one of them cannot be trusted.
    pub difference: Vec<Option<f32>>,
}

/// Compares two pictures, pixel by pixel as they lie, or after moving the second over the first.
///
/// # Errors
///
/// Where sizes differ and the pictures are not to be registered, no place is found where they agree, no pixel can be trusted in
/// both, or a region reaches out of the first picture.
pub fn compare(
    first: &Photograph,
    second: &Photograph,
    to_register: bool,
    regions: &[Region],
) -> Result<Comparison, CompareError> {
    if let Some(region) = regions.iter().find(|region| !region.rectangle.lies_in(first.width, first.height)) {
        return Err(CompareError::Region {
            name: region.name.clone(),
            rectangle: region.rectangle,
            width: first.width,
            height: first.height,
        });
    }
    let registration = to_register.then(|| register::register(first, second)).transpose()?;
    let pair = Pair::new(first, second, registration.as_ref())?;
    let difference: Vec<Option<f32>> = (0..pair.len())
        .into_par_iter()
        .map(|place| {
            let lab = |light: [f32; 3]| LinearRgb(light.map(f64::from)).to_lab();
            let [one, other] = pair.light.each_ref().map(|light| lab(light[place]));
            #[expect(clippy::cast_possible_truncation, reason = "for a map and its quantiles")]
            pair.is_trusted[place].then(|| one.delta_e_2000(other) as f32)
        })
        .collect();
    let summary = summary(&difference).ok_or_else(|| CompareError::Nothing(why_nothing(first, second)))?;
    let compared = difference.iter().flatten().count();
    let similarity = structural_similarity(&pair.codes, pair.part.width_px, &pair.is_trusted);
    let psnr_db = peak_signal_to_noise_db(&pair.light, &pair.is_trusted);
    let regions = regions.iter().map(|region| pair.region(region)).collect();
    let comparison = Comparison {
        first: facts(first),
        second: facts(second),
        answer: answer(&summary, similarity.as_ref(), psnr_db, registration.as_ref(), (compared, pair.len())),
        registration,
        part: pair.part,
        compared,
        left_out: pair.len() - compared,
        difference: summary,
        similarity,
        psnr_db,
        regions,
        pixels: ComparedPixels { width: pair.part.width_px, light: pair.light, difference },
    };
    Ok(comparison)
}

fn facts(photograph: &Photograph) -> PictureFacts {
    PictureFacts {
        file: photograph.file.clone(),
        kind: PictureKind::of(photograph),
        sha256: photograph.sha256.clone(),
        bytes: photograph.bytes,
        format: photograph.format,
        width: photograph.width,
        height: photograph.height,
        coding: photograph.coding.clone(),
        notes: photograph.notes.clone(),
        counts: photograph.counts(),
    }
}

fn why_nothing(first: &Photograph, second: &Photograph) -> String {
    let of = |photograph: &Photograph| {
        let counts = photograph.counts();
        format!(
            "{}: {} clipped, {} transparent, {} no numbers of {}",
            photograph.file.display(),
            counts.clipped,
            counts.transparent,
            counts.not_a_number,
            photograph.pixels.len()
        )
    };
    format!("{}; {}", of(first), of(second))
}

/// Quantiles of what was compared; None where nothing was.
#[expect(clippy::cast_precision_loss, reason = "a count of pixels is far below 2^53")]
fn summary(difference: &[Option<f32>]) -> Option<DifferenceSummary> {
    let mut sorted: Vec<f32> = difference.iter().flatten().copied().collect();
    sorted.par_sort_unstable_by(f32::total_cmp);
    let largest = *sorted.last()?;
    let mean = sorted.iter().map(|value| f64::from(*value)).sum::<f64>() / sorted.len() as f64;
    // The smallest value that is at least as large as this share of all.
    let quantile = |percent: usize| f64::from(sorted[(sorted.len() * percent).div_ceil(100).max(1) - 1]);
    Some(DifferenceSummary { median: quantile(50), mean, percentile_95: quantile(95), largest: largest.into() })
}

fn answer(
    difference: &DifferenceSummary,
    similarity: Option<&Similarity>,
    psnr_db: Option<f64>,
    registration: Option<&Registration>,
    (compared, all): (usize, usize),
) -> String {
    let mut sentences = vec![if difference.largest == 0.0 {
        "The two pictures do not differ.".to_owned()
    } else {
        format!(
            "Half of the pixels differ by less than ΔE2000 {}, 95 % by less than {}; the largest difference is {}.",
            significant(difference.median, 3),
            significant(difference.percentile_95, 3),
            significant(difference.largest, 3)
        )
    }];
    let structure = similarity.map(|similarity| format!("SSIM is {}", significant(similarity.mean, 4)));
    let noise = psnr_db.map(|decibel| format!("PSNR {} dB", significant(decibel, 3)));
    let measures: Vec<String> = structure.into_iter().chain(noise).collect();
    if !measures.is_empty() {
        sentences.push(format!("{}.", measures.join(", ")));
    }
    if let Some(registration) = registration {
        sentences.push(registration.sentence());
    }
    if compared < all {
        sentences.push(format!(
            "{} of {all} pixels were left out, since one of the pictures cannot be trusted there.",
            all - compared
        ));
    }
    sentences.join(" ")
}
