//! How fast readings and colours change at a point.

use super::colour::ColourMaker;
use super::forward::{Forward, Refusal};
use super::outcome::{Rate, Slope};
use crate::job::JobError;
use crate::measure::colour::Lab;
use crate::sensitivity::{Derivative, DerivativeError, Range, derivative};

/// Length of the step in CIELAB over which ΔE2000 is taken as a multiple of the step: far below what an eye sees, far above
/// rounding.
const LAB_STEP: f64 = 1e-3;

/// Slopes by parameter `index` at `value`, `others` at theirs and the rest at the job's own values; `with_readings` leaves
/// those of the readings out where they are not wanted.
///
/// ΔE2000 per unit is that of the slope of L*, a* and b*: ΔE2000 of a change that is small in all three grows in proportion.
pub(super) fn slope(
    forward: &Forward,
    colours: &ColourMaker,
    exposure: f64,
    (index, value): (usize, f64),
    others: &[(usize, f64)],
    with_readings: bool,
) -> Result<Slope, JobError> {
    let parameter = &forward.parameters()[index];
    let at = |value: f64| std::iter::once((index, value)).chain(others.iter().copied()).collect::<Vec<_>>();
    let evaluate = |value: f64| -> Result<Vec<f64>, Refusal> {
        let readings = forward.readings(&at(value))?;
        let mut numbers = Vec::new();
        for (view, readings) in forward.views.iter().zip(&readings) {
            if let Some(colour) = colours.colour(view, forward.quantity, readings, exposure) {
                numbers.extend([colour.lab.l, colour.lab.a, colour.lab.b]);
            }
        }
        if with_readings {
            numbers.extend(readings.into_iter().flatten());
        }
        Ok(numbers)
    };
    let (lower, upper) = forward.range(index);
    let size = if value == 0.0 { parameter.upper - parameter.lower } else { value.abs() };
    let found = derivative(evaluate, value, Range { lower, upper, size }).map_err(|error| match error {
        DerivativeError::Function(refusal) => refusal.at("sweep"),
        error @ DerivativeError::NoRoom { .. } => JobError::key("sweep", format!("{}: {error}", parameter.name)),
    })?;

    let here = forward.readings(&at(value)).map_err(|refusal| refusal.at("sweep"))?;
    let mut differences = Vec::new();
    for (number, (view, readings)) in forward.views.iter().zip(&here).enumerate() {
        if let Some(colour) = colours.colour(view, forward.quantity, readings, exposure) {
            differences.push(difference(colour.lab, &found, 3 * number));
        }
    }
    let mut next = 3 * differences.len();
    let mut readings = Vec::new();
    if with_readings {
        for view in &forward.views {
            let end = next + view.wavelengths_nm.len();
            readings.push((next..end).map(|component| rate(&found, component)).collect());
            next = end;
        }
    }
    Ok(Slope { parameter: parameter.clone(), at: value, side: found.side, readings, differences })
}

fn rate(found: &Derivative, component: usize) -> Rate {
    Rate {
        per_unit: found.slopes[component],
        error: found.errors[component],
        step: found.steps[component],
        is_kink: found.kinks[component],
    }
}

/// ΔE2000 per unit from the slopes of L*, a* and b*, which stand from `first` on.
fn difference(lab: Lab, found: &Derivative, first: usize) -> Rate {
    let parts = first..first + 3;
    let slopes = &found.slopes[parts.clone()];
    let errors = &found.errors[parts.clone()];
    Rate {
        per_unit: length(lab, slopes),
        // The triangle's inequality: an error of the slopes changes the length by no more than its own length.
        error: length(lab, errors),
        step: found.steps[parts.clone()].iter().copied().fold(f64::INFINITY, f64::min),
        is_kink: found.kinks[parts].contains(&true),
    }
}

/// Length of a small change of a colour, by ΔE2000, as a multiple of the change.
fn length(lab: Lab, change: &[f64]) -> f64 {
    let size = change.iter().map(|part| part * part).sum::<f64>().sqrt();
    if size == 0.0 {
        return 0.0;
    }
    let scale = 0.5 * LAB_STEP / size;
    let moved = |sign: f64| Lab {
        l: lab.l + sign * scale * change[0],
        a: lab.a + sign * scale * change[1],
        b: lab.b + sign * scale * change[2],
    };
    moved(-1.0).delta_e_2000(moved(1.0)) * size / LAB_STEP
}

#[cfg(test)]
mod tests {
    use super::*;

    /// On the grey axis ΔE2000 of a change in lightness alone is `ΔL*/S_L` with the `S_L` of Sharma, Wu and Dalal (2005).
    #[test]
    fn the_length_of_a_change_in_lightness_is_known() {
        for l in [10.0, 50.0, 90.0] {
            let from_middle: f64 = (l - 50.0f64).powi(2);
            let s_l = 1.0 + 0.015 * from_middle / (20.0 + from_middle).sqrt();
            let found = length(Lab { l, a: 0.0, b: 0.0 }, &[3.0, 0.0, 0.0]);
            // A step of 1e-3 in L* is told from its rounding, of 1e-14 in 100, to about 1e-11.
            approx::assert_relative_eq!(found, 3.0 / s_l, max_relative = 1e-9);
        }
    }

    /// A length grows in proportion to the change, in any direction.
    #[test]
    fn a_change_twice_as_large_is_twice_as_long() {
        let lab = Lab { l: 40.0, a: 30.0, b: -50.0 };
        for change in [[1.0, 2.0, 3.0], [0.1, -5.0, 0.3], [0.0, 0.0, 1.0]] {
            let doubled: Vec<f64> = change.iter().map(|part| 2.0 * part).collect();
            approx::assert_relative_eq!(length(lab, &doubled), 2.0 * length(lab, &change), max_relative = 1e-12);
        }
    }
}
