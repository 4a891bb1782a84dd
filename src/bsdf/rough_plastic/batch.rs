//! Rough plastic for many pairs of directions at a time, as a renderer wants it.
//!
//! Lanes are pairs, not channels. Nothing but the Fresnel factor and the density of normals depends on both directions;
//! what depends on one, T and the masking, is a smooth function of its cosine and is read from a small table of cubics.
//! The rest is plain arithmetic in blocks, which the compiler turns into the widest vectors that the processor has.

use std::f64::consts::PI;

use super::BoundRoughPlastic;
use crate::bsdf::Direction;
use crate::optics::TransmittanceCurve;
use crate::optics::elementary::{ROUND, exp_of_negative};
use crate::optics::microfacet::Beckmann;

/// Pairs that are worked on together.
pub(super) const BLOCK: usize = 64;

/// Cells of the table. They are counted in √μ, so that at the smallest roughness, 0.005, the bend at the horizon is ten
/// cells wide.
const CELLS: usize = 256;
pub(super) const CELL_COUNT: f64 = CELLS as f64;

/// T(μ) and μ/G1(μ) as cubics over √μ, with less than 1e-5 of error beyond that of the curve they are made from.
#[derive(Debug, Clone)]
pub(super) struct DirectionTable {
    cells: Box<[Cell; CELLS]>,
}

/// T and μ/G1 side by side, as two lanes: coefficients from the constant to the cube, in the place inside the cell.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
struct Cell([[f64; 2]; 4]);

impl DirectionTable {
    pub(super) fn new(coat: &Beckmann, transmittance: &TransmittanceCurve) -> Self {
        #[expect(clippy::cast_precision_loss, reason = "numbers of cells are far below 2^53")]
        let node = |index: usize, place: f64| ((index as f64 + place) / CELL_COUNT).min(1.0).powi(2);
        let cell = |index: usize| {
            let cosines = [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0].map(|place| node(index, place));
            let transmittance = cubic(cosines.map(|cosine| transmittance.at(cosine)));
            let masking = cubic(cosines.map(|cosine| {
                // G1 vanishes at the horizon as fast as μ does; close to it the quotient is at its limit.
                let cosine = cosine.max(1e-12);
                cosine / coat.visible_share(cosine)
            }));
            Cell(std::array::from_fn(|power| [transmittance[power], masking[power]]))
        };
        Self { cells: Box::new(std::array::from_fn(cell)) }
    }

    /// T and μ/G1 at the place `x` = [`CELLS`] √μ.
    #[inline(always)]
    pub(super) fn at(&self, x: f64) -> [f64; 2] {
        // The number of the cell stands in the lowest bits of the shifted place; a plain cast would saturate, for which
        // there is no vector instruction.
        let shifted = x.min(LAST_PLACE) - 0.5 + ROUND;
        #[expect(clippy::cast_possible_truncation, reason = "the number of the cell is kept")]
        let index = shifted.to_bits() as usize % CELLS;
        let t = x - (shifted - ROUND);
        let Cell([c0, c1, c2, c3]) = &self.cells[index];
        std::array::from_fn(|lane| c0[lane] + t * (c1[lane] + t * (c2[lane] + t * c3[lane])))
    }
}

/// A place in the last cell that rounds to no other.
const LAST_PLACE: f64 = CELL_COUNT - 0.25;

/// The cubic through values at 0, 1/3, 2/3 and 1.
fn cubic([a, b, c, d]: [f64; 4]) -> [f64; 4] {
    [
        a,
        (-11.0 * a + 18.0 * b - 9.0 * c + 2.0 * d) / 2.0,
        9.0 * (2.0 * a - 5.0 * b + 4.0 * c - d) / 2.0,
        9.0 * (d - a + 3.0 * (b - c)) / 2.0,
    ]
}

/// [`crate::bsdf::Bsdf::evaluate_many`] of a rough plastic.
pub(super) fn evaluate(
    plastic: &BoundRoughPlastic,
    table: &DirectionTable,
    incoming: &[Direction],
    outgoing: &[Direction],
    values: &mut [f64],
) {
    let channels = plastic.specular.len();
    assert_eq!(incoming.len(), outgoing.len(), "directions come in pairs");
    assert_eq!(values.len(), incoming.len() * channels, "one value a pair and channel");
    pulp::Arch::new().dispatch(Pairs { plastic, table, incoming, outgoing, values });
}

/// The loop over blocks, in the form in which it is compiled once for each instruction set.
struct Pairs<'a> {
    plastic: &'a BoundRoughPlastic,
    table: &'a DirectionTable,
    incoming: &'a [Direction],
    outgoing: &'a [Direction],
    values: &'a mut [f64],
}

impl pulp::NullaryFnOnce for Pairs<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let channels = self.plastic.specular.len();
        let blocks = self.incoming.chunks(BLOCK).zip(self.outgoing.chunks(BLOCK));
        for ((incoming, outgoing), values) in blocks.zip(self.values.chunks_mut(BLOCK * channels)) {
            let (gloss, passed) = block(self.plastic, self.table, incoming, outgoing);
            let pairs = gloss.iter().zip(&passed);
            if let (&[r_s, g_s, b_s], &[r_d, g_d, b_d]) =
                (self.plastic.specular.as_slice(), self.plastic.diffuse.as_slice())
            {
                // Pictures have three channels: written out, there is no loop of three inside the loop over pairs.
                for (value, (gloss, passed)) in values.as_chunks_mut().0.iter_mut().zip(pairs) {
                    *value = [r_s * gloss + r_d * passed, g_s * gloss + g_d * passed, b_s * gloss + b_d * passed];
                }
                continue;
            }
            for (values, (gloss, passed)) in values.chunks_exact_mut(channels).zip(pairs) {
                for ((value, specular), diffuse) in
                    values.iter_mut().zip(&self.plastic.specular).zip(&self.plastic.diffuse)
                {
                    *value = specular * gloss + diffuse * passed;
                }
            }
        }
    }
}

/// F D G1 G1/(4 cosθi cosθo) and T(θi) T(θo) of up to [`BLOCK`] pairs.
#[inline(always)]
fn block(
    plastic: &BoundRoughPlastic,
    table: &DirectionTable,
    incoming: &[Direction],
    outgoing: &[Direction],
) -> ([f64; BLOCK], [f64; BLOCK]) {
    let (mut cosine_i, mut cosine_o) = ([0.0; BLOCK], [0.0; BLOCK]);
    // The sum of the two directions: the square of its length along the surface.
    let mut along_squared = [0.0; BLOCK];
    for (pair, (i, o)) in incoming.iter().zip(outgoing).enumerate().take(BLOCK) {
        let (x, y) = (i.x + o.x, i.y + o.y);
        along_squared[pair] = x * x + y * y;
        (cosine_i[pair], cosine_o[pair]) = (i.z, o.z);
    }

    // A pair with a direction below the horizon is worked on as if both were above, and counts nothing.
    let (mut counts, mut height) = ([0.0; BLOCK], [0.0; BLOCK]);
    let (mut x_i, mut x_o) = ([0.0; BLOCK], [0.0; BLOCK]);
    for pair in 0..BLOCK {
        let above = cosine_i[pair] > 0.0 && cosine_o[pair] > 0.0;
        counts[pair] = if above { 1.0 } else { 0.0 };
        let (i, o) = if above { (cosine_i[pair], cosine_o[pair]) } else { (1.0, 1.0) };
        height[pair] = i + o;
        x_i[pair] = i.sqrt() * CELL_COUNT;
        x_o[pair] = o.sqrt() * CELL_COUNT;
    }

    let (mut passed, mut masking) = ([0.0; BLOCK], [0.0; BLOCK]);
    for pair in 0..BLOCK {
        let ([transmittance_i, masking_i], [transmittance_o, masking_o]) = (table.at(x_i[pair]), table.at(x_o[pair]));
        passed[pair] = counts[pair] * transmittance_i * transmittance_o;
        masking[pair] = masking_i * masking_o;
    }

    let inverse_alpha_squared = 1.0 / (plastic.roughness * plastic.roughness);
    let eta_squared = plastic.eta * plastic.eta;
    let step_squared = (eta_squared - 1.0) * (eta_squared - 1.0);
    // ½ of Fresnel's mean over polarisations, ¼ of the lobe, 1/(π α²) of the density.
    let scale = inverse_alpha_squared / (8.0 * PI);
    let mut gloss = [0.0; BLOCK];
    for pair in 0..BLOCK {
        let height_squared = height[pair] * height[pair];
        let tan_squared = along_squared[pair] / height_squared;
        // 1/cos²θ of the half vector, whose cosine to either direction is half the sum's length.
        let secant_squared = 1.0 + tan_squared;
        let density = exp_of_negative(-tan_squared * inverse_alpha_squared) * secant_squared * secant_squared;
        let cosine_squared = (0.25 * (height_squared + along_squared[pair])).min(1.0);
        let cosine = cosine_squared.sqrt();
        // Fresnel over one denominator; (c − q)/(c + q) = (1 − η²)/(c + q)².
        let q = (eta_squared - 1.0 + cosine_squared).sqrt();
        let (sum, p_sum, p_difference) = (cosine + q, eta_squared * cosine + q, eta_squared * cosine - q);
        let fourth = sum * sum * (sum * sum);
        let reflected = step_squared * (p_sum * p_sum) + fourth * (p_difference * p_difference);
        gloss[pair] = counts[pair] * scale * density * reflected / (fourth * (p_sum * p_sum) * masking[pair]);
    }
    (gloss, passed)
}
