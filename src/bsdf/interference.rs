//! The phase term that two models of the second thesis share: `f_Φ = 2 cos(2Φ) √(f_r f_t)`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::optics::elementary::sin_cos;

/// How light from the outer surface and light from below it interfere.
///
/// A thickness of 0 is not "off": there cos(2Φ) is 1 and the term is at its largest.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Interference {
    /// By the film's thickness.
    #[default]
    Film,
    /// Not at all.
    Off,
    /// cos(2Φ) = 1 everywhere: the upper bound of whatever a film can do.
    Constructive,
    /// cos(2Φ) = −1 everywhere: the lower bound.
    Destructive,
}

impl Interference {
    /// cos(2Φ), or what stands for it; 0 where there is no interference.
    #[inline(always)]
    pub(super) fn cosine(self, double_phase: f64) -> f64 {
        match self {
            Self::Film => sin_cos(double_phase).1,
            Self::Off => 0.0,
            Self::Constructive => 1.0,
            Self::Destructive => -1.0,
        }
    }
}
