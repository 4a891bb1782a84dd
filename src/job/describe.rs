//! What a job would do, in words, before it is done.

use std::fmt::Write;

use super::case::{CheckedCase, Comparison};
use super::model_note::model_note;
use super::population::specimen_names;
use super::support::part;
use super::sweep::describe as describe_sweep;
use super::{Job, JobError};
use crate::fit::{Assignment, Role};
use crate::number::plain;
use crate::parameter::Parameter;

/// Checks a job and its data, and says what a fit would do.
pub fn describe(job: &Job) -> Result<String, JobError> {
    let mut text = format!("{}\n", job.file.title);
    for case in job.cases()?.0 {
        let residuals = case.residuals();
        let readings = match &case.comparison {
            Comparison::Spectra(table, fitted, _) => format!(
                "{} of {} spectra, {} readings",
                fitted.iter().filter(|fitted| **fitted).count(),
                table.spectra.len(),
                residuals.count()
            ),
            Comparison::Peaks(table, _, _) => {
                format!("{} of {} peak wavelengths", residuals.count(), table.readings.len())
            }
        };
        let sigma = if residuals.sigma_known() { "σ known" } else { "σ unknown, to be estimated from the residuals" };
        let settings = &case.file.fit;
        // Writing to a String cannot fail.
        let _ = writeln!(text, "\nCase {}\n  fits {readings}; {sigma}", case.file.case);
        if let Some(line) = specimens_text(&case) {
            let _ = writeln!(text, "  {line}");
        }
        let _ = writeln!(text, "  {}", model_note(&case)?.text);
        let _ = writeln!(text, "  from {} starts, seed {}", settings.starts, settings.seed);
        for (parameter, assignment) in residuals.parameters().iter().zip(&case.assignments) {
            let _ =
                writeln!(text, "  {:<30} {}", parameter.name, role_text(parameter, assignment, residuals.parameters()));
        }
    }
    if job.file.sweep.is_some() {
        let _ = writeln!(text, "\nSweep\n  {}", describe_sweep(job)?);
    }
    Ok(text.trim_end().to_owned())
}

/// What is done with the specimens of a table, where the job speaks of them.
fn specimens_text(case: &CheckedCase) -> Option<String> {
    let (Some(settings), Comparison::Spectra(table, fitted, _)) = (&case.file.specimens, &case.comparison) else {
        return None;
    };
    let count = specimen_names(&part(table, |index| fitted[index])).len();
    let prediction = if settings.leave_one_out { " and predicted from the others" } else { "" };
    Some(match count {
        1 => "one specimen alone: there is no spread to tell".to_owned(),
        count => format!("{count} specimens, each fitted by itself too{prediction}"),
    })
}

fn role_text(parameter: &Parameter, assignment: &Assignment, all: &[Parameter]) -> String {
    let role = match assignment.role {
        Role::Free { start, lower, upper } => {
            format!("free from {} to {}, first start {}", plain(lower), plain(upper), plain(start))
        }
        Role::Fixed(value) => format!("fixed at {}", plain(value)),
        Role::Tied { constant, ref terms } => {
            let terms = terms.iter().map(|(index, factor)| format!("{factor} × {}", all[*index].name));
            let sum: Vec<String> = std::iter::once(constant.to_string()).chain(terms).collect();
            format!("tied: {}", sum.join(" + "))
        }
    };
    let unit = if parameter.unit.is_empty() { String::new() } else { format!(" {}", parameter.unit) };
    let prior = assignment.prior.map_or_else(String::new, |prior| format!(", prior {} ± {}", prior.mean, prior.sigma));
    format!("{role}{unit}{prior}")
}
