//! One film between two media: the Airy sum.

use num_complex::Complex64;

use super::stack::{Interface, Layer, Wave};
use super::{Amplitudes, Response};

/// Response of a film on a substrate, light coming from a clear medium of index `front`.
///
/// r = (r₀₁ + r₁₂ e^{2iδ}) / (1 + r₀₁ r₁₂ e^{2iδ}) and t = t₀₁ t₁₂ e^{iδ} / (1 + r₀₁ r₁₂ e^{2iδ}) with
/// δ = 2π d q₁/λ (Born and Wolf 1999, equations 7.6.9 and 7.6.10). `cos_theta` is that of the light in front, 0 to 1.
/// Exact for any order of the indices, absorbing films and total reflection.
pub fn airy(front: f64, film: Layer, substrate: Complex64, cos_theta: f64, wavelength_nm: f64) -> Response {
    let wave = Wave::new(front, cos_theta, wavelength_nm);
    let (middle, last) = (wave.medium(film.index), wave.medium(substrate));
    let upper = wave.front.interface_to(middle);
    let lower = middle.interface_to(last);
    let pass = wave.pass(middle, film.thickness_nm);
    wave.response(last, airy_sum(upper.s, lower.s, pass), airy_sum(upper.p, lower.p, pass))
}

/// The sum over all internal reflections, for one polarisation.
fn airy_sum(upper: Interface, lower: Interface, pass: Complex64) -> Amplitudes {
    let round_trip = pass * pass;
    let all_echoes = 1.0 + upper.r * lower.r * round_trip;
    Amplitudes { r: (upper.r + lower.r * round_trip) / all_echoes, t: upper.t * lower.t * pass / all_echoes }
}
