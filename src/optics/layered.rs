//! Layers on a substrate over many channels: what they are, and their unpolarised reflectance.

use super::film_kernel::{self, FilmChannels};
use super::stack_kernel::{self, StackChannels};

/// ε = (n + ik)² of a material, channel by channel.
#[derive(Debug, Clone, PartialEq)]
pub struct Permittivity {
    re: Vec<f64>,
    im: Vec<f64>,
    least_re: f64,
    clear: bool,
}

impl Permittivity {
    /// From n > 0 and k ≥ 0 in each channel.
    pub fn new(n: impl Iterator<Item = f64> + Clone, k: impl Iterator<Item = f64> + Clone) -> Self {
        let re: Vec<f64> = n.clone().zip(k.clone()).map(|(n, k)| n * n - k * k).collect();
        let im: Vec<f64> = n.zip(k).map(|(n, k)| 2.0 * n * k).collect();
        let least_re = fold_lanes(&re, f64::INFINITY, |least, re| if re < least { re } else { least });
        let clear = fold_lanes(&im, 0.0, |greatest, im| if im > greatest { im } else { greatest }) <= 0.0;
        Self { re, im, least_re, clear }
    }

    pub(super) fn re(&self) -> &[f64] {
        &self.re
    }

    pub(super) fn im(&self) -> &[f64] {
        &self.im
    }
}

/// A fold whose steps do not wait for each other: eight at a time, and then those eight.
fn fold_lanes(values: &[f64], start: f64, step: impl Fn(f64, f64) -> f64) -> f64 {
    let mut lanes = [start; 8];
    for chunk in values.chunks(lanes.len()) {
        for (lane, value) in lanes.iter_mut().zip(chunk) {
            *lane = step(*lane, *value);
        }
    }
    lanes.into_iter().fold(start, step)
}

/// Which layers follow each other, from the outside in, and of what material each is. Layers that occur several times
/// (a period) are named once.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Arrangement {
    material_count: usize,
    layer_materials: Vec<usize>,
    sequence: Vec<usize>,
    substrate: usize,
    /// Distinct pairs of media that touch, upper and lower; the medium in front has the number `material_count`.
    interfaces: Vec<(usize, usize)>,
    last_interface: usize,
    /// From the inside out: the interface above a layer, and that layer.
    steps: Vec<(usize, usize)>,
}

impl Arrangement {
    /// `layer_materials` gives the material of each distinct layer, `sequence` the layers from the outside in, `substrate`
    /// the material below them all; materials are numbers below `material_count`.
    ///
    /// # Panics
    /// If a number names no layer or no material: that is the caller's slip, not a user's.
    pub fn new(material_count: usize, layer_materials: Vec<usize>, sequence: Vec<usize>, substrate: usize) -> Self {
        assert!(substrate < material_count, "the substrate's material does not exist");
        assert!(layer_materials.iter().all(|&material| material < material_count), "a layer's material does not exist");
        assert!(sequence.iter().all(|&layer| layer < layer_materials.len()), "a layer does not exist");

        let media: Vec<usize> = std::iter::once(material_count)
            .chain(sequence.iter().map(|&layer| layer_materials[layer]))
            .chain(std::iter::once(substrate))
            .collect();
        let mut interfaces = Vec::new();
        let kinds: Vec<usize> = media
            .windows(2)
            .map(|pair| {
                let pair = (pair[0], pair[1]);
                interfaces.iter().position(|known| *known == pair).unwrap_or_else(|| {
                    interfaces.push(pair);
                    interfaces.len() - 1
                })
            })
            .collect();
        let last_interface = kinds[sequence.len()];
        let steps = kinds.into_iter().zip(sequence.iter().copied()).rev().collect();
        Self { material_count, layer_materials, sequence, substrate, interfaces, last_interface, steps }
    }

    /// Number of distinct layers.
    pub fn layer_count(&self) -> usize {
        self.layer_materials.len()
    }

    pub(super) fn layer_materials(&self) -> &[usize] {
        &self.layer_materials
    }

    pub(super) fn interfaces(&self) -> &[(usize, usize)] {
        &self.interfaces
    }

    pub(super) fn last_interface(&self) -> usize {
        self.last_interface
    }

    pub(super) fn steps(&self) -> &[(usize, usize)] {
        &self.steps
    }
}

/// 4π/λ for each wavelength, 1/nm: what [`LayeredMedium`] needs of the channels.
pub fn double_wavenumbers(wavelengths_nm: &[f64]) -> Vec<f64> {
    wavelengths_nm.iter().map(|wavelength| 4.0 * std::f64::consts::PI / wavelength).collect()
}

/// Layers on a substrate with all their numbers.
#[derive(Debug, Clone)]
pub struct LayeredMedium<'a> {
    arrangement: &'a Arrangement,
    double_wavenumbers: &'a [f64],
    permittivities: Vec<Permittivity>,
    thicknesses_nm: Vec<f64>,
}

impl<'a> LayeredMedium<'a> {
    /// From 4π/λ of each channel, the permittivity of each material and the thickness of each distinct layer.
    ///
    /// # Panics
    /// If a list is not as long as the arrangement or the channels ask: that is the caller's slip, not a user's.
    pub fn new(
        arrangement: &'a Arrangement,
        double_wavenumbers: &'a [f64],
        permittivities: Vec<Permittivity>,
        thicknesses_nm: Vec<f64>,
    ) -> Self {
        assert_eq!(permittivities.len(), arrangement.material_count, "one permittivity a material");
        assert_eq!(thicknesses_nm.len(), arrangement.layer_materials.len(), "one thickness a layer");
        for permittivity in &permittivities {
            assert_eq!(permittivity.re.len(), double_wavenumbers.len(), "one permittivity a channel");
        }
        Self { arrangement, double_wavenumbers, permittivities, thicknesses_nm }
    }

    /// Writes the unpolarised reflectance of every channel, for light at `cos_theta` (0 to 1) to the normal in a clear
    /// medium of index `front`.
    ///
    /// Within 1e-12 of [`super::stack::transfer`] for phases 2δ up to 10⁶.
    ///
    /// # Panics
    /// If `reflectance` is not one number a channel.
    pub fn reflectance(&self, front: f64, cos_theta: f64, reflectance: &mut [f64]) {
        assert_eq!(reflectance.len(), self.double_wavenumbers.len(), "one reflectance a channel");
        match self.clear_film(front, cos_theta) {
            Some((channels, thickness_nm)) => {
                film_kernel::reflectance(channels, thickness_nm, front, cos_theta, reflectance);
            }
            None => stack_kernel::reflectance(
                StackChannels {
                    arrangement: self.arrangement,
                    double_wavenumbers: self.double_wavenumbers,
                    permittivities: &self.permittivities,
                    thicknesses_nm: &self.thicknesses_nm,
                    front,
                    cos_theta,
                },
                reflectance,
            ),
        }
    }

    /// Σ n d over all layers in the order they follow each other, nm, in each channel.
    pub fn optical_thickness_nm(&self) -> Vec<f64> {
        let mut sums = vec![0.0; self.double_wavenumbers.len()];
        for &layer in &self.arrangement.sequence {
            let material = &self.permittivities[self.arrangement.layer_materials[layer]];
            for ((sum, re), im) in sums.iter_mut().zip(&material.re).zip(&material.im) {
                // n is the real part of √ε.
                *sum += self.thicknesses_nm[layer] * (0.5 * (re.hypot(*im) + re)).sqrt();
            }
        }
        sums
    }

    /// The inputs of the fast kernel, where this is a single clear film far enough from total reflection.
    fn clear_film(&self, front: f64, cos_theta: f64) -> Option<(FilmChannels<'_>, f64)> {
        let &[layer] = self.arrangement.sequence.as_slice() else { return None };
        let film = &self.permittivities[self.arrangement.layer_materials[layer]];
        let substrate = &self.permittivities[self.arrangement.substrate];
        let least = front * front * (1.0 - cos_theta * cos_theta) + film_kernel::LEAST_MARGIN;
        (film.clear && film.least_re > least && substrate.least_re > least).then(|| {
            let channels = FilmChannels {
                double_wavenumbers: self.double_wavenumbers,
                film: &film.re,
                substrate_re: &substrate.re,
                substrate_im: &substrate.im,
            };
            (channels, self.thicknesses_nm[layer])
        })
    }
}
