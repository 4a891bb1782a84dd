//! `barbule fit JOB`

use std::io::IsTerminal;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use anyhow::{Context, Result};
use barbule::fit::{Checkpoints, Control, StopReason};
use barbule::job::{self, Job, Outcome};
use barbule::report;
use clap::{Args, ValueEnum};
use indicatif::{ProgressBar, ProgressStyle};

use super::Ending;
use super::output::{check_writable, print};

/// Fit a job's model to its readings and write a report.
///
/// Ends by printing the answer in a sentence: values ± errors, rivals that the data do not rule out, and what stays
/// open. Ctrl-C ends the fit with the best so far, and its report says so; a second one quits at once.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  barbule fit fits/teal-peaks\n  barbule fit my-job.toml --seed 7 --out my-report")]
pub(super) struct Fit {
    /// The job: its TOML file, or a folder with a job.toml in it.
    job: PathBuf,
    /// Folder of the report [default: reports/<job's name>].
    #[arg(long)]
    out: Option<PathBuf>,
    /// Seed of the start points, instead of the job's.
    #[arg(long, allow_negative_numbers = true)]
    seed: Option<u64>,
    /// Number of threads [default: one a core]. The result does not depend on it.
    #[arg(long, allow_negative_numbers = true, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Folder in which the fit saves its progress each second; a killed or interrupted one goes on from there.
    #[arg(long, value_name = "FOLDER")]
    checkpoint: Option<PathBuf>,
    /// What to print at the end.
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    /// The answer in a sentence.
    Text,
    /// The whole result, as in result.json.
    Json,
}

static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// The first Ctrl-C asks the fit to end; the second does not wait for it.
fn interrupt() {
    if INTERRUPTED.swap(true, Ordering::Relaxed) {
        std::process::exit(130);
    }
    eprintln!("barbule: ending with the best so far; Ctrl-C once more quits at once");
}

impl Fit {
    pub(super) fn run(self) -> Result<Ending> {
        let mut job = Job::read(&self.job)?;
        if let Some(seed) = self.seed {
            job.set_seed(seed);
        }
        if let Some(threads) = self.threads {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.into()).build_global();
            pool.context("the threads cannot be started; choose a smaller --threads")?;
        }
        let folder = self.out.unwrap_or_else(|| PathBuf::from("reports").join(&job.name));
        check_writable(&folder)?;
        ctrlc::set_handler(interrupt).context("Ctrl-C cannot be caught")?;

        let bar = progress_bar();
        let progress = |done: usize, total: usize| {
            bar.set_length(total as u64);
            bar.set_position(done as u64);
        };
        let checkpoints = self.checkpoint.map(Checkpoints::new);
        let started = Instant::now();
        let control = Control { interrupt: &INTERRUPTED, progress: &progress, checkpoint: checkpoints.as_ref() };
        let outcome = job::run(&job, &control)?;
        bar.finish_and_clear();

        let page = report::write_report(&outcome, &folder)?;
        let result = outcome.to_json().context("the result cannot be written as JSON")?;
        report::write_file(&folder.join("result.json"), result.as_bytes())?;
        report::write_file(&folder.join("timing.json"), timing(started).as_bytes())?;
        if let Some(checkpoints) = checkpoints.filter(|_| !INTERRUPTED.load(Ordering::Relaxed)) {
            checkpoints.remove()?;
        }
        match self.format {
            Format::Json => print(&result)?,
            Format::Text => {
                print(&outcome.answer)?;
                print(&format!("Report: {}", page.display()))?;
            }
        }
        Ok(ending(&outcome))
    }
}

/// What the fit took, apart from the result, which must not hang on it.
fn timing(started: Instant) -> String {
    let (seconds, threads) = (started.elapsed().as_secs_f64(), rayon::current_num_threads());
    format!("{{\n  \"seconds\": {seconds:.3},\n  \"threads\": {threads}\n}}\n")
}

fn ending(outcome: &Outcome) -> Ending {
    if outcome.cases.iter().any(|case| case.fit.stop == StopReason::Failed) { Ending::FitFailed } else { Ending::Done }
}

/// A bar on a terminal, nothing otherwise.
fn progress_bar() -> ProgressBar {
    if !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let style = ProgressStyle::with_template("{msg} {bar:40} {pos}/{len} starts, {elapsed}");
    ProgressBar::new(1).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar())).with_message("fitting")
}
