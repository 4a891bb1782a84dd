//! Unpolarised reflectance of one clear film on a substrate, all channels at once: the commonest thing a fit evaluates.
//!
//! With a real film index the Airy sum needs no complex arithmetic. For each polarisation let u and v be the two
//! admittances at the film's lower interface (s: u = q₁, v = q₂; p: u = ε₂q₁, v = ε₁q₂), so that r₁₂ = (u − v)/(u + v), and
//! a and b those at its upper one (s: q₀ and q₁; p: ε₁q₀ and ε₀q₁), so that r₀₁ = (a − b)/(a + b). Then
//!
//! R = 1 − 2Q/(P + Q + Y) with P = (a² + b²)(|u|² + |v|²), Q = 4ab Re(uv*), Y = (a² − b²) Re[(u − v)(u + v)* e^{2iδ}],
//!
//! where (u − v)(u + v)* = |u|² − |v|² + 2i Im(uv*). P + Q + Y is |(u + v)(a + b)|² |1 + r₀₁r₁₂e^{2iδ}|² up to a factor,
//! hence positive. All is multiplied by 2 Re q₂, which removes the division in Im q₂ = Im ε₂/(2 Re q₂), and
//! the two polarisations share their one division, their sine and cosine, and the roots.

use super::elementary::sin_cos;

/// Per-channel inputs, all of one length.
#[derive(Debug, Clone, Copy)]
pub(super) struct FilmChannels<'a> {
    /// 4π/λ, 1/nm.
    pub(super) double_wavenumbers: &'a [f64],
    /// ε₁ = n₁², real.
    pub(super) film: &'a [f64],
    /// Re ε₂.
    pub(super) substrate_re: &'a [f64],
    /// Im ε₂.
    pub(super) substrate_im: &'a [f64],
}

/// Least distance of a permittivity from (n₀ sinθ₀)² for which this kernel is used. Nearer to total reflection Q and
/// P + Y cancel; at this distance they still leave 13 digits.
pub(super) const LEAST_MARGIN: f64 = 1e-3;

/// Writes the reflectance of the film, light coming at `cos_theta` from a clear medium of index `front`.
///
/// Every ε₁ and Re ε₂ must exceed (n₀ sinθ₀)² by [`LEAST_MARGIN`]: no total reflection and no mirror-like metal.
pub(super) fn reflectance(
    channels: FilmChannels<'_>,
    thickness_nm: f64,
    front: f64,
    cos_theta: f64,
    reflectance: &mut [f64],
) {
    pulp::Arch::new().dispatch(FilmLoop { channels, thickness_nm, front, cos_theta, reflectance });
}

/// The loop, in the form in which it is compiled once for each instruction set.
struct FilmLoop<'a, 'b> {
    channels: FilmChannels<'a>,
    thickness_nm: f64,
    front: f64,
    cos_theta: f64,
    reflectance: &'b mut [f64],
}

impl pulp::NullaryFnOnce for FilmLoop<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let FilmChannels { double_wavenumbers, film, substrate_re, substrate_im } = self.channels;
        film_loop(
            self.front * self.front,
            self.cos_theta,
            self.thickness_nm,
            double_wavenumbers,
            film,
            substrate_re,
            substrate_im,
            self.reflectance,
        );
    }
}

/// Slices come as arguments of their own, since the compiler knows of arguments alone that they do not overlap.
#[inline(always)]
#[expect(clippy::too_many_arguments, reason = "a loop vectorises only over slices that are arguments of their own")]
fn film_loop(
    e0: f64,
    cos_theta: f64,
    thickness_nm: f64,
    double_wavenumbers: &[f64],
    film: &[f64],
    substrate_re: &[f64],
    substrate_im: &[f64],
    reflectance: &mut [f64],
) {
    let q0_squared = e0 * cos_theta * cos_theta;
    let q0 = q0_squared.sqrt();
    let transverse_squared = e0 * (1.0 - cos_theta * cos_theta).max(0.0);
    let channels = double_wavenumbers.iter().zip(film).zip(substrate_re).zip(substrate_im);
    for (out, (((&double_wavenumber, &e1), &e2_re), &e2_im)) in reflectance.iter_mut().zip(channels) {
        let q1_squared = e1 - transverse_squared;
        let q1 = q1_squared.sqrt();

        // q₂² = z; with Re z > 0, Re q₂ = √((|z| + Re z)/2) loses nothing.
        let z_re = e2_re - transverse_squared;
        let q2_abs_squared = (z_re * z_re + e2_im * e2_im).sqrt();
        let half_scale_squared = q2_abs_squared + z_re;
        let scale = (2.0 * half_scale_squared).sqrt();

        let (sine, cosine) = sin_cos(double_wavenumber * thickness_nm * q1);
        let scaled_cosine = scale * cosine;
        let echo_sine = 2.0 * q1 * e2_im * sine;

        let q_s = 4.0 * q0 * q1_squared * half_scale_squared;
        let total_s = (q0_squared + q1_squared) * (scale * (q1_squared + q2_abs_squared))
            + q_s
            + (q0_squared - q1_squared) * ((q1_squared - q2_abs_squared) * scaled_cosine + echo_sine);

        let e1_squared = e1 * e1;
        let u_squared = (e2_re * e2_re + e2_im * e2_im) * q1_squared;
        let v_squared = e1_squared * q2_abs_squared;
        let a_squared = e1_squared * q0_squared;
        let b_squared = e0 * e0 * q1_squared;
        let q_p = 4.0 * e0 * q0 * e1_squared * q1_squared * (e2_re * half_scale_squared + e2_im * e2_im);
        let total_p = (a_squared + b_squared) * (scale * (u_squared + v_squared))
            + q_p
            + (a_squared - b_squared)
                * ((u_squared - v_squared) * scaled_cosine - e1 * (q2_abs_squared - transverse_squared) * echo_sine);

        *out = 1.0 - (q_s * total_p + q_p * total_s) / (total_s * total_p);
    }
}
