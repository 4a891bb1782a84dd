//! Unpolarised reflectance and transmittance of any stack, all channels at once.
//!
//! The recursion of [`super::stack`] over blocks of channels. What occurs more than once in a stack, as in a periodic
//! one, is computed once for a block: q of each medium, e^{2iδ} of each layer, the amplitudes of each kind of interface.
//!
//! Of the transmitted amplitude only the power matters, and that is a product of real factors: |t₀|² of each interface,
//! and |e^{iδ}|²/|1 + r₀ r e^{2iδ}|² of each layer, times Re q of the last medium over q of the first.

use super::elementary::{exp_of_negative, sin_cos};
use super::layered::{Arrangement, Permittivity};

/// Channels worked on together: long enough for any vector unit, short enough that a block stays in the cache.
const BLOCK: usize = 32;

/// Complex numbers for a block of channels.
#[derive(Clone)]
struct Block {
    re: [f64; BLOCK],
    im: [f64; BLOCK],
}

impl Block {
    const ZERO: Self = Self { re: [0.0; BLOCK], im: [0.0; BLOCK] };
}

/// A stack and the light that falls on it.
#[derive(Clone, Copy)]
pub(super) struct StackChannels<'a> {
    pub(super) arrangement: &'a Arrangement,
    /// 4π/λ, 1/nm.
    pub(super) double_wavenumbers: &'a [f64],
    /// One a material.
    pub(super) permittivities: &'a [Permittivity],
    /// One a distinct layer.
    pub(super) thicknesses_nm: &'a [f64],
    /// Index of the medium outside, which no material of the list is.
    pub(super) outside: f64,
    /// Of the light, in the medium that it comes from.
    pub(super) cos_theta: f64,
}

/// Writes the reflectance of the stack. Any indices, absorption and total reflection are right.
pub(super) fn reflectance(channels: StackChannels<'_>, reflectance: &mut [f64]) {
    pulp::Arch::new().dispatch(StackLoop { channels, reflectance, transmittance: None });
}

/// Writes the reflectance, and the power that goes on in the last medium as a share of what arrives. The light's medium
/// and the last one must be clear, and `cos_theta` above 0.
pub(super) fn shares(channels: StackChannels<'_>, reflectance: &mut [f64], transmittance: &mut [f64]) {
    debug_assert!(channels.cos_theta > 0.0, "at grazing incidence the transmittance is 0/0");
    debug_assert_eq!(reflectance.len(), transmittance.len(), "one number a channel");
    pulp::Arch::new().dispatch(StackLoop { channels, reflectance, transmittance: Some(transmittance) });
}

/// The loops, in the form in which they are compiled once for each instruction set.
struct StackLoop<'a, 'b> {
    channels: StackChannels<'a>,
    reflectance: &'b mut [f64],
    transmittance: Option<&'b mut [f64]>,
}

impl pulp::NullaryFnOnce for StackLoop<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let StackChannels { arrangement, double_wavenumbers, permittivities, thicknesses_nm, outside, cos_theta } =
            self.channels;
        let (reflectance, mut transmittance) = (self.reflectance, self.transmittance);
        let (light, last) = (arrangement.light(), arrangement.last());
        let sine_squared = (1.0 - cos_theta * cos_theta).max(0.0);

        // The medium outside comes after the materials, as in the arrangement's interfaces.
        let mut media = vec![Block::ZERO; permittivities.len() + 1];
        let mut roots = vec![Block::ZERO; permittivities.len() + 1];
        let mut round_trips = vec![Block::ZERO; thicknesses_nm.len()];
        let mut interfaces = vec![(Block::ZERO, Block::ZERO); arrangement.interfaces().len()];
        media[permittivities.len()].re = [outside * outside; BLOCK];
        let mut transmitted = match transmittance {
            Some(_) => vec![([0.0; BLOCK], [0.0; BLOCK]); interfaces.len()],
            None => Vec::new(),
        };

        for (block, reflectance) in reflectance.chunks_mut(BLOCK).enumerate() {
            let channels = block * BLOCK..block * BLOCK + reflectance.len();
            for (medium, permittivity) in media.iter_mut().zip(permittivities) {
                medium.re[..reflectance.len()].copy_from_slice(&permittivity.re()[channels.clone()]);
                medium.im[..reflectance.len()].copy_from_slice(&permittivity.im()[channels.clone()]);
            }
            let transverse_squared = media[light].re.map(|e| e * sine_squared);
            for (medium, root) in media.iter().zip(&mut roots) {
                square_root(&transverse_squared, &medium.re, &medium.im, &mut root.re, &mut root.im);
            }
            // Not by the root of a difference, which loses digits near grazing incidence.
            roots[light] = Block { re: media[light].re.map(|e| e.sqrt() * cos_theta), im: [0.0; BLOCK] };
            let mut wavenumbers = [0.0; BLOCK];
            wavenumbers[..reflectance.len()].copy_from_slice(&double_wavenumbers[channels.clone()]);
            for ((trip, &thickness), &material) in
                round_trips.iter_mut().zip(thicknesses_nm).zip(arrangement.layer_materials())
            {
                let q = &roots[material];
                round_trip(thickness, &wavenumbers, &q.re, &q.im, &mut trip.re, &mut trip.im);
            }
            for ((s, p), &(upper, lower)) in interfaces.iter_mut().zip(arrangement.interfaces()) {
                let (q, next_q) = (&roots[upper], &roots[lower]);
                amplitude(&q.re, &q.im, &next_q.re, &next_q.im, &mut s.re, &mut s.im);
                let (e, next_e) = (&media[upper], &media[lower]);
                let (mut a, mut b) = (Block::ZERO, Block::ZERO);
                product(&next_e.re, &next_e.im, &q.re, &q.im, &mut a.re, &mut a.im);
                product(&e.re, &e.im, &next_q.re, &next_q.im, &mut b.re, &mut b.im);
                amplitude(&a.re, &a.im, &b.re, &b.im, &mut p.re, &mut p.im);
            }

            for ((s, p), &(upper, lower)) in transmitted.iter_mut().zip(arrangement.interfaces()) {
                let ((q, next_q), (e, next_e)) = ((&roots[upper], &roots[lower]), (&media[upper], &media[lower]));
                crossing(&q.re, &q.im, &next_q.re, &next_q.im, s);
                crossing_parallel(q, next_q, e, next_e, p);
            }

            let (mut s, mut p) = interfaces[arrangement.last_interface()].clone();
            let mut passed = transmitted.get(arrangement.last_interface()).copied();
            for &(interface, layer) in arrangement.steps() {
                let trip = &round_trips[layer];
                let (upper_s, upper_p) = &interfaces[interface];
                if let Some((passed_s, passed_p)) = &mut passed {
                    let (entered_s, entered_p) = &transmitted[interface];
                    pass_layer(trip, upper_s, &s, entered_s, passed_s);
                    pass_layer(trip, upper_p, &p, entered_p, passed_p);
                }
                add_layer(&trip.re, &trip.im, &upper_s.re, &upper_s.im, &mut s.re, &mut s.im);
                add_layer(&trip.re, &trip.im, &upper_p.re, &upper_p.im, &mut p.re, &mut p.im);
            }
            for (i, out) in reflectance.iter_mut().enumerate() {
                *out = 0.5 * (s.re[i] * s.re[i] + s.im[i] * s.im[i] + p.re[i] * p.re[i] + p.im[i] * p.im[i]);
            }
            if let (Some(transmittance), Some((passed_s, passed_p))) = (&mut transmittance, &passed) {
                for (i, out) in transmittance[channels].iter_mut().enumerate() {
                    *out = 0.5 * (passed_s[i] + passed_p[i]) * roots[last].re[i] / roots[light].re[i];
                }
            }
        }
    }
}

/// A block of real numbers. Each loop below takes its blocks as arguments of their own, since the compiler knows of
/// arguments alone that they do not overlap.
type Lane = [f64; BLOCK];

/// q = √(ε − (n₀ sinθ₀)²) with both parts ≥ 0. The larger part is computed first and the smaller from it, so that
/// neither loses digits near the axes.
#[inline(always)]
fn square_root(transverse_squared: &Lane, e_re: &Lane, e_im: &Lane, q_re: &mut Lane, q_im: &mut Lane) {
    for i in 0..BLOCK {
        let z_re = e_re[i] - transverse_squared[i];
        let z_im = e_im[i];
        let modulus = (z_re * z_re + z_im * z_im).sqrt();
        let larger = (0.5 * (modulus + z_re.abs())).sqrt();
        let smaller = z_im / (2.0 * larger).max(f64::MIN_POSITIVE);
        q_re[i] = if z_re >= 0.0 { larger } else { smaller };
        q_im[i] = if z_re >= 0.0 { smaller } else { larger };
    }
}

/// e^{2iδ}: once down and up through a layer.
#[inline(always)]
fn round_trip(thickness_nm: f64, wavenumbers: &Lane, q_re: &Lane, q_im: &Lane, re: &mut Lane, im: &mut Lane) {
    for i in 0..BLOCK {
        let path = wavenumbers[i] * thickness_nm;
        let decay = exp_of_negative(-path * q_im[i]);
        let (sine, cosine) = sin_cos(path * q_re[i]);
        re[i] = decay * cosine;
        im[i] = decay * sine;
    }
}

#[inline(always)]
fn product(a_re: &Lane, a_im: &Lane, b_re: &Lane, b_im: &Lane, re: &mut Lane, im: &mut Lane) {
    for i in 0..BLOCK {
        re[i] = a_re[i] * b_re[i] - a_im[i] * b_im[i];
        im[i] = a_re[i] * b_im[i] + a_im[i] * b_re[i];
    }
}

/// (a − b)/(a + b), 0 where both vanish.
#[inline(always)]
fn amplitude(a_re: &Lane, a_im: &Lane, b_re: &Lane, b_im: &Lane, re: &mut Lane, im: &mut Lane) {
    for i in 0..BLOCK {
        let (minus_re, minus_im) = (a_re[i] - b_re[i], a_im[i] - b_im[i]);
        let (plus_re, plus_im) = (a_re[i] + b_re[i], a_im[i] + b_im[i]);
        let scale = 1.0 / (plus_re * plus_re + plus_im * plus_im).max(f64::MIN_POSITIVE);
        re[i] = (minus_re * plus_re + minus_im * plus_im) * scale;
        im[i] = (minus_im * plus_re - minus_re * plus_im) * scale;
    }
}

/// |t₀|² = |2 q/(q + q')|², of light whose field lies in the interface.
#[inline(always)]
fn crossing(q_re: &Lane, q_im: &Lane, next_re: &Lane, next_im: &Lane, out: &mut Lane) {
    for (i, out) in out.iter_mut().enumerate() {
        let (sum_re, sum_im) = (q_re[i] + next_re[i], q_im[i] + next_im[i]);
        let norm = (sum_re * sum_re + sum_im * sum_im).max(f64::MIN_POSITIVE);
        *out = 4.0 * (q_re[i] * q_re[i] + q_im[i] * q_im[i]) / norm;
    }
}

/// |t₀|² = |2 n n' q/(ε'q + εq')|², of light whose field lies in the plane of incidence.
#[inline(always)]
fn crossing_parallel(q: &Block, next_q: &Block, e: &Block, next_e: &Block, out: &mut Lane) {
    let (mut a, mut b) = (Block::ZERO, Block::ZERO);
    product(&next_e.re, &next_e.im, &q.re, &q.im, &mut a.re, &mut a.im);
    product(&e.re, &e.im, &next_q.re, &next_q.im, &mut b.re, &mut b.im);
    for (i, out) in out.iter_mut().enumerate() {
        let (sum_re, sum_im) = (a.re[i] + b.re[i], a.im[i] + b.im[i]);
        let norm = (sum_re * sum_re + sum_im * sum_im).max(f64::MIN_POSITIVE);
        let indices = ((e.re[i] * e.re[i] + e.im[i] * e.im[i])
            * (next_e.re[i] * next_e.re[i] + next_e.im[i] * next_e.im[i]))
            .sqrt();
        *out = 4.0 * indices * (q.re[i] * q.re[i] + q.im[i] * q.im[i]) / norm;
    }
}

/// T ← T |t₀|² |e^{iδ}|²/|1 + r₀ r e^{2iδ}|², `r` being that below the layer, before [`add_layer`].
#[inline(always)]
fn pass_layer(trip: &Block, upper: &Block, r: &Block, entered: &Lane, passed: &mut Lane) {
    for i in 0..BLOCK {
        let echo_re = r.re[i] * trip.re[i] - r.im[i] * trip.im[i];
        let echo_im = r.re[i] * trip.im[i] + r.im[i] * trip.re[i];
        let all_re = 1.0 + upper.re[i] * echo_re - upper.im[i] * echo_im;
        let all_im = upper.re[i] * echo_im + upper.im[i] * echo_re;
        let decay = (trip.re[i] * trip.re[i] + trip.im[i] * trip.im[i]).sqrt();
        passed[i] *= entered[i] * decay / (all_re * all_re + all_im * all_im).max(f64::MIN_POSITIVE);
    }
}

/// r ← (r₀ + r e^{2iδ})/(1 + r₀ r e^{2iδ}), r₀ being the interface above the layer.
#[inline(always)]
fn add_layer(trip_re: &Lane, trip_im: &Lane, upper_re: &Lane, upper_im: &Lane, re: &mut Lane, im: &mut Lane) {
    for i in 0..BLOCK {
        let echo_re = re[i] * trip_re[i] - im[i] * trip_im[i];
        let echo_im = re[i] * trip_im[i] + im[i] * trip_re[i];
        let top_re = upper_re[i] + echo_re;
        let top_im = upper_im[i] + echo_im;
        let bottom_re = 1.0 + upper_re[i] * echo_re - upper_im[i] * echo_im;
        let bottom_im = upper_re[i] * echo_im + upper_im[i] * echo_re;
        let scale = 1.0 / (bottom_re * bottom_re + bottom_im * bottom_im).max(f64::MIN_POSITIVE);
        re[i] = (top_re * bottom_re + top_im * bottom_im) * scale;
        im[i] = (top_im * bottom_re - top_re * bottom_im) * scale;
    }
}
