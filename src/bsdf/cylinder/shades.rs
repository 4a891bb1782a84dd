//! Fibres that differ in what absorbs inside them, for a picture in which pigment lies thicker here than there.
//!
//! For a given surface the azimuthal lobe Nₚ of one channel hangs on that channel's σₐ alone. So one table over σₐ serves any
//! number of fibres and of wavelengths: each channel of a picture is a weighted sum over wavelengths, each wavelength a
//! weighted sum over the table's knots, and the sums are carried out once, when a shade is made. A [sponge](crate::bsdf::spongy_barb)
//! takes its share from the inner lobes and gives it to a term of its own, which is a sum of the same kind.
//!
//! Knots are evenly spaced in √σₐ, and cubic polynomials run through four of them. The lobes are means of exp(−rσₐ), r up to
//! 5.3 for TRT and η 1.55, hence of Gaussians in √σₐ. With the spacing here the far field is within 1e-3 of its largest value
//! over azimuths in a fibre without absorption (a test holds it to that); beyond 40/radius every fibre counts as 40, which
//! lets less than e⁻⁵⁰ pass.

use std::collections::BTreeMap;
use std::sync::Arc;

use rayon::prelude::*;

use super::Cylinder;
use super::tabulated::{Combination, TabulatedCylinder};
use crate::bsdf::channel_mix::mixed;
use crate::bsdf::{Bsdf, ChannelMix, PICTURE_TOLERANCE};

/// What a table of shades may be wrong by as a share of a lobe's largest value: half a step between two shades of an 8-bit
/// screen.
const SHADE_TOLERANCE: f64 = 1e-3;

/// Absorption beyond which a fibre is black inside, 1/radius.
const BLACK: f64 = 40.0;

/// A fibre with a sponge inside, for a picture.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::bsdf) struct PictureFibre {
    pub(in crate::bsdf) cylinder: Cylinder,
    /// Share of the light inside that a sponge scatters, one a channel; 0 without one.
    pub(in crate::bsdf) sponge: Vec<f64>,
}

/// Each of these fibres as a table for a picture, or as `exact` makes it where no table of a reasonable size is good enough.
/// Equal fibres share theirs.
pub(in crate::bsdf) fn for_picture<'a>(
    fibres: &[PictureFibre],
    mix: Option<&ChannelMix>,
    exact: impl Fn(usize) -> Box<dyn Bsdf + 'a>,
) -> Vec<Box<dyn Bsdf + 'a>> {
    // Groups of fibres that one table over σₐ serves.
    let mut families: Vec<Family> = Vec::new();
    let mut made: Vec<(usize, Option<Arc<TabulatedCylinder>>)> = Vec::new();
    let distinct = |fibre: &PictureFibre| fibres.iter().position(|other| other == fibre);
    for (number, fibre) in fibres.iter().enumerate() {
        if distinct(fibre) == Some(number) {
            match families.iter_mut().find(|family| family.takes(&fibres[family.members[0]].cylinder, &fibre.cylinder))
            {
                Some(family) => family.members.push(number),
                None => families.push(Family { members: vec![number] }),
            }
        }
    }
    for family in &families {
        let members: Vec<&PictureFibre> = family.members.iter().map(|&number| &fibres[number]).collect();
        let tables = match members.as_slice() {
            [only] => vec![alone(only, mix)],
            _ => together(&members, mix),
        };
        made.extend(family.members.iter().copied().zip(tables));
    }
    let of = |fibre: &PictureFibre| {
        let first = distinct(fibre)?;
        made.iter().find(|(number, _)| *number == first).and_then(|(_, table)| table.clone())
    };
    let bound = fibres.iter().enumerate().map(|(number, fibre)| -> Box<dyn Bsdf + 'a> {
        match of(fibre) {
            Some(table) => Box::new(table),
            None => mixed(exact(number), mix),
        }
    });
    bound.collect()
}

/// Fibres that differ in nothing but absorption and sponge.
struct Family {
    members: Vec<usize>,
}

impl Family {
    fn takes(&self, first: &Cylinder, other: &Cylinder) -> bool {
        first.has_one_index() && first.clear() == other.clear()
    }
}

/// The table of one fibre; None where it is not good enough.
fn alone(fibre: &PictureFibre, mix: Option<&ChannelMix>) -> Option<Arc<TabulatedCylinder>> {
    let table = fibre.cylinder.tabulate(PICTURE_TOLERANCE);
    if table.error() > PICTURE_TOLERANCE {
        return None;
    }
    let has_sponge = fibre.sponge.iter().any(|share| *share > 0.0);
    if mix.is_none() && !has_sponge {
        return Some(Arc::new(table));
    }
    let table = if has_sponge { table.with_insides(&fibre.cylinder) } else { table };
    Some(Arc::new(table.combined(&combination(fibre, mix, |channel| vec![(channel, 1.0)]))))
}

/// The tables of fibres that differ in absorption and sponge.
fn together(fibres: &[&PictureFibre], mix: Option<&ChannelMix>) -> Vec<Option<Arc<TabulatedCylinder>>> {
    let absorptions = || fibres.iter().flat_map(|fibre| fibre.cylinder.channels()).map(|(_, sigma_a)| sigma_a);
    let knots = Knots::up_to(absorptions().fold(0.0, f64::max).min(BLACK));
    let over_absorption = fibres[0].cylinder.with_absorptions(knots.absorptions());
    let table = over_absorption.tabulate_shades(SHADE_TOLERANCE);
    if table.error() > SHADE_TOLERANCE {
        return vec![None; fibres.len()];
    }
    let has_sponge = fibres.iter().flat_map(|fibre| &fibre.sponge).any(|share| *share > 0.0);
    let table = if has_sponge { table.with_insides(&over_absorption) } else { table };
    let shade = |fibre: &&PictureFibre| {
        let absorptions: Vec<f64> = fibre.cylinder.channels().map(|(_, sigma_a)| sigma_a).collect();
        let combination = combination(fibre, mix, |channel| knots.weights(absorptions[channel]).to_vec());
        Some(Arc::new(table.combined(&combination)))
    };
    fibres.par_iter().map(shade).collect()
}

/// How the picture's channels are made of a table's: `parts` says of which a channel of the fibre consists.
fn combination(
    fibre: &PictureFibre,
    mix: Option<&ChannelMix>,
    parts: impl Fn(usize) -> Vec<(usize, f64)>,
) -> Combination {
    let channels = fibre.sponge.len();
    let weights: Vec<Vec<f64>> = match mix {
        Some(mix) => mix.weights().to_vec(),
        None => (0..channels).map(|k| (0..channels).map(|other| f64::from(u8::from(k == other))).collect()).collect(),
    };
    let sums = |share: &dyn Fn(f64) -> f64| -> Vec<Vec<(usize, f64)>> {
        let of = |weights: &Vec<f64>| {
            let each = weights.iter().zip(&fibre.sponge).enumerate().flat_map(|(channel, (weight, sponge))| {
                let scale = weight * share(*sponge);
                parts(channel).into_iter().map(move |(knot, part)| (knot, scale * part))
            });
            // Wavelengths share knots.
            let mut sums: BTreeMap<usize, f64> = BTreeMap::new();
            for (knot, weight) in each {
                *sums.entry(knot).or_default() += weight;
            }
            sums.into_iter().filter(|(_, weight)| *weight != 0.0).collect()
        };
        weights.iter().map(of).collect()
    };
    Combination { outer: sums(&|_| 1.0), inner: sums(&|sponge| 1.0 - sponge), sponge: sums(&|sponge| sponge) }
}

/// Where a table over σₐ is known.
struct Knots {
    largest: f64,
    intervals: usize,
}

impl Knots {
    /// From no absorption to this one.
    fn up_to(largest: f64) -> Self {
        // Eight to the width of exp(−σₐ) in √σₐ.
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 4 and 55")]
        let intervals = 4 + (8.0 * largest.sqrt()).ceil() as usize;
        // Fibres without any absorption at all need some length to count along.
        Self { largest: largest.max(1e-6), intervals }
    }

    fn absorptions(&self) -> Vec<f64> {
        (0..=self.intervals).map(|k| self.largest * (k as f64 / self.intervals as f64).powi(2)).collect()
    }

    /// Four knots and their weights (Lagrange's cubic) for an absorption.
    fn weights(&self, sigma_a: f64) -> [(usize, f64); 4] {
        let place = (sigma_a / self.largest).clamp(0.0, 1.0).sqrt() * self.intervals as f64;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a number of a knot")]
        let first = (place as usize).clamp(1, self.intervals - 2) - 1;
        let x = place - first as f64;
        let (a, b, c, d) = (x, x - 1.0, x - 2.0, x - 3.0);
        let weights = [-b * c * d / 6.0, a * c * d / 2.0, -a * b * d / 2.0, a * b * c / 6.0];
        std::array::from_fn(|k| (first + k, weights[k]))
    }
}

impl Cylinder {
    fn has_one_index(&self) -> bool {
        self.groups.len() == 1
    }

    /// The same fibre with these absorptions, one a channel, in the place of its own. It has one index.
    fn with_absorptions(&self, sigma_a: Vec<f64>) -> Self {
        let mut fibre = Self { sampler: Default::default(), ..self.clone() };
        fibre.groups[0].sigma_a = sigma_a;
        fibre
    }

    /// The same fibre without absorption: what fibres of a family have in common.
    fn clear(&self) -> Self {
        let mut fibre = Self { sampler: Default::default(), ..self.clone() };
        for group in &mut fibre.groups {
            group.sigma_a.fill(0.0);
        }
        fibre
    }
}
