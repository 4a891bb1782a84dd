//! The plots of a sweep, one file each. A new plot is a new file and one line in [`ALL`].

mod chromaticity;
mod colours;
mod differences;
mod excursions;
mod readings;
mod slopes;
mod variance;

use crate::job::Sweep;
use crate::report::chart::Figure;

/// The part of the page where a figure stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Place {
    /// What is seen over the grid.
    Grid,
    /// How fast it changes at a point.
    Slopes,
    /// What each parameter does on its own.
    Excursions,
    /// Shares of the variance.
    Variance,
}

/// A plot: where it stands and what draws it. It draws nothing where a sweep has no such data.
pub(crate) struct Plot {
    pub(crate) place: Place,
    pub(crate) draw: fn(&Sweep) -> Vec<Figure>,
}

/// Every plot, in the order of the page.
pub(crate) const ALL: &[Plot] = &[
    Plot { place: Place::Grid, draw: colours::draw },
    Plot { place: Place::Grid, draw: differences::draw },
    Plot { place: Place::Grid, draw: chromaticity::draw },
    Plot { place: Place::Grid, draw: readings::draw },
    Plot { place: Place::Slopes, draw: slopes::draw },
    Plot { place: Place::Excursions, draw: excursions::draw },
    Plot { place: Place::Variance, draw: variance::draw },
];
