//! CIEDE2000, the difference between two colours as eyes judge it.

use super::Lab;

/// 25⁷, where the blue and grey corrections take hold of chroma.
const CHROMA_POWER: f64 = 6_103_515_625.0;

impl Lab {
    /// ΔE₀₀ between two colours with all weights 1: about 1 can just be told apart side by side.
    ///
    /// CIE 142-2001 in the form of Sharma, Wu and Dalal (2005), Color Research & Application 30:21–30, equations 2 to 22.
    /// Hue's mean jumps where two hues lie opposite each other, and so does the difference there (their section on
    /// discontinuities); it is symmetric throughout.
    pub fn delta_e_2000(self, other: Self) -> f64 {
        // Stretch a* of greys, and take chroma and hue from it (eq. 2 to 7).
        let mean_chroma = (self.a.hypot(self.b) + other.a.hypot(other.b)) / 2.0;
        let stretch = 1.0 + (1.0 - share_of_power(mean_chroma)) / 2.0;
        let (a1, a2) = (stretch * self.a, stretch * other.a);
        let (c1, c2) = (a1.hypot(self.b), a2.hypot(other.b));
        let (h1, h2) = (hue_deg(a1, self.b), hue_deg(a2, other.b));

        // Differences in lightness, chroma and hue (eq. 8 to 11). A grey has no hue to differ in.
        let grey = c1 * c2 == 0.0;
        let delta_l = other.l - self.l;
        let delta_c = c2 - c1;
        let turn = match h2 - h1 {
            _ if grey => 0.0,
            turn if turn > 180.0 => turn - 360.0,
            turn if turn < -180.0 => turn + 360.0,
            turn => turn,
        };
        let delta_h = 2.0 * (c1 * c2).sqrt() * (turn / 2.0).to_radians().sin();

        // Means (eq. 12 to 14).
        let mean_l = (self.l + other.l) / 2.0;
        let mean_c = (c1 + c2) / 2.0;
        let mean_h = match h1 + h2 {
            sum if grey => sum,
            sum if (h1 - h2).abs() <= 180.0 => sum / 2.0,
            sum if sum < 360.0 => (sum + 360.0) / 2.0,
            sum => (sum - 360.0) / 2.0,
        };

        // Weights of each, and the rotation that corrects blues (eq. 15 to 21).
        let cosine = |times: f64, shift: f64| (times * mean_h + shift).to_radians().cos();
        let t = 1.0 - 0.17 * cosine(1.0, -30.0) + 0.24 * cosine(2.0, 0.0) + 0.32 * cosine(3.0, 6.0)
            - 0.20 * cosine(4.0, -63.0);
        let from_middle = (mean_l - 50.0).powi(2);
        let s_l = 1.0 + 0.015 * from_middle / (20.0 + from_middle).sqrt();
        let s_c = 1.0 + 0.045 * mean_c;
        let s_h = 1.0 + 0.015 * mean_c * t;
        let blueness = (-((mean_h - 275.0) / 25.0).powi(2)).exp();
        let rotation = -(60.0 * blueness).to_radians().sin() * 2.0 * share_of_power(mean_c);

        let (l, c, h) = (delta_l / s_l, delta_c / s_c, delta_h / s_h);
        // The rotated form is positive definite; rounding near 0 is not.
        (l * l + c * c + h * h + rotation * c * h).max(0.0).sqrt()
    }
}

/// √(C⁷/(C⁷ + 25⁷)): 0 for greys, 1 for strong colours.
fn share_of_power(chroma: f64) -> f64 {
    let power = chroma.powi(7);
    (power / (power + CHROMA_POWER)).sqrt()
}

/// Hue angle, 0 to 360; 0 for grey.
fn hue_deg(a: f64, b: f64) -> f64 {
    let angle = b.atan2(a).to_degrees();
    if angle < 0.0 { angle + 360.0 } else { angle }
}
