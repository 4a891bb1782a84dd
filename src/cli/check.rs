//! `barbule check JOB`

use std::path::PathBuf;

use anyhow::Result;
use barbule::job::{self, Job};
use clap::Args;

use super::Ending;
use super::output::print;

/// Read a job and its data, and say what `fit` would do, without doing it.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  barbule check fits/teal-peaks")]
pub(super) struct Check {
    /// The job: its TOML file, or a folder with a job.toml in it.
    job: PathBuf,
}

impl Check {
    pub(super) fn run(self) -> Result<Ending> {
        let job = Job::read(&self.job)?;
        print(&job::describe(&job)?)?;
        Ok(Ending::Done)
    }
}
