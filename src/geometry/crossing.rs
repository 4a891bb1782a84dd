//! Where two Bézier curves cross.
//!
//! Both are halved as long as the rectangles around their control points overlap, which no crossing can escape, until the
//! pieces are so straight that their chords tell where they meet; that starts Newton's method on the curves themselves,
//! which ends where double precision does. Curves that only touch may be missed: they do not cross.

use kurbo::{Point, Rect, Vec2};

use super::bezier::Bezier;

/// The chords of two pieces meet where the curves do, but for this share of the shorter one: then Newton's method converges
/// at once.
const STRAIGHT: f64 = 0.1;

/// Curves at a smaller angle, in radians, run along each other rather than cross.
const PARALLEL: f64 = 1e-6;

/// Pieces shorter than this share of the curves' size touch without crossing.
const SHORTEST: f64 = 1e-7;

/// Pairs of pieces after which two curves lie on each other. Ten crossings take a few hundred.
const MOST_PAIRS: usize = 20_000;

/// A point in which two curves cross.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Crossing {
    /// Parameter on the first curve.
    pub(super) first: f64,
    /// Parameter on the second curve.
    pub(super) second: f64,
    /// The point, on the second curve.
    pub(super) point: Point,
}

/// The two curves lie on each other over some length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Coincide;

/// A piece of a curve with its range of parameters.
#[derive(Debug, Clone)]
struct Piece {
    curve: Bezier,
    from: f64,
    to: f64,
    hull: Rect,
}

impl Piece {
    fn new(curve: Bezier, from: f64, to: f64) -> Self {
        let hull = curve.hull();
        Self { curve, from, to, hull }
    }

    fn chord(&self) -> Vec2 {
        self.curve.end() - self.curve.start()
    }

    fn size(&self) -> f64 {
        self.hull.width().max(self.hull.height())
    }

    fn halves(&self) -> [Self; 2] {
        let (before, after) = self.curve.split(0.5);
        let middle = 0.5 * (self.from + self.to);
        [Self::new(before, self.from, middle), Self::new(after, middle, self.to)]
    }
}

/// A curve in pieces, to be crossed with many others.
#[derive(Debug, Clone)]
pub(super) struct Target {
    whole: Bezier,
    pieces: Vec<Piece>,
}

impl Target {
    pub(super) fn new(curve: &Bezier) -> Self {
        let mut pieces = vec![Piece::new(curve.clone(), 0.0, 1.0)];
        // 32 pieces: enough that most of them lie clear of a barb.
        for _ in 0..5 {
            pieces = pieces.iter().flat_map(Piece::halves).collect();
        }
        Self { whole: curve.clone(), pieces }
    }

    /// Every crossing with another curve, in the order of that curve's parameter.
    pub(super) fn crossings(&self, first: &Bezier) -> Result<Vec<Crossing>, Coincide> {
        let mut search = Search { first, second: &self.whole, pairs: 0, size: 0.0, found: Vec::new() };
        let piece = Piece::new(first.clone(), 0.0, 1.0);
        search.size = self.whole.hull().union(piece.hull).size().max_side();
        for other in &self.pieces {
            search.pair(&piece, other)?;
        }
        Ok(search.sorted())
    }
}

/// The parameters of a point in which a curve crosses itself, or of one where it stands still (then they are equal).
pub(super) fn self_crossing(curve: &Bezier) -> Option<(f64, f64)> {
    /// Halvings after which a curve that still turns by a quarter has a cusp there.
    const DEEPEST: u32 = 24;
    let mut pieces = Vec::new();
    let mut waiting = vec![(Piece::new(curve.clone(), 0.0, 1.0), 0)];
    while let Some((piece, depth)) = waiting.pop() {
        if piece.curve.turns_little() {
            pieces.push(piece);
        } else if depth == DEEPEST {
            return Some((piece.from, piece.from));
        } else {
            let [before, after] = piece.halves();
            waiting.push((after, depth + 1));
            waiting.push((before, depth + 1));
        }
    }
    for (index, one) in pieces.iter().enumerate() {
        for other in &pieces[index + 1..] {
            let size = curve.hull().size().max_side();
            let mut search = Search { first: curve, second: curve, pairs: 0, size, found: Vec::new() };
            if search.pair(one, other).is_err() {
                return Some((one.from, other.from));
            }
            // Neighbours share a point.
            if let Some(crossing) = search.found.iter().find(|found| (found.second - found.first).abs() > 1e-6) {
                return Some((crossing.first, crossing.second));
            }
        }
    }
    None
}

struct Search<'a> {
    first: &'a Bezier,
    second: &'a Bezier,
    pairs: usize,
    size: f64,
    found: Vec<Crossing>,
}

impl Search<'_> {
    fn pair(&mut self, one: &Piece, other: &Piece) -> Result<(), Coincide> {
        if !touch(one.hull, other.hull) {
            return Ok(());
        }
        self.pairs += 1;
        if self.pairs > MOST_PAIRS {
            return Err(Coincide);
        }
        // The curves lie beside their chords by their deviations, and these cross at an angle: so far off may the chords'
        // crossing be.
        let (chord, other_chord) = (one.chord(), other.chord());
        let (length, other_length) = (chord.hypot(), other_chord.hypot());
        let sine = (chord.cross(other_chord) / (length * other_length)).abs();
        let deviation = one.curve.deviation() + other.curve.deviation();
        if sine > PARALLEL && deviation <= STRAIGHT * sine * length.min(other_length) {
            self.meet(one, other);
            return Ok(());
        }
        if one.size().max(other.size()) < SHORTEST * self.size {
            return Ok(());
        }
        let halve_one = one.size() >= other.size();
        if halve_one {
            one.halves().iter().try_for_each(|half| self.pair(half, other))
        } else {
            other.halves().iter().try_for_each(|half| self.pair(one, half))
        }
    }

    /// Newton's method on both curves from the crossing of two straight pieces' chords.
    fn meet(&mut self, one: &Piece, other: &Piece) {
        let (chord, other_chord) = (one.chord(), other.chord());
        let between = other.curve.start() - one.curve.start();
        let determinant = chord.cross(other_chord);
        let along = between.cross(other_chord) / determinant;
        let other_along = between.cross(chord) / determinant;
        // Twice as far as the curves' crossing may lie from the chords'.
        let near = |share: f64| (-2.0 * STRAIGHT..=1.0 + 2.0 * STRAIGHT).contains(&share);
        if !(near(along) && near(other_along)) {
            return;
        }
        let mut s = one.from + along * (one.to - one.from);
        let mut t = other.from + other_along * (other.to - other.from);
        for _ in 0..8 {
            let (a, b) = (self.first.jet(s), self.second.jet(t));
            let gap = b.point - a.point;
            let determinant = a.derivative.cross(b.derivative);
            if determinant.abs() < f64::MIN_POSITIVE {
                return;
            }
            s += gap.cross(b.derivative) / determinant;
            t += gap.cross(a.derivative) / determinant;
        }
        /// A crossing in the seam of two pieces is found in either; rounding must not lose it in both.
        const SEAM: f64 = 1e-9;
        let inside = |value: f64, piece: &Piece| (piece.from - SEAM..=piece.to + SEAM).contains(&value);
        if !(inside(s, one) && inside(t, other)) {
            return;
        }
        let (s, t) = (s.clamp(0.0, 1.0), t.clamp(0.0, 1.0));
        let point = self.second.point(t);
        let converged = (self.first.point(s) - point).hypot() < 1e-10 * self.size;
        let known = self.found.iter().any(|found| (found.point - point).hypot() < 1e-9 * self.size);
        if converged && !known {
            self.found.push(Crossing { first: s, second: t, point });
        }
    }

    fn sorted(mut self) -> Vec<Crossing> {
        self.found.sort_by(|a, b| a.first.total_cmp(&b.first));
        self.found
    }
}

fn touch(one: Rect, other: Rect) -> bool {
    one.x0 <= other.x1 && other.x0 <= one.x1 && one.y0 <= other.y1 && other.y0 <= one.y1
}

#[cfg(test)]
mod tests {
    use super::*;
    use kurbo::{CubicBez, Line, PathSeg};
    use proptest::prelude::*;

    fn curve(points: &[(f64, f64)]) -> Bezier {
        Bezier::new(points.iter().map(|&point| point.into()).collect())
    }

    /// y = g(x) and x = g(y) with g(x) = (1 + T3(2x − 1))/2 = 16x³ − 24x² + 9x, T3 Chebyshev's polynomial: they cross where
    /// g(g(x)) = x, which has nine roots. That is Bézout's bound for two cubics.
    #[test]
    fn two_cubics_may_cross_nine_times() {
        let third = 1.0 / 3.0;
        let flat = curve(&[(0.0, 0.0), (third, 3.0), (2.0 * third, -2.0), (1.0, 1.0)]);
        let upright = curve(&[(0.0, 0.0), (3.0, third), (-2.0, 2.0 * third), (1.0, 1.0)]);
        let found = Target::new(&upright).crossings(&flat).unwrap();
        assert_eq!(found.len(), 9, "{found:?}");
        let g = |x: f64| 16.0 * x.powi(3) - 24.0 * x.powi(2) + 9.0 * x;
        for crossing in found {
            approx::assert_abs_diff_eq!(g(g(crossing.first)), crossing.first, epsilon = 1e-12);
            let gap = flat.point(crossing.first) - upright.point(crossing.second);
            assert!(gap.hypot() < 1e-13, "{gap:?}");
        }
    }

    #[test]
    fn curves_on_each_other_are_told() {
        let straight = curve(&[(0.0, 0.0), (10.0, 10.0)]);
        let same = curve(&[(1.0, 1.0), (4.0, 4.0), (12.0, 12.0)]);
        assert_eq!(Target::new(&same).crossings(&straight), Err(Coincide));
    }

    #[test]
    fn a_loop_crosses_itself_and_a_bow_does_not() {
        let (one, other) = self_crossing(&curve(&[(0.0, 0.0), (12.0, 10.0), (-2.0, 10.0), (10.0, 0.0)])).unwrap();
        // By symmetry about x = 5 the two parameters sum to 1.
        approx::assert_abs_diff_eq!(one + other, 1.0, epsilon = 1e-12);
        assert!(one < other);
        let cusp = curve(&[(0.0, 0.0), (10.0, 10.0), (0.0, 10.0), (10.0, 0.0)]);
        assert!(self_crossing(&cusp).is_some_and(|(one, other)| (one - other).abs() < 1e-6));
        assert_eq!(self_crossing(&curve(&[(0.0, 0.0), (2.0, 10.0), (8.0, 10.0), (10.0, 0.0)])), None);
        assert!(self_crossing(&curve(&[(1.0, 1.0), (1.0, 1.0)])).is_some(), "a point stands still");
    }

    /// Pieces whose chords met at less than 0.02 were once halved until they were gone. The line meets this cubic twice, at
    /// 0.017; kurbo finds it at 0.426… and 0.4588… of the line.
    #[test]
    fn a_crossing_at_a_small_angle_is_found() {
        let cubic = curve(&[
            (0.0, 0.0),
            (9.1718767234932, -3.021957075675139),
            (-6.252503805689542, 9.187059413735664),
            (-5.470637390522667, -5.139342430303066),
        ]);
        let line = curve(&[(-4.482530763429303, 2.1567461128811654), (-6.276788104582874, -6.514205481092857)]);
        let found = Target::new(&cubic).crossings(&line).unwrap();
        assert_eq!(found.len(), 2, "{found:?}");
        approx::assert_abs_diff_eq!(found[1].first, 0.45883752371499353, epsilon = 1e-9);
    }

    fn coordinate() -> impl Strategy<Value = f64> {
        -10.0..10.0
    }

    proptest! {
        /// Kurbo solves the cubic equation that a line makes of a cubic; the two find the same crossings, but for those
        /// within rounding of an end or of touching, where one may see two and the other none.
        #[test]
        fn a_line_crosses_a_cubic_where_kurbo_finds_it(
            points in proptest::array::uniform4((coordinate(), coordinate())),
            ends in proptest::array::uniform2((coordinate(), coordinate())),
        ) {
            let cubic = CubicBez::new(points[0], points[1], points[2], points[3]);
            let line = Line::new(ends[0], ends[1]);
            let expected: Vec<f64> = PathSeg::Cubic(cubic)
                .intersect_line(line)
                .iter()
                .filter(|hit| {
                    let jet = Bezier::from(cubic).jet(hit.segment_t);
                    let direction = line.p1 - line.p0;
                    let sine = jet.derivative.cross(direction) / (jet.derivative.hypot() * direction.hypot());
                    let inner = |t: f64| (1e-6..1.0 - 1e-6).contains(&t);
                    sine.abs() > 1e-3 && inner(hit.line_t) && inner(hit.segment_t)
                })
                .map(|hit| hit.line_t)
                .collect();
            let found = Target::new(&cubic.into()).crossings(&Bezier::new(vec![line.p0, line.p1])).unwrap();
            for t in expected {
                // Kurbo's root is good to about 1e-9 of the line.
                prop_assert!(found.iter().any(|crossing| (crossing.first - t).abs() < 1e-7), "{t} not in {found:?}");
            }
            for crossing in &found {
                let gap = line.p0.lerp(line.p1, crossing.first) - crossing.point;
                prop_assert!(gap.hypot() < 1e-9);
            }
        }
    }
}
