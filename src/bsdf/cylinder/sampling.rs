//! Drawing from a fibre: where light comes from, for a viewer.
//!
//! The far field is Σₚ Mₚ Nₚ, each Mₚ a density along the fibre and each Nₚ a share of the light times a density around it. So a
//! path p is drawn by its share Aₚ, averaged over the fibre's width and over channels; an inclination from Mₚ, exactly (d'Eon
//! et al. 2013, *Importance sampling for physically-based hair fiber models*; see [`Longitudinal::draw`]); an
//! azimuth from a table of Nₚ. The table stands for the usual draw of a position h across the fibre, whose density would
//! need an integral over h at each call.
//!
//! Rows of the table stand at evenly spaced cosines of the viewer's inclination. A draw takes one of the two rows beside the
//! viewer, the nearer the likelier, so that the density is the mixture of both: exact, whatever the table resolves. What it
//! does not resolve costs variance only.

use std::f64::consts::{FRAC_1_PI, PI, TAU};
use std::sync::OnceLock;

use super::FibreAngles;
use super::azimuth_table::{AzimuthCurve, AzimuthTable};
use super::longitudinal::Longitudinal;
use crate::bsdf::Direction;
use crate::bsdf::sampling::{Choice, Sample, on_disk};

/// Rows beside the first. Between them the azimuths of exits move by less than a lobe is wide, but for the narrowest.
const INCLINATIONS: usize = 32;

/// R, TT, TRT, all later paths, and a sponge.
const PARTS: usize = 5;

/// How a fibre scatters around itself, averaged over channels.
pub(in crate::bsdf) trait AzimuthalSource {
    /// N₀, N₁, N₂, or for `path` 3 the sum of all later ones, 1/rad, at the viewer and azimuth of `angles`.
    fn lobe(&mut self, angles: &FibreAngles, path: usize) -> f64;

    /// Share of the light that a [sponge](crate::bsdf::spongy_barb) inside sends to this viewer.
    fn sponge(&mut self, _angles: &FibreAngles) -> f64 {
        0.0
    }
}

/// What a fibre is drawn from.
#[derive(Debug, Clone)]
pub(in crate::bsdf) struct FibreSampler {
    longitudinal: Longitudinal,
    /// Probabilities of the parts in each row.
    shares: Vec<[f64; PARTS]>,
    /// Three curves a row.
    azimuths: AzimuthTable,
}

impl FibreSampler {
    /// Tabulates a fibre with lobes of this width around it, radians.
    pub(super) fn new(longitudinal: Longitudinal, lobe_width: f64, mut source: impl AzimuthalSource) -> Self {
        let mut azimuths = AzimuthTable::for_lobes_of(lobe_width);
        let shares = (0..=INCLINATIONS).map(|row| {
            // Along the fibre nothing enters, and the shares are those just beside it.
            let cos_theta_o = (row as f64 / INCLINATIONS as f64).max(1e-7);
            let mut angles = FibreAngles {
                sin_theta_i: 0.0,
                cos_theta_i: 1.0,
                sin_theta_o: (1.0 - cos_theta_o * cos_theta_o).max(0.0).sqrt(),
                cos_theta_o,
                phi: 0.0,
            };
            let mut shares = [0.0; PARTS];
            for (path, share) in shares[..3].iter_mut().enumerate() {
                *share = azimuths.push(|phi| source.lobe(&FibreAngles { phi, ..angles }, path));
            }
            angles.phi = 0.0;
            shares[3] = TAU * source.lobe(&angles, 3);
            shares[4] = source.sponge(&angles);
            let sum: f64 = shares.iter().sum();
            shares.map(|share| share / sum)
        });
        let shares = shares.collect();
        Self { longitudinal, shares, azimuths }
    }

    /// The row before a viewer, and the probability of the one after it.
    fn place(cos_theta_o: f64) -> (usize, f64) {
        let position = cos_theta_o.min(1.0) * INCLINATIONS as f64;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and INCLINATIONS")]
        let row = (position as usize).min(INCLINATIONS - 1);
        (row, position - row as f64)
    }

    fn curve(&self, row: usize, path: usize) -> AzimuthCurve<'_> {
        self.azimuths.curve(3 * row + path)
    }

    /// See [`Bsdf::sample`](crate::bsdf::Bsdf::sample).
    pub(in crate::bsdf) fn sample(&self, outgoing: &Direction, random: [f64; 3]) -> Option<Sample> {
        let (sin_theta_o, cos_theta_o) = (outgoing.x, outgoing.y.hypot(outgoing.z));
        let mut choice = Choice(random[2]);
        let (row, next) = Self::place(cos_theta_o);
        let row = if choice.takes(next) { row + 1 } else { row };
        let part = choice.index(&self.shares[row]);

        let along = [random[0], random[1]];
        // The draw along the fibre takes the cosine of a turn's share random[1], which is as likely in either half of it.
        let side = if random[1] < 0.5 { 1.0 } else { -1.0 };
        let (sin_theta_i, phi) = match part {
            0..=2 => {
                let azimuth = if cos_theta_o > 0.0 { self.curve(row, part).draw(choice.0) } else { PI * choice.0 };
                (self.longitudinal.draw(part, sin_theta_o, cos_theta_o, along), side * azimuth)
            }
            3 => (self.longitudinal.draw(2, sin_theta_o, cos_theta_o, along), side * PI * choice.0),
            // The sine of φ/2 is a coordinate of the unit disk's points: its density is (2/π) cos²(φ/2) by φ/2.
            _ => (2.0 * choice.0 - 1.0, 2.0 * on_disk(along).1.clamp(-1.0, 1.0).asin()),
        };

        let incoming = direction_around(outgoing, sin_theta_i, phi);
        let density = self.density(&incoming, outgoing);
        // It is 0 at single points of the table, where nothing scatters.
        (density > 0.0).then(|| Sample::scattered(incoming, density))
    }

    /// See [`Bsdf::density`](crate::bsdf::Bsdf::density).
    pub(in crate::bsdf) fn density(&self, incoming: &Direction, outgoing: &Direction) -> f64 {
        let angles = FibreAngles::between(incoming, outgoing);
        let longitudinal = self.longitudinal.evaluate(&angles);
        let (row, next) = Self::place(angles.cos_theta_o);
        let of_row = |row: usize| {
            let [shares @ .., later, sponge] = &self.shares[row];
            let mut sum = 0.5 * FRAC_1_PI * later * longitudinal[2];
            for (path, (share, m)) in shares.iter().zip(longitudinal).enumerate() {
                // A viewer along the fibre has no azimuth to count from.
                let around =
                    if angles.cos_theta_o > 0.0 { self.curve(row, path).density(angles.phi) } else { 0.5 * FRAC_1_PI };
                sum += share * m * around;
            }
            if *sponge > 0.0 {
                sum += sponge * sponge_density(angles.phi);
            }
            sum
        };
        (1.0 - next) * of_row(row) + next * of_row(row + 1)
    }
}

/// The direction of this inclination whose azimuth is `phi` beyond the viewer's; for a viewer along the fibre, beyond the
/// normal's.
pub(super) fn direction_around(outgoing: &Direction, sin_theta_i: f64, phi: f64) -> Direction {
    let cos_theta_o = outgoing.y.hypot(outgoing.z);
    let cos_theta_i = (1.0 - sin_theta_i * sin_theta_i).max(0.0).sqrt();
    let (sin_phi, cos_phi) = phi.sin_cos();
    let (y, z) = if cos_theta_o > 0.0 { (outgoing.y / cos_theta_o, outgoing.z / cos_theta_o) } else { (0.0, 1.0) };
    Direction::new(sin_theta_i, cos_theta_i * (cos_phi * y - sin_phi * z), cos_theta_i * (cos_phi * z + sin_phi * y))
}

/// (1 + cosφ)/4π, 1/sr: back to the viewer's side, all inclinations alike in their sine.
fn sponge_density(phi: f64) -> f64 {
    0.25 * FRAC_1_PI * (1.0 + phi.cos())
}

/// A sampler that is made when it is first needed: fits never draw.
///
/// It follows from the fibre that holds it, so that two are always equal.
#[derive(Debug, Clone, Default)]
pub(in crate::bsdf) struct LazySampler(OnceLock<FibreSampler>);

impl LazySampler {
    /// The sampler; `make` must not start other threads, which might come back here and wait for each other.
    pub(in crate::bsdf) fn get(&self, make: impl FnOnce() -> FibreSampler) -> &FibreSampler {
        self.0.get_or_init(make)
    }
}

impl PartialEq for LazySampler {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}
