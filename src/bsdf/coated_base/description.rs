//! The model in words, for the methods section of a paper.

use super::base::BaseKind;
use super::design::{Design, DesignEntry, DesignLayer, MaterialChoice, OwnMaterial};
use super::{CoatedBase, VariableMaterial};
use crate::optics::{Dispersion, KnownMaterial, MaterialNote, Reference, known_material};

/// A model in words.
#[derive(Debug, Clone, PartialEq)]
pub struct Description {
    /// Complete sentences for a methods section.
    pub text: String,
    /// Materials used, each once, with their source.
    pub materials: Vec<MaterialNote>,
    /// Works to cite.
    pub references: Vec<Reference>,
}

impl CoatedBase {
    /// The model in words: layers from the outside in, materials with their source, and the works to cite. Thicknesses
    /// are those of the design, where a fit starts.
    pub fn describe(&self) -> Description {
        let mut references = vec![
            Reference::new("Yeh 1988", "Yeh, P. (1988). Optical Waves in Layered Media. Wiley, New York."),
            Reference::new(
                "Walter 2007",
                "Walter, B., Marschner, S. R., Li, H. and Torrance, K. E. (2007). Microfacet models for refraction through \
                 rough surfaces. Eurographics Symposium on Rendering, 195–206.",
            ),
        ];
        for reference in self.materials.iter().filter_map(|material| known(material)?.reference()) {
            if !references.contains(&reference) {
                references.push(reference);
            }
        }
        Description {
            text: model_text(&self.design, self.base.kind()),
            materials: self.materials.iter().map(|material| self.material_note(material)).collect(),
            references,
        }
    }

    fn material_note(&self, material: &VariableMaterial) -> MaterialNote {
        let formula = formula(&material.dispersion);
        let text = match known(material) {
            Some(known) => {
                let (from, to) = known.range_nm;
                let beyond = self.wavelengths_nm.iter().any(|wavelength| !(from..=to).contains(wavelength));
                let extrapolated = if beyond { "; used here beyond it, an extrapolation" } else { "" };
                format!(
                    "{formula}. Source: {}. Known from {from} to {to} nm{extrapolated}. {}",
                    known.source,
                    known.certainty_text()
                )
            }
            None => format!("{formula}, as given in the job."),
        };
        MaterialNote { name: material.name.clone(), text }
    }
}

/// The known material that this is; a user's own may bear the same name.
fn known(material: &VariableMaterial) -> Option<&'static KnownMaterial> {
    known_material(&material.name).ok().filter(|known| known.dispersion == material.dispersion)
}

fn model_text(design: &Design, base: BaseKind) -> String {
    let optics = match design.layers.as_slice() {
        [] => "that of a plain interface (Fresnel), without a film",
        [DesignEntry::Layer(_)] => {
            "that of a single film, the sum over all internal reflections with their phases (Yeh 1988)"
        }
        _ => "that of a stack of layers by the transfer-matrix method (Yeh 1988)",
    };
    let surrounding = design.clear_coat.map_or_else(
        || "The layers lie in air.".to_owned(),
        |index| {
            format!(
                "The layers lie under a clear coat of refractive index {index}, into which directions are refracted first; \
                 the gloss of the coat itself is left out."
            )
        },
    );
    let entries: Vec<String> = design.layers.iter().map(entry_text).collect();
    let substrate = material_name(&design.substrate);
    let order = if entries.is_empty() {
        format!("The surface is {substrate}.")
    } else {
        format!("From the outside in: {}, on {substrate}.", entries.join(", "))
    };
    let diffuse = match base {
        BaseKind::Below => {
            "over a Lambertian base below the substrate's surface, which receives what neither the facets reflect nor the \
             layers absorb and between which and the layers light is summed over all bounces"
        }
        BaseKind::Beside => "beside a Lambertian share of the light that does not meet them",
    };
    format!(
        "The surface is a multitude of microfacets with Gaussian slopes (Beckmann) that shadow each other (Smith; Walter \
         2007), {diffuse}. Each facet reflects unpolarised light; its reflectance is {optics}. {order} {surrounding}"
    )
}

fn entry_text(entry: &DesignEntry) -> String {
    match entry {
        DesignEntry::Layer(layer) => layer_text(layer),
        DesignEntry::Period(period) => {
            let layers: Vec<String> = period.period.iter().map(layer_text).collect();
            format!("{} times ({})", period.count, layers.join(", "))
        }
    }
}

fn layer_text(layer: &DesignLayer) -> String {
    let material = material_name(&layer.material);
    // A layer that is called after its material is named once.
    let of_material = if layer.name == material { String::new() } else { format!(" of {material}") };
    format!("{}{of_material} (nominally {} nm)", layer.name, layer.thickness_nm)
}

fn material_name(choice: &MaterialChoice) -> &str {
    match choice {
        MaterialChoice::Known(name) => known_material(name).map_or(name, |known| known.name),
        MaterialChoice::Own(OwnMaterial { name, .. }) => name,
    }
}

fn formula(dispersion: &Dispersion) -> String {
    match dispersion {
        Dispersion::Constant { index, extinction } if *extinction > 0.0 => format!("n = {index}, k = {extinction}"),
        Dispersion::Constant { index, .. } => format!("n = {index}, clear"),
        Dispersion::Cauchy { a, b_nm2, extinction_c, extinction_length_nm } if *extinction_c > 0.0 => {
            format!("n = {a} + {b_nm2}/λ², k = {extinction_c} exp(−λ/{extinction_length_nm}) (λ in nm)")
        }
        Dispersion::Cauchy { a, b_nm2, .. } => format!("n = {a} + {b_nm2}/λ² (λ in nm), clear"),
        Dispersion::Table(table) => {
            let (from, to) = table.range_nm();
            format!("n and k by linear interpolation in a table of {} rows from {from} to {to} nm", table.row_count())
        }
    }
}
