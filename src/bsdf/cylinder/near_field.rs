//! The fibre seen so closely that the position across it is known: S(h) = Σₚ Mₚ Aₚ(h) D(φ − Φₚ(h)).

use std::f64::consts::{FRAC_1_PI, PI, TAU};

use super::attenuation::Attenuation;
use super::azimuthal::Density;
use super::far_field::Refraction;

/// Scattering function at h = sinγ, −1 to 1, in the frame of the viewer's azimuth.
pub(super) fn near_field<D: Density>(
    density: D,
    refraction: &Refraction,
    phi: f64,
    longitudinal: [f64; 3],
    h: f64,
    sigma_a: f64,
) -> f64 {
    let attenuation = Attenuation::at(refraction, h, sigma_a);
    let gamma = h.clamp(-1.0, 1.0).asin();
    let gamma_t = (h * refraction.inverse_eta_prime).asin();
    // Paths without an own lobe leave in all azimuths alike, as wide as TRT along the fibre.
    let mut sum = longitudinal[2] * attenuation.later * 0.5 * FRAC_1_PI;
    for (p, (share, m)) in attenuation.direct.into_iter().zip(longitudinal).enumerate() {
        let p = p as f64;
        let difference = phi - (2.0 * p * gamma_t - 2.0 * gamma + p * PI);
        let distance = (difference - (difference / TAU).round() * TAU).abs();
        sum += m * share * density.at(distance.min(PI));
    }
    sum
}
