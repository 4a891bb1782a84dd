//! `barbule geometry FEATHER.json`

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use barbule::geometry::{Feather, FeatherMap, GeometrySummary, Preview, VaneSummary};
use barbule::report::write_file;
use clap::Args;

use super::Ending;
use super::output::{check_writable, print};

/// Draw a feather from its shaft, its outlines and its barbs.
///
/// Writes map.png (class, tangent and coverage of each texel, for rendering), preview.svg (for people), barbs.csv (every
/// barb as a polyline) and geometry.json (lengths, counts and area shares).
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  barbule geometry fits/feather-primary\n  barbule geometry fits/feather-primary --pixels-per-mm 20 --out primary"
)]
pub(super) struct Geometry {
    /// The feather: its JSON file, or a folder with a feather.json in it.
    feather: PathBuf,
    /// Folder to write into [default: reports/ and the feather's name].
    #[arg(long)]
    out: Option<PathBuf>,
    /// Resolution of the map, rounded to thousandths [default: so that its longer side has 2048 texels].
    #[arg(long, allow_negative_numbers = true)]
    pixels_per_mm: Option<f64>,
    /// Show in the preview how each barb was made: its chord and its control points.
    #[arg(long)]
    construction: bool,
}

impl Geometry {
    pub(super) fn run(self) -> Result<Ending> {
        let feather = Feather::read(&self.feather)?;
        let out = self.out.unwrap_or_else(|| Path::new("reports").join(name(&self.feather)));
        check_writable(&out)?;

        let map = FeatherMap::of(&feather, self.pixels_per_mm)?;
        let summary = GeometrySummary::new(&feather, &map);
        let preview = if self.construction { Preview::Construction } else { Preview::Feather };

        let summary_text = serde_json::to_string_pretty(&summary).context("the summary could not be written down")?;
        for (file, bytes) in [
            ("map.png", map.png().context("the map could not be written down")?),
            ("preview.svg", feather.svg(preview).into_bytes()),
            ("barbs.csv", feather.barbs_csv().into_bytes()),
            ("geometry.json", (summary_text + "\n").into_bytes()),
        ] {
            write_file(&out.join(file), &bytes)?;
        }
        print(&told(&summary))?;
        print(&format!("{}", out.join("map.png").display()))?;
        Ok(Ending::Done)
    }
}

/// The folder's name, or the file's without its ending.
fn name(path: &Path) -> String {
    let folder = path.is_dir().then(|| path.canonicalize().unwrap_or_else(|_| path.to_owned()));
    let name = folder.as_deref().map_or_else(|| path.file_stem(), Path::file_name);
    name.map_or_else(|| "feather".into(), |name| name.to_string_lossy().into_owned())
}

fn told(summary: &GeometrySummary) -> String {
    let vane = |name: &str, vane: &VaneSummary| {
        format!(
            "{name} vane: {} barbs, {:.2} mm long on average, {:.0} µm apart, covering {:.1} % of it{}",
            vane.barb_count,
            vane.mean_barb_length_mm,
            vane.barb_spacing_um,
            100.0 * vane.barb_share,
            match vane.clipped_barb_count {
                0 => String::new(),
                count => format!("; {count} cut where they bulge out of it"),
            }
        )
    };
    let map = &summary.map;
    format!(
        "{}\nshaft: {:.2} mm, of which calamus {:.2} mm\n{}\n{}\nmap: {} × {} texels, {} a millimetre",
        summary.title,
        summary.shaft_length_mm,
        summary.calamus_length_mm,
        vane("left", &summary.left_vane),
        vane("right", &summary.right_vane),
        map.width,
        map.height,
        map.pixels_per_mm
    )
}
