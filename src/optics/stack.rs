//! Any number of layers, one wavelength at a time: the reference that the fast kernels are held against.
//!
//! The textbook product of transfer matrices holds growing exponentials e^{+Im δ}, which overflow in a thick absorbing
//! layer. The same product is therefore taken from the substrate outwards on the ratio of its elements (Rouard's
//! method; Parratt 1954 for X-rays): only decaying exponentials occur and every amplitude stays finite for any thickness.

use num_complex::Complex64;

use super::{Amplitudes, Polarised, Response};

/// A homogeneous layer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Layer {
    /// Complex index n + ik, k ≥ 0.
    pub index: Complex64,
    /// Thickness, nm.
    pub thickness_nm: f64,
}

/// Response of layers, listed from the light's side, on a substrate. Light comes from a clear medium of index `front` at
/// `cos_theta` (0 to 1) to the normal. No layers is a plain interface.
pub fn transfer(front: f64, layers: &[Layer], substrate: Complex64, cos_theta: f64, wavelength_nm: f64) -> Response {
    let wave = Wave::new(front, cos_theta, wavelength_nm);
    let last = wave.medium(substrate);
    let mut below = last;
    let mut s: Option<Amplitudes> = None;
    let mut p: Option<Amplitudes> = None;
    for layer in layers.iter().rev() {
        let medium = wave.medium(layer.index);
        let interface = medium.interface_to(below);
        let pass = wave.pass(medium, layer.thickness_nm);
        s = Some(through_layer(add_interface(interface.s, s), pass));
        p = Some(through_layer(add_interface(interface.p, p), pass));
        below = medium;
    }
    let first = wave.front.interface_to(below);
    wave.response(last, add_interface(first.s, s), add_interface(first.p, p))
}

/// A plane wave on its way through parallel layers.
#[derive(Debug, Clone, Copy)]
pub(super) struct Wave {
    /// The medium that the light comes from.
    pub(super) front: Medium,
    /// (n sinθ)², the same in every layer.
    transverse_squared: f64,
    /// 2π/λ, 1/nm.
    wavenumber: f64,
}

/// A medium as the wave meets it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Medium {
    index: Complex64,
    /// q = n cosθ, Im q ≥ 0.
    q: Complex64,
}

/// Amplitudes of one interface, for one polarisation.
pub(super) type Interface = Amplitudes;

/// Amplitudes of one interface, for both polarisations.
pub(super) struct Interfaces {
    pub(super) s: Interface,
    pub(super) p: Interface,
}

impl Wave {
    pub(super) fn new(front: f64, cos_theta: f64, wavelength_nm: f64) -> Self {
        Self {
            // Not by the root of a difference, which loses digits near grazing incidence.
            front: Medium { index: Complex64::from(front), q: Complex64::from(front * cos_theta) },
            transverse_squared: front * front * (1.0 - cos_theta * cos_theta).max(0.0),
            wavenumber: 2.0 * std::f64::consts::PI / wavelength_nm,
        }
    }

    /// The principal root has Im q ≥ 0, since Im n² ≥ 0.
    pub(super) fn medium(&self, index: Complex64) -> Medium {
        Medium { index, q: (index * index - self.transverse_squared).sqrt() }
    }

    /// e^{iδ}, one pass through a layer.
    pub(super) fn pass(&self, medium: Medium, thickness_nm: f64) -> Complex64 {
        (Complex64::i() * medium.q * (self.wavenumber * thickness_nm)).exp()
    }

    /// Powers from amplitudes: T = |t|² Re q/q₀ for s and |t|² Re(n cosθ*)/q₀ for p, both into the last medium.
    pub(super) fn response(&self, last: Medium, s: Amplitudes, p: Amplitudes) -> Response {
        let entering = |amplitude: Complex64, last: f64| {
            // At grazing incidence t is 0 as q₀ is, and t²/q₀ with it.
            if self.front.q.re > 0.0 { amplitude.norm_sqr() * last / self.front.q.re } else { 0.0 }
        };
        Response {
            s,
            p,
            reflectance: Polarised { s: s.r.norm_sqr(), p: p.r.norm_sqr() },
            transmittance: Polarised {
                s: entering(s.t, last.q.re),
                p: entering(p.t, (last.index * (last.q / last.index).conj()).re),
            },
        }
    }
}

impl Medium {
    /// Fresnel's amplitudes for light that goes from this medium into the next.
    pub(super) fn interface_to(&self, to: Self) -> Interfaces {
        let s_sum = self.q + to.q;
        let s = Interface { r: (self.q - to.q) / s_sum, t: 2.0 * self.q / s_sum };
        let (a, b) = (to.index * to.index * self.q, self.index * self.index * to.q);
        let p = Interface { r: (a - b) / (a + b), t: 2.0 * self.index * to.index * self.q / (a + b) };
        Interfaces { s, p }
    }
}

/// Puts an interface on top of what lies below it, all seen from just above and just below the interface.
fn add_interface(interface: Interface, below: Option<Amplitudes>) -> Amplitudes {
    let Some(below) = below else { return interface };
    let all_echoes = 1.0 + interface.r * below.r;
    Amplitudes { r: (interface.r + below.r) / all_echoes, t: interface.t * below.t / all_echoes }
}

/// Amplitudes seen from the upper side of a layer instead of its lower side.
fn through_layer(amplitudes: Amplitudes, pass: Complex64) -> Amplitudes {
    Amplitudes { r: amplitudes.r * pass * pass, t: amplitudes.t * pass }
}
