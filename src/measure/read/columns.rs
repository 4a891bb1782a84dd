//! Names of columns in a layout, turned into places in a row.

use std::collections::BTreeMap;
use std::path::Path;

use crate::measure::error::{Place, TableError, TableProblem};
use crate::measure::layout::{Angles, Cell, Source};
use crate::measure::text::{Row, Rows};

/// One number of each row.
#[derive(Clone, Copy)]
pub(super) enum Number {
    /// The same in all rows.
    Fixed(f64),
    /// In this column.
    Column(usize),
}

impl Number {
    pub(super) fn find(source: &Source, rows: &Rows<'_>) -> Result<Self, TableError> {
        match source {
            Source::Number(number) => Ok(Self::Fixed(*number)),
            Source::Column(name) => rows.column(name).map(Self::Column),
        }
    }

    pub(super) fn of(self, row: &Row<'_>) -> Result<f64, TableProblem> {
        match self {
            Self::Fixed(number) => Ok(number),
            Self::Column(column) => row.number(column),
        }
    }

    /// The column, if it is one.
    pub(super) fn column(self) -> Option<usize> {
        match self {
            Self::Fixed(_) => None,
            Self::Column(column) => Some(column),
        }
    }
}

/// Angles as written: θi, φi, θo, φo in the file's unit, or θ of a mirror geometry.
#[derive(Debug, Clone, Copy)]
pub(super) enum WrittenAngles {
    Mirror(f64),
    Four([f64; 4]),
    NotRecorded,
}

impl WrittenAngles {
    /// A key that is equal for equal angles.
    pub(super) fn bits(&self) -> [u64; 4] {
        match self {
            Self::Mirror(theta) => [theta.to_bits(); 4],
            Self::Four(angles) => angles.map(f64::to_bits),
            Self::NotRecorded => [0; 4],
        }
    }

    /// The inclinations among them.
    pub(super) fn inclinations(&self) -> [f64; 2] {
        match *self {
            Self::Mirror(theta) => [theta, theta],
            Self::Four([theta_i, _, theta_o, _]) => [theta_i, theta_o],
            Self::NotRecorded => [0.0; 2],
        }
    }
}

/// Where a row keeps its angles.
pub(super) enum AnglesOf {
    Mirror(Number),
    Four([Number; 4]),
    NotRecorded,
}

impl AnglesOf {
    pub(super) fn find(angles: &Angles, rows: &Rows<'_>) -> Result<Self, TableError> {
        let find = |source| Number::find(source, rows);
        Ok(match angles {
            Angles::Mirror(theta) => Self::Mirror(find(theta)?),
            Angles::Four(four) => {
                Self::Four([find(&four.theta_i)?, find(&four.phi_i)?, find(&four.theta_o)?, find(&four.phi_o)?])
            }
            Angles::NotRecorded => Self::NotRecorded,
        })
    }

    pub(super) fn of(&self, row: &Row<'_>, file: &Path) -> Result<WrittenAngles, TableError> {
        let number = |number: Number| number.of(row).map_err(|problem| at(file, row, number.column(), problem));
        Ok(match self {
            Self::Mirror(theta) => WrittenAngles::Mirror(number(*theta)?),
            Self::Four([theta_i, phi_i, theta_o, phi_o]) => {
                WrittenAngles::Four([number(*theta_i)?, number(*phi_i)?, number(*theta_o)?, number(*phi_o)?])
            }
            Self::NotRecorded => WrittenAngles::NotRecorded,
        })
    }
}

/// The rows that a job keeps.
pub(super) struct Only<'a> {
    wanted: Vec<(usize, &'a Cell)>,
}

impl<'a> Only<'a> {
    pub(super) fn find(only: &'a BTreeMap<String, Cell>, rows: &Rows<'_>) -> Result<Self, TableError> {
        let wanted =
            only.iter().map(|(name, cell)| Ok((rows.column(name)?, cell))).collect::<Result<_, TableError>>()?;
        Ok(Self { wanted })
    }

    pub(super) fn keeps(&self, row: &Row<'_>) -> bool {
        self.wanted.iter().all(|&(column, cell)| match cell {
            // Both are as written, not computed, so equal means equal.
            Cell::Number(number) => row.number(column).is_ok_and(|found| found.total_cmp(number).is_eq()),
            Cell::Text(text) => row.text(column) == text.trim(),
        })
    }
}

/// An error at a cell, or at the row where no column is to blame.
pub(super) fn at(file: &Path, row: &Row<'_>, column: Option<usize>, problem: TableProblem) -> TableError {
    let place = column.map_or(Place::Line(row.line), |column| row.place(column));
    TableError::new(file, place, problem)
}
