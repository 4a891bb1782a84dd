//! Densities of the azimuth that are drawn from: even, of period 2π, straight between evenly spaced points.

use std::f64::consts::{PI, TAU};

/// Most and least intervals between φ = 0 and π. More than the most would resolve edges of the narrowest lobes, at the
/// price of a table that leaves the processor's cache.
const INTERVALS: std::ops::RangeInclusive<f64> = 64.0..=256.0;

/// A list of densities.
#[derive(Debug, Clone)]
pub(super) struct AzimuthTable {
    intervals: usize,
    /// Density (1/rad) and share of the azimuths up to ± this one, at each point of each curve.
    nodes: Vec<[f32; 2]>,
}

impl AzimuthTable {
    /// An empty table whose points stand closer than lobes of this width (radians) can bend.
    pub(super) fn for_lobes_of(width: f64) -> Self {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small positive whole number")]
        let intervals = (16.0 * PI / width).ceil().clamp(*INTERVALS.start(), *INTERVALS.end()) as usize;
        Self { intervals, nodes: Vec::new() }
    }

    /// Adds a curve from values at azimuths 0 to π that need not be normalised, and gives their integral over the turn. A value
    /// below 0, as interpolation leaves beside a peak, counts as 0.
    #[expect(clippy::cast_possible_truncation, reason = "the table holds f32")]
    pub(super) fn push(&mut self, mut value: impl FnMut(f64) -> f64) -> f64 {
        let step = PI / self.intervals as f64;
        let heights: Vec<f64> = (0..=self.intervals).map(|k| value(k as f64 * step).max(0.0)).collect();
        let mut cumulative = vec![0.0; heights.len()];
        for k in 1..heights.len() {
            // Both sides of the turn: twice half the sum of two heights.
            cumulative[k] = cumulative[k - 1] + step * (heights[k - 1] + heights[k]);
        }
        let total = cumulative[self.intervals];
        let scale = if total > 0.0 { 1.0 / total } else { 0.0 };
        self.nodes.extend(heights.iter().zip(&cumulative).map(|(h, c)| [(h * scale) as f32, (c * scale) as f32]));
        total
    }

    /// A curve by its number.
    pub(super) fn curve(&self, number: usize) -> AzimuthCurve<'_> {
        let count = self.intervals + 1;
        AzimuthCurve(&self.nodes[number * count..][..count])
    }
}

/// One density.
#[derive(Debug, Clone, Copy)]
pub(super) struct AzimuthCurve<'a>(&'a [[f32; 2]]);

impl AzimuthCurve<'_> {
    fn intervals_per_radian(&self) -> f64 {
        (self.0.len() - 1) as f64 / PI
    }

    /// 1/rad, at any azimuth.
    pub(super) fn density(&self, phi: f64) -> f64 {
        let distance = (phi - (phi / TAU).round() * TAU).abs();
        let position = distance * self.intervals_per_radian();
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small positive number")]
        let before = (position as usize).min(self.0.len() - 2);
        let share = position - before as f64;
        f64::from(self.0[before][0]) * (1.0 - share) + f64::from(self.0[before + 1][0]) * share
    }

    /// Absolute value of an azimuth of this density, 0 to π, from a uniform number in [0, 1).
    pub(super) fn draw(&self, random: f64) -> f64 {
        let before = (self.0.partition_point(|node| f64::from(node[1]) <= random) - 1).min(self.0.len() - 2);
        let [[start, passed], [end, _]] = [self.0[before], self.0[before + 1]].map(|node| node.map(f64::from));
        // With t the share of the interval, start · t + (end − start) t²/2 = rest: the root in the form that never cancels.
        let rest = 0.5 * (random - passed) * self.intervals_per_radian();
        let root = (start * start + 2.0 * (end - start) * rest).max(0.0).sqrt();
        let share = if rest > 0.0 { (2.0 * rest / (start + root)).min(1.0) } else { 0.0 };
        (before as f64 + share) / self.intervals_per_radian()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A draw has passed as much of the density as the number that it was drawn from.
    #[test]
    fn draws_invert_the_integral() {
        let mut table = AzimuthTable::for_lobes_of(0.5);
        table.push(|phi| (-phi).exp());
        // Nothing in the middle.
        table.push(|phi| (phi.cos() - 0.3).max(0.0) + (-phi.cos() - 0.5).max(0.0));
        for curve in [table.curve(0), table.curve(1)] {
            for step in 0..1000 {
                let random = f64::from(step) / 1000.0;
                let drawn = curve.draw(random);
                // Trapezoids between the curve's own points are exact.
                let count = (drawn * curve.intervals_per_radian()).floor();
                let mut passed = 0.0;
                let mut before = 0.0;
                let mut k = 1.0;
                while k <= count {
                    let here = k / curve.intervals_per_radian();
                    passed += (here - before) * (curve.density(before) + curve.density(here));
                    before = here;
                    k += 1.0;
                }
                passed += (drawn - before) * (curve.density(before) + curve.density(drawn));
                // The table holds f32.
                assert!((passed - random).abs() < 1e-5, "{passed} instead of {random}");
                assert!(random == 0.0 || curve.density(drawn) > 0.0, "drew {drawn} where nothing is");
            }
        }
    }
}
