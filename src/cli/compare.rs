//! `barbule compare FIRST SECOND`

use std::path::{Path, PathBuf};

use anyhow::{Result, bail};
use barbule::compare::compare;
use barbule::measure::photograph::{Encoding, Photograph, PhotographOptions, Region, Regions};
use barbule::report::write_comparison;
use clap::Args;

use super::Ending;
use super::output::{check_writable, print};

/// Compare two pictures: two photographs, or a render and a photograph.
///
/// Writes a page with both side by side, a wipe, the difference (CIEDE2000) of every pixel, its histogram, SSIM and PSNR, and
/// the mean colours of regions. What is clipped or transparent in either picture is left out and counted.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  barbule compare photo.jpg reports/scene/render.png\n  barbule compare a.jpg b.jpg --register --regions patches.csv"
)]
pub(super) struct Compare {
    /// The first picture: JPEG, PNG, TIFF or EXR. Regions count from its upper left corner.
    first: PathBuf,
    /// The second picture.
    second: PathBuf,
    /// Move the second picture over the first, by the shift at which they agree best; scale and turn must be the same.
    #[arg(long)]
    register: bool,
    /// Table of regions of the first picture: `patch`, `x_px`, `y_px`, `width_px`, `height_px`, and `file` if it holds several pictures.
    #[arg(long, value_name = "CSV")]
    regions: Option<PathBuf>,
    /// What the first picture's numbers are, instead of what its file says: srgb or linear.
    #[arg(long, value_parser = encoding)]
    first_encoding: Option<Encoding>,
    /// The same for the second picture.
    #[arg(long, value_parser = encoding)]
    second_encoding: Option<Encoding>,
    /// Folder to write into [default: reports/ and both names].
    #[arg(long)]
    out: Option<PathBuf>,
}

impl Compare {
    pub(super) fn run(self) -> Result<Ending> {
        let read = |path: &Path, encoding| Photograph::read(path, &PhotographOptions { encoding, scale: None });
        let first = read(&self.first, self.first_encoding)?;
        let second = read(&self.second, self.second_encoding)?;
        let regions = match &self.regions {
            None => Vec::new(),
            Some(table) => regions_of(table, &self.first)?,
        };
        let out = self.out.unwrap_or_else(|| {
            let stem = |path: &Path| path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            Path::new("reports").join(format!("{}-and-{}", stem(&self.first), stem(&self.second)))
        });
        check_writable(&out)?;
        let comparison = compare(&first, &second, self.register, &regions)?;
        let page = write_comparison(&comparison, &out)?;
        print(&comparison.answer)?;
        print(&format!("Report: {}", page.display()))?;
        Ok(Ending::Done)
    }
}

/// The regions of a picture; a table that has none for it is most likely another picture's.
fn regions_of(table: &Path, picture: &Path) -> Result<Vec<Region>> {
    let regions = Regions::read(table)?.of(picture);
    if regions.is_empty() {
        bail!(
            "{}: its column `file` names no region of {}; name the first picture there, or leave the cell empty",
            table.display(),
            picture.display()
        );
    }
    Ok(regions)
}

fn encoding(text: &str) -> Result<Encoding, String> {
    match text {
        "srgb" => Ok(Encoding::Srgb),
        "linear" => Ok(Encoding::Linear),
        _ => Err("expected srgb or linear".to_owned()),
    }
}
