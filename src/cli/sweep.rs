//! `barbule sweep JOB`

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

use anyhow::{Context, Result};
use barbule::job::{self, Job};
use barbule::render::Control;
use barbule::report;
use barbule::scene::contact_sheet;
use clap::Args;

use super::Ending;
use super::output::{check_writable, print, setting};
use super::render::progress_bar;

/// Run a job's model over a grid of one or two parameters: readings, colours, and how sensitive they are.
///
/// The job's `[sweep]` section says which parameters go over which values. All others keep the job's own values (the start
/// of a free parameter, the value of a fixed one), unless --set says otherwise. The report holds swatches, colour
/// differences, the way through the chromaticity diagram, slopes, and Sobol indices over the ranges of the free parameters;
/// with `[sweep.render]` a picture of every cell too.
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  barbule sweep fits/sweep-thickness\n  barbule sweep my-job.toml --set roughness=0.2 --out my-sweep"
)]
pub(super) struct Sweep {
    /// The job: its TOML file, or a folder with a job.toml in it.
    job: PathBuf,
    /// Folder of the report [default: reports/<job's name>].
    #[arg(long)]
    out: Option<PathBuf>,
    /// A parameter's value; may be given several times.
    #[arg(long, value_name = "NAME=VALUE", value_parser = setting)]
    set: Vec<(String, f64)>,
    /// Number of threads [default: one a core]. The result does not depend on it.
    #[arg(long, allow_negative_numbers = true, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
}

impl Sweep {
    pub(super) fn run(self) -> Result<Ending> {
        let job = Job::read(&self.job)?;
        if let Some(threads) = self.threads {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.into()).build_global();
            pool.context("the threads cannot be started; choose a smaller --threads")?;
        }
        let folder = self.out.unwrap_or_else(|| PathBuf::from("reports").join(&job.name));
        check_writable(&folder)?;
        let sweep = job::sweep(&job, &self.set.into_iter().collect())?;
        let bar = progress_bar();
        let progress = |done: usize, total: usize| {
            bar.set_length(total as u64);
            bar.set_position(done as u64);
        };
        let control = Control { interrupt: &AtomicBool::new(false), progress: &progress, checkpoint: None };
        let sheet = contact_sheet(&job, &sweep, &control)?;
        bar.finish_and_clear();
        let page = report::write_sweep(&sweep, sheet.as_ref(), &folder)?;
        print(&sweep.answer)?;
        print(&format!("Report: {}", page.display()))?;
        Ok(Ending::Done)
    }
}
