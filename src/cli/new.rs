//! `barbule new TABLE.csv`

use std::path::PathBuf;

use anyhow::{Result, bail};
use barbule::job;
use barbule::report::write_file;
use clap::Args;

use super::Ending;
use super::output::print;

/// Write a job for a table: its columns, units and angles guessed, each guess marked for you to check.
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  barbule new my-table.csv\n  barbule check my-table.toml\n  barbule fit my-table.toml"
)]
pub(super) struct New {
    /// The table: spectra (long, or wide as R writes a pavo object) or peak wavelengths.
    table: PathBuf,
    /// Job file to write [default: beside the table, with the ending .toml].
    #[arg(long)]
    out: Option<PathBuf>,
}

impl New {
    pub(super) fn run(self) -> Result<Ending> {
        let path = self.out.unwrap_or_else(|| self.table.with_extension("toml"));
        if path.exists() {
            bail!("{} is there already; choose another name with --out, or move it away", path.display());
        }
        let draft = job::draft(&self.table, &path)?;
        write_file(&path, draft.as_bytes())?;
        print(&format!(
            "Wrote {0}. Look at the lines marked `guess` or `FILL IN`, then run: barbule check {0}",
            path.display()
        ))?;
        Ok(Ending::Done)
    }
}
