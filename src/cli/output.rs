//! What several subcommands share: writing to standard output, what comes before and after writing files, settings.

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

/// Reads `NAME=VALUE`.
pub(super) fn setting(text: &str) -> Result<(String, f64), String> {
    let (name, value) = text.split_once('=').ok_or("expected NAME=VALUE, as film.thickness_nm=330")?;
    let value = value.trim().parse().map_err(|_| format!("`{value}` is not a number"))?;
    Ok((name.trim().to_owned(), value))
}
