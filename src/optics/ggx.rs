//! The GGX distribution of slopes, whose tails are longer than Beckmann's.

use std::f64::consts::PI;

use nalgebra::Vector3;

use super::visible_normals;

/// GGX (Walter et al. 2007, section 5.2; Trowbridge and Reitz 1975): slopes have the density of a bivariate t
/// distribution with two degrees of freedom, scale α.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ggx {
    alpha: f64,
}

impl Ggx {
    /// The distribution of roughness `alpha` > 0.
    pub fn new(alpha: f64) -> Self {
        debug_assert!(alpha > 0.0, "roughness must be positive, found {alpha}");
        Self { alpha }
    }

    /// D: area of microfacets per area of surface and solid angle of their normals, 1/sr, for normals at `cos_theta` to
    /// the surface's. ∫ D cosθ dω = 1. (Walter et al. 2007, equation 33, multiplied out so that it is finite at the
    /// horizon.)
    pub fn density(&self, cos_theta: f64) -> f64 {
        if cos_theta <= 0.0 {
            return 0.0;
        }
        let alpha_squared = self.alpha * self.alpha;
        let cos_squared = cos_theta * cos_theta;
        let spread = cos_squared * alpha_squared + (1.0 - cos_squared).max(0.0);
        alpha_squared / (PI * spread * spread)
    }

    /// Smith's G1: the share of microfacets, among those that face it, that a direction at `cos_theta` to the normal
    /// sees. 1 from above, 0 at the horizon; the sign of the cosine does not matter. (Walter et al. 2007, equation 34.)
    pub fn visible_share(&self, cos_theta: f64) -> f64 {
        let cosine = cos_theta.abs();
        let sine_squared = (1.0 - cosine * cosine).max(0.0);
        2.0 * cosine / (cosine + (cosine * cosine + self.alpha * self.alpha * sine_squared).sqrt())
    }

    /// A normal drawn with the density D(m) G1(o) (o·m)₊/cosθo of those that a viewer above the horizon sees, from two
    /// uniform numbers in [0, 1).
    pub fn visible_normal(&self, viewer: &Vector3<f64>, random: [f64; 2]) -> Vector3<f64> {
        visible_normals::ggx(self.alpha, viewer, random)
    }
}
