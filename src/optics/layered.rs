//! Layers on a substrate over many channels: what they are, and their unpolarised shares of reflected and transmitted
//! power.

use super::film_kernel::{self, FilmChannels};
use super::gauss_legendre;
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
    /// The medium that the light comes from, and the last one. That outside has the number `material_count`.
    light: usize,
    last: usize,
    /// Distinct pairs of media that touch, upper and lower.
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

        Self::between(material_count, layer_materials, sequence, material_count, substrate)
    }

    /// The same layers met from the substrate.
    fn reversed(&self) -> Self {
        let sequence = self.sequence.iter().rev().copied().collect();
        Self::between(self.material_count, self.layer_materials.clone(), sequence, self.last, self.light)
    }

    fn between(
        material_count: usize,
        layer_materials: Vec<usize>,
        sequence: Vec<usize>,
        light: usize,
        last: usize,
    ) -> Self {
        let media: Vec<usize> = std::iter::once(light)
            .chain(sequence.iter().map(|&layer| layer_materials[layer]))
            .chain(std::iter::once(last))
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
        Self { material_count, layer_materials, sequence, light, last, interfaces, last_interface, steps }
    }

    /// Number of distinct layers.
    pub fn layer_count(&self) -> usize {
        self.layer_materials.len()
    }

    pub(super) fn light(&self) -> usize {
        self.light
    }

    pub(super) fn last(&self) -> usize {
        self.last
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

/// Cosines on either side of the critical angle at which light from inside is followed.
const INSIDE_NODES: usize = 48;

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
            None => stack_kernel::reflectance(self.stack(self.arrangement, front, cos_theta), reflectance),
        }
    }

    /// Writes the share of unpolarised power that enters the substrate, for light as in
    /// [`LayeredMedium::reflectance`]. The substrate must be clear, see [`LayeredMedium::substrate_permittivity`].
    ///
    /// # Panics
    /// If `transmittance` is not one number a channel.
    pub fn transmittance(&self, front: f64, cos_theta: f64, transmittance: &mut [f64]) {
        if cos_theta <= 0.0 {
            // Nothing enters at grazing incidence.
            transmittance.fill(0.0);
        } else if self.layers_are_clear() {
            self.reflectance(front, cos_theta, transmittance);
            for share in transmittance {
                *share = 1.0 - *share;
            }
        } else {
            let mut reflectance = vec![0.0; transmittance.len()];
            stack_kernel::shares(self.stack(self.arrangement, front, cos_theta), &mut reflectance, transmittance);
        }
    }

    /// Writes the share of unpolarised power that the layers absorb of diffuse light from the substrate, 2 ∫ A(μ) μ dμ
    /// with μ the cosine in the substrate, which must be clear; `front` is the index of the medium on the other side.
    ///
    /// By Gauss–Legendre quadrature on both sides of the critical angle, whose place is taken to be that of the middle
    /// channel; error below 1e-4 for layers of visible colours and some micrometres.
    ///
    /// # Panics
    /// If `absorptance` is not one number a channel.
    pub fn diffuse_absorptance_inside(&self, front: f64, absorptance: &mut [f64]) {
        absorptance.fill(0.0);
        if self.layers_are_clear() {
            return;
        }
        let reversed = self.arrangement.reversed();
        let middle = self.substrate_permittivity()[absorptance.len() / 2];
        let critical = (1.0 - front * front / middle).max(0.0).sqrt();
        let (mut reflectance, mut transmittance) = (vec![0.0; absorptance.len()], vec![0.0; absorptance.len()]);
        for (start, end) in [(0.0, critical), (critical, 1.0)] {
            for (t, weight) in gauss_legendre(INSIDE_NODES) {
                // β(t) = t²(3 − 2t) takes away the square root with which transmission begins at the critical angle.
                let cos_theta = start + (end - start) * t * t * (3.0 - 2.0 * t);
                let weight = weight * (end - start) * 6.0 * t * (1.0 - t);
                if cos_theta <= 0.0 {
                    continue;
                }
                stack_kernel::shares(self.stack(&reversed, front, cos_theta), &mut reflectance, &mut transmittance);
                for ((sum, reflected), transmitted) in absorptance.iter_mut().zip(&reflectance).zip(&transmittance) {
                    *sum += 2.0 * cos_theta * weight * (1.0 - reflected - transmitted);
                }
            }
        }
    }

    /// ε of the substrate in each channel; 0 < ε is n² where the substrate is clear.
    pub fn substrate_permittivity(&self) -> &[f64] {
        &self.permittivities[self.arrangement.last].re
    }

    /// Number of layers, repeated ones as often as they occur.
    pub(super) fn layer_count(&self) -> usize {
        self.arrangement.sequence.len()
    }

    /// Whether nothing above the substrate absorbs.
    fn layers_are_clear(&self) -> bool {
        self.arrangement
            .sequence
            .iter()
            .all(|&layer| self.permittivities[self.arrangement.layer_materials[layer]].clear)
    }

    /// How fast the phases of all layers together turn with the cosine of the light in a medium of index `front`, in the
    /// channel where they do so fastest: Σ d(2δ)/dc at c = 1, where 2δ = 4π d √(n² − n₀² + n₀² c²)/λ is steepest. Where
    /// there is total reflection, at c beyond its bend.
    pub(super) fn fringe_rate(&self, front: f64) -> f64 {
        let rate = |channel: usize| {
            let of_layer = |&layer: &usize| {
                let permittivity = self.permittivities[self.arrangement.layer_materials[layer]].re[channel];
                self.thicknesses_nm[layer] * front * front / permittivity.max(front * front).sqrt()
            };
            self.double_wavenumbers[channel] * self.arrangement.sequence.iter().map(of_layer).sum::<f64>()
        };
        (0..self.double_wavenumbers.len()).map(rate).fold(0.0, f64::max)
    }

    /// The inputs of the general kernel, the layers met in the order of `arrangement`.
    fn stack<'b>(&'b self, arrangement: &'b Arrangement, outside: f64, cos_theta: f64) -> StackChannels<'b> {
        StackChannels {
            arrangement,
            double_wavenumbers: self.double_wavenumbers,
            permittivities: &self.permittivities,
            thicknesses_nm: &self.thicknesses_nm,
            outside,
            cos_theta,
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
        let substrate = &self.permittivities[self.arrangement.last];
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
