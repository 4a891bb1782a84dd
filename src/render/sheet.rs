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
    /// A pattern.
    Pattern(Pattern),
}

/// Which material lies where, in rows from the top over the whole map.
#[derive(Debug, Clone, PartialEq)]
pub struct Pattern {
    width: usize,
    materials: Vec<usize>,
}

impl Pattern {
    /// A pattern of this width; None where the materials fill no whole rows.
    pub fn new(width: usize, materials: Vec<usize>) -> Option<Self> {
        let whole = width > 0 && !materials.is_empty() && materials.len().is_multiple_of(width);
        whole.then_some(Self { width, materials })
    }

    /// The material at the nearest texel: materials are not blended.
    fn at(&self, [u, v]: [f64; 2]) -> usize {
        let height = self.materials.len() / self.width;
        self.materials[nearest(1.0 - v, height) * self.width + nearest(u, self.width)]
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
    /// Number of the material.
    pub(super) material: usize,
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
        let material = match texel.class {
            TexelClass::Nothing => return None,
            TexelClass::Shaft => self.shaft,
            TexelClass::Barb => match &self.vanes {
                Vanes::Plain(material) => *material,
                Vanes::Pattern(pattern) => pattern.at(hit.uv),
            },
        };
        let upwards = hit.normal.cross(&hit.tangent);
        let [right, up] = texel.tangent;
        let tangent = (hit.tangent * right + upwards * up).try_normalize(0.0).unwrap_or(hit.tangent);
        Some(SheetPoint { material, coverage: texel.coverage, tangent })
    }
}
