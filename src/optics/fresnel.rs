//! Reflectance of one interface.

use num_complex::Complex64;

use super::Polarised;

/// Reflectance of the interface between two clear media, for light at `cos_theta` to the normal.
///
/// `eta` is the index below the interface divided by the one above. A negative cosine is light that comes from below,
/// for which the ratio is turned round. 1 for total internal reflection. (Born and Wolf 1999, section 1.5.2.)
#[inline(always)]
pub fn dielectric(cos_theta: f64, eta: f64) -> Polarised {
    let (cosine, eta) = if cos_theta >= 0.0 { (cos_theta, eta) } else { (-cos_theta, 1.0 / eta) };
    let sine_squared = (1.0 - cosine * cosine).max(0.0);
    let refracted = eta * eta - sine_squared;
    if refracted <= 0.0 {
        return Polarised::both(1.0);
    }
    let q = refracted.sqrt();
    let s = (cosine - q) / (cosine + q);
    let p = (eta * eta * cosine - q) / (eta * eta * cosine + q);
    Polarised { s: s * s, p: p * p }
}

/// Reflectance of an absorbing half-space of relative index `eta` = n + ik, k ≥ 0, for light from the clear side at
/// `cos_theta` ≥ 0 to the normal.
pub fn absorbing(cos_theta: f64, eta: Complex64) -> Polarised {
    let sine_squared = (1.0 - cos_theta * cos_theta).max(0.0);
    let permittivity = eta * eta;
    let q = (permittivity - sine_squared).sqrt();
    let s = (cos_theta - q) / (cos_theta + q);
    let p = (permittivity * cos_theta - q) / (permittivity * cos_theta + q);
    Polarised { s: s.norm_sqr(), p: p.norm_sqr() }
}
