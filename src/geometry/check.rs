//! Whether the numbers of a feather make sense, each for itself.

use super::bezier::MOST_CONTROL_POINTS;
use super::file::FeatherFile;
use super::{FeatherMistake, Side};
use crate::number;

/// A shaft that is shorter is none, mm.
pub(super) const SHORTEST_SHAFT_MM: f64 = 0.1;

/// The longest feathers, of some breeds of fowl, reach ten metres; no coordinate needs to be larger.
const LARGEST_COORDINATE_MM: f64 = 20_000.0;

/// Barbs in one vane: an eagle's primary has some 1,500.
pub(super) const MOST_BARBS: u32 = 20_000;

/// Smallest v1 and v3: with 0 the barb would have no direction at its end.
const SMALLEST_HANDLE: f64 = 0.01;

/// The first number that makes no sense.
pub(super) fn numbers(file: &FeatherFile) -> Result<(), FeatherMistake> {
    let shaft = &file.shaft;
    points("shaft.control_points_mm", &shaft.control_points_mm, 2, MOST_CONTROL_POINTS)?;
    within("shaft.base_width_mm", shaft.base_width_mm, 0.001, 50.0, "mm")?;
    within("shaft.tip_width_mm", shaft.tip_width_mm, 0.001, 50.0, "mm")?;
    within("shaft.calamus_length_mm", shaft.calamus_length_mm, 0.0, LARGEST_COORDINATE_MM, "mm")?;
    for (side, vane) in [(Side::Left, &file.left_vane), (Side::Right, &file.right_vane)] {
        let key = |name: &str| format!("{}_vane.{name}", side.name());
        points(&key("control_points_mm"), &vane.control_points_mm, 1, MOST_CONTROL_POINTS - 2)?;
        let angle = vane.barb_angle_deg;
        if !(angle > 0.0 && angle < 90.0) {
            return Err(FeatherMistake::new(
                key("barb_angle_deg"),
                format!(
                    "found {}; expected an angle above 0 and below 90°, between the rachis towards its tip and the barb",
                    found(angle)
                ),
            ));
        }
    }
    let barbs = &file.barbs;
    if !(1..=MOST_BARBS).contains(&barbs.count_per_vane) {
        return Err(FeatherMistake::new(
            "barbs.count_per_vane",
            format!("found {}; expected from 1 to {MOST_BARBS}", barbs.count_per_vane),
        ));
    }
    within("barbs.width_um", barbs.width_um, 0.1, 10_000.0, "µm")?;
    within("barbs.v1", barbs.v1, SMALLEST_HANDLE, 1.0, "")?;
    within("barbs.v3", barbs.v3, SMALLEST_HANDLE, 1.0, "")?;
    within("barbs.v2", barbs.v2, -1.0, 1.0, "")?;
    within("barbs.v4", barbs.v4, -1.0, 1.0, "")?;
    // Rounding of two thirds and one third.
    if barbs.v1 + barbs.v3 > 1.0 + 1e-12 {
        return Err(FeatherMistake::new(
            "barbs.v3",
            format!(
                "v1 + v3 is {}; expected 1 at most, since a barb runs outwards all the way: make one of them smaller",
                number::plain(barbs.v1 + barbs.v3)
            ),
        ));
    }
    if let Some(variation) = &file.variation {
        within("variation.root", variation.root, 0.0, 0.3, "of the spacing of roots")?;
        within("variation.angle_deg", variation.angle_deg, 0.0, 30.0, "°")?;
        within("variation.angle_reach_mm", variation.angle_reach_mm, 0.0, 100.0, "mm")?;
    }
    Ok(())
}

fn within(key: &str, value: f64, lower: f64, upper: f64, unit: &str) -> Result<(), FeatherMistake> {
    if (lower..=upper).contains(&value) {
        return Ok(());
    }
    let range = format!("from {} to {} {unit}", number::plain(lower), number::plain(upper));
    Err(FeatherMistake::new(key, format!("found {}; expected {}", found(value), range.trim_end())))
}

fn points(key: &str, points: &[[f64; 2]], fewest: usize, most: usize) -> Result<(), FeatherMistake> {
    if !(fewest..=most).contains(&points.len()) {
        let found = match points.len() {
            0 => "no point".to_owned(),
            1 => "one point".to_owned(),
            count => format!("{count} points"),
        };
        return Err(FeatherMistake::new(key, format!("found {found}; expected from {fewest} to {most}")));
    }
    for (index, point) in points.iter().enumerate() {
        for value in point {
            if !(-LARGEST_COORDINATE_MM..=LARGEST_COORDINATE_MM).contains(value) {
                return Err(FeatherMistake::new(
                    format!("{key}[{}]", index + 1),
                    format!(
                        "found {}; expected a coordinate in mm, at most {} from 0",
                        found(*value),
                        number::plain(LARGEST_COORDINATE_MM)
                    ),
                ));
            }
        }
    }
    Ok(())
}

fn found(value: f64) -> String {
    if value.is_finite() { number::plain(value) } else { format!("{value}") }
}
