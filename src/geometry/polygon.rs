//! Closed polygons: the shaft, a barb and a vane as areas.

use kurbo::{Point, Vec2};

use super::barb::Barb;
use super::bezier::{Bezier, as_f64, even_steps};
use super::feather::{Shaft, Vane};

/// The area inside a polygon, positive where it runs counter-clockwise with y up (the shoelace formula).
pub(super) fn signed_area(points: &[Point]) -> f64 {
    let next = points.iter().cycle().skip(1);
    0.5 * points.iter().zip(next).map(|(a, b)| a.to_vec2().cross(b.to_vec2())).sum::<f64>()
}

/// The same polygon, counter-clockwise.
pub(super) fn counter_clockwise(mut points: Vec<Point>) -> Vec<Point> {
    if signed_area(&points) < 0.0 {
        points.reverse();
    }
    points
}

/// A band around a curve with straight ends, from points, unit tangents and half widths along it.
fn band(places: impl Iterator<Item = (Point, Vec2, f64)>) -> Vec<Point> {
    let (mut left, mut right) = (Vec::new(), Vec::new());
    for (point, tangent, half) in places {
        let normal = half * Vec2::new(-tangent.y, tangent.x);
        left.push(point + normal);
        right.push(point - normal);
    }
    left.extend(right.into_iter().rev());
    counter_clockwise(left)
}

/// The shaft as an area, its edges off by no more than `tolerance_mm`.
pub(super) fn shaft(shaft: &Shaft, tolerance_mm: f64) -> Vec<Point> {
    // The edge of a bent band bends more than its axis, but no feather's so much that twice the points would not do.
    let axis = shaft.curve.polyline(0.25 * tolerance_mm);
    band(axis.into_iter().map(|(t, point)| (point, shaft.curve.tangent(t), 0.5 * shaft.width_mm(t))))
}

/// A barb as an area.
pub(super) fn barb(barb: &Barb, width_mm: f64, tolerance_mm: f64) -> Vec<Point> {
    let axis = Bezier::from(barb.curve).polyline(0.25 * tolerance_mm);
    band(axis.into_iter().map(|(t, point)| (point, barb.tangent(t), 0.5 * width_mm)))
}

/// A vane as an area: between rachis and outline, from its first barb to its last. A vane is what barbs make, so that none
/// lies before the first nor beyond the last, even where the outline goes farther.
pub(super) fn vane(vane: &Vane, shaft: &Shaft, tolerance_mm: f64) -> Vec<Point> {
    let (first, last) = (&vane.barbs[0], &vane.barbs[vane.barbs.len() - 1]);
    let mut around: Vec<Point> = line(&first.curve.into(), tolerance_mm);

    // Up the outline from the first barb's end to the last one's.
    let outline = vane.outline.polyline(tolerance_mm);
    let (from, to) = (parameter_near(&outline, first.curve.p3), parameter_near(&outline, last.curve.p3));
    around.extend(outline.iter().filter(|(t, _)| *t > from && *t < to).map(|(_, point)| *point));

    around.extend(line(&last.curve.into(), tolerance_mm).into_iter().rev());

    // Down the rachis.
    let (top, bottom) = (shaft.at_rachis_mm(last.root_mm), shaft.at_rachis_mm(first.root_mm));
    let steps = as_f64(shaft.curve.polyline(tolerance_mm).len());
    around.extend(even_steps(steps).map(|share| shaft.curve.point(top + share * (bottom - top))));
    counter_clockwise(around)
}

fn line(curve: &Bezier, tolerance_mm: f64) -> Vec<Point> {
    curve.polyline(tolerance_mm).into_iter().map(|(_, point)| point).collect()
}

/// The parameter of a polyline's point that is nearest to a place on it, between its points.
fn parameter_near(line: &[(f64, Point)], place: Point) -> f64 {
    let share = |pair: &[(f64, Point)]| {
        let chord = pair[1].1 - pair[0].1;
        ((place - pair[0].1).dot(chord) / chord.hypot2()).clamp(0.0, 1.0)
    };
    line.windows(2)
        .map(|pair| {
            let share = share(pair);
            let distance = (pair[0].1.lerp(pair[1].1, share) - place).hypot2();
            (distance, pair[0].0 + share * (pair[1].0 - pair[0].0))
        })
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map_or(0.0, |(_, t)| t)
}
