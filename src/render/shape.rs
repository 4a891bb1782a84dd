//! Spheres and rectangles: where a ray meets them, and how light from them is drawn.

use std::f64::consts::{PI, TAU};

use super::ray::{Hit, Ray, Vector};

/// A sphere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sphere {
    /// Its centre.
    pub centre: Vector,
    /// Its radius, mm.
    pub radius: f64,
}

impl Sphere {
    /// Distance to the first point of the ray on it between two distances.
    #[inline]
    pub fn distance(&self, ray: &Ray, nearest: f64, farthest: f64) -> Option<f64> {
        let to_centre = self.centre - ray.origin;
        let along = to_centre.dot(&ray.direction);
        // The distance of the line from the centre, from the vector rather than from Pythagoras, which would lose digits
        // on small spheres far away (Haines et al. 2019).
        let beside = to_centre - ray.direction * along;
        let half_chord_squared = self.radius * self.radius - beside.norm_squared();
        if half_chord_squared < 0.0 {
            return None;
        }
        let half_chord = half_chord_squared.sqrt();
        [along - half_chord, along + half_chord].into_iter().find(|d| *d > nearest && *d < farthest)
    }

    /// What a ray meets at this distance: u the azimuth about z as a share of the whole turn, v from the lower pole to
    /// the upper.
    pub fn hit(&self, ray: &Ray, distance: f64, surface: usize) -> Hit {
        let normal = (ray.at(distance) - self.centre) / self.radius;
        let normal = normal.normalize();
        let around = normal.x.hypot(normal.y);
        // At a pole every tangent is as good as any other.
        let tangent = if around > 0.0 { Vector::new(-normal.y / around, normal.x / around, 0.0) } else { Vector::x() };
        let azimuth = normal.y.atan2(normal.x).rem_euclid(TAU);
        Hit {
            distance,
            point: self.centre + normal * self.radius,
            normal,
            geometric_normal: normal,
            tangent,
            uv: [azimuth / TAU, normal.z.clamp(-1.0, 1.0).asin() / PI + 0.5],
            surface,
        }
    }

    /// Whether a point is inside.
    pub fn contains(&self, point: &Vector) -> bool {
        (point - self.centre).norm() < self.radius
    }

    /// A direction towards it from outside, uniform over the solid angle that it fills. From inside none is drawn.
    pub fn direction_towards(&self, point: &Vector, random: [f64; 2]) -> Option<Vector> {
        let to_centre = self.centre - point;
        let distance = to_centre.norm();
        if distance <= self.radius {
            return None;
        }
        let axis = to_centre / distance;
        let one_minus_cosine = random[0] * self.one_minus_cosine_of_cone(distance);
        let cosine = 1.0 - one_minus_cosine;
        let sine = (one_minus_cosine * (1.0 + cosine)).max(0.0).sqrt();
        let (sin_phi, cos_phi) = (TAU * random[1]).sin_cos();
        let tangent = super::ray::any_tangent(&axis);
        let bitangent = axis.cross(&tangent);
        Some((axis * cosine + tangent * (sine * cos_phi) + bitangent * (sine * sin_phi)).normalize())
    }

    /// Density of [`Sphere::direction_towards`], 1/sr: one over the solid angle that the sphere fills; 0 from inside.
    pub fn density_towards(&self, point: &Vector) -> f64 {
        let distance = (self.centre - point).norm();
        if distance <= self.radius { 0.0 } else { 1.0 / (TAU * self.one_minus_cosine_of_cone(distance)) }
    }

    /// 1 − cos of the half angle under which the sphere is seen, without cancellation for small ones.
    fn one_minus_cosine_of_cone(&self, distance: f64) -> f64 {
        let sine_squared = (self.radius / distance).powi(2);
        sine_squared / (1.0 + (1.0 - sine_squared).max(0.0).sqrt())
    }
}

/// A rectangle from one corner along two edges that are perpendicular to each other. Its normal is their cross product.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rectangle {
    corner: Vector,
    edge_u: Vector,
    edge_v: Vector,
    normal: Vector,
    tangent: Vector,
    /// Edges over their squared lengths: their products with a point give its place.
    place_u: Vector,
    place_v: Vector,
    area: f64,
}

impl Rectangle {
    /// A rectangle; None where an edge has no length.
    pub fn new(corner: Vector, edge_u: Vector, edge_v: Vector) -> Option<Self> {
        let normal = edge_u.cross(&edge_v);
        let area = normal.norm();
        let normal = normal.try_normalize(0.0)?;
        Some(Self {
            corner,
            edge_u,
            edge_v,
            normal,
            tangent: edge_u.normalize(),
            place_u: edge_u / edge_u.norm_squared(),
            place_v: edge_v / edge_v.norm_squared(),
            area,
        })
    }

    /// The side on which a light on it shines.
    pub fn normal(&self) -> Vector {
        self.normal
    }

    /// mm².
    pub fn area(&self) -> f64 {
        self.area
    }

    /// Its four corners.
    pub fn corners(&self) -> [Vector; 4] {
        let (a, b) = (self.corner, self.corner + self.edge_u);
        [a, b, b + self.edge_v, a + self.edge_v]
    }

    /// Three linear functions of a point, each a vector to multiply it with and a number to take away: its height above
    /// the plane, and its place along both edges.
    pub(super) fn functions(&self) -> [(Vector, f64); 3] {
        [self.normal, self.place_u, self.place_v].map(|vector| (vector, vector.dot(&self.corner)))
    }

    /// What a ray meets at this distance and place.
    #[inline]
    pub fn hit(&self, distance: f64, uv: [f64; 2], surface: usize) -> Hit {
        Hit {
            distance,
            point: self.at(uv),
            normal: self.normal,
            geometric_normal: self.normal,
            tangent: self.tangent,
            uv,
            surface,
        }
    }

    /// The point at this place along both edges.
    #[inline]
    pub fn at(&self, uv: [f64; 2]) -> Vector {
        self.corner + self.edge_u * uv[0] + self.edge_v * uv[1]
    }
}
