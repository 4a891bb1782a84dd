//! Where an axis has its ticks, and what stands beside them.

use super::chart::length;
use crate::number::{minus, superscript};

/// A tick's place and label.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Tick {
    pub(crate) at: f64,
    pub(crate) label: String,
}

/// Ticks at multiples of 1, 2, 4 or 5 times a power of ten inside the range: as many as fit, about `most` (at least 3).
pub(crate) fn linear(low: f64, high: f64, most: f64) -> Vec<Tick> {
    at_multiples(low, high, most, 0.0)
}

/// The same for counts: whole numbers only.
pub(crate) fn whole(low: f64, high: f64, most: f64) -> Vec<Tick> {
    at_multiples(low, high, most, 1.0)
}

fn at_multiples(low: f64, high: f64, most: f64, smallest_step: f64) -> Vec<Tick> {
    let span = high - low;
    if !span.is_finite() || span <= 0.0 {
        return Vec::new();
    }
    // Rounding in the division must not lose a tick that lies on the very end.
    let slack = 1e-9 * span;
    let multiples = |step: f64| {
        let (first, last) = (((low - slack) / step).ceil(), ((high + slack) / step).floor());
        let ticks = std::iter::successors(Some(first), |m| Some(m + 1.0)).take_while(|m| *m <= last).map(|m| m * step);
        (step, ticks.collect::<Vec<f64>>())
    };
    // Each step is at most twice the one before it: a range with one tick has three or four at the next finer step.
    let power = 10f64.powf((span / most.max(3.0)).log10().floor() - 1.0);
    let steps = (0..4).flat_map(|decade| [1.0, 2.0, 4.0, 5.0].map(|f| f * power * 10f64.powi(decade)));
    let choices = steps.filter(|step| *step >= smallest_step * (1.0 - 1e-9)).map(multiples);
    let (step, ticks) = comfortable(choices, most, |(_, ticks)| ticks.len()).unwrap_or((1.0, Vec::new()));
    label(ticks, step, low.abs().max(high.abs()))
}

/// Of choices from the finest to the coarsest, the first with no more than `most` ticks (at least 3). Where that leaves
/// fewer than three, the one before it, unless that is half as crowded again: an axis with one tick has no scale.
fn comfortable<C>(choices: impl Iterator<Item = C>, most: f64, count: impl Fn(&C) -> usize) -> Option<C> {
    let most = most.floor().max(3.0);
    let mut finer: Option<C> = None;
    for choice in choices {
        let ticks = count(&choice);
        if length(ticks) > most {
            finer = Some(choice);
            continue;
        }
        let is_better = |finer: &C| ticks < 2 || length(count(finer)) <= 1.5 * most;
        return Some(if ticks < 3 { finer.filter(is_better).unwrap_or(choice) } else { choice });
    }
    finer
}

/// Ticks of a logarithmic axis: powers of ten, with their doubles and fives where the range is short.
pub(crate) fn logarithmic(low: f64, high: f64, most: f64) -> Vec<Tick> {
    if low.is_nan() || low <= 0.0 || high.is_nan() || high <= low || !high.is_finite() {
        return Vec::new();
    }
    let (first, last) = (low.log10().floor(), high.log10().ceil());
    if high.log10() - low.log10() < 1.0 {
        return linear(low, high, most);
    }
    let powers = |stride: f64, factors: &[f64]| {
        let start = (first / stride).floor() * stride;
        let exponents = std::iter::successors(Some(start), |e| Some(e + stride)).take_while(|e| *e <= last);
        exponents
            .flat_map(|exponent| factors.iter().map(move |factor| (*factor, exponent)))
            .map(|(factor, exponent)| Tick { at: factor * 10f64.powf(exponent), label: power_label(factor, exponent) })
            .filter(|tick| tick.at >= low * 0.999_999 && tick.at <= high * 1.000_001)
            .collect::<Vec<_>>()
    };
    let strides = std::iter::successors(Some(1.0), |s| Some(s + 1.0)).take_while(|s| *s <= last - first);
    let choices = std::iter::once(powers(1.0, &[1.0, 2.0, 5.0])).chain(strides.map(|stride| powers(stride, &[1.0])));
    comfortable(choices, most, Vec::len).unwrap_or_default()
}

fn power_label(factor: f64, exponent: f64) -> String {
    #[expect(clippy::cast_possible_truncation, reason = "the exponent of a finite number, within ±308")]
    let whole = exponent as i32;
    match whole {
        -3..=4 => minus(&format!("{}", format!("{:.3}", factor * 10f64.powi(whole)).parse::<f64>().unwrap_or(0.0))),
        _ if factor > 1.5 => format!("{factor}×10{}", superscript(whole)),
        _ => format!("10{}", superscript(whole)),
    }
}

fn label(ticks: Vec<f64>, step: f64, largest: f64) -> Vec<Tick> {
    #[expect(clippy::cast_possible_truncation, reason = "the exponent of a finite number, within ±308")]
    let exponent_of = |x: f64| x.log10().floor() as i32;
    let step_exponent = exponent_of(step * 1.000_001);
    let written = |at: f64| {
        if !(-4..=5).contains(&step_exponent) || largest >= 1e6 {
            let exponent = exponent_of(largest);
            let decimals = usize::try_from(exponent - step_exponent).unwrap_or(0);
            if at.abs() < step * 1e-6 {
                return "0".to_owned();
            }
            return minus(&format!("{:.decimals$}×10{}", at / 10f64.powi(exponent), superscript(exponent)));
        }
        let decimals = usize::try_from(-step_exponent).unwrap_or(0);
        let text = format!("{at:.decimals$}");
        minus(if at.abs() < step * 1e-6 { text.trim_start_matches('-') } else { &text })
    };
    ticks.into_iter().map(|at| Tick { at, label: written(at) }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(ticks: &[Tick]) -> Vec<&str> {
        ticks.iter().map(|t| t.label.as_str()).collect()
    }

    #[test]
    fn ticks_are_round_numbers_inside_the_range() {
        assert_eq!(labels(&linear(298.0, 701.0, 5.0)), ["300", "400", "500", "600", "700"]);
        assert_eq!(labels(&linear(-0.024, 0.024, 4.0)), ["−0.02", "0.00", "0.02"]);
        assert_eq!(labels(&linear(0.0, 2.2e-6, 3.0)), ["0", "1×10⁻⁶", "2×10⁻⁶"]);
        assert!(linear(1.0, 1.0, 4.0).is_empty());
        assert!(linear(0.0, f64::NAN, 4.0).is_empty());
    }

    #[test]
    fn logarithmic_ticks_are_powers_of_ten() {
        assert_eq!(labels(&logarithmic(0.5, 2e6, 8.0)), ["1", "10", "100", "1000", "10000", "10⁵", "10⁶"]);
        assert_eq!(labels(&logarithmic(0.9, 21.0, 6.0)), ["1", "2", "5", "10", "20"]);
        assert!(logarithmic(0.0, 1.0, 5.0).is_empty());
    }

    /// A strip of residuals 56 pixels high has room for three labels; ranges of ±44 once had the label 0 alone.
    #[test]
    fn no_axis_is_left_with_one_tick() {
        assert_eq!(labels(&linear(-44.0, 44.0, 3.0)), ["−40", "0", "40"]);
        for hundredth in 100..1000 {
            let limit = f64::from(hundredth) / 100.0;
            assert!(linear(-limit, limit, 3.0).len() >= 3, "±{limit}");
            for low in [0.0, 0.37, 3.2, 33.21, 332.49] {
                let ticks = linear(low, low + limit, 3.0);
                assert!((2..=4).contains(&ticks.len()), "{low} to {}: {ticks:?}", low + limit);
            }
            assert!(logarithmic(0.31, 0.31 * 10.0 * limit, 3.0).len() >= 2, "0.31 to {}", 3.1 * limit);
        }
    }

    #[test]
    fn counts_have_whole_ticks() {
        assert_eq!(labels(&whole(-0.06, 1.06, 14.0)), ["0", "1"]);
        assert_eq!(labels(&whole(-0.2, 3.2, 14.0)), ["0", "1", "2", "3"]);
        assert_eq!(labels(&whole(-2.0, 42.0, 6.0)), ["0", "10", "20", "30", "40"]);
    }
}
