//! From a path to a parsed job.

use std::path::{Path, PathBuf};
use std::{fs, io};

use sha2::{Digest, Sha256};

use super::case::{CheckedCase, read_data, resolve};
use super::error::at_line;
use super::origin::by_group;
use super::pigments::load_pigments;
use super::syntax::{keys_of, line_of, parse};
use super::{AlternativeFile, InputFile, JobError, JobFile};
use crate::fit::FitError;

/// A parsed job and where it came from.
#[derive(Debug, Clone, PartialEq)]
pub struct Job {
    /// Name: the folder's, or the file's without its ending.
    pub name: String,
    /// The job file, or the name of a job that came as text.
    pub path: PathBuf,
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
        let refused = |error: io::Error| {
            unreadable(match error.kind() {
                io::ErrorKind::NotFound if path.is_dir() => "this folder has no job.toml".into(),
                io::ErrorKind::NotFound => "there is no such file".into(),
                _ => error.to_string(),
            })
        };
        let about = fs::metadata(&file_path).map_err(refused)?;
        if !about.is_file() {
            return Err(unreadable("found a device where a file was expected".into()));
        }
        if about.len() > LARGEST_JOB_BYTES {
            return Err(unreadable(format!("it has {} bytes, and a job has a few thousand", about.len())));
        }
        let bytes = fs::read(&file_path).map_err(refused)?;
        let input = input_file(&file_path, &bytes);
        let text = String::from_utf8(bytes).map_err(|_| unreadable("it is not UTF-8 text".into()))?;
        let folder = file_path.parent().map_or_else(|| PathBuf::from("."), Path::to_owned);
        let named =
            if path.is_dir() { path.canonicalize().unwrap_or_else(|_| path.to_owned()) } else { path.to_owned() };
        let name = named.file_stem().map_or_else(|| "job".into(), |stem| stem.to_string_lossy().into_owned());
        let mut job =
            Self { name, file: parse(&text, &file_path)?, path: file_path, folder, text, inputs: vec![input] };
        job.load_pigments()?;
        Ok(job)
    }

    /// A job from its text, with paths that count from `folder`.
    pub fn from_text(name: &str, text: &str, folder: &Path) -> Result<Self, JobError> {
        let file = parse(text, Path::new(name))?;
        let (name, path, text) = (name.to_owned(), PathBuf::from(name), text.to_owned());
        let mut job = Self { name, path, folder: folder.to_owned(), file, text, inputs: Vec::new() };
        job.load_pigments()?;
        Ok(job)
    }

    fn load_pigments(&mut self) -> Result<(), JobError> {
        let inputs = load_pigments(&mut self.file, &self.folder).map_err(|error| self.placed(error, 0))?;
        self.inputs.extend(inputs);
        Ok(())
    }

    /// The table that the job reads, if it reads one and the folder that holds it is known.
    pub fn table_path(&self) -> Option<PathBuf> {
        self.file.data.file.as_ref().and_then(|name| resolve("data.file", name, &self.folder).ok())
    }

    /// Every case, its readings read or made and checked against its model, and the files that they came from.
    pub fn cases(&self) -> Result<(Vec<CheckedCase>, Vec<InputFile>), JobError> {
        let mut inputs = self.inputs.clone();
        let mut cases = Vec::new();
        for (index, file) in self.file.cases().into_iter().enumerate() {
            let (table, input) = read_data(&file.data, &self.folder, &self.file).map_err(|e| self.placed(e, index))?;
            if let Some(input) = input.filter(|input| !inputs.contains(input)) {
                inputs.push(input);
            }
            for (file, table) in by_group(file, table) {
                cases.push(CheckedCase::new(file, table).map_err(|error| self.placed(error, index))?);
            }
        }
        Ok((cases, inputs))
    }

    /// The error with its file, line and case, as far as it does not name them itself.
    pub(crate) fn placed(&self, error: JobError, case: usize) -> JobError {
        let keys = match &error {
            JobError::Key { key, .. } => keys_of(key),
            JobError::Model(_) => vec!["model".to_owned()],
            JobError::Fit(FitError::Setting { name, .. }) => vec!["fit".to_owned(), (*name).to_owned()],
            JobError::Fit(FitError::TiedToTied { name, .. } | FitError::TieOutOfRange { name, .. }) => {
                vec!["parameters".to_owned(), name.clone()]
            }
            JobError::Fit(_) => vec!["parameters".to_owned()],
            _ => return error,
        };
        // An alternative has some keys of its own; the others are the main case's.
        let own: Vec<String> = case
            .checked_sub(1)
            .map(|other| ["alternative".to_owned(), other.to_string()].into_iter().chain(keys.clone()).collect())
            .unwrap_or_default();
        let owns = |settings: &AlternativeFile| match keys.first().map(String::as_str) {
            Some("model") => settings.model.is_some(),
            Some("parameters") => settings.parameters.is_some(),
            Some("instrument") => settings.instrument.is_some(),
            Some("fit") => settings.fit.is_some(),
            _ => false,
        };
        let other = case.checked_sub(1).and_then(|other| self.file.alternative.get(other));
        let keys = if other.is_some_and(owns) { &own } else { &keys };
        let line = at_line(line_of(&self.text, keys));
        let case = other.map_or_else(String::new, |other| format!(", case \"{}\"", other.case));
        JobError::Placed { place: format!("{}{line}{case}", self.path.display()), error: Box::new(error) }
    }

    /// Uses another seed for the start points of every case.
    pub fn set_seed(&mut self, seed: u64) {
        self.file.fit.seed = seed;
        for settings in self.file.alternative.iter_mut().filter_map(|alternative| alternative.fit.as_mut()) {
            settings.seed = seed;
        }
    }
}

/// Name, hash and size of a file that was read.
pub(super) fn input_file(path: &Path, bytes: &[u8]) -> InputFile {
    let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let sha256 = Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect();
    InputFile { name, sha256, bytes: bytes.len() as u64 }
}
