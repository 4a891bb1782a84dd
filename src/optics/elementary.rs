//! Sine, cosine, their inverse and the exponential without branches and without calls, so that a loop over channels becomes vector
//! instructions.
//!
//! The standard library's functions are calls into libm, and one call ends the vectorisation of the loop that holds
//! it. The functions here are plain arithmetic on one number; the compiler turns a loop over them into as many lanes
//! as the processor has. No fused multiply-add is used: without it the hardware instruction is missing on old
//! processors and its emulation is slow, and with one rounding an operation all processors give the same bits.

/// Adding and subtracting 1.5 · 2⁵² rounds to the nearest integer, which is then in the low bits of the sum.
pub(crate) const ROUND: f64 = 6_755_399_441_055_744.0;

/// π/2 in two parts (Cody and Waite 1980). The first has 33 bits, so that its product with a whole number up to 2²⁰ is
/// exact; the second continues it with 53 more.
const HALF_PI_HIGH: f64 = 1.570_796_326_734_125_6;
const HALF_PI_LOW: f64 = 6.077_100_506_506_192e-11;

/// Sine and cosine of `x`, absolute error below 4e-16 for |x| ≤ 1.6e6 (10⁶ quarter turns); useless far beyond.
///
/// Reduction to |r| ≤ π/4 by whole quarter turns, then the minimax polynomials of fdlibm (Sun Microsystems 1993,
/// `k_sin.c` and `k_cos.c`).
#[inline(always)]
pub(crate) fn sin_cos(x: f64) -> (f64, f64) {
    let shifted = x * std::f64::consts::FRAC_2_PI + ROUND;
    let quarter_turns = shifted - ROUND;
    let r = (x - quarter_turns * HALF_PI_HIGH) - quarter_turns * HALF_PI_LOW;

    let z = r * r;
    let w = z * z;
    let sine_tail = (8.333_333_333_322_49e-3 + z * -1.984_126_982_985_795e-4)
        + w * ((2.755_731_370_707_006_8e-6 + z * -2.505_076_025_340_686_3e-8) + w * 1.589_690_995_211_55e-10);
    let sine = r + r * z * (-1.666_666_666_666_663_2e-1 + z * sine_tail);
    let cosine_tail = (4.166_666_666_666_66e-2 + z * -1.388_888_888_887_411e-3)
        + w * ((2.480_158_728_947_673e-5 + z * -2.755_731_435_139_066_3e-7)
            + w * (2.087_572_321_298_175e-9 + z * -1.135_964_755_778_819_5e-11));
    let cosine = 1.0 - z * 0.5 + w * cosine_tail;

    // An odd number of quarter turns swaps sine and cosine; the signs go +, +, −, − and +, −, −, +.
    let quadrant = shifted.to_bits();
    let swap = quadrant & 1 == 1;
    let (sine, cosine) = if swap { (cosine, sine) } else { (sine, cosine) };
    let sine_sign = (quadrant & 2) << 62;
    let cosine_sign = ((quadrant.wrapping_add(1)) & 2) << 62;
    (f64::from_bits(sine.to_bits() ^ sine_sign), f64::from_bits(cosine.to_bits() ^ cosine_sign))
}

/// ln 2 in two parts, the first with 33 bits.
const LN_2_HIGH: f64 = 6.931_471_803_691_238e-1;
const LN_2_LOW: f64 = 1.908_214_929_270_587_7e-10;

/// exp(x) for x ≤ 0, relative error below 4e-16; 0 stands for everything below e^−708.
///
/// Reduction by whole powers of two to |r| ≤ ln 2/2, then 1 + r + r² P(r), with P the Chebyshev series of degree 9 of
/// (e^r − 1 − r)/r² on that interval (first omitted term 1e-17, computed for this file in 60 digits).
#[inline(always)]
pub(crate) fn exp_of_negative(x: f64) -> f64 {
    // A comparison, since `max` has more to do than the instruction of that name.
    let inside = if x > -708.0 { x } else { -708.0 };
    let shifted = inside * std::f64::consts::LOG2_E + ROUND;
    let power = shifted - ROUND;
    let r = (inside - power * LN_2_HIGH) - power * LN_2_LOW;
    let mut series = 2.510_521_769_568_451_6e-8;
    for coefficient in [
        2.762_008_948_195_459e-7,
        2.755_725_539_833_871e-6,
        2.480_152_129_346_386_2e-5,
        1.984_126_987_482_230_7e-4,
        1.388_888_891_721_558_6e-3,
        8.333_333_333_326_134e-3,
        4.166_666_666_662_412e-2,
        1.666_666_666_666_667e-1,
        0.500_000_000_000_000_1,
        1.0,
        1.0,
    ] {
        series = series * r + coefficient;
    }
    let two_to_power = f64::from_bits(shifted.to_bits().wrapping_add(1023) << 52);
    if x < -708.0 { 0.0 } else { series * two_to_power }
}

/// [`exp_of_negative`] with a relative error below 5e-12, in two thirds of the time: P of degree 6.
#[inline(always)]
pub(crate) fn quick_exp_of_negative(x: f64) -> f64 {
    let inside = if x > -708.0 { x } else { -708.0 };
    let shifted = inside * std::f64::consts::LOG2_E + ROUND;
    let power = shifted - ROUND;
    // One part of ln 2 is enough: at the smallest result its rounding makes 2e-14.
    let r = inside - power * std::f64::consts::LN_2;
    let mut series = 2.486_787_206_587_467e-5;
    for coefficient in [
        1.989_927_622_238_488_7e-4,
        1.388_883_910_717_376_1e-3,
        8.333_298_480_356_209e-3,
        4.166_666_678_628_104e-2,
        1.666_666_671_900_771_3e-1,
        0.499_999_999_999_551,
        1.0,
        1.0,
    ] {
        series = series * r + coefficient;
    }
    let two_to_power = f64::from_bits(shifted.to_bits().wrapping_add(1023) << 52);
    if x < -708.0 { 0.0 } else { series * two_to_power }
}

/// The angle between 0 and π/2 whose sine and cosine are these, absolute error below 1e-11.
///
/// asin x = x P(x²) up to 1/2, with P the Chebyshev series of degree 7 (computed for this file in 50 digits). Beyond, that is
/// the angle's excess over π/3, whose sine follows from both numbers: no root is needed.
#[inline(always)]
pub(crate) fn acute_angle(sine: f64, cosine: f64) -> f64 {
    let is_large = sine > 0.5;
    let x = if is_large { 0.5 * sine - HALF_ROOT_3 * cosine } else { sine };
    let square = x * x;
    let mut series = 3.487_368_871_873_404e-2;
    for coefficient in [
        7.291_883_892_068_53e-3,
        2.468_817_965_056_864_5e-2,
        3.009_618_529_985_232_4e-2,
        4.466_168_831_176_662e-2,
        7.499_939_642_391_999e-2,
        1.666_666_739_918_369_5e-1,
        0.999_999_999_985_474_5,
    ] {
        series = series * square + coefficient;
    }
    let angle = x * series;
    if is_large { std::f64::consts::FRAC_PI_3 + angle } else { angle }
}

/// Sine of π/3.
const HALF_ROOT_3: f64 = 0.866_025_403_784_438_6;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn acute_angle_agrees_with_libm() {
        let mut worst: f64 = 0.0;
        for i in 0..=1_000_000 {
            let angle = f64::from(i) * 1e-6 * std::f64::consts::FRAC_PI_2;
            let (sine, cosine) = angle.sin_cos();
            worst = worst.max((acute_angle(sine, cosine) - angle).abs());
        }
        assert!(worst <= 1e-11, "worst absolute error {worst:e}");
    }

    /// Largest difference from the standard library over a dense list of phases that no grid of quarter turns shares.
    #[test]
    fn sine_and_cosine_agree_with_libm() {
        let mut worst: f64 = 0.0;
        for i in -400_000..400_000 {
            let x = f64::from(i) * 0.025_312_7;
            let (sine, cosine) = sin_cos(x);
            worst = worst.max((sine - x.sin()).abs()).max((cosine - x.cos()).abs());
        }
        for x in [0.0, -0.0, 1e-300, std::f64::consts::FRAC_PI_4, 1.0e6, 1.5e6, -1.6e6] {
            let (sine, cosine) = sin_cos(x);
            worst = worst.max((sine - x.sin()).abs()).max((cosine - x.cos()).abs());
        }
        assert!(worst <= 4e-16, "worst absolute error {worst:e}");
    }

    #[test]
    fn exponential_agrees_with_libm() {
        let (mut worst, mut worst_of_quick): (f64, f64) = (0.0, 0.0);
        for i in 0..700_000 {
            let x = -f64::from(i) * 1.011e-3;
            worst = worst.max((exp_of_negative(x) / x.exp() - 1.0).abs());
            worst_of_quick = worst_of_quick.max((quick_exp_of_negative(x) / x.exp() - 1.0).abs());
        }
        assert!(worst <= 4e-16, "worst relative error {worst:e}");
        assert!(worst_of_quick <= 5e-12, "worst relative error of the quick one {worst_of_quick:e}");
        assert_eq!(quick_exp_of_negative(0.0).to_bits(), 1.0_f64.to_bits());
        assert_eq!(quick_exp_of_negative(f64::NEG_INFINITY).to_bits(), 0.0_f64.to_bits());
        assert_eq!(exp_of_negative(0.0).to_bits(), 1.0_f64.to_bits());
        assert_eq!(exp_of_negative(-709.0).to_bits(), 0.0_f64.to_bits());
        assert_eq!(exp_of_negative(f64::NEG_INFINITY).to_bits(), 0.0_f64.to_bits());
    }
}
