//! What comes back diffusely: from a base below the layers where the substrate is clear, and otherwise as a share of the
//! light that never meets them.

use std::f64::consts::{FRAC_1_PI, PI};
use std::sync::{Arc, Mutex, PoisonError};

use crate::bsdf::{Direction, ModelError};
use crate::optics::{EnteringLight, FacetKernel, LayeredMedium};
use crate::parameter::{Parameter, Spread};

/// The diffuse light over the channels, as a mixture of its parameters.
#[derive(Debug, Clone)]
pub(super) struct Base {
    kind: BaseKind,
    /// Number of parameters: one, or one a knot.
    count: usize,
    /// For each channel the parameter to its left and the share of the one to its right.
    places: Vec<(usize, f64)>,
    kernels: Kernels,
}

/// Where diffuse light comes from; the substrate decides.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum BaseKind {
    /// A Lambertian base in the clear substrate: `diffuse_albedo`.
    Below,
    /// A Lambertian share beside the layers, whose substrate takes what enters it: `diffuse_share`.
    Beside,
}

impl BaseKind {
    /// The kind of base over a substrate that absorbs, or does not.
    pub(super) fn of(substrate_absorbs: bool) -> Self {
        if substrate_absorbs { Self::Beside } else { Self::Below }
    }
}

impl Base {
    /// Declares `diffuse_albedo` or `diffuse_share`, or one `….<nm>` a knot, between which it runs straight and beyond
    /// which it stays level.
    pub(super) fn declare(
        kind: BaseKind,
        knots_nm: &[f64],
        wavelengths_nm: &[f64],
        parameters: &mut Vec<Parameter>,
    ) -> Result<Self, ModelError> {
        if !knots_nm.is_sorted_by(|a, b| a < b) || knots_nm.iter().any(|knot| !knot.is_finite()) {
            return Err(ModelError::UnsortedKnots);
        }
        let (name, symbol, text) = match kind {
            BaseKind::Below => ("diffuse_albedo", "ρ", "albedo of the diffuse base below the layers"),
            BaseKind::Beside => {
                ("diffuse_share", "s", "share of the light that comes back diffusely beside the layers")
            }
        };
        if knots_nm.is_empty() {
            let text = format!("{text}, the same at every wavelength");
            parameters.push(parameter(name.to_owned(), symbol.to_owned(), text));
            let places = vec![(0, 0.0); wavelengths_nm.len()];
            return Ok(Self { kind, count: 1, places, kernels: Kernels::default() });
        }
        for knot in knots_nm {
            let text = format!("{text} at {knot} nm");
            parameters.push(parameter(format!("{name}.{knot}"), format!("{symbol} {knot}"), text));
        }
        let last = knots_nm.len() - 1;
        let place = |nm: &f64| match knots_nm.partition_point(|knot| knot <= nm) {
            0 => (0, 0.0),
            right if right > last => (last, 0.0),
            right => (right - 1, (nm - knots_nm[right - 1]) / (knots_nm[right] - knots_nm[right - 1])),
        };
        let places = wavelengths_nm.iter().map(place).collect();
        Ok(Self { kind, count: knots_nm.len(), places, kernels: Kernels::default() })
    }

    pub(super) fn kind(&self) -> BaseKind {
        self.kind
    }

    /// Number of parameters.
    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// With its values given, for layers on facets of roughness `alpha` under a medium of index `front`.
    pub(super) fn bind(&self, values: &[f64], alpha: f64, medium: &LayeredMedium<'_>, front: f64) -> BoundBase {
        let diffuse = self.mixture(values);
        if diffuse.iter().all(|share| *share <= 0.0) {
            return BoundBase::Black;
        }
        match self.kind {
            BaseKind::Beside => BoundBase::Beside {
                kept: diffuse.iter().map(|share| 1.0 - share).collect(),
                diffuse: diffuse.iter().map(|share| share * FRAC_1_PI).collect(),
            },
            BaseKind::Below => {
                let entering = self.kernels.of(alpha, medium, front).entering(medium, front);
                let factors = factors(&diffuse, medium, front, entering.mean());
                BoundBase::Below { entering, factors }
            }
        }
    }

    /// The albedo or share in each channel.
    fn mixture(&self, values: &[f64]) -> Vec<f64> {
        let at = |&(left, share): &(usize, f64)| {
            if share > 0.0 { values[left] + share * (values[left + 1] - values[left]) } else { values[left] }
        };
        self.places.iter().map(at).collect()
    }
}

/// What T(θi) T(θo) is multiplied by in each channel: ρ/(π n² (1 − ρ R̄)), n being the substrate's index over that in
/// front, and 1 − R̄ the share of diffuse light from below that leaves through the layers or is absorbed in them.
fn factors(albedo: &[f64], medium: &LayeredMedium<'_>, front: f64, mean_entering: &[f64]) -> Vec<f64> {
    let mut absorbed = vec![0.0; albedo.len()];
    medium.diffuse_absorptance_inside(front, &mut absorbed);
    let channels = albedo.iter().zip(medium.substrate_permittivity()).zip(mean_entering).zip(absorbed);
    let factor = |(((albedo, permittivity), entering), absorbed): (((&f64, &f64), &f64), f64)| {
        let n_squared = permittivity / (front * front);
        let not_back = entering / n_squared + absorbed;
        // 1 − ρ R̄ without cancellation.
        albedo / (PI * n_squared * ((1.0 - albedo) + albedo * not_back))
    };
    channels.map(factor).collect()
}

/// A base with its values given.
#[derive(Debug)]
pub(super) enum BoundBase {
    /// Nothing comes back diffusely.
    Black,
    /// ρ T(θi) T(θo)/(π n² (1 − ρ R̄)).
    Below { entering: EnteringLight, factors: Vec<f64> },
    /// s/π, and 1 − s is left for the layers.
    Beside { kept: Vec<f64>, diffuse: Vec<f64> },
}

impl BoundBase {
    /// About what gloss and base send towards light or viewer at a cosine in the medium of the layers, channels summed, for
    /// a sampler: `reflectance` is that of smooth layers; for the base, light along the normal stands for all light.
    pub(super) fn albedos(&self, cosine: f64, reflectance: &[f64]) -> (f64, f64) {
        match self {
            Self::Black => (reflectance.iter().sum(), 0.0),
            Self::Beside { kept, diffuse } => {
                let gloss = reflectance.iter().zip(kept).map(|(reflectance, kept)| reflectance * kept);
                (gloss.sum(), diffuse.iter().sum::<f64>() * PI)
            }
            Self::Below { entering, factors } => {
                let mut base = vec![0.0; factors.len()];
                entering.add_products([cosine, 1.0], factors, &mut base);
                (reflectance.iter().sum(), base.iter().sum::<f64>() * PI)
            }
        }
    }

    /// Turns the layers' reflectance in `values` into `scale` · f, for directions above the horizon.
    pub(super) fn add(&self, scale: f64, lobe: f64, incoming: &Direction, outgoing: &Direction, values: &mut [f64]) {
        match self {
            Self::Black => {
                let lobe = scale * lobe;
                for value in values {
                    *value *= lobe;
                }
            }
            Self::Beside { kept, diffuse } => {
                for ((value, kept), diffuse) in values.iter_mut().zip(kept).zip(diffuse) {
                    *value = scale * (kept * (lobe * *value) + diffuse);
                }
            }
            Self::Below { entering, factors } => {
                for value in &mut *values {
                    *value *= lobe;
                }
                entering.add_products([incoming.z, outgoing.z], factors, values);
                for value in values {
                    *value *= scale;
                }
            }
        }
    }
}

/// The kernels last used. A fit asks for one roughness many times, for every other parameter that it moves.
#[derive(Debug, Clone, Default)]
struct Kernels(Arc<Mutex<Vec<Arc<FacetKernel>>>>);

impl Kernels {
    /// Enough for the starts that run in parallel, each with a roughness and its neighbour for the derivative.
    const MOST: usize = 16;

    /// The kernel for this roughness and these layers, from the list or new.
    fn of(&self, alpha: f64, medium: &LayeredMedium<'_>, front: f64) -> Arc<FacetKernel> {
        let list = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let known = |list: &Vec<Arc<FacetKernel>>| list.iter().position(|kernel| kernel.suits(alpha, medium, front));
        {
            let mut list = list();
            if let Some(position) = known(&list) {
                // The one used last stands last.
                let kernel = list.remove(position);
                list.push(Arc::clone(&kernel));
                return kernel;
            }
        }
        // Made outside the lock: another thread may make the same, and the same bytes.
        let kernel = Arc::new(FacetKernel::new(alpha, medium, front));
        let mut list = list();
        if list.len() >= Self::MOST {
            list.remove(0);
        }
        list.push(Arc::clone(&kernel));
        kernel
    }
}

fn parameter(name: String, symbol: String, text: String) -> Parameter {
    Parameter {
        name,
        symbol,
        unit: "",
        default: 0.0,
        lower: 0.0,
        upper: 1.0,
        spread: Spread::Linear,
        scan_step: None,
        text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_straight_between_knots_and_level_beyond() {
        let mut parameters = Vec::new();
        let wavelengths_nm = [350.0, 400.0, 450.0, 650.0, 700.0, 800.0];
        let base = Base::declare(BaseKind::Below, &[400.0, 500.0, 700.0], &wavelengths_nm, &mut parameters);
        let names: Vec<&str> = parameters.iter().map(|parameter| parameter.name.as_str()).collect();
        assert_eq!(names, ["diffuse_albedo.400", "diffuse_albedo.500", "diffuse_albedo.700"]);
        let albedo = base.unwrap().mixture(&[0.1, 0.3, 0.7]);
        for (found, expected) in albedo.iter().zip([0.1, 0.1, 0.2, 0.6, 0.7, 0.7]) {
            approx::assert_abs_diff_eq!(*found, expected, epsilon = 1e-15);
        }
    }
}
