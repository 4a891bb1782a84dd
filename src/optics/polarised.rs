//! A quantity for each of the two polarisations.

use num_complex::Complex64;

/// Powers between 0 and 1 for each polarisation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Polarised {
    /// Electric field perpendicular to the plane of incidence.
    pub s: f64,
    /// Electric field in the plane of incidence.
    pub p: f64,
}

impl Polarised {
    /// The same value for both.
    #[inline(always)]
    pub fn both(value: f64) -> Self {
        Self { s: value, p: value }
    }

    /// Mean of the two: natural light.
    #[inline(always)]
    pub fn unpolarised(self) -> f64 {
        0.5 * (self.s + self.p)
    }
}

/// Amplitude ratios of the electric field, reflected and transmitted to incident.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Amplitudes {
    /// Reflected.
    pub r: Complex64,
    /// Transmitted into the last medium.
    pub t: Complex64,
}

/// What an interface, film or stack does to a plane wave.
///
/// For one interface r = (q₀ − q₁)/(q₀ + q₁) for s and r = (n₁²q₀ − n₀²q₁)/(n₁²q₀ + n₀²q₁) for p, so that at normal
/// incidence the two have opposite signs: a matter of convention.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Response {
    /// Amplitudes for the field perpendicular to the plane of incidence.
    pub s: Amplitudes,
    /// Amplitudes for the field in the plane of incidence.
    pub p: Amplitudes,
    /// Reflected power.
    pub reflectance: Polarised,
    /// Power that enters the last medium. Together with the reflectance it makes 1 where nothing absorbs.
    pub transmittance: Polarised,
}
