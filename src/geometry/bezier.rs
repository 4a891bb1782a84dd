//! One Bézier curve with any number of control points.
//!
//! A shaft and an outline are one such curve each, as in the first thesis (Romeo Arroyo 2021, section 4.1), which sets no
//! limit to the number of points; kurbo's curves end at four. Everything is by de Casteljau's algorithm, which is stable for
//! any degree: its points are means of the control points, never differences.

use kurbo::{Point, Rect, Vec2};

/// Control points that one curve may have: evaluation takes the square of it.
pub(super) const MOST_CONTROL_POINTS: usize = 64;

/// A Bézier curve; its parameter t runs from 0 to 1.
#[derive(Debug, Clone, PartialEq)]
pub struct Bezier {
    points: Vec<Point>,
}

impl Bezier {
    /// The curve with these control points, two or more (at most [`MOST_CONTROL_POINTS`], which the caller has checked).
    pub(super) fn new(points: Vec<Point>) -> Self {
        debug_assert!((2..=MOST_CONTROL_POINTS).contains(&points.len()), "{} control points", points.len());
        Self { points }
    }

    /// Its control points.
    pub fn control_points(&self) -> &[Point] {
        &self.points
    }

    /// Where it begins.
    pub fn start(&self) -> Point {
        self.points[0]
    }

    /// Where it ends.
    pub fn end(&self) -> Point {
        self.points[self.points.len() - 1]
    }

    /// The point at t.
    pub fn point(&self, t: f64) -> Point {
        self.jet(t).point
    }

    /// Point and first two derivatives by t.
    pub(super) fn jet(&self, t: f64) -> Jet {
        let mut buffer = [Point::ZERO; MOST_CONTROL_POINTS];
        let count = self.points.len();
        buffer[..count].copy_from_slice(&self.points);
        let degree = count - 1;
        let n = as_f64(degree);
        let (mut derivative, mut second) = (Vec2::ZERO, Vec2::ZERO);
        for left in (1..count).rev() {
            // With three points left their second difference, with two their first, is the derivative up to a factor.
            if left == 2 {
                second = n * (n - 1.0) * ((buffer[2] - buffer[1]) - (buffer[1] - buffer[0]));
            }
            if left == 1 {
                derivative = n * (buffer[1] - buffer[0]);
            }
            for index in 0..left {
                buffer[index] = buffer[index].lerp(buffer[index + 1], t);
            }
        }
        Jet { point: buffer[0], derivative, second }
    }

    /// The unit tangent at t, towards larger t.
    pub fn tangent(&self, t: f64) -> Vec2 {
        self.jet(t).derivative.normalize()
    }

    /// The two parts before and after t.
    pub(super) fn split(&self, t: f64) -> (Self, Self) {
        let count = self.points.len();
        let mut rest = self.points.clone();
        let (mut before, mut after) = (Vec::with_capacity(count), vec![Point::ZERO; count]);
        for left in (0..count).rev() {
            before.push(rest[0]);
            after[left] = rest[left];
            for index in 0..left {
                rest[index] = rest[index].lerp(rest[index + 1], t);
            }
        }
        (Self { points: before }, Self { points: after })
    }

    /// The part after t.
    pub(super) fn after(&self, t: f64) -> Self {
        self.split(t).1
    }

    /// A rectangle around the control points, and so around the curve.
    pub(super) fn hull(&self) -> Rect {
        self.points[1..].iter().fold(Rect::from_points(self.points[0], self.points[0]), |hull, &p| hull.union_pt(p))
    }

    /// Largest distance of a control point from the chord between the ends, and with it the curve's.
    pub(super) fn deviation(&self) -> f64 {
        let chord = self.end() - self.start();
        let length = chord.hypot();
        self.points[1..self.points.len() - 1]
            .iter()
            .map(|&point| {
                let off = point - self.start();
                // A point beyond an end is off the chord as well.
                let along = off.dot(chord) / length;
                if length > 0.0 && (0.0..=length).contains(&along) {
                    (chord.cross(off) / length).abs()
                } else {
                    off.hypot().min((point - self.end()).hypot())
                }
            })
            .fold(0.0, f64::max)
    }

    /// Whether the curve's direction stays within a quarter turn, so that it cannot cross itself, and never stands still.
    pub(super) fn turns_little(&self) -> bool {
        let chord = self.end() - self.start();
        let cos_eighth = std::f64::consts::FRAC_1_SQRT_2;
        self.points
            .windows(2)
            .all(|pair| (pair[1] - pair[0]).dot(chord) > cos_eighth * (pair[1] - pair[0]).hypot() * chord.hypot())
    }

    /// The parameter of the nearest point, by Newton's method from a guess that is near it.
    pub(super) fn nearest(&self, target: Point, guess: f64) -> f64 {
        refine_nearest(|t| self.jet(t), target, guess)
    }

    /// Points at even steps of t, so many that the polyline through them errs by no more than `tolerance`.
    pub(super) fn polyline(&self, tolerance: f64) -> Vec<(f64, Point)> {
        self.polyline_in_pieces(tolerance, f64::INFINITY)
    }

    /// The same with no piece longer than `longest`.
    pub(super) fn polyline_in_pieces(&self, tolerance: f64, longest: f64) -> Vec<(f64, Point)> {
        let n = as_f64(self.points.len() - 1);
        // A chord over a step h of t is off by at most h²/8 of the second derivative, and that by n(n − 1) of the second
        // differences of the control points; the first derivative is at most n of the first ones.
        let bend = self.points.windows(3).map(|three| ((three[2] - three[1]) - (three[1] - three[0])).hypot());
        let second = n * (n - 1.0) * bend.fold(0.0, f64::max);
        let first = n * self.points.windows(2).map(|pair| (pair[1] - pair[0]).hypot()).fold(0.0, f64::max);
        let steps = (second / (8.0 * tolerance)).sqrt().max(first / longest);
        even_steps(steps).map(|t| (t, self.point(t))).collect()
    }
}

impl From<kurbo::CubicBez> for Bezier {
    fn from(cubic: kurbo::CubicBez) -> Self {
        Self::new(vec![cubic.p0, cubic.p1, cubic.p2, cubic.p3])
    }
}

/// A point of a curve with the first two derivatives by its parameter.
#[derive(Debug, Clone, Copy)]
pub(super) struct Jet {
    pub(super) point: Point,
    pub(super) derivative: Vec2,
    pub(super) second: Vec2,
}

/// The parameter in 0 to 1 of the point nearest to a target, by Newton's method on (C − target)·C′ = 0.
pub(super) fn refine_nearest(curve: impl Fn(f64) -> Jet, target: Point, guess: f64) -> f64 {
    let mut t = guess;
    // From a guess on a polyline of the curve the error squares with every step, and three are past double precision; near the
    // centre of curvature it only shrinks by a factor.
    for _ in 0..20 {
        let Jet { point, derivative, second } = curve(t);
        let off = point - target;
        // Beyond the centre of curvature Newton's step would run away from the nearest point; Gauss and Newton's does not.
        let slope = derivative.hypot2();
        let full = slope + off.dot(second);
        let step = off.dot(derivative) / if full > 0.1 * slope { full } else { slope };
        let next = (t - step).clamp(0.0, 1.0);
        if (next - t).abs() < 1e-12 {
            return next;
        }
        t = next;
    }
    t
}

/// Parameters from 0 to 1 in even steps, at least this many.
pub(super) fn even_steps(at_least: f64) -> impl Iterator<Item = f64> {
    /// A curve in more pieces than this would be finer than a double resolves its bends.
    const MOST: f64 = 65536.0;
    let count = at_least.ceil().clamp(1.0, MOST);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 1 and 65536")]
    let steps = count as u32;
    (0..=steps).map(move |step| f64::from(step) / count)
}

#[expect(clippy::cast_precision_loss, reason = "numbers of control points and of barbs are far below 2^53")]
pub(super) fn as_f64(count: usize) -> f64 {
    count as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use kurbo::{CubicBez, ParamCurve, ParamCurveDeriv};

    fn cubic() -> CubicBez {
        CubicBez::new((0.0, 0.0), (1.0, 3.0), (4.0, -2.0), (5.0, 1.0))
    }

    /// Degree raised by hand keeps the curve (Farin 2002, section 6.1).
    fn raised(curve: &Bezier) -> Bezier {
        let points = curve.control_points();
        let n = as_f64(points.len());
        let inner = (1..points.len()).map(|i| points[i].lerp(points[i - 1], as_f64(i) / n));
        let ends = (curve.start(), curve.end());
        Bezier::new(std::iter::once(ends.0).chain(inner).chain(std::iter::once(ends.1)).collect())
    }

    #[test]
    fn a_cubic_of_higher_degree_is_kurbos_cubic() {
        let curve = raised(&raised(&raised(&cubic().into())));
        assert_eq!(curve.control_points().len(), 7);
        for t in even_steps(16.0) {
            let jet = curve.jet(t);
            let derivative = cubic().deriv().eval(t).to_vec2();
            let second = cubic().deriv().deriv().eval(t).to_vec2();
            // Rounding of some thirty operations on numbers of size 10 to 100.
            assert!((jet.point - cubic().eval(t)).hypot() < 1e-13);
            assert!((jet.derivative - derivative).hypot() < 1e-12);
            assert!((jet.second - second).hypot() < 1e-11);
        }
    }

    #[test]
    fn parts_are_the_same_curve() {
        let curve = raised(&cubic().into());
        let (before, after) = curve.split(0.3);
        for t in even_steps(8.0) {
            assert!((before.point(t) - curve.point(0.3 * t)).hypot() < 1e-13);
            assert!((after.point(t) - curve.point(0.3 + 0.7 * t)).hypot() < 1e-13);
        }
    }

    #[test]
    fn the_nearest_point_is_square_to_the_curve() {
        let curve = Bezier::from(cubic());
        for (target, guess) in [((0.9, 0.8), 0.2), ((2.5, 0.9), 0.5), ((4.0, 0.5), 0.9)] {
            let target = Point::from(target);
            let t = curve.nearest(target, guess);
            let jet = curve.jet(t);
            assert!((jet.point - target).dot(jet.derivative).abs() < 1e-9, "at {t}");
        }
    }

    #[test]
    fn a_polyline_stays_within_its_tolerance() {
        let curve = Bezier::from(cubic());
        let line = curve.polyline(1e-3);
        for pair in line.windows(2) {
            let middle = curve.point(0.5 * (pair[0].0 + pair[1].0));
            assert!((middle - pair[0].1.midpoint(pair[1].1)).hypot() <= 1e-3);
        }
    }
}
