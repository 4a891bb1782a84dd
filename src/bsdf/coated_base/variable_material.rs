//! A material of which parts can be fitted.

use crate::bsdf::ModelError;
use crate::optics::{Dispersion, Permittivity, double_wavenumbers};
use crate::parameter::{Parameter, Spread};

/// A material, and which of the model's parameters change it.
#[derive(Debug, Clone)]
pub(super) struct VariableMaterial {
    pub(super) name: String,
    pub(super) dispersion: Dispersion,
    variation: Variation,
}

/// Positions of a material's parameters in the model's list.
#[derive(Debug, Clone)]
enum Variation {
    /// Nothing about it is uncertain.
    None,
    /// n and k themselves.
    Constant { index: usize, extinction: Option<usize> },
    /// A and B of n = A + B/λ², and a factor on k.
    Cauchy { a: usize, b_nm2: usize, extinction_scale: Option<usize> },
    /// n = scale · n₀(λ) + offset, and a factor on k₀(λ).
    Correction { offset: usize, scale: usize, extinction_scale: Option<usize> },
}

impl VariableMaterial {
    /// Declares the material's parameters at the end of the list. `own` is a material that the user described: its own
    /// numbers vary; of a known one, or a table, it is the correction of the known values that varies.
    pub(super) fn declare(
        name: &str,
        dispersion: Dispersion,
        own: bool,
        wavelengths_nm: &[f64],
        parameters: &mut Vec<Parameter>,
    ) -> Result<Self, ModelError> {
        let (n, _) = dispersion
            .spectrum(wavelengths_nm)
            .map_err(|problem| ModelError::Material { what: format!("material {name:?}"), problem })?;
        let mut declare = |suffix: &str, symbol: &str, unit, default: f64, lower: f64, upper: f64, text: &str| {
            parameters.push(Parameter {
                name: format!("{name}.{suffix}"),
                symbol: format!("{symbol} {name}"),
                unit,
                default,
                // What the design says is always allowed.
                lower: default.min(lower),
                upper: default.max(upper),
                spread: Spread::Linear,
                scan_step: None,
                text: text.replace("{}", name),
            });
            parameters.len() - 1
        };
        let absorbs = dispersion.absorbs();
        let extinction_text = "factor on the extinction coefficient of {} over its whole spectrum";
        let variation = match dispersion {
            Dispersion::Constant { .. } if !own => Variation::None,
            Dispersion::Constant { index, extinction } => Variation::Constant {
                index: declare(
                    "index",
                    "n",
                    "",
                    index,
                    1.0,
                    3.0,
                    "refractive index of {}, the same at every wavelength",
                ),
                extinction: absorbs.then(|| {
                    let text = "extinction coefficient of {}, the same at every wavelength";
                    declare("extinction", "k", "", extinction, 0.0, 2.0, text)
                }),
            },
            Dispersion::Cauchy { a, b_nm2, .. } if own => Variation::Cauchy {
                a: declare("cauchy_a", "A", "", a, 1.0, 3.0, "A of the refractive index A + B/λ² of {}"),
                b_nm2: declare("cauchy_b_nm2", "B", "nm²", b_nm2, 0.0, 1e5, "B of the refractive index A + B/λ² of {}"),
                extinction_scale: absorbs
                    .then(|| declare("extinction_scale", "k/k₀", "", 1.0, 0.0, 5.0, extinction_text)),
            },
            Dispersion::Cauchy { .. } | Dispersion::Table(_) => {
                // Together with the least scale this leaves n above 0.4 of its least known value.
                let least_index = n.iter().copied().fold(f64::INFINITY, f64::min);
                let least_offset = -(0.4 * least_index).min(0.3);
                let text = "added to the refractive index of {} at every wavelength";
                Variation::Correction {
                    offset: declare("index_offset", "Δn", "", 0.0, least_offset, 0.3, text),
                    scale: declare("index_scale", "n/n₀", "", 1.0, 0.8, 1.25, "factor on the refractive index of {}"),
                    extinction_scale: absorbs
                        .then(|| declare("extinction_scale", "k/k₀", "", 1.0, 0.0, 5.0, extinction_text)),
                }
            }
        };
        Ok(Self { name: name.to_owned(), dispersion, variation })
    }
}

/// A list of wavelengths, and of each material what depends on them alone.
#[derive(Debug, Clone)]
pub(super) struct Channels {
    pub(super) double_wavenumbers: Vec<f64>,
    /// 1/λ², 1/nm².
    inverse_squares: Vec<f64>,
    /// n₀ and k₀ of each material.
    indices: Vec<(Vec<f64>, Vec<f64>)>,
}

impl Channels {
    pub(super) fn new(wavelengths_nm: &[f64], materials: &[VariableMaterial]) -> Self {
        let known = |material: &VariableMaterial| {
            wavelengths_nm.iter().map(|&w| material.dispersion.at(w)).map(|index| (index.re, index.im)).unzip()
        };
        Self {
            double_wavenumbers: double_wavenumbers(wavelengths_nm),
            inverse_squares: wavelengths_nm.iter().map(|w| 1.0 / (w * w)).collect(),
            indices: materials.iter().map(known).collect(),
        }
    }

    /// The permittivity of each material at these values of the model's parameters.
    pub(super) fn permittivities(&self, materials: &[VariableMaterial], values: &[f64]) -> Vec<Permittivity> {
        let of_one = |(material, (n, k)): (&VariableMaterial, &(Vec<f64>, Vec<f64>))| {
            let factor = |scale: Option<usize>| scale.map_or(1.0, |parameter| values[parameter]);
            match material.variation {
                Variation::None => Permittivity::new(n.iter().copied(), k.iter().copied()),
                Variation::Constant { index, extinction } => {
                    let (index, extinction) = (values[index], extinction.map_or(0.0, |parameter| values[parameter]));
                    Permittivity::new(n.iter().map(|_| index), n.iter().map(|_| extinction))
                }
                Variation::Cauchy { a, b_nm2, extinction_scale } => {
                    let (a, b, factor) = (values[a], values[b_nm2], factor(extinction_scale));
                    let n = self.inverse_squares.iter().map(|inverse_square| a + b * inverse_square);
                    Permittivity::new(n, k.iter().map(|k| factor * k))
                }
                Variation::Correction { offset, scale, extinction_scale } => {
                    let (offset, scale, factor) = (values[offset], values[scale], factor(extinction_scale));
                    Permittivity::new(n.iter().map(|n| scale * n + offset), k.iter().map(|k| factor * k))
                }
            }
        };
        materials.iter().zip(&self.indices).map(of_one).collect()
    }
}
