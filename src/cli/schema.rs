//! `barbule schema`

use std::path::PathBuf;

use anyhow::Result;
use barbule::report::write_file;
use barbule::{geometry, job, scene};
use clap::Args;

use super::Ending;
use super::output::print;

/// Write the JSON Schemas of every file that Barbule reads or writes.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  barbule schema --out data-schema")]
pub(super) struct Schema {
    /// Folder to write into.
    #[arg(long, default_value = "data-schema")]
    out: PathBuf,
}

impl Schema {
    pub(super) fn run(self) -> Result<Ending> {
        for (name, schema) in job::schemas().into_iter().chain(scene::schemas()).chain(geometry::schemas()) {
            let path = self.out.join(name);
            write_file(&path, schema.as_bytes())?;
            print(&path.display().to_string())?;
        }
        Ok(Ending::Done)
    }
}
