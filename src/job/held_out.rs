//! How well the readings that a fit did not see are predicted, and which of several cases predicts them best.

use super::outcome::{Case, CaseData, Comparison, ComparisonRow, HeldOut};
use crate::fit::{Loss, SigmaSource};
use crate::measure::Compared;
use crate::number::significant;

/// Errors at the held-out readings of a case; None where it has no spectra or none is held out.
///
/// A spectrum whose gain is its own has that from its own readings: they say how the instrument was set.
pub(super) fn held_out(data: &CaseData) -> Option<HeldOut> {
    let CaseData::Spectra { spectra, .. } = data else { return None };
    let (mut squares, mut root_squares, mut readings) = (0.0, 0.0, 0);
    for spectrum in spectra.iter().filter(|spectrum| !spectrum.fitted) {
        for (model, measured) in spectrum.model.iter().zip(&spectrum.measured) {
            squares += (model - measured).powi(2);
            root_squares += (model.cbrt() - measured.cbrt()).powi(2);
            readings += 1;
        }
    }
    #[expect(clippy::cast_precision_loss, reason = "numbers of readings are far below 2^53")]
    let count = readings as f64;
    (readings > 0).then(|| HeldOut {
        readings,
        rms: (squares / count).sqrt(),
        rms_of_cube_roots: (root_squares / count).sqrt(),
    })
}

/// The cases of a job side by side; None where there is one alone, or nothing is held out.
pub(super) fn comparison(cases: &[Case]) -> Option<Comparison> {
    let judged: Vec<(&Case, &HeldOut)> =
        cases.iter().filter_map(|case| Some((case, case.held_out.as_ref()?))).collect();
    // Groups are other readings, not other assumptions.
    let are_groups = cases.iter().any(|case| !case.group.is_empty());
    if judged.len() < 2 || judged.len() < cases.len() || are_groups {
        return None;
    }
    // How many independent readings there are is a matter of the readings; the case that follows them best shows it best.
    let misfit = |case: &Case| case.fit.goodness.chi_squared;
    let closest = cases.iter().min_by(|a, b| misfit(a).total_cmp(&misfit(b)))?;
    let effective_readings = closest.fit.goodness.effective_readings;
    // A criterion of likelihood compares fits to the same readings by the same likelihood alone.
    let likelihood = |case: &Case| {
        let goodness = &case.fit.goodness;
        (case.fit.settings.loss, goodness.sigma_source == SigmaSource::Known, goodness.readings)
    };
    let comparable =
        cases.iter().all(|case| likelihood(case) == likelihood(closest) && case.fit.settings.loss == Loss::Squares);
    let rows = judged.into_iter().map(|(case, held_out)| ComparisonRow {
        case: case.name.clone(),
        free_parameters: case.fit.goodness.free_parameters,
        held_out: held_out.clone(),
        aicc: case.fit.goodness.aicc_on(effective_readings).filter(|_| comparable),
    });
    Some(Comparison { effective_readings, rows: rows.collect() })
}

/// What the comparison says, in a sentence or two.
pub(super) fn comparison_answer(comparison: &Comparison, cases: &[Case]) -> Option<String> {
    let roots = cases.iter().any(|case| matches!(case.data, CaseData::Spectra { compare: Compared::CubeRoots, .. }));
    let error = |row: &ComparisonRow| if roots { row.held_out.rms_of_cube_roots } else { row.held_out.rms };
    let mut ranked: Vec<&ComparisonRow> = comparison.rows.iter().collect();
    ranked.sort_by(|a, b| error(a).total_cmp(&error(b)));
    let (best, others) = ranked.split_first()?;
    let numbers = |row: &ComparisonRow| {
        format!("{} ({})", significant(row.held_out.rms, 3), significant(row.held_out.rms_of_cube_roots, 3))
    };
    let others: Vec<String> = others.iter().map(|row| format!("{} {}", row.case, numbers(row))).collect();
    let mut text = format!(
        "Of {} cases, {} predicts the {} readings held out best: rms {}, in brackets of cube roots; then {}.",
        ranked.len(),
        best.case,
        best.held_out.readings,
        numbers(best),
        others.join(", ")
    );
    let by_aicc = comparison.rows.iter().filter_map(|row| Some((row.aicc?, &row.case)));
    if let Some((_, favourite)) = by_aicc.min_by(|a, b| a.0.total_cmp(&b.0)) {
        text += &if *favourite == best.case {
            " AICc, on the readings fitted, favours it too.".to_owned()
        } else {
            format!(" AICc, on the readings fitted, favours {favourite}.")
        };
    }
    if let Some(case) = cases.iter().find(|case| case.name == best.case) {
        text += &format!(" By it: {}", super::answer::values_sentence(case));
    }
    Some(text)
}
