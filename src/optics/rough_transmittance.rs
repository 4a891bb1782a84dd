//! The power fractions of [`super::RoughInterface`] from a shipped table, for models that need them at every
//! evaluation.
//!
//! T depends on index, roughness and cosine. A plain grid would need very many nodes, because T bends over a width of
//! the order of α near the horizon, and from the denser side near the critical angle, which moves with the index. The
//! cosine is therefore counted in
//!
//! ```text
//! u = asinh((μ − μ_c) / w),   w = 1.5 α min(η, 1),   μ_c the critical cosine (0 from the thinner side),
//! ```
//!
//! between its values at μ = 0 and μ = 1, so that the bends lie at the same nodes for all indices and roughnesses and
//! have nodes closer than α. The index is counted in ln(n² − 1), because √(n² − 1) is the cosine over which a smooth
//! Fresnel reflectance falls, and the roughness in α^(1/3). Catmull–Rom interpolation along all three (Catmull and Rom
//! 1974), with a parabola at the ends.
//!
//! Index and roughness are the same for many directions: [`RoughTransmittance::curve`] interpolates along these two
//! once and leaves a curve over the cosine.

use std::ops::RangeInclusive;

use rayon::prelude::*;

use super::rough_interface::{RoughInterface, critical_cosine};

/// The shipped table; see [`RoughTransmittance::tabulate`].
static TABLE: &[u8] = include_bytes!("rough_transmittance.f32");

/// Bytes of a tabulated number.
const WIDTH: usize = size_of::<f32>();

const INDEX_NODES: usize = 20;
const ROUGHNESS_NODES: usize = 28;

/// From which side light comes to the interface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Side {
    /// The thinner medium, η = n > 1.
    Thinner,
    /// The denser medium, η = 1/n < 1, where there is total reflection.
    Denser,
}

impl Side {
    const fn cosine_nodes(self) -> usize {
        match self {
            Self::Thinner => 40,
            Self::Denser => 64,
        }
    }

    /// η = far side's index over light's side's.
    fn eta(self, n: f64) -> f64 {
        match self {
            Self::Thinner => n,
            Self::Denser => 1.0 / n,
        }
    }

    /// Numbers before this side's T in the table.
    const fn transmittance_offset(self) -> usize {
        match self {
            Self::Thinner => 0,
            Self::Denser => PAIRS * Self::Thinner.cosine_nodes(),
        }
    }

    /// Numbers before this side's reflectance of diffuse light.
    const fn reflectance_offset(self) -> usize {
        let transmittances = PAIRS * (Self::Thinner.cosine_nodes() + Self::Denser.cosine_nodes());
        match self {
            Self::Thinner => transmittances,
            Self::Denser => transmittances + PAIRS,
        }
    }
}

/// Pairs of index and roughness.
const PAIRS: usize = INDEX_NODES * ROUGHNESS_NODES;

/// Numbers before the transmittance of diffuse light from the thinner side, the last block.
const DIFFUSE_TRANSMITTANCE_OFFSET: usize = Side::Denser.reflectance_offset() + PAIRS;

/// Transmittance of a rough dielectric interface, interpolated in a shipped table of 240 kB.
///
/// Within 1e-3 of the direct quadrature everywhere (worst of 10⁵ random points: 5e-4 for T, 4e-4 for the means). Outside
/// [`RoughTransmittance::INDICES`] and [`RoughTransmittance::ROUGHNESSES`] the answer is NaN.
#[derive(Debug)]
pub struct RoughTransmittance;

impl RoughTransmittance {
    /// Ratios of the denser medium's index to the thinner one's that the table holds.
    pub const INDICES: RangeInclusive<f64> = 1.05..=2.5;

    /// Roughnesses α that the table holds.
    pub const ROUGHNESSES: RangeInclusive<f64> = 0.005..=1.0;

    /// T(μ) of the interface with `eta` = index on the far side over index on the light's side, and roughness `alpha`.
    pub fn curve(eta: f64, alpha: f64) -> TransmittanceCurve {
        let (side, place) = Place::of(eta, alpha);
        let count = side.cosine_nodes();
        let mut nodes = vec![0.0; count];
        for (pair, weight) in place.taps() {
            let start = side.transmittance_offset() + pair * count;
            for (node, value) in nodes.iter_mut().zip(numbers(start, count)) {
                *node += weight * value;
            }
        }
        TransmittanceCurve { scale: CosineScale::new(eta, alpha), nodes }
    }

    /// T(μ) for each of several indices `etas` ≥ 1, as [`RoughTransmittance::curve`] gives it, at one roughness.
    pub fn curves(etas: &[f64], alpha: f64) -> TransmittanceCurves {
        let (count, channels) = (Side::Thinner.cosine_nodes(), etas.len());
        let mut nodes = vec![0.0; count * channels];
        for (channel, &eta) in etas.iter().enumerate() {
            debug_assert!(eta >= 1.0, "light must come from the thinner side, found η = {eta}");
            if channel > 0 && eta.to_bits() == etas[channel - 1].to_bits() {
                // Most often all channels share their index.
                for row in nodes.chunks_exact_mut(channels) {
                    row[channel] = row[channel - 1];
                }
                continue;
            }
            for (node, value) in Self::curve(eta, alpha).nodes.into_iter().enumerate() {
                nodes[node * channels + channel] = value;
            }
        }
        // From the thinner side the scale depends on the roughness alone.
        TransmittanceCurves { scale: CosineScale::new(1.0, alpha), nodes, channels }
    }

    /// Share of diffuse light that the interface throws back, 2 ∫ R(μ) μ dμ.
    pub fn diffuse_reflectance(eta: f64, alpha: f64) -> f64 {
        let (side, place) = Place::of(eta, alpha);
        place.interpolate(side.reflectance_offset())
    }

    /// Share of diffuse light that crosses the interface, 2 ∫ T(μ) μ dμ. From the denser side it is 1/n² of that from
    /// the thinner one, since a beam that goes in comes out by the same way.
    pub fn diffuse_transmittance(eta: f64, alpha: f64) -> f64 {
        let (side, place) = Place::of(eta, alpha);
        let from_thinner = place.interpolate(DIFFUSE_TRANSMITTANCE_OFFSET);
        match side {
            Side::Thinner => from_thinner,
            Side::Denser => from_thinner * eta * eta,
        }
    }

    /// Computes the shipped table anew by [`RoughInterface`], as the bytes of its little-endian 32-bit numbers: T from
    /// the thinner side, T from the denser side, diffuse reflectance from either side, diffuse transmittance from the
    /// thinner side; each by index, then roughness, then cosine. Takes a minute or two.
    pub fn tabulate() -> Vec<u8> {
        let mut numbers = Vec::new();
        for side in [Side::Thinner, Side::Denser] {
            numbers.extend(for_all_pairs(|n, alpha| {
                let eta = side.eta(n);
                let (interface, scale) = (RoughInterface::new(eta, alpha), CosineScale::new(eta, alpha));
                (0..side.cosine_nodes())
                    .map(|node| interface.transmittance(scale.cosine(share(node, side.cosine_nodes()))))
                    .collect()
            }));
        }
        for side in [Side::Thinner, Side::Denser] {
            numbers
                .extend(for_all_pairs(|n, alpha| vec![RoughInterface::new(side.eta(n), alpha).diffuse_reflectance()]));
        }
        numbers.extend(for_all_pairs(|n, alpha| vec![RoughInterface::new(n, alpha).diffuse_transmittance()]));
        #[expect(clippy::cast_possible_truncation, reason = "the seven digits of a 32-bit number are enough")]
        numbers.into_iter().flat_map(|number| (number as f32).to_le_bytes()).collect()
    }
}

/// T over the cosine for one interface.
#[derive(Debug, Clone)]
pub struct TransmittanceCurve {
    scale: CosineScale,
    nodes: Vec<f64>,
}

impl TransmittanceCurve {
    /// T at 0 ≤ `cos_theta` ≤ 1.
    pub fn at(&self, cos_theta: f64) -> f64 {
        let (first, weights) = catmull_rom(self.scale.share(cos_theta), self.nodes.len());
        self.nodes[first..].iter().zip(weights).map(|(node, weight)| weight * node).sum()
    }
}

/// T over the cosine for interfaces that share a roughness and differ in index: one a channel, light from the thinner
/// side.
#[derive(Debug, Clone)]
pub struct TransmittanceCurves {
    scale: CosineScale,
    /// Every channel at the first node, then at the second: contiguous along the channels.
    nodes: Vec<f64>,
    channels: usize,
}

impl TransmittanceCurves {
    /// Multiplies each channel's value by its T at 0 ≤ `cos_theta` ≤ 1.
    #[inline(always)]
    pub fn multiply(&self, cos_theta: f64, values: &mut [f64]) {
        let (first, weights) = catmull_rom(self.scale.share(cos_theta), self.nodes.len() / self.channels);
        let start = first * self.channels;
        let mut rows = self.nodes[start..].chunks_exact(self.channels);
        let [Some(a), Some(b), Some(c), Some(d)] = std::array::from_fn(|_| rows.next()) else { return };
        for ((((value, a), b), c), d) in values.iter_mut().zip(a).zip(b).zip(c).zip(d) {
            *value *= weights[0] * a + weights[1] * b + weights[2] * c + weights[3] * d;
        }
    }
}

/// How the cosine is counted for one interface.
#[derive(Debug, Clone, Copy)]
pub(super) struct CosineScale {
    critical: f64,
    width: f64,
    u_at_0: f64,
    u_at_1: f64,
}

impl CosineScale {
    pub(super) fn new(eta: f64, alpha: f64) -> Self {
        let critical = critical_cosine(eta);
        let width = 1.5 * alpha * eta.min(1.0);
        Self { critical, width, u_at_0: (-critical / width).asinh(), u_at_1: ((1.0 - critical) / width).asinh() }
    }

    /// Place on the scale, 0 at the horizon and 1 at the normal.
    pub(super) fn share(&self, cos_theta: f64) -> f64 {
        (((cos_theta - self.critical) / self.width).asinh() - self.u_at_0) / (self.u_at_1 - self.u_at_0)
    }

    /// The other way round; never quite 0, where [`RoughInterface`] divides by it.
    pub(super) fn cosine(&self, share: f64) -> f64 {
        self.cosine_and_slope(share).0
    }

    /// The same with its derivative.
    pub(super) fn cosine_and_slope(&self, share: f64) -> (f64, f64) {
        let length = self.u_at_1 - self.u_at_0;
        let u = self.u_at_0 + length * share;
        ((self.critical + self.width * u.sinh()).clamp(1e-9, 1.0), length * self.width * u.cosh())
    }
}

/// Which nodes of index and roughness a pair lies between.
struct Place {
    index: (usize, [f64; 4]),
    roughness: (usize, [f64; 4]),
}

impl Place {
    fn of(eta: f64, alpha: f64) -> (Side, Self) {
        let (side, n) = if eta >= 1.0 { (Side::Thinner, eta) } else { (Side::Denser, 1.0 / eta) };
        // The inverse of an end of the range may miss it by a rounding.
        let n = if side == Side::Denser {
            n.clamp(RoughTransmittance::INDICES.start() - 1e-12, RoughTransmittance::INDICES.end() + 1e-12)
        } else {
            n
        };
        let index = position(&RoughTransmittance::INDICES, n, index_measure);
        let roughness = position(&RoughTransmittance::ROUGHNESSES, alpha, roughness_measure);
        let place = Self { index: catmull_rom(index, INDEX_NODES), roughness: catmull_rom(roughness, ROUGHNESS_NODES) };
        (side, place)
    }

    /// The sixteen neighbouring pairs and their weights.
    fn taps(&self) -> impl Iterator<Item = (usize, f64)> {
        let (first_index, index_weights) = self.index;
        let (first_roughness, roughness_weights) = self.roughness;
        (0..4).flat_map(move |i| {
            (0..4).map(move |j| {
                let pair = (first_index + i) * ROUGHNESS_NODES + first_roughness + j;
                (pair, index_weights[i] * roughness_weights[j])
            })
        })
    }

    fn interpolate(&self, offset: usize) -> f64 {
        self.taps().map(|(pair, weight)| weight * numbers(offset + pair, 1).sum::<f64>()).sum()
    }
}

fn index_measure(n: f64) -> f64 {
    (n * n - 1.0).ln()
}

fn roughness_measure(alpha: f64) -> f64 {
    alpha.cbrt()
}

/// Place in a range between 0 and 1, counted in a measure of the value; NaN outside.
fn position(range: &RangeInclusive<f64>, value: f64, measure: fn(f64) -> f64) -> f64 {
    if !range.contains(&value) {
        return f64::NAN;
    }
    let (start, end) = (measure(*range.start()), measure(*range.end()));
    (measure(value) - start) / (end - start)
}

/// Numbers of the table from `start` on.
fn numbers(start: usize, count: usize) -> impl Iterator<Item = f64> {
    TABLE[start * WIDTH..(start + count) * WIDTH]
        .as_chunks::<WIDTH>()
        .0
        .iter()
        .map(|&bytes| f64::from(f32::from_le_bytes(bytes)))
}

/// The function at every pair of nodes of index and roughness, in the table's order.
fn for_all_pairs(function: impl Fn(f64, f64) -> Vec<f64> + Sync) -> Vec<f64> {
    let (index_start, index_end) =
        (index_measure(*RoughTransmittance::INDICES.start()), index_measure(*RoughTransmittance::INDICES.end()));
    let (start, end) = (
        roughness_measure(*RoughTransmittance::ROUGHNESSES.start()),
        roughness_measure(*RoughTransmittance::ROUGHNESSES.end()),
    );
    let rows: Vec<Vec<f64>> = (0..PAIRS)
        .into_par_iter()
        .map(|pair| {
            let n = (1.0
                + (index_start + (index_end - index_start) * share(pair / ROUGHNESS_NODES, INDEX_NODES)).exp())
            .sqrt();
            let alpha = (start + (end - start) * share(pair % ROUGHNESS_NODES, ROUGHNESS_NODES)).powi(3);
            function(n, alpha)
        })
        .collect();
    rows.concat()
}

/// Place of a node among `count`, 0 for the first and 1 for the last.
#[expect(clippy::cast_precision_loss, reason = "numbers of nodes are far below 2^53")]
fn share(node: usize, count: usize) -> f64 {
    node as f64 / (count - 1) as f64
}

/// First of four neighbouring nodes and their weights, for a place between 0 (first node) and 1 (last). Beyond an end
/// the missing node continues the parabola through the last three.
fn catmull_rom(place: f64, count: usize) -> (usize, [f64; 4]) {
    #[expect(clippy::cast_precision_loss, reason = "numbers of nodes are far below 2^53")]
    let x = place * (count - 1) as f64;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to the nodes; NaN becomes 0")]
    let cell = (x.max(0.0) as usize).min(count - 2);
    #[expect(clippy::cast_precision_loss, reason = "numbers of nodes are far below 2^53")]
    let t = x - cell as f64;
    let w0 = t * (-0.5 + t * (1.0 - 0.5 * t));
    let w1 = 1.0 + t * t * (-2.5 + 1.5 * t);
    let w2 = t * (0.5 + t * (2.0 - 1.5 * t));
    let w3 = t * t * (-0.5 + 0.5 * t);
    if cell == 0 {
        (0, [w1 + 3.0 * w0, w2 - 3.0 * w0, w3 + w0, 0.0 * t])
    } else if cell == count - 2 {
        (count - 4, [0.0 * t, w0 + w3, w1 - 3.0 * w3, w2 + 3.0 * w3])
    } else {
        (cell - 1, [w0, w1, w2, w3])
    }
}

#[cfg(test)]
mod tests {
    use rand::{Rng, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    /// The means over diffuse light at 10⁵ random points of the whole domain, evenly in the index and in the roughness's
    /// logarithm. Ten nodes a panel instead of 32 make the quadrature affordable; what that costs is found at every
    /// thousandth point, and counted as an error of the table.
    #[test]
    #[ignore = "long: run by .ci/long"]
    fn diffuse_fractions_are_right_everywhere() {
        const POINTS: u64 = 100_000;
        let (least, most) = (*RoughTransmittance::ROUGHNESSES.start(), *RoughTransmittance::ROUGHNESSES.end());
        let errors_at = |point: u64| {
            let mut random = ChaCha8Rng::seed_from_u64(37);
            random.set_stream(point);
            let n = random.random_range(RoughTransmittance::INDICES);
            let eta = if random.random() { n } else { 1.0 / n };
            let alpha = random.random_range(least.ln()..=most.ln()).exp().clamp(least, most);
            let means = |nodes| {
                let interface = RoughInterface::with_nodes(eta, alpha, nodes);
                [interface.diffuse_reflectance(), interface.diffuse_transmittance()]
            };
            let [reflected, transmitted] = means(10);
            let table = [
                (RoughTransmittance::diffuse_reflectance(eta, alpha) - reflected).abs(),
                (RoughTransmittance::diffuse_transmittance(eta, alpha) - transmitted).abs(),
            ];
            let quadrature = if point.is_multiple_of(1000) {
                let [fine_reflected, fine_transmitted] = means(32);
                (fine_reflected - reflected).abs().max((fine_transmitted - transmitted).abs())
            } else {
                0.0
            };
            [table[0], table[1], quadrature]
        };
        let errors: Vec<[f64; 3]> = (0..POINTS).into_par_iter().map(errors_at).collect();
        let worst = |which: usize| errors.iter().map(|error| error[which]).fold(0.0, f64::max);
        let [reflectance, transmittance, quadrature] = [0, 1, 2].map(worst);
        println!("worst of {POINTS}: R_int {reflectance:.2e}, T_int {transmittance:.2e}, quadrature {quadrature:.2e}");
        assert!(reflectance.max(transmittance) + quadrature <= 1e-3);
    }
}
