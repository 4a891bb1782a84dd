//! Writing to standard output, and what comes before and after writing files.

use std::io::{self, ErrorKind, Write};
use std::path::Path;

use anyhow::{Context, Result};

/// Prints a text and a line end.
pub(super) fn print(text: &str) -> Result<()> {
    writeln!(io::stdout().lock(), "{text}")?;
    Ok(())
}

/// Refuses a folder that cannot be written to before hours go into what is to be written. Leaves no trace.
pub(super) fn check_writable(folder: &Path) -> Result<()> {
    let absolute = std::path::absolute(folder)?;
    let there = absolute.ancestors().find(|ancestor| ancestor.exists()).unwrap_or(Path::new("/"));
    let probe =
        if there.is_dir() { tempfile::tempfile_in(there).map(|_| ()) } else { Err(ErrorKind::NotADirectory.into()) };
    probe.with_context(|| format!("{} cannot be written to; choose another folder with --out", folder.display()))
}

/// Whether an error is only the other end of a pipe being closed.
pub(super) fn is_broken_pipe(error: &anyhow::Error) -> bool {
    error
        .chain()
        .filter_map(|cause| cause.downcast_ref::<io::Error>())
        .any(|cause| cause.kind() == ErrorKind::BrokenPipe)
}
