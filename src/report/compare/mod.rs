//! The report of a comparison of two pictures.
//!
//! ```text
//! index.html          the page: answer, wipe, side by side, differences, regions
//! comparison.json     every number, and what kind of picture each was
//! first.png, second.png, side-by-side.png, difference.png    the compared part
//! regions.csv         mean colours of the regions
//! plots/, curves/     the histogram and the scale of differences, as in the report of a fit
//! ```

mod figures;
mod page;
mod pictures;

use std::path::{Path, PathBuf};

use super::{Picture, ReportError, files, write_pictures};
use crate::compare::{Comparison, RegionColours};
use crate::measure::colour::LinearRgb;

/// Writes the report of a comparison into `folder`, which is made where it is missing, and returns the path of its page.
///
/// Each file is written under a temporary name and then renamed, the page last.
///
/// # Errors
///
/// If a file cannot be written.
pub fn write_comparison(comparison: &Comparison, folder: &Path) -> Result<PathBuf, ReportError> {
    let high = figures::scale_end(comparison);
    let scale = Picture::paint(figures::scale(high))?;
    let histogram = Picture::paint(figures::histogram(comparison))?;
    let shown = pictures::Shown::new(comparison, high, &scale)?;
    let json = serde_json::to_string_pretty(comparison).map_err(|error| ReportError::Page(error.to_string()))?;
    for (name, bytes) in [
        ("comparison.json", (json + "\n").as_bytes()),
        ("first.png", &shown.first),
        ("second.png", &shown.second),
        ("side-by-side.png", &shown.side_by_side),
        ("difference.png", &shown.difference),
    ] {
        files::write(&folder.join(name), bytes)?;
    }
    if !comparison.regions.is_empty() {
        let text = regions_csv(&comparison.regions).map_err(|error| ReportError::Page(error.to_string()))?;
        files::write(&folder.join("regions.csv"), &text)?;
    }
    write_pictures([&scale, &histogram].into_iter(), folder)?;
    let page = folder.join("index.html");
    files::write(&page, page::html(comparison, &shown, [&scale, &histogram])?.as_bytes())?;
    Ok(page)
}

/// One row a region; cells stay empty where no pixel of it was compared.
fn regions_csv(regions: &[RegionColours]) -> Result<Vec<u8>, csv::Error> {
    let mut table = csv::Writer::from_writer(Vec::new());
    let mut header: Vec<String> =
        ["region", "x_px", "y_px", "width_px", "height_px", "pixels", "left_out", "delta_e_2000"]
            .map(str::to_owned)
            .into();
    for which in ["first", "second"] {
        header.extend(["red", "green", "blue"].map(|channel| format!("{which}_linear_{channel}")));
        header.extend(["l", "a", "b"].map(|axis| format!("{which}_lab_{axis}")));
        header.push(format!("{which}_srgb"));
    }
    table.write_record(&header)?;
    for region in regions {
        let at = region.rectangle;
        let mut row = vec![region.name.clone()];
        let counts = [at.x_px, at.y_px, at.width_px, at.height_px, region.pixels, region.left_out];
        row.extend(counts.map(|count| count.to_string()));
        row.push(region.difference.map(|difference| difference.to_string()).unwrap_or_default());
        match region.light {
            None => row.resize(header.len(), String::new()),
            Some(both) => {
                for light in both.map(LinearRgb) {
                    let lab = light.to_lab();
                    row.extend(light.0.map(|channel| channel.to_string()));
                    row.extend([lab.l, lab.a, lab.b].map(|axis| axis.to_string()));
                    row.push(light.on_screen().0);
                }
            }
        }
        table.write_record(&row)?;
    }
    table.into_inner().map_err(|error| error.into_error().into())
}
