//! What of a reading a fit compares with the model's.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What of readings and model a fit compares.
///
/// Cube roots are for readings that span decades and whose σ nobody knows, as those of a BRDF: compared as they are, a few
/// readings near the mirror direction outweigh all others, and divided by themselves the darkest do. Both sides are
/// transformed, so that a right model stays right (Carroll and Ruppert 1984, *Power transformations when fitting theoretical
/// models to data*, JASA 79, 321–328); of the metrics that Fores, Ferwerda and Gu (2012, *Toward a perceptually based metric
/// for BRDF modeling*, Color and Imaging Conference 20, 142–148) put to observers, cube roots agreed best with them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Compared {
    /// The readings as they are.
    #[default]
    Values,
    /// Their cube roots.
    CubeRoots,
}

impl Compared {
    /// What is compared of a reading, the model's or the table's.
    pub fn of(self, reading: f64) -> f64 {
        match self {
            Self::Values => reading,
            Self::CubeRoots => reading.cbrt(),
        }
    }

    /// σ of what is compared, from that of the reading, to first order; infinite for the cube root of 0.
    pub fn sigma_of(self, reading: f64, sigma: f64) -> f64 {
        match self {
            Self::Values => sigma,
            Self::CubeRoots => sigma / (3.0 * reading.cbrt().powi(2)),
        }
    }
}
