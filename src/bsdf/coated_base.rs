//! A rough surface that carries a film or a stack of layers, over a diffuse base.
//!
//! ```text
//! f = D(h) G1(ωi) G1(ωo) R(ωi·h; λ) / (4 cosθi cosθo) + ρ T(θi) T(θo) / (π n_b² (1 − ρ R̄))
//! ```
//!
//! 0 where either direction is below the horizon. D and G1 are Beckmann's and Smith's (Walter et al. 2007); R is the
//! unpolarised reflectance of the layers for light that meets a microfacet at cosθ = ωi·h, with the phase of every
//! internal reflection (Yeh 1988). Every microfacet carries the same parallel layers.
//!
//! **Base.** The second term is ours, built as in [`super::RoughPlastic`]: what enters, T, meets a Lambertian base of albedo
//! ρ in a substrate of index `n_b`, and bounces between it and the layers. T(μ) = 1 − ∫ K(μ, c; α) (1 − t(c)) dc takes off
//! what the lobe reflects and what the layers absorb in doing so, t being the layers' transmittance; 1 − R̄ =
//! (2/`n_b`²) ∫ T μ dμ + Ā, where Ā is the share of diffuse light from below that the layers absorb, 0 for clear ones,
//! taken for smooth layers. What a mirrored ray would lose on a second microfacet, 1 − ∫ K dc, counts as entering. That is
//! right where R is small, as for any film on a feather; of a rough stack that is nearly a mirror the lost light should
//! mostly come back as gloss, and here it comes back in the base's colour.
//!
//! **Which base.** `n_b` is real, so that a base needs a clear substrate: then its parameter is `diffuse_albedo`, ρ. A
//! substrate that absorbs takes all that enters; it has `diffuse_share`, s, instead: the share of the light that comes
//! back diffusely without meeting the layers (dust, broken edges, whatever scatters beside them),
//! f = (1 − s) D G1 G1 R / (4 cosθi cosθo) + s/π. `base_knots_nm` gives either of them a spectrum. A pigmented tissue
//! below the layers is thus a clear substrate with a base; to make the substrate itself absorb over such a base, let it be
//! the last layer.
//!
//! | parameter | symbol | unit | default | range |
//! | --- | --- | --- | --- | --- |
//! | `<layer>.thickness_nm` of each layer | d | nm | the design's | 5 to 5000 |
//! | `<material>.…`: index and extinction, see `barbule models` | | | the design's | |
//! | `roughness` | α | | 0.1 | 0.01 to 1 |
//! | `diffuse_albedo` (clear substrate) | ρ | | 0 | 0 to 1 |
//! | `diffuse_share` (absorbing substrate) | s | | 0 | 0 to 1 |
//!
//! **Energy.** Reciprocal; never more than arrives comes back, and with clear layers on a white base exactly all, as far
//! as the tables of T go (within 1e-3 of the sum over all directions, see [`crate::optics::FacetKernel`]).
//!
//! **Clear coat.** Under one of index n both directions are refracted into the coat first, R and T are those of the layers
//! in the coat, and the result is T(θi) T(θo)/n² times the value inside, these T being the coat's Fresnel transmittance.
//! The gloss of the coat's own surface and light that the coat turns back to the layers are left out.

mod base;
mod description;
mod design;
mod variable_material;

pub use description::Description;
pub use design::{Design, DesignEntry, DesignLayer, DesignPeriod, MaterialChoice, OwnMaterial};

use std::sync::OnceLock;

use self::base::{Base, BaseKind, BoundBase};
pub(super) use self::design::check_name;
use self::variable_material::{Channels, VariableMaterial};
use super::beckmann_lobe::{HalfVector, lobe};
use super::coat_sampling::{CoatSampler, refract, refracted_cosine};
use super::{Bsdf, Direction, Model, ModelError, Sample};
use crate::optics::microfacet::Beckmann;
use crate::optics::{Arrangement, LayeredMedium, fresnel};
use crate::parameter::{Parameter, Spread};

/// Range of a layer's thickness, nm: below it is thinner than some ten molecules, above it fringes are finer than a
/// spectrometer resolves.
const THICKNESS_NM: std::ops::RangeInclusive<f64> = 5.0..=5000.0;

/// A coated base for a list of wavelengths, its parameters not yet given.
#[derive(Debug, Clone)]
pub struct CoatedBase {
    design: Design,
    parameters: Vec<Parameter>,
    materials: Vec<VariableMaterial>,
    base: Base,
    arrangement: Arrangement,
    channels: Channels,
    wavelengths_nm: Vec<f64>,
}

impl CoatedBase {
    /// The model of a design at these wavelengths (nm, one a channel).
    ///
    /// # Errors
    /// [`ModelError`] says which layer, material or number is wrong and what was expected.
    pub fn new(design: &Design, wavelengths_nm: &[f64]) -> Result<Self, ModelError> {
        if wavelengths_nm.is_empty() {
            return Err(ModelError::NoWavelengths);
        }
        for &wavelength in wavelengths_nm {
            check_range("a wavelength", wavelength, 10.0..=1e6, "10 to 1000000 nm")?;
        }
        if let Some(index) = design.clear_coat {
            check_range("`clear_coat`", index, 1.0..=3.0, "a refractive index from 1 to 3")?;
        }

        let mut parameters = Vec::new();
        let layers = declare_layers(design, wavelengths_nm, &mut parameters)?;

        let mut materials: Vec<VariableMaterial> = Vec::new();
        let mut layer_materials = Vec::new();
        for choice in layers.list.iter().map(|layer| &layer.material).chain([&design.substrate]) {
            layer_materials.push(find_or_declare(choice, wavelengths_nm, &mut materials, &mut parameters)?);
        }
        let substrate = layer_materials.split_off(layers.list.len())[0];

        parameters.push(roughness());
        let kind = BaseKind::of(materials[substrate].dispersion.absorbs());
        let base = Base::declare(kind, &design.base_knots_nm, wavelengths_nm, &mut parameters)?;
        Ok(Self {
            design: design.clone(),
            parameters,
            base,
            arrangement: Arrangement::new(materials.len(), layer_materials, layers.sequence, substrate),
            channels: Channels::new(wavelengths_nm, &materials),
            materials,
            wavelengths_nm: wavelengths_nm.to_vec(),
        })
    }

    /// Writes the bare unpolarised reflectance of the layers at any wavelengths, for parameter values as in
    /// [`Model::bind`] and light at `cos_theta` (0 to 1) to the normal in air. A clear coat refracts the light first;
    /// its own losses are left out. NaN where a table of indices does not reach.
    ///
    /// # Panics
    /// If `reflectance` is not one number a wavelength: that is the caller's slip, not a user's.
    pub fn reflectance_at(&self, values: &[f64], cos_theta: f64, wavelengths_nm: &[f64], reflectance: &mut [f64]) {
        let channels = Channels::new(wavelengths_nm, &self.materials);
        let inside = self.design.clear_coat.map_or(cos_theta, |index| refracted_cosine(cos_theta, index));
        self.medium(&channels, values).reflectance(self.front(), inside, reflectance);
    }

    /// Σ n d of all layers at a wavelength, nm, for parameter values as in [`Model::bind`]: no fringe of the spectrum is
    /// shorter than the period 1/(2 Σ n d) in wavenumber.
    pub fn optical_thickness_nm(&self, values: &[f64], wavelength_nm: f64) -> f64 {
        let channels = Channels::new(&[wavelength_nm], &self.materials);
        self.medium(&channels, values).optical_thickness_nm()[0]
    }

    /// Whether a parameter can move a maximum of the bare reflectance: all but roughness and base, which stand last.
    pub fn moves_peaks(&self, parameter: usize) -> bool {
        parameter + 1 + self.base.count() < self.parameters.len()
    }

    /// Index of the medium that the layers lie in.
    fn front(&self) -> f64 {
        self.design.clear_coat.unwrap_or(1.0)
    }

    fn medium<'a>(&'a self, channels: &'a Channels, values: &[f64]) -> LayeredMedium<'a> {
        LayeredMedium::new(
            &self.arrangement,
            &channels.double_wavenumbers,
            channels.permittivities(&self.materials, values),
            // The thicknesses are declared first.
            values[..self.arrangement.layer_count()].to_vec(),
        )
    }
}

impl Model for CoatedBase {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn channel_count(&self) -> usize {
        self.wavelengths_nm.len()
    }

    fn bind(&self, values: &[f64]) -> Box<dyn Bsdf + '_> {
        debug_assert_eq!(values.len(), self.parameters.len(), "one value a parameter");
        // Roughness and then the base's albedos are declared last.
        let (layers_and_roughness, albedos) = values.split_at(values.len() - self.base.count());
        let roughness = layers_and_roughness[layers_and_roughness.len() - 1];
        let medium = self.medium(&self.channels, values);
        Box::new(BoundCoatedBase {
            clear_coat: self.design.clear_coat,
            surface: Beckmann::new(roughness),
            base: self.base.bind(albedos, roughness, &medium, self.front()),
            medium,
            sampler: OnceLock::new(),
        })
    }
}

/// A coated base with its parameters given.
#[derive(Debug)]
struct BoundCoatedBase<'a> {
    medium: LayeredMedium<'a>,
    clear_coat: Option<f64>,
    surface: Beckmann,
    base: BoundBase,
    /// What it is drawn from, made at the first draw.
    sampler: OnceLock<CoatSampler>,
}

impl Bsdf for BoundCoatedBase<'_> {
    fn evaluate(&self, incoming: &Direction, outgoing: &Direction, values: &mut [f64]) {
        if incoming.z <= 0.0 || outgoing.z <= 0.0 {
            values.fill(0.0);
            return;
        }
        match self.clear_coat {
            None => self.evaluate_layers(1.0, incoming, outgoing, 1.0, values),
            Some(index) => {
                let transmittance = |cosine: f64| 1.0 - fresnel::dielectric(cosine, index).unpolarised();
                let through = transmittance(incoming.z) * transmittance(outgoing.z) / (index * index);
                self.evaluate_layers(index, &refract(incoming, index), &refract(outgoing, index), through, values);
            }
        }
    }

    fn sample(&self, outgoing: &Direction, random: [f64; 3]) -> Option<Sample> {
        self.sampler().sample(outgoing, random)
    }

    fn density(&self, incoming: &Direction, outgoing: &Direction) -> f64 {
        self.sampler().density(incoming, outgoing)
    }
}

impl BoundCoatedBase<'_> {
    /// Gloss by the reflectance of the smooth layers; what a clear coat takes off, it takes off gloss and base alike.
    fn sampler(&self) -> &CoatSampler {
        self.sampler.get_or_init(|| {
            let front = self.clear_coat.unwrap_or(1.0);
            let mut reflectance = vec![0.0; self.medium.substrate_permittivity().len()];
            CoatSampler::new(self.surface, self.clear_coat, |cosine| {
                let inside = refracted_cosine(cosine, front);
                self.medium.reflectance(front, inside, &mut reflectance);
                self.base.albedos(inside, &reflectance)
            })
        })
    }

    /// `scale` · f for directions in the medium of index `front` that the layers lie in, both above the horizon.
    fn evaluate_layers(&self, front: f64, incoming: &Direction, outgoing: &Direction, scale: f64, values: &mut [f64]) {
        let half = HalfVector::between(incoming, outgoing);
        let lobe = lobe(&self.surface, &half, incoming, outgoing);
        self.medium.reflectance(front, half.cos_facet, values);
        self.base.add(scale, lobe, incoming, outgoing, values);
    }
}

/// The distinct layers of a design, and how they follow each other.
struct Layers<'a> {
    list: Vec<&'a DesignLayer>,
    sequence: Vec<usize>,
}

/// Checks the layers and declares their thicknesses.
fn declare_layers<'a>(
    design: &'a Design,
    wavelengths_nm: &[f64],
    parameters: &mut Vec<Parameter>,
) -> Result<Layers<'a>, ModelError> {
    let mut layers = Layers { list: Vec::new(), sequence: Vec::new() };
    for entry in &design.layers {
        let (period, count) = match entry {
            DesignEntry::Layer(layer) => (std::slice::from_ref(layer), 1),
            DesignEntry::Period(DesignPeriod { period, count }) => (period.as_slice(), *count),
        };
        if period.is_empty() {
            return Err(ModelError::EmptyPeriod);
        }
        if !(1..=1000).contains(&count) {
            return Err(ModelError::BadCount { found: count });
        }
        let first = layers.list.len();
        for layer in period {
            parameters.push(declare_thickness(layer, wavelengths_nm, count)?);
            if layers.list.iter().any(|other| other.name == layer.name) {
                return Err(ModelError::TwoLayers { name: layer.name.clone() });
            }
            layers.list.push(layer);
        }
        for _ in 0..count {
            layers.sequence.extend(first..layers.list.len());
        }
    }
    // One layer is simply d; of several each has its name beside it.
    if let [only] = parameters.as_mut_slice() {
        only.symbol = "d".to_owned();
    }
    Ok(layers)
}

/// Checks a layer and declares its thickness; `count` is how often it repeats.
pub(super) fn declare_thickness(
    layer: &DesignLayer,
    wavelengths_nm: &[f64],
    count: usize,
) -> Result<Parameter, ModelError> {
    check_name("layer", &layer.name)?;
    let what = format!("`thickness_nm` of layer {:?}", layer.name);
    check_range(&what, layer.thickness_nm, THICKNESS_NM, "5 to 5000 nm")?;
    let (material, dispersion) = layer.material.resolve()?;
    let shortest_nm = wavelengths_nm.iter().copied().fold(f64::INFINITY, f64::min);
    let greatest_index = wavelengths_nm.iter().map(|&w| dispersion.at(w).re).fold(1.0, f64::max);
    Ok(thickness(layer, material, scan_step_nm(shortest_nm, greatest_index, count)))
}

/// Spacing at which a scan over a layer's thickness meets every minimum of a misfit.
///
/// A reflectance repeats in d with the period λ/(2n), its square, and so a misfit, in places with half of that. A quarter
/// of this half at the shortest wavelength puts at least four points into the narrowest valley. A layer that repeats
/// changes the whole stack by as many times its own change.
fn scan_step_nm(shortest_nm: f64, greatest_index: f64, count: usize) -> f64 {
    shortest_nm / (4.0 * greatest_index) / 4.0 / count as f64
}

fn thickness(layer: &DesignLayer, material: &str, scan_step_nm: f64) -> Parameter {
    Parameter {
        name: format!("{}.thickness_nm", layer.name),
        symbol: format!("d {}", layer.name),
        unit: "nm",
        default: layer.thickness_nm,
        lower: *THICKNESS_NM.start(),
        upper: *THICKNESS_NM.end(),
        spread: Spread::Logarithmic,
        scan_step: Some(scan_step_nm),
        text: format!("thickness of the layer {} ({material})", layer.name),
    }
}

fn roughness() -> Parameter {
    Parameter {
        name: "roughness".to_owned(),
        symbol: "α".to_owned(),
        unit: "",
        default: 0.1,
        lower: 0.01,
        upper: 1.0,
        spread: Spread::Logarithmic,
        scan_step: None,
        text: "roughness of the surface, √2 times the standard deviation of its slopes (Beckmann)".to_owned(),
    }
}

/// Position of a material in the list, where it is put with its parameters if it is new.
fn find_or_declare(
    choice: &MaterialChoice,
    wavelengths_nm: &[f64],
    materials: &mut Vec<VariableMaterial>,
    parameters: &mut Vec<Parameter>,
) -> Result<usize, ModelError> {
    let (name, dispersion) = choice.resolve()?;
    if let Some(position) = materials.iter().position(|material| material.name == name) {
        return if materials[position].dispersion == dispersion {
            Ok(position)
        } else {
            Err(ModelError::TwoMaterials { name: name.to_owned() })
        };
    }
    let own = matches!(choice, MaterialChoice::Own(_));
    materials.push(VariableMaterial::declare(name, dispersion, own, wavelengths_nm, parameters)?);
    Ok(materials.len() - 1)
}

fn check_range(
    what: &str,
    found: f64,
    range: std::ops::RangeInclusive<f64>,
    expected: &'static str,
) -> Result<(), ModelError> {
    if range.contains(&found) { Ok(()) } else { Err(ModelError::OutOfRange { what: what.to_owned(), found, expected }) }
}
