//! An absorber as a job types it.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// One absorber of a feather. Its parameters are named after it: `<name>.amount`, and for bands `<name>.shift_…` and
/// `<name>.width`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum PigmentDesign {
    /// Eumelanin as a power law of wavelength, λ^−3.33, 1 at 500 nm (Donner and Jensen 2006).
    Eumelanin {
        /// Name, `eumelanin` where left out.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        name: Option<String>,
    },
    /// Pheomelanin as a power law of wavelength, λ^−4.75, 1 at 500 nm (Donner and Jensen 2006).
    Pheomelanin {
        /// Name, `pheomelanin` where left out.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        name: Option<String>,
    },
    /// Eumelanin in three channels: the customary vector of human hair in linear RGB (d'Eon et al. 2011). The longest of the
    /// three wavelengths is red, the shortest blue.
    EumelaninRgb {
        /// Name, `eumelanin` where left out.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        name: Option<String>,
    },
    /// Pheomelanin in three channels, likewise.
    PheomelaninRgb {
        /// Name, `pheomelanin` where left out.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        name: Option<String>,
    },
    /// A carotenoid: the three fingers of β-carotene, about 1 at their top, which a fit may shift and widen together.
    Carotenoid {
        /// Name, `carotenoid` where left out.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        name: Option<String>,
    },
    /// A sum of Gaussian bands over wavelength, which a fit may shift and widen together: a description, not a substance.
    Bands {
        /// Name. Letters, digits, underscores.
        name: String,
        /// The bands.
        bands: Vec<BandDesign>,
    },
    /// A measured spectrum in a file with one row a wavelength, in any unit of absorption: `amount` is its factor.
    Table {
        /// Name. Letters, digits, underscores.
        name: String,
        /// The file, relative to the job; `$BARBULE_DATA/` at its start stands for the folder that the environment variable
        /// names.
        file: PathBuf,
        /// Column of the wavelengths in nm, rising or falling.
        wavelength: String,
        /// Column of the absorption, 0 or more.
        absorption: String,
        /// What the file holds, once it has been read: (wavelength in nm, absorption).
        #[serde(skip)]
        rows: Vec<(f64, f64)>,
    },
    /// The absorption behind a colour, in three channels of a fibre. The longest wavelength is red, the shortest blue; an
    /// `amount` of 1 is that colour.
    Colour {
        /// Name, `colour` where left out.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        name: Option<String>,
        /// Red, green and blue in linear light, above 0 and at most 1.
        colour: [f64; 3],
        /// How the absorption is found.
        by: ColourRule,
        /// Roughness around the fibre, for `chiang`; 0.3 where left out.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        beta_n: Option<f64>,
        /// Refractive index of the fibre, for `albedo`; 1.55 where left out.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        eta: Option<f64>,
    },
}

/// From a colour to an absorption.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ColourRule {
    /// The fit of Chiang et al. 2016, for light that has passed many fibres of a dense coat.
    Chiang,
    /// The exact inverse of one fibre's albedo, seen and lit across it.
    Albedo,
}

/// A Gaussian band over wavelength.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BandDesign {
    /// Centre, nm.
    pub peak_nm: f64,
    /// Standard deviation, nm; the full width at half maximum is 2.355 times as much.
    pub width_nm: f64,
    /// Absorption at the centre for an amount of 1.
    #[serde(default = "one")]
    pub height: f64,
}

fn one() -> f64 {
    1.0
}

impl PigmentDesign {
    /// The name that its parameters carry.
    pub fn name(&self) -> &str {
        let (name, usual) = match self {
            Self::Eumelanin { name } | Self::EumelaninRgb { name } => (name, "eumelanin"),
            Self::Pheomelanin { name } | Self::PheomelaninRgb { name } => (name, "pheomelanin"),
            Self::Carotenoid { name } => (name, "carotenoid"),
            Self::Colour { name, .. } => (name, "colour"),
            Self::Bands { name, .. } | Self::Table { name, .. } => return name,
        };
        name.as_deref().unwrap_or(usual)
    }
}
