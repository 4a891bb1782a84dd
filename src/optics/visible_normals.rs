//! Microfacets as a viewer sees them: normals drawn with the density `D(m) G1(o) (o·m)₊ / |cosθo|` of visible normals
//! (Heitz and d'Eon 2014), which integrates to 1 for each viewer.
//!
//! A surface of roughness α is one of roughness 1 stretched along its normal, and stretching keeps the shares that are
//! seen: the viewer is stretched, a normal is drawn at α = 1, and the normal is stretched back.

use std::f64::consts::{FRAC_2_SQRT_PI, TAU};

use nalgebra::Vector3;

use super::elementary::exp_of_negative;

/// 1/√π.
const INVERSE_ROOT_PI: f64 = 0.5 * FRAC_2_SQRT_PI;

/// A normal of Beckmann's distribution, for a viewer above the horizon and uniform numbers in [0, 1).
///
/// Of the two slopes at α = 1, the one along the viewer's azimuth is [`visible_slope`], the other Gaussian and independent
/// (Heitz and d'Eon 2014; Jakob 2014).
pub(super) fn beckmann(alpha: f64, viewer: &Vector3<f64>, random: [f64; 2]) -> Vector3<f64> {
    let across = (viewer.x * viewer.x + viewer.y * viewer.y).sqrt();
    let (cos_azimuth, sin_azimuth) = if across > 0.0 { (viewer.x / across, viewer.y / across) } else { (1.0, 0.0) };
    let along = visible_slope(alpha * across / viewer.z, random[0]);
    let beside = inverse_erf(2.0 * random[1] - 1.0);
    let (slope_x, slope_y) = (cos_azimuth * along - sin_azimuth * beside, sin_azimuth * along + cos_azimuth * beside);
    Vector3::new(-alpha * slope_x, -alpha * slope_y, 1.0).normalize()
}

/// Share of visible microfacets by which a drawn slope may be off: far below what any number of draws could show.
const SLOPE_TOLERANCE: f64 = 1e-6;

/// The slope x along the azimuth of a viewer at the inclination θ of this tangent, at α = 1: the root of C(x) = `random`,
///
/// C(x) = (1 + erf x + tanθ e^{−x²}/√π) / (1 + erf a + tanθ e^{−a²}/√π), a = 1/tanθ, x < a,
///
/// the integral of the visible slopes' density ∝ (cosθ − x sinθ)₊ e^{−x²}. In b = erf x it is concave and needs no erf, so that
/// Newton's method, kept inside a bracket, takes two or three steps from the start that Jakob fitted (2014, *An improved
/// visible normal sampling routine for the Beckmann distribution*).
fn visible_slope(tangent: f64, random: f64) -> f64 {
    let steepest = 1.0 / tangent;
    let highest = libm::erf(steepest);
    let total = 1.0 + highest + INVERSE_ROOT_PI * tangent * exp_of_negative(-steepest * steepest);
    let theta = tangent.atan();
    let exponent = 1.0 + theta * (-0.876 + theta * (0.4265 - 0.0594 * theta));
    let mut b = highest - (1.0 + highest) * exp_of_negative(exponent * (1.0 - random).ln());
    let (mut low, mut high) = (-1.0, highest);
    let mut slope = 0.0;
    // Halving alone would need some 20 steps; no case is known that needs ten.
    for _ in 0..40 {
        if !(b > low && b < high) {
            b = 0.5 * (low + high);
        }
        slope = inverse_erf(b);
        let excess = 1.0 + b + INVERSE_ROOT_PI * tangent * exp_of_negative(-slope * slope) - random * total;
        if excess.abs() <= SLOPE_TOLERANCE * total {
            break;
        }
        if excess > 0.0 {
            high = b;
        } else {
            low = b;
        }
        b -= excess / (1.0 - slope * tangent);
    }
    slope
}

/// The x whose erf is b (Giles 2010, *Approximating the erfinv function*, his single-precision polynomials): erf of it is b
/// within 2e-7. Nearer to ±1 than 1e-7 it stays at ±3.77.
fn inverse_erf(b: f64) -> f64 {
    let b = b.clamp(-1.0 + 1e-7, 1.0 - 1e-7);
    let w = -((1.0 - b) * (1.0 + b)).ln();
    let (w, coefficients) = if w < 5.0 {
        let central = [
            2.810_226_36e-8,
            3.432_739_39e-7,
            -3.523_387_7e-6,
            -4.391_506_54e-6,
            2.185_808_7e-4,
            -1.253_725_03e-3,
            -4.177_681_64e-3,
            0.246_640_727,
            1.501_409_41,
        ];
        (w - 2.5, central)
    } else {
        let tail = [
            -2.002_142_57e-4,
            1.009_505_58e-4,
            1.349_343_22e-3,
            -3.673_428_44e-3,
            5.739_507_73e-3,
            -7.622_461_3e-3,
            9.438_870_47e-3,
            1.001_674_06,
            2.832_976_82,
        ];
        (w.sqrt() - 3.0, tail)
    };
    b * coefficients.into_iter().fold(0.0, |sum, coefficient| sum * w + coefficient)
}

/// A normal of the GGX distribution, for a viewer above the horizon and uniform numbers in [0, 1).
///
/// At α = 1 microfacets are a hemisphere, whose points mirror a viewer's rays into a spherical cap: a direction of that
/// cap is drawn, and the normal lies half-way to it (Dupuy and Benyoub 2023, *Sampling visible GGX normals with spherical
/// caps*).
pub(super) fn ggx(alpha: f64, viewer: &Vector3<f64>, random: [f64; 2]) -> Vector3<f64> {
    let stretched = Vector3::new(alpha * viewer.x, alpha * viewer.y, viewer.z).normalize();
    let z = 1.0 - random[0] * (1.0 + stretched.z);
    let radius = (1.0 - z * z).max(0.0).sqrt();
    let (sin_azimuth, cos_azimuth) = (TAU * random[1]).sin_cos();
    let half = Vector3::new(radius * cos_azimuth, radius * sin_azimuth, z) + stretched;
    Vector3::new(alpha * half.x, alpha * half.y, half.z).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// erf from another hand.
    #[test]
    fn the_inverse_of_erf_is_one() {
        for step in -1000..=1000 {
            let b = f64::from(step) / 1000.0;
            assert!((libm::erf(inverse_erf(b)) - b).abs() < 2e-7, "b = {b}: {}", inverse_erf(b));
        }
    }

    /// C at the drawn slope is the number it was drawn from, for viewers from the normal to the horizon.
    #[test]
    fn the_visible_slope_inverts_its_integral() {
        for step in 0..=40 {
            let tangent = 1e-4 * 10_f64.powf(f64::from(step) * 0.25);
            let integral = |slope: f64| 1.0 + libm::erf(slope) + INVERSE_ROOT_PI * tangent * (-slope * slope).exp();
            for random in [0.0, 1e-9, 0.01, 0.3, 0.7, 0.99, 1.0 - 1e-9, 1.0 - f64::EPSILON] {
                let found = integral(visible_slope(tangent, random)) / integral(1.0 / tangent);
                // The tolerance, and half as much for the inverse of erf.
                assert!((found - random).abs() <= 1.5 * SLOPE_TOLERANCE, "tanθ = {tangent}: {found}, not {random}");
            }
        }
    }
}
