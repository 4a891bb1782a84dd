//! Subcommands, one file each.

mod check;
mod compare;
mod fit;
mod geometry;
mod models;
mod new;
mod output;
mod render;
mod schema;
mod simulate;
mod sweep;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Fit a physical model of how a feather looks to measurements of real feathers, and show how good the fit is.
#[derive(Debug, Parser)]
#[command(
    version,
    arg_required_else_help = true,
    after_help = "Examples:\n  barbule fit fits/teal-peaks     fit a job that is there, and write its report\n  barbule new my-table.csv        begin with a table of your own\n  barbule models                  what can be fitted"
)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    New(new::New),
    Fit(fit::Fit),
    Simulate(simulate::Simulate),
    Sweep(sweep::Sweep),
    Check(check::Check),
    Compare(compare::Compare),
    Render(render::Render),
    Geometry(geometry::Geometry),
    Models(models::Models),
    Schema(schema::Schema),
}

/// How a command ends when nothing went wrong on the way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Ending {
    /// Exit code 0.
    Done,
    /// Exit code 1: everything was read, but the fit failed.
    FitFailed,
    /// Exit code 130, as shells count it: the user stopped it.
    Interrupted,
}

/// Runs the command line: 0 done, 1 the fit failed, 2 a mistake that the user can mend.
pub(crate) fn main() -> ExitCode {
    let ending = match Arguments::parse().command {
        Command::New(command) => command.run(),
        Command::Fit(command) => command.run(),
        Command::Simulate(command) => command.run(),
        Command::Sweep(command) => command.run(),
        Command::Check(command) => command.run(),
        Command::Compare(command) => command.run(),
        Command::Render(command) => command.run(),
        Command::Geometry(command) => command.run(),
        Command::Models(command) => command.run(),
        Command::Schema(command) => command.run(),
    };
    match ending {
        Ok(Ending::Done) => ExitCode::SUCCESS,
        Ok(Ending::FitFailed) => ExitCode::from(1),
        Ok(Ending::Interrupted) => ExitCode::from(130),
        // A reader that closes its end of a pipe has what it wanted.
        Err(error) if output::is_broken_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            // Every error quotes its cause where that helps its reader.
            eprintln!("barbule: {error}");
            ExitCode::from(2)
        }
    }
}
