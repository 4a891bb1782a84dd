//! The report as a reader gets it: a folder with a page, plots and tables.

mod fixtures;

use std::path::{Path, PathBuf};

use barbule::job::Outcome;
use barbule::report::write_report;

/// Writes a report where it can be looked at afterwards: `target/tmp/report/<name>`.
fn written(outcome: &Outcome) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("report").join(&outcome.name);
    write_report(outcome, &folder).unwrap();
    folder
}

#[test]
fn every_fixture_gives_a_page() {
    for outcome in [fixtures::film(), fixtures::synthetic(), fixtures::paint(), fixtures::peaks(), fixtures::awkward()]
    {
        assert!(written(&outcome).join("index.html").is_file());
    }
}
