//! A diffuse base under a thin clear film whose two surfaces need not be parallel (Granier and Heidrich 2003; the
//! second thesis, sections 2.4 and 3.1).
//!
//! ```text
//! f   = w_s (f_r + f_t + f_Φ) + w_d f_d
//! f_r = F(ωi·n0) (ω_ri·ωo)^e0                                      ω_ri  = −ωi + 2 (ωi·n0) n0
//! f_t = (1 − F(ωi·n0)) (ω_rti·(−ω_to))^e1 (1 − F(|ω_to·n0|))       ω_rti = ω_ti − 2 (ω_ti·n1) n1
//! f_Φ = 2 cos(2Φ) √(f_r f_t)                                       Φ = (π η d/λ) ([ω_ti + ω_to]·(−n0))
//! f_d = 1 + 2 cos(4π η d/λ) √(T_d (1 − T_d))                       T_d = (80/21) η/(1 + η)²
//! ```
//!
//! n0 is the film's outer normal, n1 that of its inner surface. `ω_ti` and `ω_to` are ωi and ωo refracted at n0 and
//! point into the film: `ω_ti = −ωi/η + ((ωi·n0)/η − cosθ_ti) n0`, `cosθ_ti = √(1 − (1 − (ωi·n0)²)/η²)`. F is Schlick's
//! f + (1 − f)(1 − c)⁵ with f = ((1 − η)/(1 + η))². Equations 2.23 to 2.35, 3.3 and 3.4 with their misprints mended;
//! the medium outside has index 1. Cosines of the lobes at or below 0 give no light, and so does `f_s` where ωi or ωo
//! lies behind n0. 0 where either direction is below the horizon of the shading normal, z.
//!
//! | parameter | symbol | unit | default | range |
//! | --- | --- | --- | --- | --- |
//! | `thickness_nm` | d | nm | 330 | 0 to 5000 |
//! | `outer_exponent` | e0 | | 130 | 0 to 1e4 |
//! | `inner_exponent` | e1 | | 130 | 0 to 1e4 |
//! | `eta`, shared or per channel | η | | 1.56 (keratin) | 1.05 to 3 |
//! | `specular`, shared or per channel | `w_s` | 1/sr as printed | 1 | 0 to 1 |
//! | `diffuse`, shared or per channel | `w_d` | 1/sr as printed | 0.1 | 0 to 1 |
//! | `outer_tilt_deg`, `outer_azimuth_deg` of a `spherical` n0 | | ° | 0, 0 | 0 to 80, −360 to 360 |
//! | `inner_tilt_deg`, `inner_azimuth_deg` of a `spherical` n1 | | ° | 0, 0 | 0 to 80, −360 to 360 |
//!
//! A `mapped` normal and a texture of thicknesses come with each point of the surface, see [`GranierHeidrich::at`].
//!
//! **Not reciprocal, and energy is not conserved.** As printed the weights carry the 1/sr: `f_d = 1` is an albedo of
//! `π w_d`, and the lobes are not normalised. `normalised` divides `f_d` by π and multiplies the lobes by (e + 2)/2π,
//! which makes each of them 1 at normal incidence. Largest directional albedo over inclinations of the light from 0 to
//! 89°, at unit weights, parallel surfaces and η 1.5, with the cosines of both phases equal to 1 and to −1:
//!
//! | e0 = e1 | printed, 1 | printed, −1 | normalised, 1 | normalised, −1 |
//! | --- | --- | --- | --- | --- |
//! | 0 | 9.34 | 3.33 | 2.97 | 1.06 |
//! | 10 | 6.24 | 2.19 | 4.13 | 1.98 |
//! | 130 | 5.03 | 1.46 | 4.20 | 2.02 |
//!
//! Where energy counts, use [`super::CoatedBase`]. Left out besides: masking, absorption, light that goes round in the
//! film more than once, polarisation.

mod sampling;

use std::f64::consts::{FRAC_1_PI, PI};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::channel_parameters::{ChannelParameter, Declarations};
use super::interference::Interference;
use super::iridescent_plastic::thickness_nm;
use super::rough_plastic;
use super::{Bsdf, Direction, Model, ModelError, Sample};
use crate::parameter::{Parameter, Spread};

/// Where a normal of the film comes from.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum NormalSource {
    /// The same everywhere, of any length, in the local frame; its third number is positive.
    Fixed([f64; 3]),
    /// The same everywhere, by two parameters: tilt against the shading normal and azimuth from the tangent, degrees.
    Spherical,
    /// From a normal map: it comes with each point, and is the shading normal where no point is given.
    Mapped,
}

impl Default for NormalSource {
    fn default() -> Self {
        Self::Fixed([0.0, 0.0, 1.0])
    }
}

/// A Granier–Heidrich film as typed in a job.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct GranierHeidrichDesign {
    /// The film's outer normal, n0.
    pub outer_normal: NormalSource,
    /// The normal of the film's inner surface, n1.
    pub inner_normal: NormalSource,
    /// Whether the lobes and the diffuse part are normalised; as printed they are not.
    pub normalised: bool,
    /// The phase term.
    pub interference: Interference,
    /// Parameters that have one value in each channel: `eta`, `specular`, `diffuse`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub per_channel: Vec<String>,
}

/// What a texture says of one point of the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Site {
    /// n0 of the point, a unit vector in the local frame; read where the outer normal is `mapped`.
    pub outer_normal: Direction,
    /// n1 of the point; read where the inner normal is `mapped`.
    pub inner_normal: Direction,
    /// What `thickness_nm` is multiplied by: a grey texture from 0 to 1, or 1.
    pub thickness_scale: f64,
}

impl Default for Site {
    fn default() -> Self {
        Self { outer_normal: Direction::z(), inner_normal: Direction::z(), thickness_scale: 1.0 }
    }
}

/// The normal that a colour of a normal map stands for: (x, y, z) = 2 (r, g, b) − 1 with colours from 0 to 1, brought
/// to length 1. None where it does not point out of the surface.
pub fn normal_from_rgb(rgb: [f64; 3]) -> Option<Direction> {
    unit_normal(rgb.map(|colour| 2.0 * colour - 1.0))
}

/// A vector brought to length 1; None where it does not point out of the surface.
fn unit_normal([x, y, z]: [f64; 3]) -> Option<Direction> {
    let vector = Direction::new(x, y, z);
    (z > 0.0 && vector.norm().is_finite()).then(|| vector.normalize())
}

/// A normal, or the positions of its two angles.
#[derive(Debug, Clone, Copy)]
enum Normal {
    Fixed(Direction),
    Spherical { tilt: usize, azimuth: usize },
    Mapped,
}

impl Normal {
    fn declare(
        source: NormalSource,
        what: &'static str,
        surface: &str,
        declarations: &mut Declarations<'_>,
    ) -> Result<Self, ModelError> {
        match source {
            NormalSource::Fixed(found) => {
                unit_normal(found).map(Self::Fixed).ok_or(ModelError::NotADirection { what, found })
            }
            NormalSource::Mapped => Ok(Self::Mapped),
            NormalSource::Spherical => {
                let angle = |name: &str, symbol: &str, lower, upper, text: &str| Parameter {
                    name: format!("{surface}_{name}_deg"),
                    symbol: format!("{symbol} {surface}"),
                    unit: "°",
                    default: 0.0,
                    lower,
                    upper,
                    spread: Spread::Linear,
                    scan_step: None,
                    text: format!("{text} the film's {surface} surface"),
                };
                Ok(Self::Spherical {
                    tilt: declarations.number(angle("tilt", "θ", 0.0, 80.0, "tilt of")),
                    azimuth: declarations.number(angle("azimuth", "φ", -360.0, 360.0, "azimuth of the tilt of")),
                })
            }
        }
    }

    fn at(self, values: &[f64], mapped: Direction) -> Direction {
        match self {
            Self::Fixed(normal) => normal,
            Self::Mapped => mapped,
            Self::Spherical { tilt, azimuth } => {
                let (sin_tilt, cos_tilt) = values[tilt].to_radians().sin_cos();
                let (sin_azimuth, cos_azimuth) = values[azimuth].to_radians().sin_cos();
                Direction::new(sin_tilt * cos_azimuth, sin_tilt * sin_azimuth, cos_tilt)
            }
        }
    }
}

/// A Granier–Heidrich film for a list of wavelengths.
#[derive(Debug, Clone)]
pub struct GranierHeidrich {
    design: GranierHeidrichDesign,
    parameters: Vec<Parameter>,
    thickness_nm: usize,
    outer_exponent: usize,
    inner_exponent: usize,
    eta: ChannelParameter,
    specular: ChannelParameter,
    diffuse: ChannelParameter,
    outer_normal: Normal,
    inner_normal: Normal,
    wavelengths_nm: Vec<f64>,
}

impl GranierHeidrich {
    /// The model at these wavelengths (nm, one a channel).
    ///
    /// # Errors
    /// No wavelengths, senseless ones, a fixed normal that does not point out of the surface, or a wrong name in
    /// `per_channel`.
    pub fn new(design: &GranierHeidrichDesign, wavelengths_nm: &[f64]) -> Result<Self, ModelError> {
        let mut declarations = Declarations::new(wavelengths_nm, &design.per_channel)?;
        let thickness_nm = declarations.number(thickness_nm(wavelengths_nm));
        let outer_exponent = declarations.number(exponent("outer", "e0"));
        let inner_exponent = declarations.number(exponent("inner", "e1"));
        let eta = declarations.spectral(Parameter { upper: 3.0, ..rough_plastic::eta() });
        let specular = declarations.spectral(rough_plastic::specular());
        let diffuse = declarations.spectral(Parameter { default: 0.1, ..rough_plastic::diffuse() });
        let outer_normal = Normal::declare(design.outer_normal, "`outer_normal`", "outer", &mut declarations)?;
        let inner_normal = Normal::declare(design.inner_normal, "`inner_normal`", "inner", &mut declarations)?;
        Ok(Self {
            design: design.clone(),
            parameters: declarations.finish()?,
            thickness_nm,
            outer_exponent,
            inner_exponent,
            eta,
            specular,
            diffuse,
            outer_normal,
            inner_normal,
            wavelengths_nm: wavelengths_nm.to_vec(),
        })
    }

    /// The model bound to parameter values, at a point of which a texture says more.
    ///
    /// [`Model::bind`] is this at a point with both mapped normals along the shading normal and a thickness scale of 1.
    pub fn at(&self, values: &[f64], site: &Site) -> impl Bsdf + std::fmt::Debug + use<> {
        let outer_exponent = values[self.outer_exponent];
        let inner_exponent = values[self.inner_exponent];
        let thickness_nm = values[self.thickness_nm] * site.thickness_scale;
        // The lobes' normalisations and that of the diffuse part.
        let (outer_scale, inner_scale, diffuse_scale) = if self.design.normalised {
            (0.5 * FRAC_1_PI * (outer_exponent + 2.0), 0.5 * FRAC_1_PI * (inner_exponent + 2.0), FRAC_1_PI)
        } else {
            (1.0, 1.0, 1.0)
        };
        let channel = |(channel, &wavelength_nm): (usize, &f64)| {
            let eta = self.eta.value(values, channel);
            let turn = 2.0 * PI * eta * thickness_nm / wavelength_nm;
            let passed = 80.0 / 21.0 * eta / ((1.0 + eta) * (1.0 + eta));
            let diffuse = 1.0 + 2.0 * self.design.interference.cosine(2.0 * turn) * (passed * (1.0 - passed)).sqrt();
            Channel {
                inverse_eta: 1.0 / eta,
                normal_reflectance: ((1.0 - eta) / (1.0 + eta)).powi(2),
                specular: self.specular.value(values, channel),
                diffuse: self.diffuse.value(values, channel) * diffuse_scale * diffuse,
                double_phase: turn,
            }
        };
        BoundGranierHeidrich {
            interference: self.design.interference,
            outer_normal: self.outer_normal.at(values, site.outer_normal),
            inner_normal: self.inner_normal.at(values, site.inner_normal),
            outer_exponent,
            inner_exponent,
            outer_scale,
            inner_scale,
            channels: self.wavelengths_nm.iter().enumerate().map(channel).collect(),
        }
    }
}

fn exponent(surface: &str, symbol: &str) -> Parameter {
    Parameter {
        name: format!("{surface}_exponent"),
        symbol: symbol.to_owned(),
        unit: "",
        default: 130.0,
        lower: 0.0,
        upper: 1e4,
        spread: Spread::Linear,
        scan_step: None,
        text: format!("exponent of the lobe of the film's {surface} surface; the higher, the glossier"),
    }
}

impl Model for GranierHeidrich {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn channel_count(&self) -> usize {
        self.wavelengths_nm.len()
    }

    fn bind(&self, values: &[f64]) -> Box<dyn Bsdf + '_> {
        Box::new(self.at(values, &Site::default()))
    }
}

/// The film with its parameters given, at one point.
#[derive(Debug)]
struct BoundGranierHeidrich {
    interference: Interference,
    outer_normal: Direction,
    inner_normal: Direction,
    outer_exponent: f64,
    inner_exponent: f64,
    /// What each lobe is multiplied by.
    outer_scale: f64,
    inner_scale: f64,
    channels: Vec<Channel>,
}

/// One channel of it.
#[derive(Debug, Clone, Copy)]
struct Channel {
    inverse_eta: f64,
    /// f, Schlick's reflectance along the normal.
    normal_reflectance: f64,
    /// `w_s`.
    specular: f64,
    /// `w_d f_d`.
    diffuse: f64,
    /// 2Φ per unit of `[ω_ti + ω_to]·(−n0)`.
    double_phase: f64,
}

impl Bsdf for BoundGranierHeidrich {
    fn evaluate(&self, incoming: &Direction, outgoing: &Direction, values: &mut [f64]) {
        if incoming.z <= 0.0 || outgoing.z <= 0.0 {
            values.fill(0.0);
            return;
        }
        let (n0, n1) = (&self.outer_normal, &self.inner_normal);
        let (cos_i, cos_o) = (incoming.dot(n0), outgoing.dot(n0));
        if cos_i <= 0.0 || cos_o <= 0.0 {
            // The film is seen or lit from behind.
            for (value, channel) in values.iter_mut().zip(&self.channels) {
                *value = channel.diffuse;
            }
            return;
        }
        // All that the channels share: scalar products in air, and the outer lobe.
        let between = incoming.dot(outgoing);
        let (inner_i, inner_o, normals) = (incoming.dot(n1), outgoing.dot(n1), n0.dot(n1));
        let outer_lobe = self.outer_scale * phong(2.0 * cos_i * cos_o - between, self.outer_exponent);
        for (value, channel) in values.iter_mut().zip(&self.channels) {
            let a = channel.inverse_eta;
            let inside = |cosine: f64| (1.0 - (1.0 - cosine * cosine).max(0.0) * a * a).sqrt();
            let (cos_ti, cos_to) = (inside(cos_i), inside(cos_o));
            // ω_ti = −a ωi + b_i n0, ω_to likewise, and their products with each other and with n1.
            let (b_i, b_o) = (a * cos_i - cos_ti, a * cos_o - cos_to);
            let product = a * a * between - a * (b_o * cos_i + b_i * cos_o) + b_i * b_o;
            let (along_i, along_o) = (b_i * normals - a * inner_i, b_o * normals - a * inner_o);
            let inner_cosine = 2.0 * along_i * along_o - product;

            let entered = 1.0 - schlick(channel.normal_reflectance, cos_i);
            let left = 1.0 - schlick(channel.normal_reflectance, cos_to);
            let reflected = (1.0 - entered) * outer_lobe;
            let transmitted = entered * left * self.inner_scale * phong(inner_cosine, self.inner_exponent);
            let phase = self.interference.cosine(channel.double_phase * (cos_ti + cos_to));
            let film = reflected + transmitted + 2.0 * phase * (reflected * transmitted).sqrt();
            *value = channel.specular * film + channel.diffuse;
        }
    }

    fn sample(&self, outgoing: &Direction, random: [f64; 3]) -> Option<Sample> {
        sampling::sample(self, outgoing, random)
    }

    fn density(&self, incoming: &Direction, outgoing: &Direction) -> f64 {
        sampling::density(self, incoming, outgoing)
    }
}

/// Schlick's reflectance (1994).
#[inline]
fn schlick(normal_reflectance: f64, cosine: f64) -> f64 {
    let missing = (1.0 - cosine).max(0.0);
    let squared = missing * missing;
    normal_reflectance + (1.0 - normal_reflectance) * squared * squared * missing
}

/// Phong's lobe, empty behind its own horizon.
#[inline]
fn phong(cosine: f64, exponent: f64) -> f64 {
    if cosine > 0.0 { cosine.powf(exponent) } else { 0.0 }
}
