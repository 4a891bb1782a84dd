//! One barb: from its root on the rachis to the vane's outline.

use kurbo::{CubicBez, ParamCurve, Point, Vec2};

use super::bezier::{Bezier, Jet, refine_nearest};
use super::crossing::{Coincide, Target};
use super::file::BarbsFile;

/// Crossings this close to an end of a barb, in its parameter, are that end.
const END: f64 = 1e-6;

/// A vane: left or right of someone who looks from the shaft's base to its tip.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Side {
    /// Counter-clockwise of the shaft's direction.
    Left,
    /// Clockwise of it.
    Right,
}

impl Side {
    /// Both, in the order of every list.
    pub const BOTH: [Self; 2] = [Self::Left, Self::Right];

    /// `left` or `right`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Left => "left",
            Self::Right => "right",
        }
    }

    /// +1 where a turn from the shaft to this vane is counter-clockwise.
    pub(super) fn sign(self) -> f64 {
        match self {
            Self::Left => 1.0,
            Self::Right => -1.0,
        }
    }
}

/// A barb.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Barb {
    /// Its axis from the root, on the rachis, to its end, on the vane's outline, mm.
    pub curve: CubicBez,
    /// The curve before it was clipped at the outline. The two differ only where a bent barb would have left the vane.
    pub planned: CubicBez,
    /// Distance of the root from the beginning of the rachis, along it, mm.
    pub root_mm: f64,
}

impl Barb {
    /// Point and derivatives of the axis, in powers of t: it is needed at every texel.
    pub(super) fn jet(&self, t: f64) -> Jet {
        let CubicBez { p0, p1, p2, p3 } = self.curve;
        let first = 3.0 * (p1 - p0);
        let second = 3.0 * ((p2 - p1) - (p1 - p0));
        let third = (p3 - p0) - 3.0 * (p2 - p1);
        Jet {
            point: p0 + t * (first + t * (second + t * third)),
            derivative: first + t * (2.0 * second + 3.0 * t * third),
            second: 2.0 * second + 6.0 * t * third,
        }
    }

    /// The unit tangent at t, from root to end.
    pub fn tangent(&self, t: f64) -> Vec2 {
        self.jet(t).derivative.normalize()
    }

    /// The parameter of the nearest point of the axis, from a guess that is near it.
    pub(super) fn nearest(&self, target: Point, guess: f64) -> f64 {
        refine_nearest(|t| self.jet(t), target, guess)
    }
}

/// Why a barb cannot be drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Astray {
    /// The line in its direction never meets the outline.
    Misses,
    /// It meets the shaft before the outline.
    MeetsShaft,
    /// It lies along a straight piece of the outline.
    Grazes,
}

impl From<Coincide> for Astray {
    fn from(_: Coincide) -> Self {
        Self::Grazes
    }
}

/// What barbs of one vane grow between.
#[derive(Debug)]
pub(super) struct Bed<'a> {
    pub(super) side: Side,
    pub(super) rachis: &'a Target,
    pub(super) outline: &'a Target,
    /// Length that reaches from anywhere to beyond the feather, mm.
    pub(super) reach_mm: f64,
}

impl Bed<'_> {
    /// The barb with its root at this place, where the rachis runs along the unit vector `up`: the first thesis (Romeo
    /// Arroyo 2021), section 4.2 and equation 4.1,
    ///
    /// ```text
    /// P1 = P0 + v1 d w + v2 d w',   P2 = P3 − v3 d w + v4 d w'
    /// ```
    ///
    /// with w the direction from P0 to P3, d their distance, and w' the unit normal to w that points to the feather's tip,
    /// so that the two vanes mirror each other. (Printed there: P2 = P0 + (d − v3 d w) + …, which adds a length to a point,
    /// and w' "tangent" to w.)
    pub(super) fn barb(&self, root: Point, up: Vec2, angle: f64, shape: &BarbsFile) -> Result<Barb, Astray> {
        // The line from the root, turned out of the rachis by the barb's angle, to the outline.
        let w = rotated(up, self.side.sign() * angle);
        let ray = Bezier::new(vec![root, root + self.reach_mm * w]);
        let beyond_root = |first: f64| first * self.reach_mm > END;
        let end = self.outline.crossings(&ray)?.into_iter().find(|hit| beyond_root(hit.first));
        let farthest = end.map_or(1.0, |hit| hit.first);
        if self.rachis.crossings(&ray)?.iter().any(|hit| beyond_root(hit.first) && hit.first < farthest) {
            return Err(Astray::MeetsShaft);
        }
        let end = end.ok_or(Astray::Misses)?;

        // The curve over that line.
        let d = (end.point - root).hypot();
        let normal = rotated(w, -self.side.sign() * std::f64::consts::FRAC_PI_2);
        let planned = CubicBez::new(
            root,
            root + shape.v1 * d * w + shape.v2 * d * normal,
            end.point - shape.v3 * d * w + shape.v4 * d * normal,
            end.point,
        );

        // A curve that bulges may leave the vane before its end: it is cut where it does so.
        let curve = if shape.v2 == 0.0 && shape.v4 == 0.0 {
            planned
        } else {
            let inner = |first: f64| (END..1.0 - END).contains(&first);
            let bent = Bezier::from(planned);
            let exit = self.outline.crossings(&bent)?.into_iter().find(|hit| inner(hit.first));
            let last = exit.map_or(1.0, |hit| hit.first);
            if self.rachis.crossings(&bent)?.iter().any(|hit| inner(hit.first) && hit.first < last) {
                return Err(Astray::MeetsShaft);
            }
            match exit {
                Some(exit) => CubicBez { p3: exit.point, ..planned.subsegment(0.0..exit.first) },
                None => planned,
            }
        };
        Ok(Barb { curve, planned, root_mm: 0.0 })
    }
}

/// A vector turned counter-clockwise by an angle in radians.
fn rotated(vector: Vec2, angle: f64) -> Vec2 {
    let (sine, cosine) = angle.sin_cos();
    Vec2::new(cosine * vector.x - sine * vector.y, sine * vector.x + cosine * vector.y)
}
