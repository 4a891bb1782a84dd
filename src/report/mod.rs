//! The report of a fit, or of a sweep: one folder with a page that answers in its first sentence, its plots and their
//! numbers.
//!
//! ```text
//! index.html      self-contained: styles and plots inside, no script, nothing fetched
//! plots/*.svg     every plot as on the page, and as PNG
//! curves/*.csv    every plotted curve and map
//! ```
//!
//! An [`Outcome`] becomes figures ([`plots`]) and the texts and tables of a page ([`page`]); a figure becomes a picture
//! ([`layout`], [`plot`]) and tables ([`curves`]). Nothing here computes a physical quantity except the colours of
//! swatches. The same outcome gives the same bytes.

mod angles;
mod chart;
mod colour_cells;
mod compare;
mod curves;
mod disc;
mod files;
mod frame;
mod layout;
mod map;
mod methods;
mod page;
mod palette;
mod plot;
mod plots;
mod readings;
mod specimens;
mod swatch;
mod sweep;
mod tables;
mod ticks;

use std::io;
use std::path::{Path, PathBuf};

use crate::job::{Case, Lobes, Outcome};
use chart::Figure;
use plots::Place;

pub use compare::write_comparison;
pub use files::write as write_file;
pub use sweep::write_sweep;

/// Why a report could not be written.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// A file or folder could not be written.
    #[error("cannot write {}: {}. Check that the folder may be written to and that the disk has room.", path.display(), files::reason(source))]
    Write {
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A plot could not be painted.
    #[error("the plot `{figure}` could not be painted: {text}")]
    Paint {
        /// The plot's file name without extension.
        figure: String,
        /// What the painter said.
        text: String,
    },
    /// The page could not be put together.
    #[error("the page could not be put together: {0}")]
    Page(String),
}

/// Writes the report into `folder`, which is made where it is missing, and returns the path of its page.
///
/// Each file is written under a temporary name and then renamed, the page last: a run that is killed leaves old files or
/// new ones, never half of one. Files of an earlier report that the new one does not have stay where they are.
///
/// # Errors
///
/// If a file cannot be written. No outcome is refused: what it lacks is left out of the page.
pub fn write_report(outcome: &Outcome, folder: &Path) -> Result<PathBuf, ReportError> {
    let chapters: Vec<Chapter> =
        outcome.cases.iter().enumerate().map(|(index, _)| Chapter::draw(outcome, index)).collect::<Result<_, _>>()?;
    write_pictures(chapters.iter().flat_map(|chapter| &chapter.pictures).map(|(_, picture)| picture), folder)?;
    let page = folder.join("index.html");
    files::write(&page, page::html(outcome, &chapters)?.as_bytes())?;
    Ok(page)
}

/// Writes each picture as SVG and PNG, and its numbers beside them.
fn write_pictures<'a>(pictures: impl Iterator<Item = &'a Picture>, folder: &Path) -> Result<(), ReportError> {
    for picture in pictures {
        picture.write(folder)?;
    }
    Ok(())
}

/// Draws a model's lobes at some settings of its parameters into `folder`, as `plots/<name>-….png` and `.svg` with the numbers
/// in `curves/`, and returns the paths of the PNG files.
///
/// # Errors
///
/// If a file cannot be written.
pub fn write_lobes(name: &str, settings: &[(String, Lobes)], folder: &Path) -> Result<Vec<PathBuf>, ReportError> {
    let draw = |mut figure: Figure| {
        figure.name = format!("{name}-{}", figure.name);
        figure.title = format!("{name} · {}", figure.title);
        Picture::paint(figure)?.write(folder)
    };
    plots::lobes::figures(settings).into_iter().map(draw).collect()
}

/// The pictures of one case, each with its place on the page.
struct Chapter<'a> {
    case: &'a Case,
    pictures: Vec<(Place, Picture)>,
}

/// A figure, painted.
struct Picture {
    figure: Figure,
    svg: String,
    png: Vec<u8>,
    tables: Vec<curves::CurveTable>,
}

impl<'a> Chapter<'a> {
    fn draw(outcome: &'a Outcome, index: usize) -> Result<Self, ReportError> {
        let case = &outcome.cases[index];
        let figures = plots::ALL.iter().flat_map(|plot| (plot.draw)(case).into_iter().map(|f| (plot.place, f)));
        let pictures = figures
            .map(|(place, mut figure)| {
                // A plot may leave its page: its file and its title then say whose it is.
                if outcome.cases.len() > 1 {
                    figure.name = format!("case-{}-{}", index + 1, figure.name);
                    figure.title = format!("{} · {}", figure.title, case.name);
                }
                if outcome.synthetic.is_some() {
                    figure.title = format!("Synthetic readings · {}", figure.title);
                }
                Ok((place, Picture::paint(figure)?))
            })
            .collect::<Result<_, ReportError>>()?;
        Ok(Self { case, pictures })
    }
}

impl Picture {
    fn paint(figure: Figure) -> Result<Self, ReportError> {
        let failed =
            |error: &dyn std::fmt::Display| ReportError::Paint { figure: figure.name.clone(), text: error.to_string() };
        let drawing = layout::drawing(&figure);
        let svg = plot::svg(&drawing, &figure.title).map_err(|e| failed(&e))?;
        let png = plot::png(&drawing).map_err(|e| failed(&e))?;
        let tables = curves::tables(&figure).map_err(|e| failed(&e))?;
        Ok(Self { figure, svg, png, tables })
    }

    /// Writes the SVG, the PNG and the numbers, and returns the path of the PNG.
    fn write(&self, folder: &Path) -> Result<PathBuf, ReportError> {
        let plot = |ending: &str| folder.join("plots").join(format!("{}.{ending}", self.figure.name));
        files::write(&plot("svg"), self.svg.as_bytes())?;
        files::write(&plot("png"), &self.png)?;
        for table in &self.tables {
            files::write(&folder.join("curves").join(&table.file), table.csv.as_bytes())?;
        }
        Ok(plot("png"))
    }
}
