//! The camera: from a place in the picture to a ray into the scene.

use super::ray::{Ray, Vector};

/// A camera. Places in the picture are counted in its height, from its centre: x to the right, y up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    position: Vector,
    forward: Vector,
    right: Vector,
    up: Vector,
    /// All rays start at the position, not side by side.
    converges: bool,
    /// Height of the picture: at distance 1 where rays converge, else in mm.
    height: f64,
}

/// How a camera projects.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Projection {
    /// All rays start at the camera; the picture's height is seen under this angle, radians, 0 to π.
    Perspective {
        /// The angle.
        field_of_view: f64,
    },
    /// All rays are parallel; the picture is as high as this, mm.
    Orthographic {
        /// The height.
        height_mm: f64,
    },
}

impl Camera {
    /// A camera at `position` that looks at `target`, with `up` upwards in the picture.
    ///
    /// None where these give no picture: `target` at `position`, or `up` along the view.
    pub fn new(position: Vector, target: Vector, up: Vector, projection: Projection) -> Option<Self> {
        let forward = (target - position).try_normalize(0.0)?;
        // An angle of 1e-6 rad between view and up is no typing mistake's doing any more.
        let right = forward.cross(&up.try_normalize(0.0)?).try_normalize(1e-6)?;
        let up = right.cross(&forward);
        let (converges, height) = match projection {
            Projection::Perspective { field_of_view } => (true, 2.0 * (0.5 * field_of_view).tan()),
            Projection::Orthographic { height_mm } => (false, height_mm),
        };
        let camera = Self { position, forward, right, up, converges, height };
        [forward, right, up].iter().all(|axis| axis.iter().all(|x| x.is_finite())).then_some(camera)
    }

    /// Where the camera stands.
    pub fn position(&self) -> Vector {
        self.position
    }

    /// The ray that meets this place in the picture.
    #[inline(always)]
    pub fn ray(&self, x: f64, y: f64) -> Ray {
        let aside = self.right * (x * self.height) + self.up * (y * self.height);
        if self.converges {
            let direction = self.forward + aside;
            // One division, not three.
            Ray { origin: self.position, direction: direction * (1.0 / direction.norm()) }
        } else {
            Ray { origin: self.position + aside, direction: self.forward }
        }
    }
}
