//! From a path to a parsed job.

use std::fs;
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use super::case::{CheckedCase, read_data};
use super::{InputFile, JobError, JobFile};

/// A parsed job and where it came from.
#[derive(Debug, Clone, PartialEq)]
pub struct Job {
    /// Name: the folder's, or the file's without its ending.
    pub name: String,
    /// Folder that relative paths count from.
    pub folder: PathBuf,
    /// The file as parsed.
    pub file: JobFile,
    /// The file as written.
    pub text: String,
    /// Files read so far, with their hashes.
    pub inputs: Vec<InputFile>,
}

/// Jobs are written by hand: a file larger than this is not one.
const LARGEST_JOB_BYTES: u64 = 1 << 20;

impl Job {
    /// Reads a job from its TOML file, or from the `job.toml` in a folder.
    pub fn read(path: &Path) -> Result<Self, JobError> {
        let unreadable = |reason: String| JobError::Unreadable { path: path.to_owned(), reason };
        let file_path = if path.is_dir() { path.join("job.toml") } else { path.to_owned() };
        let size = fs::metadata(&file_path).map_err(|error| unreadable(error.to_string()))?.len();
        if size > LARGEST_JOB_BYTES {
            return Err(unreadable(format!("it has {size} bytes, and a job has a few thousand")));
        }
        let bytes = fs::read(&file_path).map_err(|error| unreadable(error.to_string()))?;
        let input = input_file(&file_path, &bytes);
        let text = String::from_utf8(bytes).map_err(|_| unreadable("it is not UTF-8 text".into()))?;
        let folder = file_path.parent().map_or_else(|| PathBuf::from("."), Path::to_owned);
        let named =
            if path.is_dir() { path.canonicalize().unwrap_or_else(|_| path.to_owned()) } else { path.to_owned() };
        let name = named.file_stem().map_or_else(|| "job".into(), |stem| stem.to_string_lossy().into_owned());
        let file = parse(&text).map_err(|message| JobError::Syntax { path: file_path, message })?;
        Ok(Self { name, folder, file, text, inputs: vec![input] })
    }

    /// A job from its text, with paths that count from `folder`.
    pub fn from_text(name: &str, text: &str, folder: &Path) -> Result<Self, JobError> {
        let file = parse(text).map_err(|message| JobError::Syntax { path: PathBuf::from(name), message })?;
        let (name, text) = (name.to_owned(), text.to_owned());
        Ok(Self { name, folder: folder.to_owned(), file, text, inputs: Vec::new() })
    }

    /// Every case, its readings read or made and checked against its model, and the files that they came from.
    pub fn cases(&self) -> Result<(Vec<CheckedCase>, Vec<InputFile>), JobError> {
        let mut inputs = self.inputs.clone();
        let mut cases = Vec::new();
        for file in self.file.cases() {
            let (table, input) = read_data(&file.data, &self.folder, &self.file)?;
            if let Some(input) = input.filter(|input| !inputs.contains(input)) {
                inputs.push(input);
            }
            cases.push(CheckedCase::new(file, table)?);
        }
        Ok((cases, inputs))
    }

    /// Uses another seed for the start points of every case.
    pub fn set_seed(&mut self, seed: u64) {
        self.file.fit.seed = seed;
        for settings in self.file.alternative.iter_mut().filter_map(|alternative| alternative.fit.as_mut()) {
            settings.seed = seed;
        }
    }
}

/// Parses a job, or says in which line and key it goes wrong.
fn parse(text: &str) -> Result<JobFile, String> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let table: toml::Table = toml::from_str(text).map_err(|error| error.to_string())?;
    serde_path_to_error::deserialize(toml::Value::Table(table)).map_err(|error| {
        let path = error.path().to_string();
        let message = error.into_inner().to_string();
        let message = message.trim();
        if path == "." { message.to_owned() } else { format!("{path}: {message}") }
    })
}

/// Name, hash and size of a file that was read.
pub(super) fn input_file(path: &Path, bytes: &[u8]) -> InputFile {
    let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let sha256 = Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect();
    InputFile { name, sha256, bytes: bytes.len() as u64 }
}
