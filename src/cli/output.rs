//! Writing to standard output and to files.

use std::io::{self, Write};
use std::path::Path;

use anyhow::{Context, Result};

/// Prints a text and a line end.
pub(super) fn print(text: &str) -> Result<()> {
    writeln!(io::stdout().lock(), "{text}")?;
    Ok(())
}

/// Writes a file under a temporary name and renames it, so that a killed run leaves the old file or the new one.
pub(super) fn write_file(path: &Path, contents: &str) -> Result<()> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let write = || -> io::Result<()> {
        std::fs::create_dir_all(folder)?;
        let mut file = tempfile::NamedTempFile::new_in(folder)?;
        file.write_all(contents.as_bytes())?;
        file.persist(path)?;
        Ok(())
    };
    write().with_context(|| format!("{} cannot be written; choose another place or make room", path.display()))
}

/// Whether an error is only the other end of a pipe being closed.
pub(super) fn is_broken_pipe(error: &anyhow::Error) -> bool {
    error
        .chain()
        .filter_map(|cause| cause.downcast_ref::<io::Error>())
        .any(|cause| cause.kind() == io::ErrorKind::BrokenPipe)
}
