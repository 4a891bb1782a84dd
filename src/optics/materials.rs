//! The materials that are known by name.

use super::{Dispersion, MaterialError, Reference};
use crate::nearest::nearest;

/// How well a material's numbers are known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Certainty {
    /// True by definition or to more digits than matter.
    Exact,
    /// Read in the abstract of the paper that measured it.
    Verified,
    /// Read in code or tables that cite the paper, not in the paper itself.
    Secondary,
}

/// A material known by name.
#[derive(Debug, Clone, PartialEq)]
pub struct KnownMaterial {
    /// The name in jobs and results.
    pub name: &'static str,
    /// Other names that are understood.
    pub aliases: &'static [&'static str],
    /// n and k over wavelength.
    pub dispersion: Dispersion,
    /// Wavelengths, nm, for which the source gives values; elsewhere the formula is an extrapolation.
    pub range_nm: (f64, f64),
    /// Where the numbers come from, as a phrase.
    pub source: &'static str,
    /// How well they are known.
    pub certainty: Certainty,
    /// Key and full citation.
    pub reference: Option<(&'static str, &'static str)>,
}

impl KnownMaterial {
    /// The work to cite.
    pub fn reference(&self) -> Option<Reference> {
        self.reference.map(|(key, citation)| Reference::new(key, citation))
    }

    /// How well the numbers are known, as a sentence.
    pub fn certainty_text(&self) -> &'static str {
        match self.certainty {
            Certainty::Exact => "Exact for this purpose.",
            Certainty::Verified => "Verified in the abstract of the source paper.",
            Certainty::Secondary => {
                "Secondary: read in published code and tables that cite the source, not in the paper itself, so fit or \
                 vary it before resting a conclusion on it."
            }
        }
    }
}

const LEERTOUWER_2011: (&str, &str) = (
    "Leertouwer 2011",
    "Leertouwer, H. L., Wilts, B. D. and Stavenga, D. G. (2011). Refractive index and dispersion of butterfly chitin and \
     bird keratin measured by polarizing interference microscopy. Optics Express 19, 24061–24066.",
);

const STAVENGA_2015: (&str, &str) = (
    "Stavenga 2015",
    "Stavenga, D. G., Leertouwer, H. L., Osorio, D. C. and Wilts, B. D. (2015). High refractive index of melanin in shiny \
     occipital feathers of a bird of paradise. Light: Science & Applications 4, e243.",
);

/// Every material known by name.
pub fn known_materials() -> &'static [KnownMaterial] {
    &KNOWN
}

static KNOWN: [KnownMaterial; 5] = [
    KnownMaterial {
        name: "keratin",
        aliases: &["feather_keratin"],
        dispersion: Dispersion::Cauchy { a: 1.532, b_nm2: 5890.0, extinction_c: 0.0, extinction_length_nm: 1.0 },
        range_nm: (400.0, 600.0),
        source: "barbs of white goose feathers, by interference microscopy",
        certainty: Certainty::Verified,
        reference: Some(LEERTOUWER_2011),
    },
    KnownMaterial {
        name: "bird_melanin",
        aliases: &["melanin"],
        dispersion: Dispersion::Cauchy { a: 1.648, b_nm2: 23_700.0, extinction_c: 0.56, extinction_length_nm: 270.0 },
        range_nm: (400.0, 700.0),
        source: "feathers of a bird of paradise; the abstract gives only n = 1.7 to 1.8 in the visible, the formulas are \
                 those of public renderers of feathers",
        certainty: Certainty::Secondary,
        reference: Some(STAVENGA_2015),
    },
    KnownMaterial {
        name: "chitin",
        aliases: &["insect_chitin"],
        dispersion: Dispersion::Cauchy { a: 1.517, b_nm2: 8800.0, extinction_c: 0.0, extinction_length_nm: 1.0 },
        range_nm: (400.0, 600.0),
        source: "glass scales of a butterfly, by interference microscopy",
        certainty: Certainty::Verified,
        reference: Some(LEERTOUWER_2011),
    },
    KnownMaterial {
        name: "insect_melanin",
        aliases: &[],
        dispersion: Dispersion::Cauchy { a: 1.56, b_nm2: 36_000.0, extinction_c: 1.62, extinction_length_nm: 142.0 },
        range_nm: (300.0, 1000.0),
        source: "damselfly and beetle melanin of Stavenga and co-workers, by the table melanin.nk of the R package modelR",
        certainty: Certainty::Secondary,
        reference: Some((
            "modelR",
            "Eliason, C. M. modelR, an R package for optical models of feathers, table melanin.nk (300 to 1000 nm).",
        )),
    },
    KnownMaterial {
        name: "air",
        aliases: &[],
        dispersion: Dispersion::Constant { index: 1.0, extinction: 0.0 },
        range_nm: (200.0, 2000.0),
        source: "index 1; the true 1.0003 makes no difference here",
        certainty: Certainty::Exact,
        reference: None,
    },
];

/// The material of this name. Capitals, spaces and hyphens do not matter.
///
/// # Errors
/// [`MaterialError::Unknown`] lists the known names and suggests the nearest.
pub fn known_material(name: &str) -> Result<&'static KnownMaterial, MaterialError> {
    let wanted = name.trim().to_lowercase().replace([' ', '-'], "_");
    KNOWN.iter().find(|material| names(material).any(|known| known == wanted)).ok_or_else(|| {
        let meant = nearest(&wanted, KNOWN.iter().flat_map(names));
        MaterialError::Unknown {
            found: name.to_owned(),
            known: KNOWN.iter().map(|material| material.name).collect::<Vec<_>>().join(", "),
            suggestion: meant.map_or_else(String::new, |name| format!("; did you mean {name:?}?")),
        }
    })
}

fn names(material: &'static KnownMaterial) -> impl Iterator<Item = &'static str> {
    std::iter::once(material.name).chain(material.aliases.iter().copied())
}
