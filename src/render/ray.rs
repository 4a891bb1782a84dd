//! Rays, and what they meet.

use nalgebra::Vector3;

use crate::bsdf::Direction;

/// A place or a direction in the scene; lengths in mm.
pub type Vector = Vector3<f64>;

/// Linear radiometric values in the three channels.
pub type Colour = [f64; 3];

/// A half line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Where it starts.
    pub origin: Vector,
    /// Where it goes, a unit vector.
    pub direction: Vector,
}

impl Ray {
    /// The point at a distance.
    #[inline]
    pub fn at(&self, distance: f64) -> Vector {
        self.origin + self.direction * distance
    }
}

/// A point on a surface, as what lies there needs it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// From the ray's origin, mm.
    pub distance: f64,
    /// The point.
    pub point: Vector,
    /// Normal for shading; a mesh interpolates it.
    pub normal: Vector,
    /// Normal of the surface itself.
    pub geometric_normal: Vector,
    /// Where u grows: the x axis of the local frame, made perpendicular to the normal.
    pub tangent: Vector,
    /// Place in textures, u to the right and v upwards.
    pub uv: [f64; 2],
    /// Which surface of the scene.
    pub surface: usize,
}

/// The local frame of a scattering function: x tangent, z normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// x axis.
    pub tangent: Vector,
    /// y axis.
    pub bitangent: Vector,
    /// z axis.
    pub normal: Vector,
}

impl Frame {
    /// The frame of a unit normal and a unit tangent perpendicular to it.
    #[inline]
    pub fn new(normal: Vector, tangent: Vector) -> Self {
        Self { tangent, bitangent: normal.cross(&tangent), normal }
    }

    /// A direction of the scene in this frame.
    #[inline]
    pub fn to_local(&self, direction: &Vector) -> Direction {
        Direction::new(self.tangent.dot(direction), self.bitangent.dot(direction), self.normal.dot(direction))
    }

    /// A direction of this frame in the scene.
    #[inline]
    pub fn to_scene(&self, direction: &Direction) -> Vector {
        self.tangent * direction.x + self.bitangent * direction.y + self.normal * direction.z
    }
}

/// A unit vector perpendicular to a unit normal, by a formula without branches that divide by small numbers (Duff et al.
/// 2017, *Building an orthonormal basis, revisited*).
pub(super) fn any_tangent(normal: &Vector) -> Vector {
    let sign = 1f64.copysign(normal.z);
    let a = -1.0 / (sign + normal.z);
    let b = normal.x * normal.y * a;
    Vector::new(1.0 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x)
}

/// Luminance of linear Rec. 709 channels (ITU-R BT.709-6, item 3.2, to four digits as printed there).
#[inline]
pub(super) fn luminance([r, g, b]: Colour) -> f64 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}
