//! What can be wrong with a job, each in a sentence that names the file and key and says how to mend it.

use std::path::PathBuf;

use thiserror::Error;

use crate::bsdf::ModelError;
use crate::fit::FitError;
use crate::measure::TableError;

/// A job that cannot be run as it is written.
#[derive(Debug, Error)]
pub enum JobError {
    /// The job file is not there or cannot be read.
    #[error("{}: {reason}; give a job's TOML file, or a folder with a job.toml in it", .path.display())]
    Unreadable {
        /// The path as given.
        path: PathBuf,
        /// What the system said.
        reason: String,
    },
    /// The text is not a job: bad TOML, an unknown key, a value of the wrong kind.
    #[error("{}{}: {message}", .path.display(), at_line(*.line))]
    Syntax {
        /// The job file.
        path: PathBuf,
        /// The line, where the message does not show it itself.
        line: Option<usize>,
        /// Key, what was found and what was expected.
        message: String,
    },
    /// Another error, with where in the job it lies.
    #[error("{place}: {error}")]
    Placed {
        /// File, line and case.
        place: String,
        /// What is wrong there.
        error: Box<JobError>,
    },
    /// An option of the command line whose value makes no sense for this job.
    #[error("{option}: {problem}")]
    Option {
        /// The option: `--set`.
        option: &'static str,
        /// What was found, what was expected, and how to mend it.
        problem: String,
    },
    /// A key whose value makes no sense.
    #[error("{key}: {problem}")]
    Key {
        /// The key: `data.file`.
        key: String,
        /// What was found, what was expected, and how to mend it.
        problem: String,
    },
    /// The table.
    #[error(transparent)]
    Table(#[from] TableError),
    /// The model.
    #[error("model: {0}")]
    Model(#[from] ModelError),
    /// The fit could not begin.
    #[error(transparent)]
    Fit(#[from] FitError),
}

/// `, line 3` where it is known.
pub(super) fn at_line(line: Option<usize>) -> String {
    line.map_or_else(String::new, |line| format!(", line {line}"))
}

impl JobError {
    /// A key whose value makes no sense.
    pub(crate) fn key(key: impl Into<String>, problem: impl Into<String>) -> Self {
        Self::Key { key: key.into(), problem: problem.into() }
    }
}
