//! The report of a sweep.
//!
//! ```text
//! index.html          the page: answer, colours, plots, sensitivities, methods
//! readings.csv        every reading of every cell
//! colours.csv         every colour: XYZ, chromaticity, CIELAB, sRGB, ΔE2000 to the first
//! sensitivities.csv   slopes of readings and colours
//! excursions.csv      each parameter on its own over its range
//! sobol.csv           shares of the variance
//! contact-sheet.png   a picture of every cell, where the job asks for pictures
//! plots/, curves/     as in the report of a fit
//! ```

mod contact_sheet;
mod csv_files;
mod page;
mod plots;
mod swept;

use std::path::{Path, PathBuf};

use super::{Picture, ReportError, files, write_pictures};
use crate::job::Sweep;
use crate::scene::ContactSheet;

/// Writes the report of a sweep, and of the pictures of its cells if there are any, into `folder`, which is made where it is missing, and returns the path of its page.
///
/// Each file is written under a temporary name and then renamed, the page last.
///
/// # Errors
///
/// If a file cannot be written.
pub fn write_sweep(sweep: &Sweep, sheet: Option<&ContactSheet>, folder: &Path) -> Result<PathBuf, ReportError> {
    let pictures: Vec<(plots::Place, Picture)> = plots::ALL
        .iter()
        .flat_map(|plot| (plot.draw)(sweep).into_iter().map(|figure| (plot.place, figure)))
        .map(|(place, figure)| Ok((place, Picture::paint(figure)?)))
        .collect::<Result<_, ReportError>>()?;
    for (name, text) in csv_files::all(sweep).map_err(|error| ReportError::Page(error.to_string()))? {
        files::write(&folder.join(name), text.as_bytes())?;
    }
    write_pictures(pictures.iter().map(|(_, picture)| picture), folder)?;
    let sheet = sheet.map(|sheet| contact_sheet::Sheet::paint(sweep, sheet)).transpose()?;
    if let Some(sheet) = &sheet {
        files::write(&folder.join(contact_sheet::FILE), &sheet.png)?;
    }
    let page = folder.join("index.html");
    files::write(&page, page::html(sweep, &pictures, sheet.as_ref())?.as_bytes())?;
    Ok(page)
}
