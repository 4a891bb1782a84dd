//! The plots of a report, one file each. A new plot is a new file and one line in [`ALL`].

mod convergence;
mod correlation;
pub(super) mod lobes;
mod maps;
mod peaks;
mod predicted;
mod profile;
mod scatter;
mod specimens;
mod spectra;
mod support;

use super::chart::Figure;
use super::readings;
use crate::fit::{Loss, SigmaSource};
use crate::job::Case;

/// The part of the page where a figure stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Place {
    /// Measured and fitted.
    Data,
    /// Every minimum.
    Minima,
    /// What the data cannot tell apart.
    Correlations,
    /// Whether a film is supported.
    Support,
    /// How the solver went.
    Convergence,
}

/// A plot: where it stands and what draws it. It draws nothing where a case has no such data.
pub(crate) struct Plot {
    pub(crate) place: Place,
    pub(crate) draw: fn(&Case) -> Vec<Figure>,
}

/// Every plot, in the order of the page.
pub(crate) const ALL: &[Plot] = &[
    Plot { place: Place::Data, draw: spectra::draw },
    Plot { place: Place::Data, draw: specimens::draw },
    Plot { place: Place::Data, draw: scatter::draw },
    Plot { place: Place::Data, draw: maps::draw },
    Plot { place: Place::Data, draw: peaks::draw },
    Plot { place: Place::Data, draw: predicted::draw },
    Plot { place: Place::Data, draw: lobes::draw },
    Plot { place: Place::Minima, draw: profile::draw },
    Plot { place: Place::Correlations, draw: correlation::draw },
    Plot { place: Place::Support, draw: support::draw },
    Plot { place: Place::Convergence, draw: convergence::draw },
];

/// What the cost is, as an axis says it.
fn cost_label(case: &Case) -> String {
    match (case.fit.settings.loss, case.fit.goodness.sigma_source) {
        (Loss::Squares, SigmaSource::Known) => "cost (χ²)".to_owned(),
        (Loss::Squares, SigmaSource::Estimated) => readings::labelled("sum of squares", readings::units(case).squared),
        _ => "cost (robust)".to_owned(),
    }
}
