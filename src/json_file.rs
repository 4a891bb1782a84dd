//! From a JSON file that a person typed to a type, or to a sentence that says where it goes wrong.

use std::path::{Path, PathBuf};
use std::{fs, io};

use serde::de::DeserializeOwned;
use serde_json::error::Category;
use serde_path_to_error::Segment;
use thiserror::Error;

use crate::slip::{in_words, written};

/// Such files are written by hand or by a fit: a larger one is something else.
const LARGEST_BYTES: u64 = 1 << 24;

/// What JSON calls a group of keys.
pub(crate) const OBJECT: &str = "an object, as { \"key\": value }";

/// A JSON file that cannot be read.
#[derive(Debug, Error)]
pub enum JsonFileError {
    /// It is not there, is no file, or is not text.
    #[error("{}: {reason}", .path.display())]
    Unreadable {
        /// The path as given.
        path: PathBuf,
        /// What is wrong and what was expected.
        reason: String,
    },
    /// It is not JSON, has an unknown key, or a value of the wrong kind.
    #[error("{}, line {line}: {message}", .path.display())]
    Syntax {
        /// The file.
        path: PathBuf,
        /// The line, counted from 1.
        line: usize,
        /// Key, what was found and what was expected.
        message: String,
    },
}

/// The file that a path means: itself, or the one of this name in the folder that it is.
pub(crate) fn in_folder(path: &Path, name: &str) -> PathBuf {
    if path.is_dir() { path.join(name) } else { path.to_owned() }
}

/// Reads the file, or the one called `name` in the folder.
///
/// # Errors
///
/// A sentence for everything that the file may be instead.
pub(crate) fn read<T: DeserializeOwned>(path: &Path, name: &str) -> Result<T, JsonFileError> {
    let unreadable = |reason: String| JsonFileError::Unreadable { path: path.to_owned(), reason };
    let file_path = in_folder(path, name);
    let refused = |error: io::Error| {
        unreadable(match error.kind() {
            io::ErrorKind::NotFound if path.is_dir() => format!("this folder has no {name}"),
            io::ErrorKind::NotFound => format!("there is no such file; give a {name}, or a folder that holds one"),
            _ => error.to_string().split(" (os error").next().unwrap_or_default().to_owned(),
        })
    };
    let about = fs::metadata(&file_path).map_err(refused)?;
    if !about.is_file() {
        return Err(unreadable("found a device where a file was expected".into()));
    }
    if about.len() > LARGEST_BYTES {
        return Err(unreadable(format!("it has {} bytes, and a {name} has a few thousand", about.len())));
    }
    let bytes = fs::read(&file_path).map_err(refused)?;
    let text = String::from_utf8(bytes).map_err(|_| unreadable("it is not UTF-8 text".into()))?;
    parse(&text, &file_path)
}

/// Parses the text of a file.
pub(crate) fn parse<T: DeserializeOwned>(text: &str, path: &Path) -> Result<T, JsonFileError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let refused = |line, message| JsonFileError::Syntax { path: path.to_owned(), line, message };
    let mut reader = serde_json::Deserializer::from_str(text);
    let value = serde_path_to_error::deserialize(&mut reader).map_err(|error| {
        let keys: Vec<String> = error
            .path()
            .iter()
            .filter_map(|segment| match segment {
                Segment::Seq { index } => Some(index.to_string()),
                Segment::Map { key } => Some(key.clone()),
                Segment::Enum { .. } | Segment::Unknown => None,
            })
            .collect();
        let error = error.into_inner();
        let message = without_place(&error);
        let message = match error.classify() {
            Category::Data => in_words(&message, OBJECT),
            Category::Syntax | Category::Eof | Category::Io => format!("this is not JSON: {message}"),
        };
        let key = if keys.is_empty() { String::new() } else { format!("{}: ", written(&keys)) };
        refused(error.line(), format!("{key}{message}"))
    })?;
    reader.end().map_err(|error| refused(error.line(), format!("this is not JSON: {}", without_place(&error))))?;
    Ok(value)
}

/// The message without `at line 3 column 5`, which is said elsewhere.
fn without_place(error: &serde_json::Error) -> String {
    let text = error.to_string();
    text.rsplit_once(" at line ").map_or(text.as_str(), |(message, _)| message).to_owned()
}
