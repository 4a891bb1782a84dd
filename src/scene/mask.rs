//! How much of a layer of paint lies at a place of a vane.

use super::error::SceneProblem;
use super::inputs::Inputs;
use super::paint_file::{BarsFile, MaskFile, MottleFile, StripFile, VaneSide};
use crate::geometry::{Side, VanePlace};
use crate::measure::photograph::Encoding;
use crate::render::{Texture, mixed, unit};

/// A layer's mask, checked.
#[derive(Debug)]
pub(super) struct Mask {
    plan: MaskFile,
    picture: Option<Texture>,
    seed: u64,
}

impl Mask {
    /// Checks a mask, and reads its picture. Layers of different numbers stray differently.
    pub(super) fn new(key: &str, plan: &MaskFile, number: u64, inputs: &mut Inputs) -> Result<Self, SceneProblem> {
        if let Some(strength) = plan.strength {
            within(key, "strength", strength, 0.0, 1.0)?;
        }
        for (name, strip) in [("along", &plan.along), ("across", &plan.across)] {
            let Some(StripFile { from, to, soft, stray }) = strip else { continue };
            let (from, to) = (from.unwrap_or(-2.0), to.unwrap_or(2.0));
            within(key, &format!("{name}.from"), from, -2.0, 2.0)?;
            within(key, &format!("{name}.to"), to, from, 2.0)?;
            within(key, &format!("{name}.soft"), *soft, 0.0, 2.0)?;
            within(key, &format!("{name}.stray"), *stray, 0.0, 1.0)?;
        }
        if let Some(BarsFile { first, period, width, lean, soft, stray }) = &plan.bars {
            within(key, "bars.first", *first, -2.0, 2.0)?;
            within(key, "bars.period", *period, 1e-3, 2.0)?;
            within(key, "bars.width", *width, 0.0, *period)?;
            within(key, "bars.lean", *lean, -1.0, 1.0)?;
            within(key, "bars.soft", *soft, 0.0, *period)?;
            within(key, "bars.stray", *stray, 0.0, 1.0)?;
        }
        if let Some(MottleFile { along, across, from, to }) = &plan.mottle {
            within(key, "mottle.along", *along, 1e-4, 10.0)?;
            within(key, "mottle.across", *across, 1e-3, 10.0)?;
            within(key, "mottle.from", *from, -1.0, 2.0)?;
            within(key, "mottle.to", *to, *from, 2.0)?;
        }
        let picture = match &plan.picture {
            Some(file) => {
                let key = format!("{key}.picture");
                let picture = inputs.picture(&key, file, Some(Encoding::Linear))?;
                if let Some(found) = picture.texels().iter().map(|t| t[0]).find(|red| !(0.0..=1.0).contains(red)) {
                    let problem = format!("{} holds {found}; expected shares from 0 to 1", file.display());
                    return Err(SceneProblem::key(key, problem));
                }
                Some(picture)
            }
            None => None,
        };
        Ok(Self { plan: plan.clone(), picture, seed: number })
    }

    /// Whether it can be told only where the feather's own coordinates are known.
    pub(super) fn needs_places(&self) -> bool {
        let MaskFile { vane, along, across, bars, mottle, picture: _, strength: _ } = &self.plan;
        vane.is_some() || along.is_some() || across.is_some() || bars.is_some() || mottle.is_some()
    }

    /// From 0 to 1, at a place of the map and, where it is known, of the vane.
    pub(super) fn at(&self, uv: [f64; 2], place: Option<&VanePlace>) -> f64 {
        let mut share = self.plan.strength.unwrap_or(1.0);
        if let Some(picture) = &self.picture {
            share *= picture.at(uv)[0];
        }
        match place {
            Some(place) if share > 0.0 => share * self.on_vane(place),
            _ => share,
        }
    }

    fn on_vane(&self, place: &VanePlace) -> f64 {
        let plan = &self.plan;
        let on_side = |side: VaneSide| {
            matches!((side, place.side), (VaneSide::Left, Side::Left) | (VaneSide::Right, Side::Right))
        };
        if plan.vane.is_some_and(|side| !on_side(side)) {
            return 0.0;
        }
        let (root, along, across) = (f64::from(place.root), f64::from(place.along), f64::from(place.across));
        let noise = |kind: u64| Noise(mixed(self.seed ^ (kind << 32) ^ (u64::from(place.side == Side::Left) << 48)));
        // From barb to barb, and slowly along each.
        let strayed = |kind: u64, reach: f64| {
            if reach == 0.0 {
                return 0.0;
            }
            let coarse = noise(kind).at(root / 0.03, across / 0.4);
            let fine = noise(kind + 1).at(f64::from(place.barb), across / 0.8);
            reach * (1.2 * coarse + 0.8 * fine - 1.0)
        };
        let mut share = 1.0;
        for (kind, strip, at) in [(0, &plan.along, along), (2, &plan.across, across)] {
            if let Some(strip) = strip {
                let at = at + strayed(kind, strip.stray);
                share *= strip.from.map_or(1.0, |from| edge(at - from, strip.soft));
                share *= strip.to.map_or(1.0, |to| edge(to - at, strip.soft));
            }
        }
        if let Some(bars) = &plan.bars {
            let at = along - bars.lean * across - bars.first + strayed(4, bars.stray);
            let from_middle = (at - bars.period * (at / bars.period).round()).abs();
            share *= edge(0.5 * bars.width - from_middle, bars.soft);
        }
        if let Some(mottle) = &plan.mottle {
            let field = noise(6).at(root / mottle.along, across / mottle.across);
            share *= edge(field - 0.5 * (mottle.from + mottle.to), mottle.to - mottle.from);
        }
        share
    }
}

fn within(key: &str, name: &str, found: f64, lower: f64, upper: f64) -> Result<(), SceneProblem> {
    if (lower..=upper).contains(&found) {
        return Ok(());
    }
    Err(SceneProblem::key(format!("{key}.{name}"), format!("found {found}; expected a number from {lower} to {upper}")))
}

/// From 0 to 1 where `inside` passes 0, smoothly over `soft`.
fn edge(inside: f64, soft: f64) -> f64 {
    if soft <= 0.0 {
        return f64::from(u8::from(inside >= 0.0));
    }
    let x = (inside / soft + 0.5).clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

/// A smooth random field over the plane, from 0 to 1: independent values at whole numbers, joined by cubics without slope there.
struct Noise(u64);

impl Noise {
    fn at(&self, x: f64, y: f64) -> f64 {
        let (x0, y0) = (x.floor(), y.floor());
        let ease = |share: f64| share * share * (3.0 - 2.0 * share);
        let (right, up) = (ease(x - x0), ease(y - y0));
        let corner = |dx: f64, dy: f64| {
            #[expect(clippy::cast_possible_truncation, reason = "cells of a feather are few")]
            let (i, j) = ((x0 + dx) as i64, (y0 + dy) as i64);
            unit(mixed(self.0 ^ mixed((i.cast_unsigned() << 32) ^ j.cast_unsigned())))
        };
        let lower = corner(0.0, 0.0) * (1.0 - right) + corner(1.0, 0.0) * right;
        let upper = corner(0.0, 1.0) * (1.0 - right) + corner(1.0, 1.0) * right;
        lower * (1.0 - up) + upper * up
    }
}
