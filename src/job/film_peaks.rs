//! Peak wavelengths of a film or stack, found on the full model's own spectrum.

use super::JobError;
use crate::bsdf::Model;
use crate::bsdf::{CoatedBase, Design};
use crate::measure::{Geometry, Peak, PeakModel, find_peaks, mirror_cosine};
use crate::parameter::Parameter;

/// The reflectance spectrum of a coated base, reduced to its maxima. Roughness and base do not move a maximum of a flat
/// film and are not among its parameters.
#[derive(Debug)]
pub(super) struct FilmPeaks {
    model: CoatedBase,
    /// The model's parameters that can move a peak: all but the lobe's and the base's, which stand last.
    moving: Vec<Parameter>,
    /// Default values of all the model's parameters.
    defaults: Vec<f64>,
}

impl FilmPeaks {
    /// The design's peaks no shorter than `shortest_nm`.
    pub(super) fn new(design: &Design, shortest_nm: f64) -> Result<Self, JobError> {
        let model = CoatedBase::new(design, &[shortest_nm])?;
        if design.layers.is_empty() {
            let problem = "a plain interface has no peaks; give the model a layer";
            return Err(JobError::key("model.layers", problem));
        }
        let declared = model.parameters();
        let moving = declared.iter().enumerate().filter(|(index, _)| model.moves_peaks(*index));
        let moving = moving.map(|(_, parameter)| parameter.clone()).collect();
        let defaults = declared.iter().map(|parameter| parameter.default).collect();
        Ok(Self { model, moving, defaults })
    }

    fn all_values(&self, values: &[f64]) -> Vec<f64> {
        let mut all = self.defaults.clone();
        all[..values.len()].copy_from_slice(values);
        all
    }

    /// Reflectance at these angles.
    pub(super) fn spectrum(&self, values: &[f64], geometry: &Geometry, wavelengths_nm: &[f64], out: &mut [f64]) {
        self.model.reflectance_at(&self.all_values(values), mirror_cosine(geometry), wavelengths_nm, out);
    }
}

impl PeakModel for FilmPeaks {
    fn parameters(&self) -> &[Parameter] {
        &self.moving
    }

    fn peaks(&self, values: &[f64], geometry: &Geometry, shortest_nm: f64, longest_nm: f64) -> Vec<Peak> {
        let all = self.all_values(values);
        let cosine = mirror_cosine(geometry);
        let optical_thickness_nm = self.model.optical_thickness_nm(&all, shortest_nm);
        find_peaks(optical_thickness_nm, shortest_nm, longest_nm, |wavelengths_nm, out| {
            self.model.reflectance_at(&all, cosine, wavelengths_nm, out);
        })
    }
}
