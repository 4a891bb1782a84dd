//! Charts around a point of the surface: lobes in the plane of incidence, and all viewers of a hemisphere seen from above.

use std::f64::consts::SQRT_2;

use super::chart::{Axis, Look, Mark, Series, length};
use super::frame::{Frame, thinned};
use super::layout::{TICK_SIZE, line, marker, stroke, text, x_ticks};
use super::palette::{BLACK, Colour, GREY, INK, PALE, Scale};
use super::plot::{Align, Shape, text_width};
use super::ticks::{Tick, linear, logarithmic};

/// A chart without axes of its own.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Disc {
    Lobes(LobeChart),
    Dome(Dome),
}

/// Values over the viewer's angle in the plane of incidence, as distances from a point of the surface.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LobeChart {
    /// Lines over the viewer's angle from the normal, degrees: positive on the mirror side, drawn right; beyond ±90 below the
    /// surface.
    pub(crate) curves: Vec<Series>,
    /// Inclination of the light, which comes from the left.
    pub(crate) light_deg: f64,
    /// Whether the side below the surface is drawn.
    pub(crate) has_below: bool,
    pub(crate) radius: Radius,
    /// What the distances are, with unit.
    pub(crate) label: String,
}

/// How a value becomes a distance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Radius {
    /// The value at the rim.
    pub(crate) largest: f64,
    /// Whether distances go with the cube root of values.
    pub(crate) is_root: bool,
}

/// Values for every viewer of a hemisphere, in Lambert's azimuthal equal-area projection.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Dome {
    /// One list a ring of equal inclination, from the normal outwards; in it one value an azimuth, from the tangent (x) on
    /// towards y.
    pub(crate) rings: Vec<Vec<f64>>,
    /// Which value has which colour.
    pub(crate) colours: Axis,
    /// Inclination and azimuth of the light, degrees.
    pub(crate) light_deg: (f64, f64),
}

impl Radius {
    /// Distances as the values, or as their cube roots where they differ so much that small ones would not be seen.
    pub(crate) fn of(values: impl Iterator<Item = f64>) -> Self {
        /// Of a lobe that is more than this many times the median value, the rest would be a dot.
        const WIDE: f64 = 8.0;
        let mut sorted: Vec<f64> = values.filter(|v| v.is_finite() && *v > 0.0).collect();
        sorted.sort_by(f64::total_cmp);
        let largest = sorted.last().copied().unwrap_or(1.0);
        let median = sorted.get(sorted.len() / 2).copied().unwrap_or(1.0);
        Self { largest, is_root: largest > WIDE * median }
    }

    fn share(self, value: f64) -> f64 {
        let share = (value / self.largest).clamp(0.0, 1.0);
        if self.is_root { share.cbrt() } else { share }
    }

    /// Circles with a number.
    fn rings(self) -> Vec<Tick> {
        if self.is_root { logarithmic(1e-3 * self.largest, self.largest, 4.0) } else { linear(0.0, self.largest, 4.0) }
    }
}

/// Room around a disc for the numbers at its rim.
const RIM: f64 = 18.0;

/// Draws a disc into the middle of a frame.
pub(super) fn lay(disc: &Disc, frame: Frame, shapes: &mut Vec<Shape>) {
    match disc {
        Disc::Lobes(chart) => lay_lobes(chart, frame, shapes),
        Disc::Dome(dome) => lay_dome(dome, frame, shapes),
    }
}

fn lay_lobes(chart: &LobeChart, frame: Frame, shapes: &mut Vec<Shape>) {
    let middle = (frame.left + frame.right) / 2.0;
    let (radius, height) = if chart.has_below {
        (frame.height().min(frame.width()) / 2.0 - RIM, (frame.top + frame.bottom) / 2.0)
    } else {
        ((frame.height() - RIM).min(frame.width() / 2.0) - RIM, frame.bottom - RIM)
    };
    // A direction at this angle from the normal, so far from the point.
    let at = |angle_deg: f64, distance: f64| {
        let (sine, cosine) = angle_deg.to_radians().sin_cos();
        (middle + distance * sine, height - distance * cosine)
    };
    let reach_deg = if chart.has_below { 180.0 } else { 90.0 };
    let arc = |distance: f64| -> Vec<(f64, f64)> {
        (-60..=60).map(|step| at(reach_deg * f64::from(step) / 60.0, distance)).collect()
    };
    let rings = chart.radius.rings();
    for ring in &rings {
        shapes.push(line(&arc(radius * chart.radius.share(ring.at)), PALE, 0.8));
    }
    shapes.push(line(&arc(radius), GREY, 0.8));
    for step in -5..=6 {
        let angle_deg = 30.0 * f64::from(step);
        if angle_deg.abs() > reach_deg {
            continue;
        }
        shapes.push(line(&[at(angle_deg, 0.0), at(angle_deg, radius)], PALE, 0.8));
        let from_normal = angle_deg.abs();
        let place = at(angle_deg, radius + 11.0);
        shapes.push(text(format!("{from_normal}°"), place, TICK_SIZE, Align::Middle).coloured(GREY));
    }
    shapes.push(line(&[at(-90.0, radius), at(90.0, radius)], INK, 1.0));
    stroke(&[at(-chart.light_deg, radius), at(-chart.light_deg, 0.0)], INK, 1.2, true, shapes);
    marker(at(-chart.light_deg, radius), Mark::Disc, BLACK, true, shapes);
    for series in &chart.curves {
        let points: Vec<(f64, f64)> =
            series.points.iter().map(|point| at(point.x, radius * chart.radius.share(point.y))).collect();
        if let Look::Line { colour, width, dashed } = series.look {
            stroke(&thinned(&points), colour, width, dashed, shapes);
        }
    }
    // The numbers of the circles, along the surface on the side of the light, each where it has room.
    let mut free_from = 8.0;
    for ring in rings {
        let distance = radius * chart.radius.share(ring.at);
        let half = text_width(&ring.label, TICK_SIZE, false) / 2.0;
        if distance - half >= free_from && distance + half < radius - 4.0 {
            free_from = distance + half + 5.0;
            let (x, y) = at(-90.0, distance);
            shapes.push(text(ring.label, (x, y + 9.0), TICK_SIZE, Align::Middle).into());
        }
    }
}

fn lay_dome(dome: &Dome, frame: Frame, shapes: &mut Vec<Shape>) {
    let centre = ((frame.left + frame.right) / 2.0, (frame.top + frame.bottom) / 2.0);
    let radius = frame.height().min(frame.width()) / 2.0 - RIM;
    // Equal areas of the picture are equal solid angles: the distance goes with sin(θ/2).
    let distance = |theta_deg: f64| radius * SQRT_2 * (theta_deg.to_radians() / 2.0).sin();
    let at = |distance: f64, phi_deg: f64| {
        let (sine, cosine) = phi_deg.to_radians().sin_cos();
        (centre.0 + distance * cosine, centre.1 - distance * sine)
    };
    let ring_deg = 90.0 / length(dome.rings.len());
    // From the rim inwards, each cell a little over its outer neighbour, so that no seam shows between them.
    for (index, ring) in dome.rings.iter().enumerate().rev() {
        let (inner, outer) = (distance(ring_deg * length(index)), distance(ring_deg * length(index + 1)) + 0.5);
        let step_deg = 360.0 / length(ring.len());
        let colours: Vec<_> = ring.iter().map(|value| colour(*value, &dome.colours)).collect();
        let mut first = 0;
        while first < colours.len() {
            let run = colours[first..].iter().take_while(|colour| **colour == colours[first]).count();
            let edge = |column: usize| step_deg * length(column);
            let outside = (first..=first + run).map(|column| at(outer.min(radius), edge(column)));
            let inside = (first..=first + run).rev().map(|column| at(inner, edge(column)));
            shapes.push(Shape::Polygon { points: outside.chain(inside).collect(), colour: colours[first] });
            first += run;
        }
    }
    let circle = |theta_deg: f64| -> Vec<(f64, f64)> {
        (0..=90).map(|step| at(distance(theta_deg), 4.0 * f64::from(step))).collect()
    };
    for theta_deg in [30.0, 60.0] {
        shapes.push(line(&circle(theta_deg), GREY, 0.6));
    }
    shapes.push(line(&circle(90.0), INK, 1.0));
    let sides = [
        ("0°", 0.0, 4.0, Align::Start),
        ("90°", 90.0, 9.0, Align::Middle),
        ("180°", 180.0, 4.0, Align::End),
        ("270°", 270.0, 9.0, Align::Middle),
    ];
    for (azimuth, phi_deg, gap, align) in sides {
        shapes.push(text(azimuth.to_owned(), at(radius + gap, phi_deg), TICK_SIZE, align).coloured(GREY));
    }
    let (theta_deg, phi_deg) = dome.light_deg;
    marker(at(distance(theta_deg), phi_deg), Mark::Disc, BLACK, true, shapes);
    if theta_deg > 0.0 {
        marker(at(distance(theta_deg), phi_deg + 180.0), Mark::Diamond, BLACK, true, shapes);
    }
}

/// The colour of a value, in 64 steps; what is beyond an end has that end's.
fn colour(value: f64, colours: &Axis) -> Colour {
    const STEPS: f64 = 64.0;
    let share = colours.share(value).unwrap_or(0.0).clamp(0.0, 1.0);
    Scale::Sequential { low: 0.0, high: 1.0 }.colour((STEPS * share).round() / STEPS)
}

/// Draws the bar of a dome's colours and returns where it ends.
pub(super) fn colour_bar(dome: &Dome, frame: Frame, top: f64, shapes: &mut Vec<Shape>) -> f64 {
    const STEPS: u32 = 64;
    let bar = Frame { left: frame.left + RIM, top, right: frame.right - RIM, bottom: top + 10.0 };
    for step in 0..STEPS {
        let edge = |s: u32| bar.left + bar.width() * f64::from(s) / f64::from(STEPS);
        let colour = Scale::Sequential { low: 0.0, high: 1.0 }.colour((f64::from(step) + 0.5) / f64::from(STEPS));
        let to = ((edge(step + 1) + 0.6).min(bar.right), bar.bottom);
        shapes.push(Shape::Rectangle { from: (edge(step), top), to, colour });
    }
    x_ticks(&dome.colours, bar, shapes);
    let at = ((bar.left + bar.right) / 2.0, bar.bottom + 27.0);
    shapes.push(text(dome.colours.label.clone(), at, TICK_SIZE, Align::Middle).into());
    at.1 + 9.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_values_or_their_cube_roots() {
        let even = Radius::of([0.2, 0.3, 0.4].into_iter());
        assert_eq!(even, Radius { largest: 0.4, is_root: false });
        approx::assert_relative_eq!(even.share(0.1), 0.25);
        let glossy = Radius::of([0.01, 0.01, 0.01, 8.0].into_iter());
        assert!(glossy.is_root);
        approx::assert_relative_eq!(glossy.share(1.0), 0.5);
        assert_eq!(glossy.rings().iter().map(|ring| ring.label.as_str()).collect::<Vec<_>>(), ["0.01", "0.1", "1"]);
    }
}
