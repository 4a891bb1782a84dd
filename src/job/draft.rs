//! A first job for a table: everything that can be guessed, each guess marked.

use std::path::Path;

use super::JobError;
use crate::measure::{Quantity, TableLayout, TableText, guess_layout};

/// Text of a job for this table, to be written to `job_path` (from whose folder the table's path then counts).
pub fn draft(table: &Path, job_path: &Path) -> Result<String, JobError> {
    let guess = guess_layout(&TableText::load(table)?)?;
    let name = table.file_name().map_or_else(|| "table".into(), |name| name.to_string_lossy().into_owned());
    let file = relative(table, job_path.parent().unwrap_or(Path::new(".")));
    let (instrument, model) = sections(&guess.layout);
    let layout =
        guess.commented_toml("data.layout").map_err(|error| JobError::key("data.layout", error.to_string()))?;
    Ok(format!(
        "# A job for {name}. Look at every line marked `guess` or `FILL IN`, then run `barbule check` on this file.\n\
         # `barbule schema` writes what every key means; `barbule models` lists the models.\n\n\
         title = {}\n\
         about = \"\"  # what was measured, by whom, and how: the report prints it\n\n\
         [data]\n\
         file = {}\n\n\
         {layout}\n{instrument}{model}",
        toml::Value::String(name.clone()),
        toml::Value::String(file),
    ))
}

/// The table's path as seen from the job's folder: as short as the two allow.
fn relative(table: &Path, folder: &Path) -> String {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let same = table.parent().map(|parent| if parent.as_os_str().is_empty() { Path::new(".") } else { parent });
    let path = match (same, table.file_name()) {
        (Some(parent), Some(name)) if parent == folder => name.into(),
        _ => table.canonicalize().unwrap_or_else(|_| table.to_owned()),
    };
    path.to_string_lossy().into_owned()
}

/// Instrument and model to start from.
fn sections(layout: &TableLayout) -> (String, &'static str) {
    match layout {
        TableLayout::Peaks(_) => (
            String::new(),
            "# guess: the closed law of one film; `barbule models` lists what else reads peaks\n\
             [model]\n\
             kind = \"thin-film-law\"\n\n\
             [parameters]\n\
             \"film.thickness_nm\" = { lower = 50, upper = 1500 }\n\
             \"film.index\" = { lower = 1.1, upper = 2.6 }\n",
        ),
        TableLayout::Spectra(layout) if layout.is_without_geometry() => (
            "[instrument]\n\
             gain = \"fixed\"  # guess: a reading of 1 is the white standard; or \"shared\", \"per-spectrum\"\n\
             bandwidth_nm = 0  # FILL IN: spectral resolution (full width at half maximum)\n\n\
             # guess: several individuals, each fitted by itself and predicted from the others; delete it if all are of one\n\
             [specimens]\n\
             leave_one_out = true\n\n"
                .to_owned(),
            "# guess: pigmented plumage; for an iridescent one use `film-at-unknown-angle`, with gain and offset free\n\
             [model]\n\
             kind = \"pigmented-base\"\n\
             pigments = [{ kind = \"eumelanin\" }, { kind = \"carotenoid\" }]\n\n\
             # guess: which parameters are free, and between which bounds\n\
             [parameters]\n\
             \"eumelanin.amount\" = { lower = 0, upper = 100 }\n\
             \"carotenoid.amount\" = { lower = 0, upper = 100 }\n\
             \"carotenoid.shift_per_cm\" = { lower = -500, upper = 2500 }\n\
             \"carotenoid.width\" = { lower = 0.5, upper = 4 }\n\
             scattering = { lower = 0.01, upper = 100 }\n\
             scattering_exponent = { lower = -1, upper = 4 }\n",
        ),
        TableLayout::Spectra(layout) => {
            let (gain, why) = match layout.quantity {
                Quantity::Reflectance => {
                    ("per-spectrum", "a reflectance against a white standard has no absolute scale")
                }
                Quantity::Brdf | Quantity::BsdfCos => ("shared", "one factor for the whole table"),
            };
            (
                format!(
                    "[instrument]\n\
                     gain = \"{gain}\"  # guess: {why}; or \"fixed\", \"shared\", \"per-spectrum\"\n\
                     offset = \"fixed\"  # guess: no stray light; or \"shared\", \"per-spectrum\"\n\
                     light_half_angle_deg = 0  # FILL IN: half-angle of the cone of light, if you know it\n\
                     viewer_half_angle_deg = 0  # FILL IN: half-angle of the cone that the probe collects\n\
                     bandwidth_nm = 0  # FILL IN: spectral resolution (full width at half maximum)\n\n"
                ),
                "# guess: one keratin film on melanin; put your own layers here, from the outside in\n\
                 [model]\n\
                 kind = \"coated-base\"\n\
                 layers = [{ name = \"film\", material = \"keratin\", thickness_nm = 300 }]\n\
                 substrate = \"bird_melanin\"\n\n\
                 # guess: which parameters are free, and between which bounds\n\
                 [parameters]\n\
                 \"film.thickness_nm\" = { lower = 50, upper = 1500 }\n\
                 \"keratin.index_offset\" = { lower = -0.05, upper = 0.05 }\n",
            )
        }
    }
}
