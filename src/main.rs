//! The command line: it only dispatches.

mod cli;

use std::process::ExitCode;

fn main() -> ExitCode {
    cli::main()
}
