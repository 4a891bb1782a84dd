//! Where the light comes from and where the viewer stands.

use nalgebra::Vector3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::bsdf::Direction;

/// The four angles of a reading, in degrees. Both directions point away from the surface; the inclination θ is counted
/// from the normal and the azimuth φ around it, from the tangent.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Geometry {
    /// Inclination of the light, 0 to 90.
    pub theta_i_deg: f64,
    /// Azimuth of the light.
    pub phi_i_deg: f64,
    /// Inclination of the viewer, 0 to 90.
    pub theta_o_deg: f64,
    /// Azimuth of the viewer.
    pub phi_o_deg: f64,
}

impl Geometry {
    /// Light at this inclination, viewer in the mirror direction on the other side of the normal.
    pub fn mirror(theta_deg: f64) -> Self {
        Self { theta_i_deg: theta_deg, phi_i_deg: 0.0, theta_o_deg: theta_deg, phi_o_deg: 180.0 }
    }

    /// Direction towards the light.
    pub fn incoming(&self) -> Direction {
        direction(self.theta_i_deg, self.phi_i_deg)
    }

    /// Direction towards the viewer.
    pub fn outgoing(&self) -> Direction {
        direction(self.theta_o_deg, self.phi_o_deg)
    }

    /// Angle between the viewer and the mirror direction of the light, degrees.
    pub fn degrees_from_mirror(&self) -> f64 {
        let incoming = self.incoming();
        let mirror = Direction::new(-incoming.x, -incoming.y, incoming.z);
        mirror.dot(&self.outgoing()).clamp(-1.0, 1.0).acos().to_degrees()
    }
}

fn direction(theta_deg: f64, phi_deg: f64) -> Direction {
    let (sin_theta, cos_theta) = theta_deg.to_radians().sin_cos();
    let (sin_phi, cos_phi) = phi_deg.to_radians().sin_cos();
    Vector3::new(sin_theta * cos_phi, sin_theta * sin_phi, cos_theta)
}
