//! From a reflectance spectrum to the colour that a person with normal sight sees under daylight: CIE 1931 2° observer,
//! illuminant D65, then sRGB for a screen or CIELAB for a difference.

mod difference;
mod observer;

use observer::{FIRST_NM, OBSERVER_AND_D65, STEP_NM};

/// CIE 1931 tristimulus values under D65; the white standard has `y` = 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Xyz {
    /// X.
    pub x: f64,
    /// Y, the luminance.
    pub y: f64,
    /// Z.
    pub z: f64,
}

/// CIELAB 1976 coordinates against the white standard under D65.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lab {
    /// Lightness L*, 0 to 100 for whatever is no brighter than the standard.
    pub l: f64,
    /// a*, from green to red.
    pub a: f64,
    /// b*, from blue to yellow.
    pub b: f64,
}

/// Linear light of the Rec. 709 primaries, D65 white; outside 0 to 1 where a screen cannot show it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearRgb(pub [f64; 3]);

/// The colour of a spectrum, ready to be shown and to be said what the showing hides.
#[derive(Debug, Clone, PartialEq)]
pub struct Swatch {
    /// As the web writes it: `#1a2b3c`.
    pub hex: String,
    /// The colour before it was fitted to a screen.
    pub lab: Lab,
    /// Whether a screen cannot show it and `hex` is the nearest in each channel.
    pub clipped: bool,
    /// Whether the spectrum does not cover 380 to 780 nm and its first or last value stood in for the rest.
    pub extended: bool,
}

impl Swatch {
    /// The colour of a reflectance spectrum (1 = the white standard) given at rising wavelengths in nm.
    ///
    /// None if there are no values, or not as many as wavelengths.
    pub fn new(wavelengths_nm: &[f64], reflectances: &[f64]) -> Option<Self> {
        let xyz = Xyz::of_reflectance(wavelengths_nm, reflectances)?;
        let (hex, clipped) = xyz.to_linear_rgb().on_screen();
        Some(Self { hex, lab: xyz.to_lab(), clipped, extended: !covers_visible(wavelengths_nm) })
    }
}

impl LinearRgb {
    /// CIE 1931 tristimulus values; white (1, 1, 1) has `y` = 1.
    pub fn to_xyz(self) -> Xyz {
        let [x, y, z] = RGB_TO_XYZ.map(|[r, g, b]| r * self.0[0] + g * self.0[1] + b * self.0[2]);
        Xyz { x, y, z }
    }

    /// CIELAB against this space's own white, so that equal channels are grey. (Its white and that of
    /// [`Xyz::of_reflectance`]'s sums differ by 3e-4.)
    pub fn to_lab(self) -> Lab {
        self.to_xyz().lab_against(Self([1.0; 3]).to_xyz())
    }

    /// As the web writes it, `#1a2b3c`, and whether that is only the nearest in each channel, since a screen cannot show
    /// the colour itself.
    pub fn on_screen(self) -> (String, bool) {
        let [red, green, blue] = self.bytes();
        let is_cut = self.0.iter().any(|channel| !(0.0..=255.0).contains(&(encode(*channel) * 255.0).round()));
        (format!("#{red:02x}{green:02x}{blue:02x}"), is_cut)
    }

    /// The nearest byte of each channel as a screen takes it.
    pub fn bytes(self) -> [u8; 3] {
        self.0.map(|channel| screen_byte(encode(channel)))
    }
}

impl Xyz {
    /// The white standard, a reflectance of 1 at all wavelengths: the sums of [`Xyz::of_reflectance`].
    pub fn white() -> Self {
        weigh(|_| 1.0)
    }

    /// Sums reflectance × D65 × observer from 380 to 780 nm at 5 nm, over the same sum of D65 × ȳ (CIE 15:2018, 7.1).
    ///
    /// The spectrum is interpolated linearly; beyond its ends the first or last value stands in, which
    /// [`covers_visible`] tells. Summing at 5 nm instead of 1 nm costs up to 4e-4 where a band is 15 nm wide.
    ///
    /// None if there are no values, or not as many as wavelengths, which rise.
    pub fn of_reflectance(wavelengths_nm: &[f64], reflectances: &[f64]) -> Option<Self> {
        if wavelengths_nm.is_empty() || wavelengths_nm.len() != reflectances.len() {
            return None;
        }
        Some(weigh(|wavelength_nm| interpolate(wavelengths_nm, reflectances, wavelength_nm)))
    }

    /// Linear Rec. 709.
    pub fn to_linear_rgb(self) -> LinearRgb {
        LinearRgb(XYZ_TO_RGB.map(|[x, y, z]| x * self.x + y * self.y + z * self.z))
    }

    /// CIELAB (CIE 15:2018, 8.2.1).
    pub fn to_lab(self) -> Lab {
        self.lab_against(Self::white())
    }

    /// Chromaticity coordinates x and y (CIE 15:2018, 7.3); None for black, which has none.
    pub fn chromaticity(self) -> Option<[f64; 2]> {
        let sum = self.x + self.y + self.z;
        (sum > 0.0).then(|| [self.x / sum, self.y / sum])
    }

    fn lab_against(self, white: Self) -> Lab {
        let [x, y, z] = [self.x / white.x, self.y / white.y, self.z / white.z].map(lab_root);
        Lab { l: 116.0 * y - 16.0, a: 500.0 * (x - y), b: 200.0 * (y - z) }
    }
}

/// From XYZ to the Rec. 709 primaries: the inverse of the matrix whose columns are the primaries (0.64, 0.33), (0.30, 0.60)
/// and (0.15, 0.06), scaled so that their sum is the white (0.3127, 0.3290) (IEC 61966-2-1, before its rounding to four
/// decimals).
const XYZ_TO_RGB: [[f64; 3]; 3] = [
    [3.240_969_941_904_521_5, -1.537_383_177_570_093_5, -0.498_610_760_293_003_3],
    [-0.969_243_636_280_879_8, 1.875_967_501_507_720_6, 0.041_555_057_407_175_61],
    [0.055_630_079_696_993_61, -0.203_976_958_888_976_57, 1.056_971_514_242_878_6],
];

/// From the Rec. 709 primaries to XYZ: the inverse of [`XYZ_TO_RGB`].
const RGB_TO_XYZ: [[f64; 3]; 3] = [
    [0.412_390_799_265_959_34, 0.357_584_339_383_878, 0.180_480_788_401_834_3],
    [0.212_639_005_871_510_27, 0.715_168_678_767_756, 0.072_192_315_360_733_71],
    [0.019_330_818_715_591_82, 0.119_194_779_794_625_99, 0.950_532_152_249_660_7],
];

/// Weights with which values of a reflectance at these wavelengths, nm and rising, sum to linear Rec. 709 under D65: those of
/// [`Xyz::of_reflectance`], each channel scaled so that white is exactly 1.
///
/// None if there are no wavelengths.
pub fn rgb_weights(wavelengths_nm: &[f64]) -> Option<[Vec<f64>; 3]> {
    let of_one = |one: usize| {
        let values: Vec<f64> = (0..wavelengths_nm.len()).map(|other| f64::from(u8::from(other == one))).collect();
        Some(Xyz::of_reflectance(wavelengths_nm, &values)?.to_linear_rgb().0)
    };
    let each = (0..wavelengths_nm.len()).map(of_one).collect::<Option<Vec<[f64; 3]>>>()?;
    let channel = |k: usize| -> Vec<f64> {
        let white: f64 = each.iter().map(|rgb| rgb[k]).sum();
        each.iter().map(|rgb| rgb[k] / white).collect()
    };
    (!each.is_empty()).then(|| [0, 1, 2].map(channel))
}

/// Wavelength in nm and chromaticity of each spectral colour from 380 to 700 nm; beyond, the chromaticity stays where it is.
pub fn spectral_locus() -> impl Iterator<Item = (f64, [f64; 2])> {
    OBSERVER_AND_D65.into_iter().enumerate().filter_map(|(index, [x, y, z, _])| {
        let nm = wavelength_nm(index);
        Xyz { x, y, z }.chromaticity().filter(|_| nm <= 700.0).map(|place| (nm, place))
    })
}

/// Whether the wavelengths reach over 380 to 780 nm, where eyes see.
pub fn covers_visible(wavelengths_nm: &[f64]) -> bool {
    let last_nm = wavelength_nm(OBSERVER_AND_D65.len() - 1);
    wavelengths_nm.first().is_some_and(|first| *first <= FIRST_NM)
        && wavelengths_nm.last().is_some_and(|last| *last >= last_nm)
}

/// Linear light as a screen's code, 0 to 1 (IEC 61966-2-1). Light outside 0 to 1 stays outside.
pub fn encode(linear: f64) -> f64 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// A screen's code as linear light, the inverse of [`encode`]. Codes outside 0 to 1 stay outside.
pub fn decode(code: f64) -> f64 {
    if code <= 12.92 * 0.003_130_8 { code / 12.92 } else { ((code + 0.055) / 1.055).powf(2.4) }
}

fn weigh(reflectance: impl Fn(f64) -> f64) -> Xyz {
    let (mut sum, mut white_y) = ([0.0; 3], 0.0);
    for (index, [x_bar, y_bar, z_bar, power]) in OBSERVER_AND_D65.into_iter().enumerate() {
        let light = power * reflectance(wavelength_nm(index));
        sum[0] += light * x_bar;
        sum[1] += light * y_bar;
        sum[2] += light * z_bar;
        white_y += power * y_bar;
    }
    let [x, y, z] = sum.map(|part| part / white_y);
    Xyz { x, y, z }
}

#[expect(clippy::cast_precision_loss, reason = "an index below 81")]
fn wavelength_nm(index: usize) -> f64 {
    FIRST_NM + STEP_NM * index as f64
}

/// Linear between neighbours, constant beyond the ends.
fn interpolate(wavelengths_nm: &[f64], values: &[f64], wavelength_nm: f64) -> f64 {
    let above = wavelengths_nm.partition_point(|&known| known < wavelength_nm);
    if above == 0 {
        return values[0];
    }
    if above == values.len() {
        return values[above - 1];
    }
    let (left, right) = (wavelengths_nm[above - 1], wavelengths_nm[above]);
    let share = (wavelength_nm - left) / (right - left);
    values[above - 1] * (1.0 - share) + values[above] * share
}

/// The cube root, continued by its tangent at (6/29)³ so that black has a finite slope.
fn lab_root(ratio: f64) -> f64 {
    const KNEE: f64 = 6.0 / 29.0;
    if ratio > KNEE * KNEE * KNEE { ratio.cbrt() } else { ratio / (3.0 * KNEE * KNEE) + 4.0 / 29.0 }
}

/// The byte nearest to a screen's code from 0 to 1; codes beyond are cut.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a whole number from 0 to 255")]
pub(crate) fn screen_byte(code: f64) -> u8 {
    (255.0 * code.clamp(0.0, 1.0)).round() as u8
}
