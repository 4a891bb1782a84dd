//! Many rectangles against one ray.
//!
//! Eight rectangles lie side by side as lanes of plain arithmetic, which the compiler turns into the widest vectors that
//! the processor has. Whether one is hit is a matter of lanes too: nothing branches until all eight are known.

use super::ray::Ray;
use super::shape::Rectangle;

/// Rectangles that are worked on together.
pub(super) const LANES: usize = 8;

/// A number of each rectangle.
type Lanes = [f64; LANES];

/// A linear function of a point of each rectangle's: product with a vector minus a constant.
#[derive(Debug, Clone, Copy, Default)]
struct Planes {
    vector: [Lanes; 3],
    constant: Lanes,
}

impl Planes {
    fn set(&mut self, lane: usize, vector: [f64; 3], constant: f64) {
        for (lanes, coordinate) in self.vector.iter_mut().zip(vector) {
            lanes[lane] = coordinate;
        }
        self.constant[lane] = constant;
    }

    /// Its value at the ray's origin and its slope along the ray.
    #[inline(always)]
    fn along(&self, ray: &Ray, lane: usize) -> (f64, f64) {
        let [x, y, z] = [self.vector[0][lane], self.vector[1][lane], self.vector[2][lane]];
        let (o, d) = (&ray.origin, &ray.direction);
        (x * o.x + y * o.y + z * o.z - self.constant[lane], x * d.x + y * d.y + z * d.z)
    }
}

/// Up to eight rectangles. A lane without one is all zeros: every distance to it is no number.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct RectangleBlock {
    height: Planes,
    place_u: Planes,
    place_v: Planes,
}

/// Where a ray meets the rectangles of a block: infinitely far where it passes by, and the place along both edges.
#[derive(Debug, Clone, Copy)]
pub(super) struct RectangleHits {
    pub(super) distance: Lanes,
    u: Lanes,
    v: Lanes,
}

impl RectangleHits {
    pub(super) fn place(&self, lane: usize) -> [f64; 2] {
        [self.u[lane], self.v[lane]]
    }
}

impl RectangleBlock {
    pub(super) fn set(&mut self, lane: usize, rectangle: &Rectangle) {
        let [normal, place_u, place_v] = rectangle.functions();
        self.height.set(lane, normal.0.into(), normal.1);
        self.place_u.set(lane, place_u.0.into(), place_u.1);
        self.place_v.set(lane, place_v.0.into(), place_v.1);
    }

    /// The points of a ray on them between two distances.
    #[inline(always)]
    pub(super) fn meet(&self, ray: &Ray, nearest: f64, farthest: f64) -> RectangleHits {
        let mut hits = RectangleHits { distance: [0.0; LANES], u: [0.0; LANES], v: [0.0; LANES] };
        for lane in 0..LANES {
            let (height, climb) = self.height.along(ray, lane);
            // A ray along the plane divides by 0: the distance is infinite or no number, and passes no comparison.
            let distance = -height / climb;
            let (u, u_slope) = self.place_u.along(ray, lane);
            let (v, v_slope) = self.place_v.along(ray, lane);
            let (u, v) = (u + distance * u_slope, v + distance * v_slope);
            let is_between = (distance > nearest) & (distance < farthest);
            let is_on = (0.0..=1.0).contains(&u) & (0.0..=1.0).contains(&v);
            hits.distance[lane] = if is_between & is_on { distance } else { f64::INFINITY };
            (hits.u[lane], hits.v[lane]) = (u, v);
        }
        hits
    }
}
