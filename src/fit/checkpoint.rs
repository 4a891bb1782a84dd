//! Fits that can be killed and picked up.
//!
//! A fit is a fixed sequence of local solves with a little arithmetic in between: the same assignments and settings give
//! the same starts, in the same order, on any number of threads. So nothing is saved but the solves, each under a digest
//! of all that decides its end, and a fit that is picked up runs from its beginning: a solve that had ended is answered
//! from the file, one that was running goes on from its last saved iteration, and the rest is done again. Evaluations are
//! saved with the solves that made them, so that even their number is that of a fit that was never killed.
//!
//! One fit has one file, written whole under another name and then renamed, so that it is complete at any moment.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use thiserror::Error;

use super::assignment::Assignment;
use super::least_squares::LeastSquares;
use super::local::LocalFit;
use super::objective::{Counts, Objective};
use super::outcome::Settings;

/// Time between two savings, for each of [`SLOWLY`] bytes that a file has begun: a long list of starts is written less often.
const INTERVAL: Duration = Duration::from_secs(1);
/// A disk takes this much in a small part of a second.
const SLOWLY: usize = 4_000_000;

/// Why a checkpoint cannot be used.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum CheckpointError {
    /// Something else was fitted there.
    #[error(
        "{} is the checkpoint of another fit: its parameters, settings, readings or version differ; give another folder, or remove this file to begin anew.",
        .path.display()
    )]
    AnotherFit {
        /// The file.
        path: PathBuf,
    },
    /// Not what this program writes.
    #[error("{} is not a complete checkpoint ({reason}); remove it to begin anew.", .path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What the JSON reader said.
        reason: String,
    },
    /// The system refuses.
    #[error("{} cannot be {done}: {reason}; give a folder for the checkpoint that can be written to.", .path.display())]
    System {
        /// The file or folder.
        path: PathBuf,
        /// `read`, `written` or `removed`.
        done: &'static str,
        /// What the system said.
        reason: String,
    },
}

/// A folder in which fits save how far they are, and from which they go on.
///
/// The fits that are given one folder must come in the same order each time, one after the other: the n-th has the file
/// `fit-n.json`. Least squares goes on within a solve; L-BFGS, Nelder–Mead and the swarm begin a solve anew that had not
/// ended. What was done since the last saving, a second or so, is done again. One process at a time may use a folder.
#[derive(Debug)]
pub struct Checkpoints {
    folder: PathBuf,
    interval: Duration,
    begun: AtomicUsize,
}

impl Checkpoints {
    /// Checkpoints in this folder, which is made if it is not there.
    pub fn new(folder: impl Into<PathBuf>) -> Self {
        Self { folder: folder.into(), interval: INTERVAL, begun: AtomicUsize::new(0) }
    }

    /// Sets the least time between two savings, one second unless told.
    #[must_use]
    pub fn every(self, interval: Duration) -> Self {
        Self { interval, ..self }
    }

    /// Removes what the fits so far have saved, and the folder if nothing else is in it: once their results are safe.
    ///
    /// # Errors
    ///
    /// A file that cannot be removed.
    pub fn remove(self) -> Result<(), CheckpointError> {
        for number in 1..=self.begun.load(Ordering::Relaxed) {
            let path = self.path(number);
            for path in [unfinished(&path), path] {
                match fs::remove_file(&path) {
                    Err(error) if error.kind() != io::ErrorKind::NotFound => {
                        return Err(system(&path, "removed", &error));
                    }
                    _ => {}
                }
            }
        }
        match fs::remove_dir(&self.folder) {
            Err(error) if !matches!(error.kind(), io::ErrorKind::NotFound | io::ErrorKind::DirectoryNotEmpty) => {
                Err(system(&self.folder, "removed", &error))
            }
            _ => Ok(()),
        }
    }

    /// The record of the next fit, with what an earlier run has left in it.
    pub(super) fn next(&self, fingerprint: String) -> Result<Record, CheckpointError> {
        let path = self.path(1 + self.begun.fetch_add(1, Ordering::Relaxed));
        fs::create_dir_all(&self.folder).map_err(|error| system(&self.folder, "written", &error))?;
        let contents = match fs::read(&path) {
            Ok(bytes) => serde_json::from_slice(&bytes)
                .map_err(|error| CheckpointError::Damaged { path: path.clone(), reason: error.to_string() })?,
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                Contents { fingerprint: fingerprint.clone(), solves: BTreeMap::new() }
            }
            Err(error) => return Err(system(&path, "read", &error)),
        };
        if contents.fingerprint != fingerprint {
            return Err(CheckpointError::AnotherFit { path });
        }
        Ok(Record {
            path,
            interval: self.interval,
            begun: Instant::now(),
            contents: Mutex::new(contents),
            due: Mutex::new(Instant::now() + self.interval),
            failure: Mutex::new(None),
        })
    }

    fn path(&self, number: usize) -> PathBuf {
        self.folder.join(format!("fit-{number}.json"))
    }
}

/// The name under which a file is written before it is complete.
fn unfinished(path: &Path) -> PathBuf {
    path.with_extension("json.part")
}

fn system(path: &Path, done: &'static str, error: &io::Error) -> CheckpointError {
    CheckpointError::System { path: path.to_owned(), done, reason: error.to_string() }
}

/// What decides how a fit goes: version, parameters, assignments, settings, and the residuals at the job's own start.
pub(super) fn fingerprint(objective: &Objective<'_>, assignments: &[Assignment], settings: &Settings) -> String {
    let parameters = objective.residuals.parameters();
    let rows = objective.rows_uncounted(&objective.mapping.start());
    // Debug writes every digit of a number.
    digest(&format!("{} {parameters:?} {assignments:?} {settings:?} {rows:?}", env!("CARGO_PKG_VERSION")))
}

/// 128 bits of SHA-256, in hexadecimal.
pub(super) fn digest(text: &str) -> String {
    Sha256::digest(text).iter().take(16).map(|byte| format!("{byte:02x}")).collect()
}

/// How far one local solve is.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) enum Progress {
    /// It has ended; None where the model is finite nowhere on its way.
    Ended(Option<LocalFit>),
    /// It was running.
    Running(Box<Running>),
}

/// A solve of least squares between two iterations.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Running {
    pub(super) solver: LeastSquares,
    pub(super) free: Vec<f64>,
    pub(super) cost: f64,
    pub(super) iteration: u64,
    pub(super) path: Vec<Vec<f64>>,
}

/// A local solve as it is saved.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Solve {
    pub(super) counts: Counts,
    pub(super) progress: Progress,
}

/// A file's contents.
#[derive(Debug, Serialize, Deserialize)]
struct Contents {
    fingerprint: String,
    /// Solves by a digest of what decides their end.
    solves: BTreeMap<String, Solve>,
}

/// What one fit has saved. A saving that fails does not end the fit, which is worth more.
#[derive(Debug)]
pub(super) struct Record {
    path: PathBuf,
    pub(super) interval: Duration,
    begun: Instant,
    contents: Mutex<Contents>,
    /// When to write next; held by who writes.
    due: Mutex<Instant>,
    failure: Mutex<Option<CheckpointError>>,
}

impl Record {
    /// How far a solve is, if it ever began.
    pub(super) fn find(&self, key: &str) -> Option<Solve> {
        lock(&self.contents).solves.get(key).cloned()
    }

    /// Notes how far a solve is, and writes the file where that is due and nobody else does.
    pub(super) fn note(&self, key: &str, solve: Solve) {
        lock(&self.contents).solves.insert(key.to_owned(), solve);
        let due = match self.due.try_lock() {
            Ok(due) => due,
            Err(std::sync::TryLockError::Poisoned(due)) => due.into_inner(),
            Err(std::sync::TryLockError::WouldBlock) => return,
        };
        if *due <= Instant::now() {
            self.write(due);
        }
    }

    /// Writes the file when the fit ends, if there is anything to write: a fit that the user stopped is to be picked up,
    /// and one of many that took a tenth of the interval is not to be done again when the next one is killed.
    pub(super) fn end(&self, interrupted: bool) {
        if (interrupted || self.begun.elapsed() >= self.interval / 10) && !lock(&self.contents).solves.is_empty() {
            self.write(lock(&self.due));
        }
    }

    /// The first saving that failed.
    pub(super) fn failure(&self) -> Option<CheckpointError> {
        lock(&self.failure).clone()
    }

    fn write(&self, mut due: MutexGuard<'_, Instant>) {
        let length = match self.replace() {
            Ok(length) => length,
            Err(error) => {
                lock(&self.failure).get_or_insert_with(|| system(&self.path, "written", &error));
                0
            }
        };
        let times = u32::try_from(1 + length / SLOWLY).unwrap_or(u32::MAX);
        *due = Instant::now() + self.interval.saturating_mul(times);
    }

    fn replace(&self) -> io::Result<usize> {
        let bytes = serde_json::to_vec(&*lock(&self.contents))?;
        let part = unfinished(&self.path);
        let mut file = fs::File::create(&part)?;
        file.write_all(&bytes)?;
        // The name must not be there before the bytes are.
        file.sync_all()?;
        fs::rename(part, &self.path)?;
        Ok(bytes.len())
    }
}

/// What a thread that panicked has left is whole: entries are only ever replaced.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
