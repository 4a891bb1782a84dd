//! What the surface of a fibre does to light that meets it.

/// Shares of the light where a ray meets the surface, unpolarised.
#[derive(Debug, Clone, Copy)]
pub(super) struct SurfaceShares {
    /// Reflected outside.
    pub(super) reflectance: f64,
    /// Transmitted, the same from both sides.
    pub(super) transmittance: f64,
    /// Reflected inside.
    pub(super) back: f64,
    /// Not reflected inside, 1 − `back` without cancellation.
    pub(super) not_back: f64,
}

/// A surface between air and a fibre of index `eta`.
pub(super) trait Surface: Copy {
    /// The shares of a ray whose cosines to the surface's normal are these outside and inside.
    fn meet(&self, eta: f64, cosine: f64, cosine_inside: f64) -> SurfaceShares;
}

/// The fibre's own surface, with nothing on it: Fresnel's equations.
#[derive(Debug, Clone, Copy)]
pub(super) struct BareSurface;

impl Surface for BareSurface {
    #[inline(always)]
    fn meet(&self, eta: f64, cosine: f64, cosine_inside: f64) -> SurfaceShares {
        // With rₛ = a/b and rₚ = c/d, f = (rₛ² + rₚ²)/2, and 1 − r² = 4 η cosines / b² or d².
        let (a, b) = (cosine - eta * cosine_inside, cosine + eta * cosine_inside);
        let (c, d) = (eta * cosine - cosine_inside, eta * cosine + cosine_inside);
        let (a, b, c, d) = (a * a, b * b, c * c, d * d);
        let inverse = 0.5 / (b * d);
        let reflectance = (a * d + b * c) * inverse;
        let transmittance = 4.0 * eta * cosine * cosine_inside * (b + d) * inverse;
        SurfaceShares { reflectance, transmittance, back: reflectance, not_back: transmittance }
    }
}
