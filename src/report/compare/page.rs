//! The page of a comparison: what stands where.

use askama::Template;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::pictures::Shown;
use crate::compare::{Comparison, PictureFacts};
use crate::measure::colour::{Lab, LinearRgb};
use crate::number::{count, significant, to_place};
use crate::report::page::FigureView;
use crate::report::{Picture, ReportError};

/// The page as HTML.
pub(super) fn html(
    comparison: &Comparison,
    shown: &Shown,
    [scale, histogram]: [&Picture; 2],
) -> Result<String, ReportError> {
    let page = Page {
        comparison,
        version: env!("CARGO_PKG_VERSION"),
        first: STANDARD.encode(&shown.first),
        second: STANDARD.encode(&shown.second),
        map: STANDARD.encode(&shown.map),
        scale: FigureView::new(scale),
        histogram: FigureView::new(histogram),
        pictures: [("First", &comparison.first), ("Second", &comparison.second)]
            .map(|(place, facts)| row_of(place, facts)),
        measures: measures(comparison),
        regions: regions(comparison),
    };
    page.render().map_err(|error| ReportError::Page(error.to_string()))
}

#[derive(Template)]
#[template(path = "compare.html")]
struct Page<'a> {
    comparison: &'a Comparison,
    version: &'a str,
    /// PNG files in base64.
    first: String,
    second: String,
    map: String,
    scale: FigureView<'a>,
    histogram: FigureView<'a>,
    pictures: [PictureRow; 2],
    /// Name and value.
    measures: Vec<(&'static str, String)>,
    regions: Vec<RegionRow>,
}

struct PictureRow {
    place: &'static str,
    file: String,
    kind: &'static str,
    size: String,
    trusted: String,
    sentences: Vec<String>,
    sha256: String,
}

struct RegionRow {
    name: String,
    pixels: String,
    /// Swatch and CIELAB of either picture; none where no pixel was compared.
    colours: Option<[(String, String); 2]>,
    difference: String,
}

fn row_of(place: &'static str, facts: &PictureFacts) -> PictureRow {
    let counts = facts.counts;
    let mut left_out = Vec::new();
    for (number, what) in
        [(counts.clipped, "clipped"), (counts.transparent, "transparent"), (counts.not_a_number, "no numbers")]
    {
        if number > 0 {
            left_out.push(format!("{} {what}", count(number as u64)));
        }
    }
    let trusted = if left_out.is_empty() { "all".to_owned() } else { format!("all but {}", left_out.join(", ")) };
    PictureRow {
        place,
        file: facts.file.display().to_string(),
        kind: facts.kind.text(),
        size: format!("{} × {}", facts.width, facts.height),
        trusted,
        sentences: std::iter::once(&facts.coding).chain(&facts.notes).cloned().collect(),
        sha256: facts.sha256.clone(),
    }
}

fn measures(comparison: &Comparison) -> Vec<(&'static str, String)> {
    let difference = &comparison.difference;
    let mut rows = vec![
        ("ΔE2000, median", significant(difference.median, 3)),
        ("ΔE2000, mean", significant(difference.mean, 3)),
        ("ΔE2000, 95 % of pixels below", significant(difference.percentile_95, 3)),
        ("ΔE2000, largest", significant(difference.largest, 3)),
    ];
    rows.push(match &comparison.similarity {
        Some(similarity) => ("SSIM", significant(similarity.mean, 4)),
        None => ("SSIM", "no window of 11 × 11 pixels can be trusted".to_owned()),
    });
    rows.push(match comparison.psnr_db {
        Some(decibel) => ("PSNR", format!("{} dB", significant(decibel, 3))),
        None => ("PSNR", "equal pictures have none".to_owned()),
    });
    rows.push(("Pixels compared", count(comparison.compared as u64)));
    rows.push(("Pixels left out", count(comparison.left_out as u64)));
    rows
}

fn regions(comparison: &Comparison) -> Vec<RegionRow> {
    let lab = |Lab { l, a, b }: Lab| [l, a, b].map(|axis| to_place(axis, -1)).join(", ");
    comparison
        .regions
        .iter()
        .map(|region| RegionRow {
            name: region.name.clone(),
            pixels: match region.left_out {
                0 => count(region.pixels as u64),
                left_out => format!("{}, {} left out", count(region.pixels as u64), count(left_out as u64)),
            },
            colours: region
                .light
                .map(|both| both.map(LinearRgb).map(|light| (light.on_screen().0, lab(light.to_lab())))),
            difference: region.difference.map_or_else(|| "–".to_owned(), |difference| significant(difference, 3)),
        })
        .collect()
}
