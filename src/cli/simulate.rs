//! `barbule simulate JOB`

use std::path::{Path, PathBuf};

use anyhow::{Result, bail};
use barbule::job::{self, Job, Noise};
use barbule::report::write_file;
use clap::Args;

use super::Ending;
use super::output::{print, setting};

/// Run a job's model forward: its readings at the geometry of the job's table.
///
/// Free parameters take their start values, fixed ones theirs, unless --set says otherwise. The table that is written
/// can be fitted again: `barbule new` reads it.
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  barbule simulate fits/duck-synthetic --set cortex.thickness_nm=330 --noise 0.01 --seed 3 --out table.csv"
)]
pub(super) struct Simulate {
    /// The job: its TOML file, or a folder with a job.toml in it.
    job: PathBuf,
    /// A parameter's value; may be given several times.
    #[arg(long, value_name = "NAME=VALUE", value_parser = setting)]
    set: Vec<(String, f64)>,
    /// Standard deviation of the noise as a share of each reading.
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    noise: f64,
    /// Seed of the noise.
    #[arg(long, default_value_t = 1, allow_negative_numbers = true)]
    seed: u64,
    /// File to write [default: standard output].
    #[arg(long)]
    out: Option<PathBuf>,
}

impl Simulate {
    pub(super) fn run(self) -> Result<Ending> {
        let job = Job::read(&self.job)?;
        let noise = Noise { share: self.noise, seed: self.seed };
        let table = job::simulate(&job, &self.set.into_iter().collect(), noise)?;
        match self.out {
            Some(path) if is_input(&path, &job) => {
                bail!("--out: {} is what this job reads; choose another name", path.display())
            }
            Some(path) => write_file(&path, table.as_bytes())?,
            None => print(table.trim_end())?,
        }
        Ok(Ending::Done)
    }
}

/// Whether writing there would destroy the job or its table.
fn is_input(path: &Path, job: &Job) -> bool {
    let inputs = std::iter::once(job.path.clone()).chain(job.table_path());
    path.canonicalize()
        .is_ok_and(|path| inputs.filter_map(|input| input.canonicalize().ok()).any(|input| input == path))
}
