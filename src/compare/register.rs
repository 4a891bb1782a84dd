//! Moving one picture over another.
//!
//! Only a shift is sought: pictures of one scale and one turn. Phase correlation is quick but breaks on black borders and on
//! masks; here the correlation of the luminance codes over what both show, without what cannot be trusted, is searched
//! directly, first on pictures reduced until the search is small, then finer by factors of two.

use rayon::prelude::*;
use serde::Serialize;

use super::CompareError;
use super::pair::luminance_code;
use crate::measure::photograph::{Photograph, Rectangle, Validity};
use crate::number::significant;

/// How the second picture was moved.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Registration {
    /// What lies at x, y in the first picture lies at x + right, y + down in the second: right and down, in pixels.
    pub shift_px: [f64; 2],
    /// Correlation of the luminance codes there, −1 to 1.
    pub correlation: f64,
}

/// Pictures are halved until their shorter side has no more pixels than this.
const COARSEST_PX: usize = 40;
/// Least part of the smaller picture that both must show.
const LEAST_OVERLAP: f64 = 0.4;
/// Below this correlation the pictures show different things.
const LEAST_CORRELATION: f64 = 0.5;

/// Luminance codes; none where they cannot be trusted.
struct Level {
    width: usize,
    height: usize,
    codes: Vec<Option<f64>>,
}

impl Level {
    fn of(photograph: &Photograph) -> Self {
        let code =
            |(pixel, validity): (&[f32; 3], &Validity)| (*validity == Validity::Valid).then(|| luminance_code(*pixel));
        let codes = photograph.pixels.iter().zip(&photograph.validity).map(code).collect();
        Self { width: photograph.width, height: photograph.height, codes }
    }

    /// Half the size: each pixel is the mean of those of four that can be trusted.
    fn halved(&self) -> Self {
        let (width, height) = (self.width / 2, self.height / 2);
        let mean = |x: usize, y: usize| {
            let four = [(0, 0), (1, 0), (0, 1), (1, 1)];
            let known: Vec<f64> = four
                .iter()
                .filter_map(|(right, down)| self.codes[(2 * y + down) * self.width + 2 * x + right])
                .collect();
            #[expect(clippy::cast_precision_loss, reason = "at most four")]
            (!known.is_empty()).then(|| known.iter().sum::<f64>() / known.len() as f64)
        };
        let codes = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| mean(x, y)).collect();
        Self { width, height, codes }
    }

    fn shorter_side(&self) -> usize {
        self.width.min(self.height)
    }

    fn len(&self) -> usize {
        self.codes.len()
    }
}

/// Finds the shift with the highest correlation.
pub(super) fn register(first: &Photograph, second: &Photograph) -> Result<Registration, CompareError> {
    let mut levels = vec![(Level::of(first), Level::of(second))];
    while let Some((one, other)) = levels.last().filter(|(a, b)| a.shorter_side().min(b.shorter_side()) > COARSEST_PX) {
        levels.push((one.halved(), other.halved()));
    }
    let mut best: Option<([isize; 2], f64)> = None;
    for (one, other) in levels.iter().rev() {
        let candidates: Vec<[isize; 2]> = match best {
            None => all_shifts(one, other),
            // Twice the coarser shift, and what halving may have hidden.
            Some(([right, down], _)) => around([2 * right, 2 * down], 2),
        };
        best = best_of(one, other, &candidates);
        if best.is_none() {
            break;
        }
    }
    let refused = |reason: &str| CompareError::NotRegistered(reason.to_owned());
    let (mut shift, mut correlation) =
        best.ok_or_else(|| refused("too few pixels can be trusted where they overlap, or one of them is even"))?;
    let (one, other) = &levels[0];
    // Uphill to the top of the finest level: halving may have led beside it.
    while let Some((better, higher)) = best_of(one, other, &around(shift, 1)).filter(|(_, value)| *value > correlation)
    {
        (shift, correlation) = (better, higher);
    }
    if correlation < LEAST_CORRELATION {
        return Err(refused(&format!(
            "where they agree best their correlation is {}, and at least {LEAST_CORRELATION} was expected",
            significant(correlation, 2)
        )));
    }
    Ok(Registration { shift_px: between_pixels(one, other, shift, correlation), correlation })
}

/// Every shift that leaves enough to see.
fn all_shifts(one: &Level, other: &Level) -> Vec<[isize; 2]> {
    let range = |a: usize, b: usize| {
        let [a, b] = [a, b].map(usize::cast_signed);
        1 - a..b
    };
    let rows = range(one.height, other.height);
    rows.flat_map(|down| range(one.width, other.width).map(move |right| [right, down])).collect()
}

fn around([right, down]: [isize; 2], reach: isize) -> Vec<[isize; 2]> {
    (-reach..=reach).flat_map(|y| (-reach..=reach).map(move |x| [right + x, down + y])).collect()
}

/// The candidate with the highest correlation; the first of equals.
fn best_of(one: &Level, other: &Level, candidates: &[[isize; 2]]) -> Option<([isize; 2], f64)> {
    let found: Vec<Option<f64>> = candidates.par_iter().map(|shift| correlation(one, other, *shift)).collect();
    let known = candidates.iter().zip(found).filter_map(|(shift, value)| Some((*shift, value?)));
    known.fold(None, |best, (shift, value)| match best {
        Some((_, highest)) if highest >= value => best,
        _ => Some((shift, value)),
    })
}

/// Pearson's correlation of the codes where both can be trusted; None where that is too little, or even.
#[expect(clippy::cast_precision_loss, reason = "a count of pixels is far below 2^53")]
fn correlation(one: &Level, other: &Level, [right, down]: [isize; 2]) -> Option<f64> {
    let (columns, rows) = (shared(one.width, other.width, right), shared(one.height, other.height, down));
    let least = LEAST_OVERLAP * one.len().min(other.len()) as f64;
    if ((columns.len() * rows.len()) as f64) < least {
        return None;
    }
    // Sums about 0 lose 1e-16 of codes between 0 and 1, far below what tells shifts apart.
    let (mut count, mut sums, mut squares, mut product) = (0.0, [0.0; 2], [0.0; 2], 0.0);
    for y in rows {
        let row = y * one.width;
        let moved = y.strict_add_signed(down) * other.width;
        for x in columns.clone() {
            let (Some(a), Some(b)) = (one.codes[row + x], other.codes[moved + x.strict_add_signed(right)]) else {
                continue;
            };
            count += 1.0;
            sums[0] += a;
            sums[1] += b;
            squares[0] += a * a;
            squares[1] += b * b;
            product += a * b;
        }
    }
    // Masks may leave less than the overlap.
    if count < 16.0 || count < least / 4.0 {
        return None;
    }
    let [mean_a, mean_b] = sums.map(|sum| sum / count);
    let variance_a = squares[0] / count - mean_a * mean_a;
    let variance_b = squares[1] / count - mean_b * mean_b;
    // Even pictures have no structure to agree in: half a step of an 8-bit code.
    const EVEN: f64 = 0.002 * 0.002;
    (variance_a > EVEN && variance_b > EVEN)
        .then(|| (product / count - mean_a * mean_b) / (variance_a * variance_b).sqrt())
}

/// Places along a side of the first that the moved second covers.
fn shared(one: usize, other: usize, shift: isize) -> std::ops::Range<usize> {
    let start = (-shift).max(0).cast_unsigned();
    let end = (other.cast_signed() - shift).max(0).cast_unsigned().min(one);
    start.min(end)..end
}

/// The top of a parabola through the correlations at a shift and beside it, along either axis.
fn between_pixels(one: &Level, other: &Level, shift: [isize; 2], top: f64) -> [f64; 2] {
    std::array::from_fn(|axis| {
        let beside = |step: isize| {
            let mut moved = shift;
            moved[axis] += step;
            correlation(one, other, moved)
        };
        #[expect(clippy::cast_precision_loss, reason = "a picture's sides are far below 2^53")]
        let whole = shift[axis] as f64;
        match (beside(-1), beside(1)) {
            // Equal pictures agree wholly: the top is where they do.
            (Some(before), Some(after)) if top < 1.0 - 1e-12 && before + after < 2.0 * top => {
                whole + 0.5 * (before - after) / (before - 2.0 * top + after)
            }
            _ => whole,
        }
    })
}

impl Registration {
    /// What was done, in a sentence.
    pub fn sentence(&self) -> String {
        format!(
            "The second picture was moved over the first by {} pixels to the left and {} up (correlation {}), linear between pixels; turn and scale were left as they are.",
            significant(self.shift_px[0], 3),
            significant(self.shift_px[1], 3),
            significant(self.correlation, 3)
        )
    }

    /// Where what both show lies in the first picture.
    pub(super) fn part(&self, first: &Photograph, second: &Photograph) -> Result<Rectangle, CompareError> {
        let along = |one: usize, other: usize, shift: f64| {
            #[expect(clippy::cast_precision_loss, reason = "a picture's sides are far below 2^53")]
            let (one, other) = (one as f64, other as f64);
            let start = (-shift).ceil().max(0.0);
            let end = (other - 1.0 - shift).floor().min(one - 1.0);
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "between 0 and the picture's side"
            )]
            (end >= start).then_some((start as usize, (end - start) as usize + 1))
        };
        let columns = along(first.width, second.width, self.shift_px[0]);
        let rows = along(first.height, second.height, self.shift_px[1]);
        match (columns, rows) {
            (Some((x_px, width_px)), Some((y_px, height_px))) => Ok(Rectangle { x_px, y_px, width_px, height_px }),
            _ => Err(CompareError::NotRegistered("they do not overlap".to_owned())),
        }
    }
}
