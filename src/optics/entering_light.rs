//! How much light passes the layers on a rough surface and enters what lies below, over all directions at once.
//!
//! With single scattering on microfacets that all carry the same layers,
//!
//! ```text
//! T(μ) = 1 − ∫ K(μ, c; α) (1 − t(c)) dc
//! ```
//!
//! where t(c) is the layers' own transmittance and K the weight with which light from the cosine μ meets microfacets at
//! c, see [`super::mirror_facets`]. What the lobe throws back and what the layers absorb is taken off; what a mirrored
//! ray would lose on a second microfacet (1 − ∫ K dc, some 1 % at α 0.2 along the normal, half at grazing incidence and
//! α 1) counts as entering.
//!
//! K knows neither thickness nor wavelength. It is kept as a [`FacetKernel`], a matrix between two lists of cosines,
//! which costs a millisecond for a roughness and then serves any layers and any number of channels. Both lists are even in
//! a measure in which the function is smooth, and read by sextic interpolation: t in c, with nodes closer than half a
//! radian of the fringes' phase; T in the measure of [`super::rough_transmittance`], in which a bend of width α at the
//! horizon spans the same number of nodes at every roughness.

use super::gauss_legendre;
use super::layered::LayeredMedium;
use super::mirror_facets::{MirrorFacets, panel_width};
use super::rough_transmittance::CosineScale;

/// Fewest intervals: what Fresnel's equations, and the bend at the horizon, need by themselves.
const LEAST_FACET_INTERVALS: usize = 48;
const LEAST_LIGHT_INTERVALS: usize = 36;

/// Most intervals. A stack whose fringes are finer is seen blurred.
const MOST_FACET_INTERVALS: usize = 3072;
const MOST_LIGHT_INTERVALS: usize = 1152;

/// Widest spacing of the nodes in a fringe's phase, radians. Sextic interpolation of a cosine is then off by
/// (225/64)/6! · 0.5⁶ = 8e-5 of its amplitude, which for a film on keratin is 0.05.
const PHASE_STEP: f64 = 0.5;

/// The same for more layers than one, whose fringes have resonances.
const PHASE_STEP_OF_STACK: f64 = 0.25;

/// The same for dozens of layers, whose resonances are sharper still.
const PHASE_STEP_OF_MANY: f64 = 0.08;

/// More layers than this are dozens.
const FEW_LAYERS: usize = 12;

/// Slopes beyond this many α hold e⁻²⁰ = 2e-9 of the surface, which is enough for a table.
const STEEPEST_SLOPE: f64 = 4.5;

/// Nodes of one panel of the quadrature over microfacets.
const PANEL_NODES: usize = 8;

/// Widest panel in a fringe's phase, radians: eight nodes integrate a period and a quarter to 1e-7.
const PANEL_PHASE: f64 = 8.0;

/// Points of the interpolation.
const TAPS: usize = 6;

/// Channels worked on together.
const BLOCK: usize = 32;

/// K of one roughness as a matrix.
///
/// What it gives for T is within 2e-5 of the exact value for a plain interface, 1e-4 for any film and for stacks of up to
/// eight layers, and 1e-3 for clear stacks of dozens of layers, whose resonances are sharper than their fringes (all for
/// α from 0.01 to 1). Where light is totally reflected within the range of cosines, by a layer or substrate thinner than
/// the medium in front, T has a bend that the interpolation rounds off: there it is good to some 1e-3.
#[derive(Debug)]
pub struct FacetKernel {
    alpha: f64,
    facet_intervals: usize,
    light_intervals: usize,
    /// For each cosine of light the first cosine of microfacets that it meets, and the weights from there on.
    rows: Vec<(usize, Vec<f64>)>,
    /// 2 ∫ T μ dμ as a sum over the cosines of light.
    mean: Vec<f64>,
}

impl FacetKernel {
    /// The kernel of roughness `alpha`, fine enough for these layers under a medium of index `front`.
    pub fn new(alpha: f64, medium: &LayeredMedium<'_>, front: f64) -> Self {
        let (facet_intervals, light_intervals) = intervals(alpha, medium, front);
        let rule = gauss_legendre(PANEL_NODES);
        let scale = CosineScale::new(1.0, alpha);
        // No fringe turns faster than this.
        let fastest = PHASE_STEP * facet_intervals as f64;
        let panel_width = panel_width(alpha).min(PANEL_PHASE / fastest);
        let facets = MirrorFacets { alpha, steepest: STEEPEST_SLOPE, panel_width, rule: &rule };
        let row = |node: usize| {
            let mut weights = vec![0.0; facet_intervals + 1];
            facets.visit(scale.cosine(place(node, light_intervals)), std::f64::consts::FRAC_PI_2, |cosine, weight| {
                let (first, taps) = sextic(cosine, facet_intervals);
                for (sum, tap) in weights[first..].iter_mut().zip(taps) {
                    *sum += weight * tap;
                }
            });
            let start = weights.iter().position(|&weight| weight != 0.0).unwrap_or(0);
            let end = weights.iter().rposition(|&weight| weight != 0.0).map_or(start, |last| last + 1);
            (start, weights[start..end].to_vec())
        };

        let mut mean = vec![0.0; light_intervals + 1];
        for interval in 0..light_intervals {
            let (start, end) = (place(interval, light_intervals), place(interval + 1, light_intervals));
            for &(node, weight) in &rule {
                let share = start + (end - start) * node;
                let (cosine, slope) = scale.cosine_and_slope(share);
                let (first, taps) = sextic(share, light_intervals);
                for (sum, tap) in mean[first..].iter_mut().zip(taps) {
                    *sum += 2.0 * cosine * slope * (end - start) * weight * tap;
                }
            }
        }
        Self { alpha, facet_intervals, light_intervals, rows: (0..=light_intervals).map(row).collect(), mean }
    }

    /// Whether this is the kernel that [`FacetKernel::new`] would make.
    pub fn suits(&self, alpha: f64, medium: &LayeredMedium<'_>, front: f64) -> bool {
        self.alpha.to_bits() == alpha.to_bits()
            && (self.facet_intervals, self.light_intervals) == intervals(alpha, medium, front)
    }

    /// T over all cosines of the light, for layers under a medium of index `front` on a clear substrate.
    pub fn entering(&self, medium: &LayeredMedium<'_>, front: f64) -> EnteringLight {
        let channels = medium.substrate_permittivity().len();
        // 1 − t at each microfacet's cosine: all channels of the first, then of the second.
        let mut held_back = vec![0.0; (self.facet_intervals + 1) * channels];
        for (node, held_back) in held_back.chunks_exact_mut(channels).enumerate() {
            medium.transmittance(front, place(node, self.facet_intervals), held_back);
            for share in held_back {
                *share = 1.0 - *share;
            }
        }
        let mut nodes = vec![1.0; self.rows.len() * channels];
        for ((start, weights), entering) in self.rows.iter().zip(nodes.chunks_exact_mut(channels)) {
            for (weight, held_back) in weights.iter().zip(held_back[start * channels..].chunks_exact(channels)) {
                for (entering, held_back) in entering.iter_mut().zip(held_back) {
                    *entering -= weight * held_back;
                }
            }
        }
        let mut mean = vec![0.0; channels];
        for (weight, entering) in self.mean.iter().zip(nodes.chunks_exact(channels)) {
            for (mean, entering) in mean.iter_mut().zip(entering) {
                *mean += weight * entering;
            }
        }
        EnteringLight { scale: CosineScale::new(1.0, self.alpha), intervals: self.light_intervals, nodes, mean }
    }
}

/// T(μ) of each channel.
#[derive(Debug)]
pub struct EnteringLight {
    scale: CosineScale,
    intervals: usize,
    /// All channels at the first cosine, then at the second.
    nodes: Vec<f64>,
    mean: Vec<f64>,
}

impl EnteringLight {
    /// 2 ∫ T μ dμ of each channel.
    pub fn mean(&self) -> &[f64] {
        &self.mean
    }

    /// Adds `factors` · T(μ) T(μ') to `values`, channel by channel. The two cosines may change places.
    pub fn add_products(&self, [one, other]: [f64; 2], factors: &[f64], values: &mut [f64]) {
        let channels = self.mean.len();
        let place = |cosine: f64| {
            let (first, weights) = sextic(self.scale.share(cosine), self.intervals);
            (&self.nodes[first * channels..(first + TAPS) * channels], weights)
        };
        let places = [place(one), place(other)];
        for (block, (values, factors)) in values.chunks_mut(BLOCK).zip(factors.chunks(BLOCK)).enumerate() {
            let lanes = block * BLOCK..block * BLOCK + values.len();
            let [one, other] = places.map(|(rows, weights)| {
                let mut sums = [0.0; BLOCK];
                for (row, weight) in rows.chunks_exact(channels).zip(weights) {
                    for (sum, node) in sums.iter_mut().zip(&row[lanes.clone()]) {
                        *sum += weight * node;
                    }
                }
                sums
            });
            for (((value, factor), one), other) in values.iter_mut().zip(factors).zip(one).zip(other) {
                *value += factor * (one * other);
            }
        }
    }
}

/// Numbers of intervals for microfacets and for light. They grow by powers of two, so that one kernel serves many
/// thicknesses, and a fit's small steps hardly ever change them.
fn intervals(alpha: f64, medium: &LayeredMedium<'_>, front: f64) -> (usize, usize) {
    let step = match medium.layer_count() {
        0..=1 => PHASE_STEP,
        2..=FEW_LAYERS => PHASE_STEP_OF_STACK,
        _ => PHASE_STEP_OF_MANY,
    };
    let needed = medium.fringe_rate(front) / step;
    let ladder = |least: usize, most: usize, needed: f64| {
        let mut count = least;
        while count < most && (count as f64) < needed {
            count *= 2;
        }
        count
    };
    // How far the cosine moves for the whole length of the measure, where it moves fastest: at the normal.
    let widest = CosineScale::new(1.0, alpha).cosine_and_slope(1.0).1;
    (
        ladder(LEAST_FACET_INTERVALS, MOST_FACET_INTERVALS, needed),
        ladder(LEAST_LIGHT_INTERVALS, MOST_LIGHT_INTERVALS, needed * widest),
    )
}

fn place(node: usize, intervals: usize) -> f64 {
    node as f64 / intervals as f64
}

/// First of six neighbouring nodes and their Lagrange weights, for a place between 0 (first node) and 1 (last).
fn sextic(place: f64, intervals: usize) -> (usize, [f64; TAPS]) {
    let x = place * intervals as f64;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place is 0 or more")]
    let first = (x as usize).saturating_sub(2).min(intervals + 1 - TAPS);
    let x = x - first as f64;
    let from = |node: i32| x - f64::from(node);
    let (a, b, c, d, e, f) = (from(0), from(1), from(2), from(3), from(4), from(5));
    let weights = [
        -b * c * d * e * f / 120.0,
        a * c * d * e * f / 24.0,
        -a * b * d * e * f / 12.0,
        a * b * c * e * f / 12.0,
        -a * b * c * d * f / 24.0,
        a * b * c * d * e / 120.0,
    ];
    (first, weights)
}
