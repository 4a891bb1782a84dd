//! `barbule models`

use anyhow::Result;
use barbule::job;
use clap::Args;

use super::Ending;
use super::output::print;

/// List every model with its parameters, their units, ranges and meaning.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  barbule models")]
pub(super) struct Models {}

impl Models {
    #[expect(clippy::unused_self, reason = "every subcommand runs alike")]
    pub(super) fn run(self) -> Result<Ending> {
        for model in job::models()? {
            print(&model.to_string())?;
        }
        Ok(Ending::Done)
    }
}
