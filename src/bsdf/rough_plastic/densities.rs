//! Draws and densities of rough plastic for many pairs of directions at a time, in the manner of [`super::batch`].

use std::f64::consts::{FRAC_1_PI, PI};

use super::BoundRoughPlastic;
use super::batch::{BLOCK, CELL_COUNT, DirectionTable};
use crate::bsdf::coat_sampling::CoatSampler;
use crate::bsdf::{Direction, Sample};
use crate::optics::elementary::exp_of_negative;

/// [`crate::bsdf::Bsdf::density_many`] of a rough plastic.
pub(super) fn fill(
    plastic: &BoundRoughPlastic,
    table: &DirectionTable,
    incoming: &[Direction],
    outgoing: &[Direction],
    densities: &mut [f64],
) {
    assert!(incoming.len() == outgoing.len() && incoming.len() == densities.len(), "one density a pair");
    let sampler = plastic.sampler();
    let inverse_alpha_squared = 1.0 / (plastic.roughness * plastic.roughness);
    pulp::Arch::new().dispatch(Pairs { sampler, table, inverse_alpha_squared, incoming, outgoing, densities });
}

/// [`crate::bsdf::Bsdf::sample_many`] of a rough plastic: directions one by one, their densities together.
pub(super) fn sample(
    plastic: &BoundRoughPlastic,
    table: &DirectionTable,
    outgoing: &[Direction],
    random: &[[f64; 3]],
    samples: &mut [Option<Sample>],
) {
    assert!(outgoing.len() == random.len() && outgoing.len() == samples.len(), "one sample a viewer");
    let sampler = plastic.sampler();
    let blocks = outgoing.chunks(BLOCK).zip(random.chunks(BLOCK));
    for ((outgoing, random), samples) in blocks.zip(samples.chunks_mut(BLOCK)) {
        // What is not drawn keeps the density of a direction from below, which is none.
        let (mut incoming, mut densities) = ([-Direction::z(); BLOCK], [0.0; BLOCK]);
        for ((sample, incoming), (outgoing, random)) in
            samples.iter_mut().zip(&mut incoming).zip(outgoing.iter().zip(random))
        {
            let drawn = sampler.direction(outgoing, *random);
            *sample = drawn.map(|direction| Sample::scattered(direction, 0.0));
            *incoming = drawn.unwrap_or(*incoming);
        }
        let count = outgoing.len();
        fill(plastic, table, &incoming[..count], outgoing, &mut densities[..count]);
        for (sample, density) in samples.iter_mut().zip(densities) {
            if let Some(sample) = sample {
                sample.density = density;
            }
        }
    }
}

/// The loop over blocks, in the form in which it is compiled once for each instruction set.
struct Pairs<'a> {
    sampler: &'a CoatSampler,
    table: &'a DirectionTable,
    inverse_alpha_squared: f64,
    incoming: &'a [Direction],
    outgoing: &'a [Direction],
    densities: &'a mut [f64],
}

impl pulp::NullaryFnOnce for Pairs<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let blocks = self.incoming.chunks(BLOCK).zip(self.outgoing.chunks(BLOCK));
        for ((incoming, outgoing), densities) in blocks.zip(self.densities.chunks_mut(BLOCK)) {
            block(self.sampler, self.table, self.inverse_alpha_squared, incoming, outgoing, densities);
        }
    }
}

/// p D G1/(4 cosθo) + (1 − p) cosθi/π of up to [`BLOCK`] pairs, p the probability of the gloss.
#[inline(always)]
fn block(
    sampler: &CoatSampler,
    table: &DirectionTable,
    inverse_alpha_squared: f64,
    incoming: &[Direction],
    outgoing: &[Direction],
    densities: &mut [f64],
) {
    let (mut along_squared, mut height) = ([0.0; BLOCK], [1.0; BLOCK]);
    let (mut gloss, mut mirrored, mut diffuse) = ([0.0; BLOCK], [0.0; BLOCK], [0.0; BLOCK]);
    for (pair, (i, o)) in incoming.iter().zip(outgoing).enumerate().take(BLOCK) {
        // A pair with a direction below the horizon is never drawn.
        if i.z > 0.0 && o.z > 0.0 {
            let (x, y) = (i.x + o.x, i.y + o.y);
            along_squared[pair] = x * x + y * y;
            height[pair] = i.z + o.z;
            gloss[pair] = sampler.gloss_probability(o.z);
            // cosθo/G1, as the table holds it.
            let [_, masking] = table.at(o.z.sqrt() * CELL_COUNT);
            mirrored[pair] = gloss[pair] * inverse_alpha_squared / (4.0 * PI * masking);
            diffuse[pair] = (1.0 - gloss[pair]) * i.z * FRAC_1_PI;
        }
    }
    for (pair, density) in densities.iter_mut().enumerate().take(BLOCK) {
        let tan_squared = along_squared[pair] / (height[pair] * height[pair]);
        let secant_squared = 1.0 + tan_squared;
        let normals = exp_of_negative(-tan_squared * inverse_alpha_squared) * secant_squared * secant_squared;
        *density = mirrored[pair] * normals + diffuse[pair];
    }
}
