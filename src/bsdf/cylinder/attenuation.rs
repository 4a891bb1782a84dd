//! What survives each path through the fibre: the readable form, one position across the fibre at a time.
//!
//! A₀ = f, Aₚ = (1 − f)² f^{p−1} T^p; f = F(cosθo cosγ; η) is the unpolarised reflectance of the surface, met by the three-
//! dimensional angle of incidence, and T = exp(−2 σₐ cosγt / cosθt) the transmittance of one pass, σₐ in 1/radius.

use super::far_field::Refraction;
use super::quadrature::WIDTH_RULE;
use crate::optics::fresnel;

/// Shares of the light that leave by R, TT, TRT, and by all later paths together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Attenuation {
    /// A₀, A₁, A₂.
    pub direct: [f64; 3],
    /// Σ_{p ≥ 3} Aₚ = A₂ f T / (1 − f T).
    pub later: f64,
}

impl Attenuation {
    /// All of the light that leaves the fibre: 1 without absorption.
    pub fn total(&self) -> f64 {
        self.direct.iter().sum::<f64>() + self.later
    }

    /// Of light that meets the fibre at h, −1 to 1.
    pub(super) fn at(refraction: &Refraction, h: f64, sigma_a: f64) -> Self {
        let cos_gamma = (1.0 - h * h).max(0.0).sqrt();
        let sin_gamma_t = h * refraction.inverse_eta_prime;
        let cos_gamma_t = (1.0 - sin_gamma_t * sin_gamma_t).sqrt();
        let f = fresnel::dielectric(refraction.cos_theta_o * cos_gamma, refraction.eta).unpolarised();
        let pass = (-2.0 * sigma_a * cos_gamma_t / refraction.cos_theta_t).exp();
        let once = (1.0 - f) * (1.0 - f) * pass;
        let twice = once * f * pass;
        // Where nothing enters, at grazing incidence, nothing is left for later: not 0/0.
        let later = if twice > 0.0 { twice * f * pass / ((1.0 - f) + f * (1.0 - pass)) } else { 0.0 };
        Self { direct: [f, once, twice], later }
    }

    /// Mean over the width of the fibre, ½ ∫ dh, with an error below 1e-12 for η ≥ 1.05.
    pub(super) fn mean(refraction: &Refraction, sigma_a: f64) -> Self {
        let mut mean = Self { direct: [0.0; 3], later: 0.0 };
        for (&h, &weight) in WIDTH_RULE.sin_gamma.iter().zip(&WIDTH_RULE.weights) {
            let here = Self::at(refraction, h, sigma_a);
            for (sum, share) in mean.direct.iter_mut().zip(here.direct) {
                *sum += weight * share;
            }
            mean.later += weight * here.later;
        }
        mean
    }
}
