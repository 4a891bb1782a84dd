//! Rough surfaces as a multitude of small mirrors: the distribution of their slopes and how they shadow each other.
//!
//! A scattering model takes [`Beckmann::density`] at the half vector and [`Beckmann::visible_share`] at each of the two
//! directions, for reflection and transmission alike (Walter, Marschner, Li and Torrance 2007).

use std::f64::consts::PI;

use nalgebra::Vector3;

pub use super::ggx::Ggx;
use super::visible_normals;

/// Beckmann's distribution: slopes are Gaussian in every direction with standard deviation α/√2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beckmann {
    alpha: f64,
}

impl Beckmann {
    /// The distribution of roughness `alpha` > 0, which is √2 times the standard deviation of the slopes.
    pub fn new(alpha: f64) -> Self {
        debug_assert!(alpha > 0.0, "roughness must be positive, found {alpha}");
        Self { alpha }
    }

    /// D: area of microfacets per area of surface and solid angle of their normals, 1/sr, for normals at `cos_theta` to
    /// the surface's. ∫ D cosθ dω = 1. (Walter et al. 2007, equation 25.)
    pub fn density(&self, cos_theta: f64) -> f64 {
        if cos_theta <= 0.0 {
            return 0.0;
        }
        let cos_squared = cos_theta * cos_theta;
        let tan_squared = (1.0 - cos_squared).max(0.0) / cos_squared;
        let alpha_squared = self.alpha * self.alpha;
        (-tan_squared / alpha_squared).exp() / (PI * alpha_squared * cos_squared * cos_squared)
    }

    /// Smith's G1: the share of microfacets, among those that face it, that a direction at `cos_theta` to the normal
    /// sees. 1 from above, 0 at the horizon; the sign of the cosine does not matter, so that a direction below the
    /// surface is as good. (Walter et al. 2007, equation 26, in the exact form with the error function.)
    pub fn visible_share(&self, cos_theta: f64) -> f64 {
        let cosine = cos_theta.abs();
        let tangent = (1.0 - cosine * cosine).max(0.0).sqrt() / cosine;
        // Infinite above (G1 = 1), 0 at the horizon (G1 = 0).
        let a = 1.0 / (self.alpha * tangent);
        2.0 / (1.0 + libm::erf(a) + (-a * a).exp() / (a * PI.sqrt()))
    }

    /// A normal drawn with the density D(m) G1(o) (o·m)₊/cosθo of those that a viewer above the horizon sees, from two
    /// uniform numbers in [0, 1).
    pub fn visible_normal(&self, viewer: &Vector3<f64>, random: [f64; 2]) -> Vector3<f64> {
        visible_normals::beckmann(self.alpha, viewer, random)
    }
}
