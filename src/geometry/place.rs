//! Where a texel lies on its vane, in the feather's own coordinates: what a plumage pattern is drawn in.

use kurbo::{Point, Vec2};

use super::barb::{Barb, Side};
use super::feather::Feather;

/// A texel's place on its vane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VanePlace {
    /// Which vane.
    pub side: Side,
    /// Number of the nearest barb in its vane, from the base.
    pub barb: u32,
    /// Where that barb's root stands: from 0 at the beginning of the rachis to 1 at its tip.
    pub root: f32,
    /// Where the texel itself stands along the rachis, in the same measure, going square to it from the root: more than `root`,
    /// since barbs lean to the tip.
    pub along: f32,
    /// From 0 at the rachis to 1 at the margin, along the barb (its curve's parameter).
    pub across: f32,
    /// Share of the texel that the barbs themselves cover; the rest is their barbules'.
    pub ramus: f32,
}

/// A barb's place on the rachis.
pub(super) struct Ground {
    side: Side,
    barb: u32,
    /// Share of the rachis before it.
    root: f64,
    /// The rachis's direction there, over its length.
    up_per_mm: Vec2,
}

impl Ground {
    /// That of each barb, the left vane's first.
    pub(super) fn of_all(feather: &Feather) -> Vec<Self> {
        let rachis_mm = feather.shaft.rachis_length_mm();
        let of_vane = |vane: usize| {
            (0..).zip(&feather.vanes[vane].barbs).map(move |(number, barb)| Self {
                side: feather.vanes[vane].side,
                barb: number,
                root: barb.root_mm / rachis_mm,
                up_per_mm: feather.shaft.curve.tangent(feather.shaft.at_rachis_mm(barb.root_mm)) / rachis_mm,
            })
        };
        of_vane(0).chain(of_vane(1)).collect()
    }

    /// The place of a point whose nearest on the barb is at `t`.
    pub(super) fn place(&self, barb: &Barb, t: f64, point: Point, ramus: f64) -> VanePlace {
        #[expect(clippy::cast_possible_truncation, reason = "a pattern needs no more than f32")]
        let single = |value: f64| value as f32;
        VanePlace {
            side: self.side,
            barb: self.barb,
            root: single(self.root),
            along: single(self.root + (point - barb.curve.p0).dot(self.up_per_mm)),
            across: single(t.clamp(0.0, 1.0)),
            ramus: single(ramus.clamp(0.0, 1.0)),
        }
    }
}
