//! Peak wavelengths: what papers print of a spectrum, and the two models that predict them.

use std::fmt::Debug;

use super::Geometry;
use crate::parameter::Parameter;

/// A local maximum of a model's spectrum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Peak {
    /// 1 for the maximum of longest wavelength, 2 for the next, and so on.
    pub order: u32,
    /// Wavelength, nm.
    pub wavelength_nm: f64,
}

/// A model that predicts where the maxima of a spectrum lie.
pub trait PeakModel: Send + Sync + Debug {
    /// The parameters, in the order in which [`PeakModel::peaks`] takes their values.
    fn parameters(&self) -> &[Parameter];

    /// All maxima between `shortest_nm` and `longest_nm` at these angles, by rising order. Orders are counted from
    /// infinite wavelength, whether or not a maximum lies in the window, so that an order means the same at every angle.
    fn peaks(&self, values: &[f64], geometry: &Geometry, shortest_nm: f64, longest_nm: f64) -> Vec<Peak>;

    /// Order of interference m of a peak, in waves of path difference: a half more or less than a whole number where
    /// one of two reflections turns the phase. The peak's own order where the model is not a single film.
    fn interference_order(&self, peak_order: u32) -> f64 {
        f64::from(peak_order)
    }
}

/// Cosine of the angle between light and half-vector: what a flat film tilted to mirror from one to the other sees.
pub fn mirror_cosine(geometry: &Geometry) -> f64 {
    let cosine = geometry.incoming().dot(&geometry.outgoing()).clamp(-1.0, 1.0);
    (0.5 * (1.0 + cosine)).sqrt()
}

/// Finds every maximum of `spectrum` between two wavelengths, counted from the longest wavelength that the film can
/// have a maximum at.
///
/// `optical_thickness_nm` (Σ n d cosθ or more) bounds how fast the spectrum can turn: a fringe has the period
/// 1/(2 Σ n d) in wavenumber 1/λ. The spectrum is sampled 24 times a fringe from the wavenumber 1/(12 Σ n d), where no
/// maximum of interference can lie, and each maximum is then refined on the slope to about 1e-9 of its wavelength.
pub fn find_peaks(
    optical_thickness_nm: f64,
    shortest_nm: f64,
    longest_nm: f64,
    mut spectrum: impl FnMut(&[f64], &mut [f64]),
) -> Vec<Peak> {
    const SAMPLES_PER_FRINGE: f64 = 24.0;
    let fringe = 0.5 / optical_thickness_nm;
    let step = fringe / SAMPLES_PER_FRINGE;
    let first = fringe / 6.0;
    let last = 1.0 / shortest_nm + step;
    if !(step > 0.0 && first < last) {
        return Vec::new();
    }
    let mut wavelengths_nm = Vec::new();
    let mut wavenumber = first;
    while wavenumber <= last {
        wavelengths_nm.push(1.0 / wavenumber);
        wavenumber += step;
    }
    let mut reflectance = vec![0.0; wavelengths_nm.len()];
    spectrum(&wavelengths_nm, &mut reflectance);

    let mut peaks = Vec::new();
    let mut order = 0;
    for (window, wavelengths) in reflectance.windows(3).zip(wavelengths_nm.windows(3)) {
        if window[1] > window[0] && window[1] >= window[2] {
            order += 1;
            if wavelengths[1] < shortest_nm || wavelengths[1] > longest_nm {
                continue;
            }
            let Some(wavenumber) = refine(1.0 / wavelengths[0], 1.0 / wavelengths[2], fringe, &mut spectrum) else {
                continue;
            };
            peaks.push(Peak { order, wavelength_nm: 1.0 / wavenumber });
        }
    }
    peaks
}

/// Wavenumber in the bracket where the slope passes from positive to negative, by the Illinois variant of false
/// position on a four-point difference; None if the slope does not change sign there, which is rounding in a flat
/// spectrum and no maximum.
///
/// The difference has the spacing fringe/500: its own error, ∝ spacing⁴, and the rounding of R, ∝ 1/spacing, both move
/// the maximum by less than 1e-9 of a fringe.
fn refine(low: f64, high: f64, fringe: f64, spectrum: &mut impl FnMut(&[f64], &mut [f64])) -> Option<f64> {
    let h = fringe / 500.0;
    let mut slope = |x: f64| {
        let mut values = [0.0; 4];
        spectrum(&[1.0 / (x - 2.0 * h), 1.0 / (x - h), 1.0 / (x + h), 1.0 / (x + 2.0 * h)], &mut values);
        values[0] - 8.0 * values[1] + 8.0 * values[2] - values[3]
    };
    let (mut low, mut high) = (low, high);
    let (mut slope_low, mut slope_high) = (slope(low), slope(high));
    if !(slope_low > 0.0 && slope_high < 0.0) {
        return None;
    }
    let mut x = low;
    // Converges faster than linearly; sixty rounds would do for plain bisection.
    for _ in 0..60 {
        let previous = x;
        x = (low * slope_high - high * slope_low) / (slope_high - slope_low);
        if (x - previous).abs() < 1e-13 * x {
            break;
        }
        let slope_x = slope(x);
        if slope_x > 0.0 {
            (low, slope_low) = (x, slope_x);
            slope_high *= 0.5;
        } else {
            (high, slope_high) = (x, slope_x);
            slope_low *= 0.5;
        }
    }
    Some(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A free-standing film of constant index has its maxima at λ = 4 n d cosθ₁/(2k − 1) exactly (the phase of
    /// reflection is the same at all wavelengths), whatever the finesse; the bar for a peak reading is 1e-3 nm.
    #[test]
    fn finds_the_maxima_of_an_airy_function() {
        for (path_nm, finesse) in [(300.0, 0.2), (1270.0, 3.0), (9000.0, 40.0)] {
            let airy = |wavelengths: &[f64], out: &mut [f64]| {
                for (value, nm) in out.iter_mut().zip(wavelengths) {
                    let sine = (std::f64::consts::TAU * path_nm / nm).sin();
                    *value = finesse * sine * sine / (1.0 + finesse * sine * sine);
                }
            };
            let peaks = find_peaks(path_nm, 300.0, 900.0, airy);
            let expected: Vec<(u32, f64)> = (1..200)
                .map(|order| (order, 4.0 * path_nm / (2.0 * f64::from(order) - 1.0)))
                .filter(|(_, nm)| (300.0..=900.0).contains(nm))
                .collect();
            assert_eq!(peaks.len(), expected.len(), "path {path_nm} nm");
            for (peak, (order, nm)) in peaks.iter().zip(expected) {
                assert_eq!(peak.order, order);
                approx::assert_abs_diff_eq!(peak.wavelength_nm, nm, epsilon = 1e-6); // a thousandth of the bar
            }
        }
    }

    #[test]
    fn a_flat_spectrum_has_no_peak() {
        assert!(find_peaks(500.0, 300.0, 800.0, |_, out| out.fill(0.3)).is_empty());
    }
}
