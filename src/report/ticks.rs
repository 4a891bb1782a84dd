//! Where an axis has its ticks, and what stands beside them.

use crate::number::{minus, superscript};

/// A tick's place and label.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Tick {
    pub(crate) at: f64,
    pub(crate) label: String,
}

/// Ticks at multiples of 1, 2 or 5 times a power of ten inside the range: as many as fit, `most` (at least 3) at most.
pub(crate) fn linear(low: f64, high: f64, most: f64) -> Vec<Tick> {
    let span = high - low;
    if !span.is_finite() || span <= 0.0 {
        return Vec::new();
    }
    // Rounding in the division must not lose a tick that lies on the very end.
    let slack = 1e-9 * span;
    let first = |step: f64| ((low - slack) / step).ceil();
    let last = |step: f64| ((high + slack) / step).floor();
    let most = most.floor().max(3.0);
    let power = 10f64.powf((span / most).log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|f| f * power).into_iter().find(|s| last(*s) - first(*s) < most);
    let step = step.unwrap_or(20.0 * power);
    let ticks = std::iter::successors(Some(first(step)), |m| Some(m + 1.0)).take_while(|m| *m <= last(step));
    label(ticks.map(|m| m * step).collect(), step, low.abs().max(high.abs()))
}

/// Ticks of a logarithmic axis: powers of ten, with their doubles and fives where the range is short.
pub(crate) fn logarithmic(low: f64, high: f64, most: f64) -> Vec<Tick> {
    if low.is_nan() || low <= 0.0 || high.is_nan() || high <= low || !high.is_finite() {
        return Vec::new();
    }
    let (first, last) = (low.log10().floor(), high.log10().ceil());
    let decades = high.log10() - low.log10();
    if decades < 1.0 {
        return linear(low, high, most);
    }
    let stride = (decades / most.max(1.0)).ceil().max(1.0);
    let factors: &[f64] = if decades <= most / 3.0 { &[1.0, 2.0, 5.0] } else { &[1.0] };
    let mut ticks = Vec::new();
    let mut exponent = (first / stride).floor() * stride;
    while exponent <= last {
        for factor in factors {
            let at = factor * 10f64.powf(exponent);
            if at >= low * 0.999_999 && at <= high * 1.000_001 {
                ticks.push(Tick { at, label: power_label(*factor, exponent) });
            }
        }
        exponent += stride;
    }
    ticks
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
}
