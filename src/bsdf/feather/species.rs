//! Barbs of flight feathers by species: 46 of them, with the source in `barbs.csv`.

use std::sync::LazyLock;

use serde::Deserialize;

use crate::bsdf::ModelError;
use crate::nearest::nearest;

/// Names that the refusal of a wrong one suggests at most.
const SUGGESTIONS: usize = 3;

/// The barbs of a species' flight feathers, means over its birds.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct BarbSpecies {
    /// Scientific name: `Columba livia`.
    #[serde(rename = "species")]
    pub name: String,
    /// Width of a barb, µm.
    #[serde(rename = "barb_width_um")]
    pub width_um: f64,
    /// Distance between neighbouring barbs, µm.
    #[serde(rename = "barb_spacing_um")]
    pub spacing_um: f64,
}

impl BarbSpecies {
    /// Every species that is known, by name.
    pub fn all() -> &'static [Self] {
        &SPECIES
    }

    /// The species of this name. Capitals do not matter, and an underscore is a space.
    ///
    /// # Errors
    /// [`ModelError::UnknownSpecies`] with the names that are near.
    pub fn named(name: &str) -> Result<&'static Self, ModelError> {
        let wanted = name.replace('_', " ").split_whitespace().collect::<Vec<_>>().join(" ");
        SPECIES.iter().find(|species| species.name.eq_ignore_ascii_case(&wanted)).ok_or_else(|| {
            let mut others: Vec<&str> = SPECIES.iter().map(|species| species.name.as_str()).collect();
            let mut near = Vec::new();
            while near.len() < SUGGESTIONS
                && let Some(name) = nearest(&wanted, others.iter().copied())
            {
                others.retain(|other| *other != name);
                near.push(name);
            }
            let meant = match near.as_slice() {
                [] => format!("the names run from {} to {}", others[0], others[others.len() - 1]),
                [only] => format!("the nearest is {only}"),
                _ => format!("the nearest are {}", near.join(", ")),
            };
            ModelError::UnknownSpecies { found: name.to_owned(), count: SPECIES.len(), meant }
        })
    }

    /// Share of the vane that barbs cover: width/(width + spacing).
    pub fn barb_share(&self) -> f64 {
        barb_share(self.width_um, self.spacing_um)
    }
}

/// Share of a vane that barbs of this width and spacing cover, both in one unit.
pub(super) fn barb_share(width: f64, spacing: f64) -> f64 {
    width / (width + spacing)
}

/// The table is part of the program, and a test counts its rows.
static SPECIES: LazyLock<Vec<BarbSpecies>> = LazyLock::new(|| {
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(include_bytes!("barbs.csv").as_slice());
    reader.deserialize().filter_map(Result::ok).collect()
});
