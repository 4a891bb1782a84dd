//! A coated base as it is typed in a job.

use std::fmt;

use schemars::JsonSchema;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Error, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

use crate::bsdf::ModelError;
use crate::optics::{Dispersion, IndexTable, known_material};

/// Layers on a substrate, as typed in a job. Without layers it is a plain interface, the control that a film is
/// compared with.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Design {
    /// Layers and periods of layers, from the outside in.
    #[serde(default)]
    pub layers: Vec<DesignEntry>,
    /// What lies below the last layer, without end. A clear one holds a diffuse base, `diffuse_albedo`; in one that
    /// absorbs nothing comes back, and there is a share that scatters beside the layers, `diffuse_share`.
    pub substrate: MaterialChoice,
    /// Refractive index, 1 to 3, of a thick clear coat over the layers: directions are refracted into it first. The gloss
    /// of the coat itself is left out. Without this key the layers lie in air.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clear_coat: Option<f64>,
    /// Wavelengths, nm, rising, between which the base's albedo or the diffuse share runs straight: a pigment. Each has a
    /// parameter `diffuse_albedo.<nm>` or `diffuse_share.<nm>`. Without this key it is grey, with one parameter.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub base_knots_nm: Vec<f64>,
}

impl Design {
    /// The same surface without its layers, a plain interface: the control that a film is compared with.
    pub fn without_layers(&self) -> Self {
        Self { layers: Vec::new(), ..self.clone() }
    }
}

/// One entry in the list of layers: a layer, or layers that repeat.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum DesignEntry {
    /// A layer.
    Layer(DesignLayer),
    /// Layers that repeat.
    Period(DesignPeriod),
}

/// A layer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DesignLayer {
    /// Name, unique in the design: its thickness is the parameter `<name>.thickness_nm`. Letters, digits, underscores.
    pub name: String,
    /// What it is made of.
    pub material: MaterialChoice,
    /// Thickness in nm, 5 to 5000: the value where a job says nothing else of the parameter.
    pub thickness_nm: f64,
}

/// Layers that repeat.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DesignPeriod {
    /// The layers of one period, from the outside in.
    pub period: Vec<DesignLayer>,
    /// How often they follow each other, 1 to 1000.
    pub count: usize,
}

/// A material: a known name (`"keratin"`), or a description of your own.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum MaterialChoice {
    /// Name of a known material: `keratin`, `bird_melanin`, `chitin`, `insect_melanin` or `air`.
    Known(String),
    /// A material of your own.
    Own(OwnMaterial),
}

/// A material of your own: a name, and one of `index`, `cauchy_a` with `cauchy_b_nm2`, or `table`.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OwnMaterial {
    /// Name: its parameters are named `<name>.…`. Letters, digits, underscores.
    pub name: String,
    /// Refractive index n, the same at every wavelength, 0.05 to 10.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub index: Option<f64>,
    /// Extinction coefficient k beside `index`, 0 to 10; 0 where left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub extinction: Option<f64>,
    /// A of n = A + B/λ² (Cauchy), 0.05 to 10.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cauchy_a: Option<f64>,
    /// B of n = A + B/λ², nm², 0 to 1,000,000.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cauchy_b_nm2: Option<f64>,
    /// c of k = c·exp(−λ/l) beside a Cauchy index, 0 to 1000; clear where left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub extinction_c: Option<f64>,
    /// l of k = c·exp(−λ/l), nm, 1 to 100,000.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub extinction_length_nm: Option<f64>,
    /// Rows of [wavelength in nm, n, k], wavelengths rising, interpolated linearly. It must reach over all wavelengths
    /// that are fitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub table: Option<Vec<[f64; 3]>>,
}

impl MaterialChoice {
    /// The canonical name and the dispersion.
    ///
    /// # Errors
    /// [`ModelError`] for an unknown name or a description that makes no sense.
    pub fn resolve(&self) -> Result<(&str, Dispersion), ModelError> {
        match self {
            Self::Known(name) => {
                let known = known_material(name)
                    .map_err(|problem| ModelError::Material { what: "material".to_owned(), problem })?;
                Ok((known.name, known.dispersion.clone()))
            }
            Self::Own(own) => Ok((&own.name, own.dispersion()?)),
        }
    }
}

impl OwnMaterial {
    /// The dispersion, checked.
    fn dispersion(&self) -> Result<Dispersion, ModelError> {
        check_name("material", &self.name)?;
        let within = |key: &str, value: f64, range: std::ops::RangeInclusive<f64>, expected: &'static str| {
            if range.contains(&value) {
                Ok(value)
            } else {
                let what = format!("`{key}` of material {:?}", self.name);
                Err(ModelError::OutOfRange { what, found: value, expected })
            }
        };
        match self {
            Self {
                index: Some(index),
                extinction,
                cauchy_a: None,
                cauchy_b_nm2: None,
                extinction_c: None,
                extinction_length_nm: None,
                table: None,
                ..
            } => Ok(Dispersion::Constant {
                index: within("index", *index, 0.05..=10.0, "0.05 to 10")?,
                extinction: within("extinction", extinction.unwrap_or(0.0), 0.0..=10.0, "0 to 10")?,
            }),
            Self {
                index: None,
                extinction: None,
                cauchy_a: Some(a),
                cauchy_b_nm2: Some(b_nm2),
                extinction_c,
                extinction_length_nm,
                table: None,
                ..
            } if extinction_c.is_some() == extinction_length_nm.is_some() => Ok(Dispersion::Cauchy {
                a: within("cauchy_a", *a, 0.05..=10.0, "0.05 to 10")?,
                b_nm2: within("cauchy_b_nm2", *b_nm2, 0.0..=1e6, "0 to 1000000 nm²")?,
                extinction_c: within("extinction_c", extinction_c.unwrap_or(0.0), 0.0..=1000.0, "0 to 1000")?,
                extinction_length_nm: within(
                    "extinction_length_nm",
                    extinction_length_nm.unwrap_or(1.0),
                    1.0..=1e5,
                    "1 to 100000 nm",
                )?,
            }),
            Self {
                index: None,
                extinction: None,
                cauchy_a: None,
                cauchy_b_nm2: None,
                extinction_c: None,
                extinction_length_nm: None,
                table: Some(rows),
                ..
            } => IndexTable::new(rows.clone())
                .map(Dispersion::Table)
                .map_err(|problem| ModelError::Material { what: format!("material {:?}", self.name), problem }),
            _ => Err(ModelError::Description { name: self.name.clone(), found: self.keys() }),
        }
    }

    /// The keys that describe the index, for a message.
    fn keys(&self) -> String {
        let keys: Vec<&str> = [
            ("`index`", self.index.is_some()),
            ("`extinction`", self.extinction.is_some()),
            ("`cauchy_a`", self.cauchy_a.is_some()),
            ("`cauchy_b_nm2`", self.cauchy_b_nm2.is_some()),
            ("`extinction_c`", self.extinction_c.is_some()),
            ("`extinction_length_nm`", self.extinction_length_nm.is_some()),
            ("`table`", self.table.is_some()),
        ]
        .into_iter()
        .filter_map(|(key, there)| there.then_some(key))
        .collect();
        if keys.is_empty() { "its name alone".to_owned() } else { keys.join(", ") }
    }
}

/// Names become parts of parameter names, which stand in expressions.
pub(in crate::bsdf) fn check_name(what: &'static str, name: &str) -> Result<(), ModelError> {
    let mut letters = name.chars();
    let fine = letters.next().is_some_and(char::is_alphabetic) && letters.all(|c| c.is_alphanumeric() || c == '_');
    if fine { Ok(()) } else { Err(ModelError::BadName { what, name: name.to_owned() }) }
}

/// By hand, since of an untagged enum serde says only that no variant matched, and not which key or name was wrong.
impl<'de> Deserialize<'de> for MaterialChoice {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct NameOrTable;

        impl<'de> Visitor<'de> for NameOrTable {
            type Value = MaterialChoice;

            fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
                formatter.write_str("the name of a known material, or a table such as { name = \"wax\", index = 1.44 }")
            }

            fn visit_str<E: Error>(self, name: &str) -> Result<Self::Value, E> {
                let known = known_material(name).map_err(E::custom)?;
                Ok(MaterialChoice::Known(known.name.to_owned()))
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
                let own = OwnMaterial::deserialize(MapAccessDeserializer::new(map))?;
                own.dispersion().map_err(A::Error::custom)?;
                Ok(MaterialChoice::Own(own))
            }
        }

        deserializer.deserialize_any(NameOrTable)
    }
}

/// By hand for the same reason.
impl<'de> Deserialize<'de> for DesignEntry {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(deny_unknown_fields)]
        struct Either {
            name: Option<String>,
            material: Option<MaterialChoice>,
            thickness_nm: Option<f64>,
            period: Option<Vec<DesignLayer>>,
            count: Option<usize>,
        }

        match Either::deserialize(deserializer)? {
            Either {
                name: Some(name),
                material: Some(material),
                thickness_nm: Some(thickness_nm),
                period: None,
                count: None,
            } => Ok(Self::Layer(DesignLayer { name, material, thickness_nm })),
            Either { name: None, material: None, thickness_nm: None, period: Some(period), count: Some(count) } => {
                Ok(Self::Period(DesignPeriod { period, count }))
            }
            Either { name, material, thickness_nm, period, count } => {
                let keys: Vec<&str> = [
                    ("`name`", name.is_some()),
                    ("`material`", material.is_some()),
                    ("`thickness_nm`", thickness_nm.is_some()),
                    ("`period`", period.is_some()),
                    ("`count`", count.is_some()),
                ]
                .into_iter()
                .filter_map(|(key, there)| there.then_some(key))
                .collect();
                let found = if keys.is_empty() { "no key".to_owned() } else { keys.join(", ") };
                Err(D::Error::custom(format!(
                    "an entry of `layers` has {found}; expected a layer with `name`, `material` and `thickness_nm`, or a \
                     period with `period` and `count`"
                )))
            }
        }
    }
}
