//! `barbule models`

use std::path::PathBuf;

use anyhow::{Result, bail};
use barbule::{job, report};
use clap::Args;

use super::Ending;
use super::output::{check_writable, print};

/// List every model with its parameters, their units, ranges and meaning, or draw what they do with light.
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  barbule models\n  barbule models --plot lobes\n  barbule models rough-plastic --plot lobes --set roughness=0.1,0.3,0.5 --light 20,60"
)]
pub(super) struct Models {
    /// One model alone.
    model: Option<String>,
    /// Folder for pictures and tables of the models' lobes, drawn instead of the list.
    #[arg(long, value_name = "FOLDER")]
    plot: Option<PathBuf>,
    /// Values of a parameter to draw beside each other; may be given several times, for every combination.
    #[arg(long, value_name = "NAME=VALUE,VALUE…", value_parser = settings, requires = "plot")]
    set: Vec<(String, Vec<f64>)>,
    /// Inclinations of the light, degrees from the normal.
    #[arg(
        long,
        value_name = "DEGREES",
        value_delimiter = ',',
        default_value = "15,45,70",
        requires = "plot",
        allow_negative_numbers = true
    )]
    light: Vec<f64>,
}

impl Models {
    pub(super) fn run(self) -> Result<Ending> {
        let Some(folder) = self.plot else {
            for model in job::models(self.model.as_deref())? {
                print(&model.to_string())?;
            }
            return Ok(Ending::Done);
        };
        check_writable(&folder)?;
        let models = job::model_lobes(self.model.as_deref(), &self.set, &self.light)?;
        if models.is_empty() {
            bail!("MODEL: `thin-film-law` gives peak wavelengths and has no lobes; choose another model");
        }
        for model in models {
            for path in report::write_lobes(model.kind, &model.settings, &folder)? {
                print(&path.display().to_string())?;
            }
        }
        Ok(Ending::Done)
    }
}

/// `roughness=0.1,0.3`
fn settings(text: &str) -> Result<(String, Vec<f64>), String> {
    let (name, values) = text.split_once('=').ok_or("expected NAME=VALUE,VALUE…, as roughness=0.1,0.3")?;
    let number = |value: &str| value.trim().parse().map_err(|_| format!("`{}` is not a number", value.trim()));
    Ok((name.trim().to_owned(), values.split(',').map(number).collect::<Result<_, _>>()?))
}
