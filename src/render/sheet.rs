//! A flat feather: a rectangle, what lies where on it, and which way it runs.

use super::ray::{Hit, Vector};
use super::shape::Rectangle;
use crate::geometry::{FeatherMap, TexelClass};

/// A flat feather.
#[derive(Debug)]
pub struct Sheet {
    /// The rectangle that the map fills, its first edge to the map's right, its second upwards.
    pub rectangle: Rectangle,
    /// What lies where.
    pub map: FeatherMap,
    /// Number of the shaft's material.
    pub shaft: usize,
    /// What the vanes are made of.
    pub vanes: Vanes,
}

/// What the vanes of a feather are made of.
#[derive(Debug, Clone, PartialEq)]
pub enum Vanes {
    /// One material all over, by its number.
    Plain(usize),
    /// Something else from place to place.
    Pattern(Pattern),
}

/// What lies where, in rows from the top over the whole map.
#[derive(Debug, Clone, PartialEq)]
pub struct Pattern {
    width: usize,
    blends: Vec<Blend>,
}

/// What lies at a place: a material, or a mixture of up to four.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Blend {
    /// Numbers of the materials.
    materials: [u16; 4],
    /// Share of the area that each takes; they sum to 1.
    shares: [f32; 4],
}

impl Blend {
    /// One material, by its number.
    pub fn pure(material: usize) -> Self {
        Self::new([(u16::try_from(material).unwrap_or(u16::MAX), 1.0), (0, 0.0), (0, 0.0), (0, 0.0)])
    }

    /// Materials by their numbers, each with the share of the area that it takes. The shares sum to 1.
    pub fn new(parts: [(u16, f32); 4]) -> Self {
        Self { materials: parts.map(|(material, _)| material), shares: parts.map(|(_, share)| share) }
    }

    /// The material that a random number in [0, 1) falls to.
    #[inline]
    pub(super) fn chosen(&self, random: f64) -> usize {
        let mut rest = random;
        let mut chosen = 0;
        for (place, share) in self.shares.iter().enumerate() {
            if *share > 0.0 {
                chosen = place;
                rest -= f64::from(*share);
                if rest < 0.0 {
                    break;
                }
            }
        }
        self.materials[chosen].into()
    }

    /// The material, where there is only one.
    #[inline]
    pub(super) fn only(&self) -> Option<usize> {
        (self.shares[0] >= 1.0).then(|| self.materials[0].into())
    }

    /// The materials with their shares.
    #[inline]
    pub(super) fn parts(&self) -> impl Iterator<Item = (usize, f64)> {
        self.materials.into_iter().zip(self.shares).map(|(material, share)| (material.into(), share.into()))
    }
}

impl Pattern {
    /// A pattern of this width; None where the blends fill no whole rows.
    pub fn new(width: usize, blends: Vec<Blend>) -> Option<Self> {
        let whole = width > 0 && !blends.is_empty() && blends.len().is_multiple_of(width);
        whole.then_some(Self { width, blends })
    }

    /// What lies at the nearest texel: patterns are not interpolated.
    fn at(&self, [u, v]: [f64; 2]) -> Blend {
        let height = self.blends.len() / self.width;
        self.blends[nearest(1.0 - v, height) * self.width + nearest(u, self.width)]
    }
}

fn nearest(share: f64, count: usize) -> usize {
    #[expect(clippy::cast_precision_loss, reason = "a picture's texels are far below 2^53")]
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "cut to the range")]
    let texel = (share.max(0.0) * count as f64) as usize;
    texel.min(count - 1)
}

/// What a ray meets on a sheet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SheetPoint {
    /// Its material, or materials.
    pub(super) blend: Blend,
    /// Share that the feather covers; the rest is open.
    pub(super) coverage: f64,
    /// Along barb or shaft, in the scene.
    pub(super) tangent: Vector,
}

impl Sheet {
    /// What lies at a place; None where nothing does.
    #[inline]
    pub(super) fn at(&self, hit: &Hit) -> Option<SheetPoint> {
        let texel = self.map.lookup(hit.uv[0], hit.uv[1]);
        let blend = match texel.class {
            TexelClass::Nothing => return None,
            TexelClass::Shaft => Blend::pure(self.shaft),
            TexelClass::Barb => match &self.vanes {
                Vanes::Plain(material) => Blend::pure(*material),
                Vanes::Pattern(pattern) => pattern.at(hit.uv),
            },
        };
        let upwards = hit.normal.cross(&hit.tangent);
        let [right, up] = texel.tangent;
        let tangent = (hit.tangent * right + upwards * up).try_normalize(0.0).unwrap_or(hit.tangent);
        Some(SheetPoint { blend, coverage: texel.coverage, tangent })
    }
}
