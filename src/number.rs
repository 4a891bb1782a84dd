//! Numbers as a measurer writes them. Every number that a page shows is formatted here.

/// Digits of a value that has no error to say where it ends.
const DIGITS_WITHOUT_ERROR: usize = 5;

/// Beyond these powers of ten a number is written as a × 10ⁿ.
const LARGEST_PLAIN_EXPONENT: i32 = 6;
const SMALLEST_PLAIN_EXPONENT: i32 = -5;

/// A value with its standard error: the error to two significant digits, the value to the same place.
///
/// Without an error, or with one that is not a positive number, the value stands alone.
pub(crate) fn with_error(value: f64, error: Option<f64>) -> String {
    let Some(error) = error.filter(|e| e.is_finite() && *e > 0.0 && value.is_finite()) else {
        return plain(value);
    };
    let place = last_place(error);
    let exponent = exponent_of(value.abs().max(error));
    if is_plain(exponent, place) {
        format!("{} ± {}", to_place(value, place), to_place(error, place))
    } else {
        let scale = 10f64.powi(exponent);
        let place = place - exponent;
        let (value, error) = (to_place(value / scale, place), to_place(error / scale, place));
        format!("({value} ± {error}) × 10{}", superscript(exponent))
    }
}

/// A number rounded to the place at which a value with this error ends; rounded like [`plain`] where there is none.
pub(crate) fn beside_error(value: f64, error: Option<f64>) -> String {
    match error.filter(|e| e.is_finite() && *e > 0.0 && value.is_finite()) {
        Some(error) if is_plain(exponent_of(value.abs().max(error)), last_place(error)) => {
            to_place(value, last_place(error))
        }
        _ => plain(value),
    }
}

/// The error as a share of the value, in percent; nothing where the value is 0.
pub(crate) fn percent(value: f64, error: Option<f64>) -> Option<String> {
    let share = 100.0 * error? / value.abs();
    share.is_finite().then(|| format!("{} %", significant(share, 2)))
}

/// A correlation with this many decimals, and with more where it would be rounded to ±1 without being so.
pub(crate) fn correlation(value: f64, decimals: i32) -> String {
    let needed = (decimals..8).find(|d| value.abs() >= 1.0 || value.abs() < 1.0 - 0.5 * 10f64.powi(-d));
    to_place(value, -needed.unwrap_or(8))
}

/// A number to five significant digits without trailing zeros.
pub(crate) fn plain(value: f64) -> String {
    if !value.is_finite() {
        return "not a finite number".to_owned();
    }
    let text = significant(value, DIGITS_WITHOUT_ERROR);
    match text.split_once(" × ") {
        Some((mantissa, power)) => format!("{} × {power}", without_trailing_zeros(mantissa)),
        None => without_trailing_zeros(&text).to_owned(),
    }
}

/// A number to this many significant digits, trailing zeros kept.
pub(crate) fn significant(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return "not a finite number".to_owned();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    let further_digits = digits.saturating_sub(1);
    let (mantissa, exponent) = mantissa_and_exponent(value, further_digits);
    if !(SMALLEST_PLAIN_EXPONENT..=LARGEST_PLAIN_EXPONENT).contains(&exponent) {
        return format!("{} × 10{}", minus(&mantissa), superscript(exponent));
    }
    let place = exponent - i32::try_from(further_digits).unwrap_or(i32::MAX);
    to_place(value, place)
}

/// A whole number with thin spaces between groups of three digits.
pub(crate) fn count(value: u64) -> String {
    let digits = value.to_string();
    if digits.len() < 5 {
        return digits;
    }
    let mut text = String::new();
    for (position, digit) in digits.chars().enumerate() {
        if position > 0 && (digits.len() - position).is_multiple_of(3) {
            text.push('\u{202f}');
        }
        text.push(digit);
    }
    text
}

/// An exponent as superscript digits.
pub(crate) fn superscript(exponent: i32) -> String {
    exponent
        .to_string()
        .chars()
        .map(|c| match c {
            '-' => '⁻',
            '0' => '⁰',
            '1' => '¹',
            '2' => '²',
            '3' => '³',
            '4' => '⁴',
            '5' => '⁵',
            '6' => '⁶',
            '7' => '⁷',
            '8' => '⁸',
            _ => '⁹',
        })
        .collect()
}

/// With a minus sign in place of the hyphen.
pub(crate) fn minus(text: &str) -> String {
    text.replace('-', "−")
}

/// The value rounded to the digit that stands for 10^place.
pub(crate) fn to_place(value: f64, place: i32) -> String {
    let text = match usize::try_from(-place) {
        Ok(decimals) => format!("{value:.decimals$}"),
        Err(_) => {
            let unit = 10f64.powi(place);
            format!("{:.0}", (value / unit).round_ties_even() * unit)
        }
    };
    // A small negative number that rounds to zero has lost its sign's meaning.
    let is_zero = text.chars().all(|c| matches!(c, '-' | '0' | '.'));
    minus(if is_zero { text.trim_start_matches('-') } else { &text })
}

/// Place of the second significant digit of an error, after rounding: 0.0996 becomes 0.10, whose last place is 10⁻².
fn last_place(error: f64) -> i32 {
    mantissa_and_exponent(error, 1).1 - 1
}

fn exponent_of(value: f64) -> i32 {
    if value == 0.0 { 0 } else { mantissa_and_exponent(value, 15).1 }
}

fn is_plain(exponent: i32, place: i32) -> bool {
    exponent <= LARGEST_PLAIN_EXPONENT && place >= SMALLEST_PLAIN_EXPONENT - 1
}

fn mantissa_and_exponent(value: f64, further_digits: usize) -> (String, i32) {
    let text = format!("{value:.further_digits$e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    (mantissa.to_owned(), exponent.parse().unwrap_or(0))
}

fn without_trailing_zeros(text: &str) -> &str {
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Worked by hand: round the error to two digits, then cut the value at the same place.
    #[test]
    fn a_value_ends_where_its_error_ends() {
        let cases = [
            (332.417, 1.234, "332.4 ± 1.2"),
            (332.417, 0.0996, "332.42 ± 0.10"),
            (332.417, 9.96, "332 ± 10"),
            (332.417, 99.6, "330 ± 100"),
            (1.5553, 0.00449, "1.5553 ± 0.0045"),
            (-0.0123, 0.0042, "−0.0123 ± 0.0042"),
            (0.0, 0.5, "0.00 ± 0.50"),
            (-0.001, 0.5, "0.00 ± 0.50"),
            (123_456.0, 1234.0, "123500 ± 1200"),
            (1.234e8, 5.6e5, "(1.2340 ± 0.0056) × 10⁸"),
            (1.2341e-7, 4.4e-9, "(1.234 ± 0.044) × 10⁻⁷"),
            (5.0, 0.0, "5"),
            (5.0, f64::NAN, "5"),
        ];
        for (value, error, expected) in cases {
            assert_eq!(with_error(value, Some(error)), expected, "{value} with error {error}");
        }
        assert_eq!(with_error(1.25, None), "1.25");
    }

    #[test]
    fn a_lone_value_keeps_five_digits_and_no_trailing_zeros() {
        let cases = [
            (1.0, "1"),
            (1.234567, "1.2346"),
            (300.0, "300"),
            (1_234_567.0, "1234600"),
            (0.000_012_3, "0.0000123"),
            (1.5e-9, "1.5 × 10⁻⁹"),
            (-2.5e12, "−2.5 × 10¹²"),
            (f64::INFINITY, "not a finite number"),
        ];
        for (value, expected) in cases {
            assert_eq!(plain(value), expected, "{value}");
        }
    }

    #[test]
    fn only_a_full_correlation_is_one() {
        let cases = [(1.0, "1.00"), (-1.0, "−1.00"), (-0.996, "−0.996"), (0.99996, "0.99996"), (0.123, "0.12")];
        for (value, expected) in cases {
            assert_eq!(correlation(value, 2), expected, "{value}");
        }
    }

    #[test]
    fn percent_is_of_the_size_of_the_value() {
        assert_eq!(percent(-200.0, Some(1.0)).as_deref(), Some("0.50 %"));
        assert_eq!(percent(0.0, Some(1.0)), None);
        assert_eq!(percent(1.0, None), None);
    }

    proptest::proptest! {
        /// Whatever the sizes, the error keeps two digits (5 % of its smallest leading pair, 1.0) and the value moves by
        /// at most half a unit of the error's last place, a twentieth of the error.
        #[test]
        fn rounding_is_small_beside_the_error(value in -1e5..1e5f64, exponent in -4..4i32, lead in 1.0..9.99f64) {
            let error = lead * 10f64.powi(exponent);
            let text = with_error(value, Some(error)).replace('−', "-");
            let (shown_value, shown_error) = text.split_once(" ± ").unwrap();
            let (shown_value, shown_error): (f64, f64) = (shown_value.parse().unwrap(), shown_error.parse().unwrap());
            proptest::prop_assert!((shown_error / error - 1.0).abs() <= 0.0501, "{text} for {value} and {error}");
            proptest::prop_assert!((shown_value - value).abs() <= 0.0501 * error, "{text} for {value} and {error}");
        }
    }

    #[test]
    fn counts_are_grouped() {
        assert_eq!(count(5213), "5213");
        assert_eq!(count(1_234_567), "1\u{202f}234\u{202f}567");
    }
}
