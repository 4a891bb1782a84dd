//! The far field from tables of its azimuthal lobes, for pictures: many directions, one set of parameters.
//!
//! Nₚ depends on the azimuth φ and on the viewer's inclination alone, for fixed parameters. It is stored over a grid in
//! cosθo and φ, both evenly spaced, and interpolated by cubic polynomials through four points in either direction. The lobes Mₚ
//! are evaluated as they are. All that enters the fibre falls as cos²θo towards the grazing end, so the table holds Nₚ/cos²θo
//! for TT and TRT, which is smooth and nowhere small. φ needs to run over half a turn only, since the lobes are even. All later
//! paths hang on the inclination alone, and without absorption as its cosine: they have a list of their own, evenly
//! spaced in √cosθo.
//!
//! The error is not assumed but measured when a table is built: half-way between its points, where it is largest, in one
//! direction and then in the other, everywhere. The grid is refined until the sum is small enough.

use rayon::prelude::*;

use super::attenuation::Attenuation;
use super::far_field::Refraction;
use super::longitudinal::Longitudinal;
use super::pairs::{FEWEST, PAIRS, PairAngles};
use super::{AzimuthalSource, Cylinder, FibreAngles, FibreSampler, LazySampler, only, over_cosine};
use crate::bsdf::{Bsdf, Direction, Sample, one_at_a_time};

/// Channels in an entry.
const ENTRY_CHANNELS: usize = 5;

/// Three lobes for each of five channels, lobe by lobe, and a rest: one line of the processor's cache.
type Entry = [f32; 16];

/// A cylinder whose azimuthal lobes are tabulated; see [`Cylinder::tabulate`].
#[derive(Debug, Clone)]
pub struct TabulatedCylinder {
    longitudinal: Longitudinal,
    channel_count: usize,
    grid: Grid,
    entries: Vec<Entry>,
    /// N₃₊ over √cosθo, from 0 to 1, all channels of a point together.
    later: Vec<f32>,
    /// What a sponge inside sends out, over (1 + cosφ), likewise; empty without a sponge.
    sponge: Vec<f32>,
    error: f64,
    lobe_width: f64,
    sampler: LazySampler,
}

/// Intervals of the list of later paths: enough for 1e-5 of its largest value at any absorption.
const LATER_INTERVALS: usize = 1024;

/// The number of intervals in both directions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Grid {
    /// Between cosθo = 0 and 1.
    inclinations: usize,
    /// Between φ = 0 and π.
    azimuths: usize,
}

/// Seven times the points that a roughness of 0.05 needs, 16 MiB; refinement stops here.
const MOST_POINTS: usize = 1 << 18;

impl Cylinder {
    /// Tabulates the azimuthal lobes so that each differs from the exact one by at most a third of `tolerance` of its
    /// largest value over azimuths, hence the far field by at most `tolerance` of its own. (Later paths: 1e-5 of their largest
    /// value over inclinations.)
    ///
    /// What was reached is told by [`TabulatedCylinder::error`]: refinement stops at 2¹⁸ points, and a tolerance below 1e-6,
    /// the resolution of the stored numbers, is not pursued.
    pub fn tabulate(&self, tolerance: f64) -> TabulatedCylinder {
        self.tabulate_by(tolerance, false)
    }

    /// The same where the channels are shades of one fibre: each is as good as `tolerance` of the brightest of them.
    pub(super) fn tabulate_shades(&self, tolerance: f64) -> TabulatedCylinder {
        self.tabulate_by(tolerance, true)
    }

    fn tabulate_by(&self, tolerance: f64, of_brightest: bool) -> TabulatedCylinder {
        let lobe_width = self.lobe.analytic_height();
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small positive whole number")]
        let azimuths = (16.0 * std::f64::consts::PI / lobe_width).ceil() as usize;
        let mut grid = Grid { inclinations: 24, azimuths: azimuths.max(32) };
        loop {
            let mut table = TabulatedCylinder::sample(self, grid);
            let [by_inclination, by_azimuth] = table.measure(self, of_brightest);
            table.error = 3.0 * (by_inclination + by_azimuth);
            let room = grid.inclinations * grid.azimuths < MOST_POINTS;
            if table.error <= tolerance || tolerance < 1e-6 || !room {
                return table;
            }
            if by_inclination > tolerance / 6.0 {
                grid.inclinations += grid.inclinations / 2;
            }
            if by_azimuth > tolerance / 6.0 {
                grid.azimuths += grid.azimuths / 2;
            }
        }
    }

    /// N₀, N₁/cos²θo and N₂/cos²θo of one viewer and azimuth, each with one value a channel.
    fn azimuthal_lobes(&self, cos_theta_o: f64, phi: f64) -> [Vec<f64>; 3] {
        // At the grazing end the quotients are taken just beside it: they change by 4e-7 of themselves from there.
        let cos_theta_o = cos_theta_o.max(1e-7);
        let angles = FibreAngles {
            sin_theta_i: 0.0,
            cos_theta_i: 1.0,
            sin_theta_o: (1.0 - cos_theta_o * cos_theta_o).max(0.0).sqrt(),
            cos_theta_o,
            phi,
        };
        let quotient = 1.0 / (cos_theta_o * cos_theta_o);
        [[1.0, 0.0, 0.0, 0.0], [0.0, quotient, 0.0, 0.0], [0.0, 0.0, quotient, 0.0]].map(|longitudinal| {
            let mut values = vec![0.0; self.channel_count()];
            self.sum_lobes(&angles, longitudinal, &mut values);
            values
        })
    }
}

impl Cylinder {
    /// N₃₊ of each channel for a viewer at this √cosθo.
    #[expect(clippy::cast_possible_truncation, reason = "the table holds f32")]
    fn later_lobe(&self, root_cos_theta_o: f64) -> Vec<f32> {
        let cos_theta_o = root_cos_theta_o * root_cos_theta_o;
        let sin_theta_o = (1.0 - cos_theta_o * cos_theta_o).max(0.0).sqrt();
        let angles = FibreAngles { sin_theta_i: 0.0, cos_theta_i: 1.0, sin_theta_o, cos_theta_o, phi: 0.0 };
        let mut values = vec![0.0; self.channel_count()];
        self.sum_lobes(&angles, [0.0, 0.0, 0.0, 1.0], &mut values);
        values.into_iter().map(|value| value as f32).collect()
    }
}

impl Grid {
    /// Points along φ: the grid's own, one more before the first, and one more after the last.
    fn columns(self) -> usize {
        self.azimuths + 3
    }

    fn cos_theta(self, row: f64) -> f64 {
        row / self.inclinations as f64
    }

    fn phi(self, step: f64) -> f64 {
        step * std::f64::consts::PI / self.azimuths as f64
    }
}

impl TabulatedCylinder {
    fn sample(cylinder: &Cylinder, grid: Grid) -> Self {
        let channel_count = cylinder.channel_count();
        let blocks = channel_count.div_ceil(ENTRY_CHANNELS);
        let rows: Vec<Vec<Entry>> = (0..=grid.inclinations)
            .into_par_iter()
            .map(|row| {
                let point =
                    |step: usize| entries(&cylinder.azimuthal_lobes(grid.cos_theta(row as f64), grid.phi(step as f64)));
                let inner: Vec<Vec<Entry>> = (0..=grid.azimuths).map(point).collect();
                // The lobes are even about both ends.
                let before = inner[1].clone();
                let after = inner[grid.azimuths - 1].clone();
                std::iter::once(before).chain(inner).chain(std::iter::once(after)).flatten().collect()
            })
            .collect();
        let entries: Vec<Entry> = rows.concat();
        debug_assert_eq!(entries.len(), (grid.inclinations + 1) * grid.columns() * blocks);
        let later =
            (0..=LATER_INTERVALS).flat_map(|k| cylinder.later_lobe(k as f64 / LATER_INTERVALS as f64)).collect();
        Self {
            longitudinal: cylinder.longitudinal.clone(),
            channel_count,
            grid,
            entries,
            later,
            sponge: Vec::new(),
            error: f64::NAN,
            lobe_width: cylinder.lobe.analytic_height(),
            sampler: LazySampler::default(),
        }
    }

    /// Largest error half-way between rows and half-way between columns, in units of a lobe's largest value over azimuths.
    /// With `of_brightest`, of that of its brightest channel.
    fn measure(&self, cylinder: &Cylinder, of_brightest: bool) -> [f64; 2] {
        let half_way = |count: usize, row_shift: f64, step_shift: f64| {
            let errors: Vec<f64> = (0..count)
                .into_par_iter()
                .map(|row| {
                    let cos_theta_o = self.grid.cos_theta(row as f64 + row_shift);
                    let lobes = 3 * self.channel_count;
                    let (mut largest, mut error) = (vec![0.0_f64; lobes], vec![0.0_f64; lobes]);
                    for step in 0..self.grid.azimuths {
                        let phi = self.grid.phi(step as f64 + step_shift);
                        let exact = cylinder.azimuthal_lobes(cos_theta_o, phi).concat();
                        for lobe in 0..3 {
                            let mut longitudinal = [0.0; 3];
                            longitudinal[lobe] = 1.0;
                            let mut found = vec![0.0; self.channel_count];
                            self.interpolate(cos_theta_o, phi, longitudinal, &mut found);
                            for (channel, found) in found.iter().enumerate() {
                                let index = lobe * self.channel_count + channel;
                                largest[index] = largest[index].max(exact[index]);
                                error[index] = error[index].max((found - exact[index]).abs());
                            }
                        }
                    }
                    if of_brightest {
                        for largest in largest.chunks_exact_mut(self.channel_count) {
                            let brightest = largest.iter().copied().fold(0.0, f64::max);
                            largest.fill(brightest);
                        }
                    }
                    // A lobe of nothing has no error.
                    error
                        .iter()
                        .zip(&largest)
                        .filter(|(_, largest)| **largest > 0.0)
                        .map(|(e, l)| e / l)
                        .fold(0.0, f64::max)
                })
                .collect();
            errors.into_iter().fold(0.0, f64::max)
        };
        [half_way(self.grid.inclinations, 0.5, 0.0), half_way(self.grid.inclinations + 1, 0.0, 0.5)]
    }

    /// Measured bound of the far field's error, as a share of its largest value over azimuths.
    pub fn error(&self) -> f64 {
        self.error
    }

    /// Number of channels.
    pub fn channel_count(&self) -> usize {
        self.channel_count
    }

    /// Size of the table.
    pub fn bytes(&self) -> usize {
        self.entries.len() * size_of::<Entry>()
    }

    /// Far-field scattering function S, 1/sr, one value a channel.
    ///
    /// # Panics
    /// If `values` is not one number a channel.
    pub fn far_field(&self, angles: &FibreAngles, values: &mut [f64]) {
        assert_eq!(values.len(), self.channel_count, "one value a channel");
        let [reflected, once, twice] = self.longitudinal.evaluate(angles);
        let entered = angles.cos_theta_o * angles.cos_theta_o;
        self.interpolate(angles.cos_theta_o, angles.phi, [reflected, entered * once, entered * twice], values);
        add_from_list(&self.later, angles.cos_theta_o, twice, values);
        if !self.sponge.is_empty() {
            add_from_list(&self.sponge, angles.cos_theta_o, 1.0 + angles.phi.cos(), values);
        }
    }

    #[inline(always)]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "grid numbers are small and positive; the table holds f32"
    )]
    fn interpolate(&self, cos_theta_o: f64, phi: f64, longitudinal: [f64; 3], values: &mut [f64]) {
        // Rows: four neighbours, one-sided at the ends.
        let row = cos_theta_o.min(1.0) * self.grid.inclinations as f64;
        let first_row = ((row as usize).max(1) - 1).min(self.grid.inclinations - 3);
        let row_weights = cubic_weights((row - first_row as f64) as f32);

        // Columns: column 0 is the step before φ = 0.
        let turns = (phi / std::f64::consts::TAU).round();
        let step = (phi - turns * std::f64::consts::TAU).abs() * (self.grid.azimuths as f64 / std::f64::consts::PI);
        let first_column = (step as usize).min(self.grid.azimuths - 1);
        let column_weights = cubic_weights((step - first_column as f64 + 1.0) as f32);

        let blocks = values.len().div_ceil(ENTRY_CHANNELS);
        for (block, values) in values.chunks_mut(ENTRY_CHANNELS).enumerate() {
            let mut sum: Entry = [0.0; 16];
            for (row, row_weight) in row_weights.into_iter().enumerate() {
                let start = ((first_row + row) * self.grid.columns() + first_column) * blocks + block;
                for (column, column_weight) in column_weights.into_iter().enumerate() {
                    let weight = row_weight * column_weight;
                    for (sum, entry) in sum.iter_mut().zip(&self.entries[start + column * blocks]) {
                        *sum += weight * entry;
                    }
                }
            }
            for (channel, value) in values.iter_mut().enumerate() {
                *value = (0..3).map(|p| longitudinal[p] * f64::from(sum[p * ENTRY_CHANNELS + channel])).sum();
            }
        }
    }
}

/// Channels of a table made of those of another: for each new one, the old ones and their weights. What is reflected
/// outside, what comes from inside, and of that what a sponge scatters have weights of their own.
#[derive(Debug)]
pub(super) struct Combination {
    pub(super) outer: Vec<Vec<(usize, f64)>>,
    pub(super) inner: Vec<Vec<(usize, f64)>>,
    pub(super) sponge: Vec<Vec<(usize, f64)>>,
}

impl TabulatedCylinder {
    /// The same table with a list of all the light that leaves each channel's inside, ½ ∫ Σ_{p≥1} Aₚ dh over 4π: a sponge's
    /// that scatters everything.
    pub(super) fn with_insides(mut self, cylinder: &Cylinder) -> Self {
        let of_point = |k: usize| {
            let root = k as f64 / LATER_INTERVALS as f64;
            // Just beside the grazing end, as the lobes.
            let cos_theta_o = (root * root).max(1e-7);
            let sin_theta_o = (1.0 - cos_theta_o * cos_theta_o).max(0.0).sqrt();
            let channels = cylinder.channels().map(move |(eta, sigma_a)| {
                let mean = Attenuation::mean(&Refraction::new(eta, sin_theta_o, cos_theta_o), sigma_a);
                #[expect(clippy::cast_possible_truncation, reason = "the table holds f32")]
                let inside = ((mean.total() - mean.direct[0]) / (4.0 * std::f64::consts::PI)) as f32;
                inside
            });
            channels.collect::<Vec<f32>>()
        };
        let points: Vec<Vec<f32>> = (0..=LATER_INTERVALS).into_par_iter().map(of_point).collect();
        self.sponge = points.concat();
        self
    }

    /// A table of other channels; where a sponge takes a share, from one with [`insides`](Self::with_insides).
    pub(super) fn combined(&self, combination: &Combination) -> Self {
        let Combination { outer, inner, sponge } = combination;
        let (old, new) = (self.channel_count, outer.len());
        let (old_blocks, new_blocks) = (old.div_ceil(ENTRY_CHANNELS), new.div_ceil(ENTRY_CHANNELS));
        let mut entries = vec![[0.0; 16]; self.entries.len() / old_blocks * new_blocks];
        for (entries, before) in entries.chunks_exact_mut(new_blocks).zip(self.entries.chunks_exact(old_blocks)) {
            for lobe in 0..3 {
                for (channel, weights) in if lobe == 0 { outer } else { inner }.iter().enumerate() {
                    let each = weights.iter().map(|(old, weight)| {
                        weight * f64::from(before[old / ENTRY_CHANNELS][lobe * ENTRY_CHANNELS + old % ENTRY_CHANNELS])
                    });
                    #[expect(clippy::cast_possible_truncation, reason = "the table holds f32")]
                    let sum = each.sum::<f64>() as f32;
                    entries[channel / ENTRY_CHANNELS][lobe * ENTRY_CHANNELS + channel % ENTRY_CHANNELS] = sum;
                }
            }
        }
        let list = |before: &[f32], weights: &[Vec<(usize, f64)>]| -> Vec<f32> {
            let of_point = |point: &[f32]| {
                #[expect(clippy::cast_possible_truncation, reason = "the table holds f32")]
                let sum = |weights: &Vec<(usize, f64)>| {
                    weights.iter().map(|(old, weight)| weight * f64::from(point[*old])).sum::<f64>() as f32
                };
                weights.iter().map(sum).collect::<Vec<f32>>()
            };
            before.chunks_exact(old).flat_map(of_point).collect()
        };
        let has_sponge = sponge.iter().any(|weights| !weights.is_empty());
        Self {
            longitudinal: self.longitudinal.clone(),
            channel_count: new,
            grid: self.grid,
            entries,
            later: list(&self.later, inner),
            sponge: if has_sponge { list(&self.sponge, sponge) } else { Vec::new() },
            error: self.error,
            lobe_width: self.lobe_width,
            sampler: LazySampler::default(),
        }
    }

    fn sampler(&self) -> &FibreSampler {
        self.sampler.get(|| {
            let lobes = Lobes { table: self, values: vec![0.0; self.channel_count] };
            FibreSampler::new(self.longitudinal.clone(), self.lobe_width, lobes)
        })
    }
}

/// The tabulated lobes, for a sampler.
struct Lobes<'a> {
    table: &'a TabulatedCylinder,
    values: Vec<f64>,
}

impl Lobes<'_> {
    /// Over channels. Interpolation may fall below 0 by a trifle, and what is drawn by must not.
    fn mean(&self) -> f64 {
        (self.values.iter().sum::<f64>() / self.values.len() as f64).max(0.0)
    }
}

impl AzimuthalSource for Lobes<'_> {
    fn lobe(&mut self, angles: &FibreAngles, path: usize) -> f64 {
        let entered = if path == 0 { 1.0 } else { angles.cos_theta_o * angles.cos_theta_o };
        let [longitudinal @ .., later] = only(path);
        self.table.interpolate(angles.cos_theta_o, angles.phi, longitudinal.map(|m| entered * m), &mut self.values);
        add_from_list(&self.table.later, angles.cos_theta_o, later, &mut self.values);
        self.mean()
    }

    fn sponge(&mut self, angles: &FibreAngles) -> f64 {
        if self.table.sponge.is_empty() {
            return 0.0;
        }
        self.values.fill(0.0);
        // ∫ (1 + cosφ) over the sphere.
        add_from_list(&self.table.sponge, angles.cos_theta_o, 4.0 * std::f64::consts::PI, &mut self.values);
        self.mean()
    }
}

impl Bsdf for TabulatedCylinder {
    fn evaluate(&self, incoming: &Direction, outgoing: &Direction, values: &mut [f64]) {
        self.far_field(&FibreAngles::between(incoming, outgoing), values);
        over_cosine(incoming, values);
    }

    fn sample(&self, outgoing: &Direction, random: [f64; 3]) -> Option<Sample> {
        self.sampler().sample(outgoing, random)
    }

    fn density(&self, incoming: &Direction, outgoing: &Direction) -> f64 {
        self.sampler().density(incoming, outgoing)
    }

    /// Differs from [`Bsdf::evaluate`] by less than 1e-6 of the largest value over azimuths.
    fn evaluate_many(&self, incoming: &[Direction], outgoing: &[Direction], values: &mut [f64]) {
        assert_eq!(incoming.len(), outgoing.len(), "directions come in pairs");
        assert_eq!(values.len(), incoming.len() * self.channel_count, "one value a pair and channel");
        if incoming.len() < FEWEST {
            return one_at_a_time(self, incoming, outgoing, values);
        }
        pulp::Arch::new().dispatch(TabulatedPairs { table: self, incoming, outgoing, values });
    }
}

/// The loop over blocks of pairs, in the form in which it is compiled once for each instruction set.
struct TabulatedPairs<'a> {
    table: &'a TabulatedCylinder,
    incoming: &'a [Direction],
    outgoing: &'a [Direction],
    values: &'a mut [f64],
}

impl pulp::NullaryFnOnce for TabulatedPairs<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { table, incoming, outgoing, values } = self;
        let blocks = incoming.chunks(PAIRS).zip(outgoing.chunks(PAIRS));
        for ((incoming, outgoing), values) in blocks.zip(values.chunks_mut(PAIRS * table.channel_count)) {
            let angles = PairAngles::new(incoming, outgoing);
            let longitudinal = table.longitudinal.of_pairs(&angles);
            for (pair, values) in values.chunks_exact_mut(table.channel_count).enumerate() {
                let [reflected, once, twice] = longitudinal.each_ref().map(|lobe| lobe[pair]);
                let cos_theta_o = angles.cos_theta_o[pair];
                let entered = cos_theta_o * cos_theta_o;
                table.interpolate(cos_theta_o, angles.phi[pair], [reflected, entered * once, entered * twice], values);
                add_from_list(&table.later, cos_theta_o, twice, values);
                if !table.sponge.is_empty() {
                    add_from_list(&table.sponge, cos_theta_o, 1.0 + angles.phi[pair].cos(), values);
                }
                for value in values {
                    *value *= angles.inverse_cosine[pair];
                }
            }
        }
    }
}

/// Adds a multiple of what a list over √cosθo holds for a viewer, all channels of a point together.
#[inline(always)]
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a grid number is small and positive; the list holds f32"
)]
fn add_from_list(list: &[f32], cos_theta_o: f64, factor: f64, values: &mut [f64]) {
    let position = cos_theta_o.clamp(0.0, 1.0).sqrt() * LATER_INTERVALS as f64;
    let before = (position as usize).min(LATER_INTERVALS - 1);
    let share = position - before as f64;
    let (low, high) = list[before * values.len()..][..2 * values.len()].split_at(values.len());
    for (value, (&low, &high)) in values.iter_mut().zip(low.iter().zip(high)) {
        *value += factor * (f64::from(low) * (1.0 - share) + f64::from(high) * share);
    }
}

/// One point of the table.
#[expect(clippy::cast_possible_truncation, reason = "the table holds f32")]
fn entries(lobes: &[Vec<f64>; 3]) -> Vec<Entry> {
    let blocks = lobes[0].len().div_ceil(ENTRY_CHANNELS);
    let mut entries = vec![[0.0; 16]; blocks];
    for (p, lobe) in lobes.iter().enumerate() {
        for (channel, &value) in lobe.iter().enumerate() {
            entries[channel / ENTRY_CHANNELS][p * ENTRY_CHANNELS + channel % ENTRY_CHANNELS] = value as f32;
        }
    }
    entries
}

/// Weights of the cubic through points at 0, 1, 2, 3 (Lagrange), at `x` between them.
fn cubic_weights(x: f32) -> [f32; 4] {
    let (a, b, c, d) = (x, x - 1.0, x - 2.0, x - 3.0);
    [-b * c * d / 6.0, a * c * d / 2.0, -a * b * d / 2.0, a * b * c / 6.0]
}
