//! Directions in which the readings tell nothing, or less than the bounds do.

use super::curvature::{Curvature, directions};
use super::minima::Found;
use super::objective::Objective;
use super::outcome::OpenDirection;
use super::summary::{ranges, sigma};

/// Combinations of relative changes that the readings do not tell apart.
pub(super) fn open_directions(
    objective: &Objective<'_>,
    best: &Found,
    curvature: &Curvature,
    names: &[String],
) -> Vec<OpenDirection> {
    let ranges = ranges(objective);
    let size = |j: usize| {
        let value = best.free[j].abs();
        if value > 0.0 {
            value
        } else if ranges[j].is_finite() {
            ranges[j]
        } else {
            1.0
        }
    };
    let mut matrix = curvature.columns(&curvature.inner);
    for (k, &j) in curvature.inner.iter().enumerate() {
        matrix.column_mut(k).scale_mut(size(j));
    }
    let directions = directions(matrix);
    let largest = directions.first().map_or(0.0, |direction| direction.0);
    let sigma = sigma(objective, best.cost);
    let mut open = Vec::new();
    for (value, direction) in directions {
        let no_rank = value <= 1e-9 * largest;
        // Twice 1.96 standard errors along the direction against the width of the box.
        let wider = sigma.is_some_and(|sigma| {
            curvature
                .inner
                .iter()
                .zip(&direction)
                .any(|(&j, share)| share.abs() * size(j) * 3.92 * sigma / value >= ranges[j] && share.abs() > 0.1)
        });
        if no_rank || wider {
            open.push(describe(&curvature.inner, &direction, names, value / largest.max(f64::MIN_POSITIVE)));
        }
    }
    open
}

fn describe(inner: &[usize], direction: &[f64], names: &[String], relative: f64) -> OpenDirection {
    let mut shares: Vec<(String, f64)> = inner
        .iter()
        .zip(direction)
        .filter(|(_, share)| share.abs() > 0.1)
        .map(|(&j, &share)| (names[j].clone(), share))
        .collect();
    // Shares that are equal but for rounding keep the order of the parameters.
    shares.sort_by(|a, b| (1e6 * b.1.abs()).round().total_cmp(&(1e6 * a.1.abs()).round()));
    if shares.first().is_some_and(|first| first.1 < 0.0) {
        shares.iter_mut().for_each(|share| share.1 = -share.1);
    }
    let listed: Vec<String> = shares.iter().map(|(name, _)| format!("`{name}`")).collect();
    let text = match listed.as_slice() {
        [one] => format!("The readings do not determine {one}."),
        [first @ .., last] => {
            format!("The readings give {} and {last} only as a combination, not each by itself.", first.join(", "))
        }
        [] => String::new(),
    };
    OpenDirection { shares, relative_singular_value: relative, text }
}
