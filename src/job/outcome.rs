//! The result of a job, as `result.json` holds it: all that a report needs.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::population::Population;
use crate::fit::Fit;
use crate::measure::{Compared, Geometry, Quantity};
use crate::optics::{MaterialNote, Reference};

/// The result of a job. Same inputs, same seed, same bytes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Outcome {
    /// Version of Barbule that made it.
    pub barbule_version: String,
    /// The job's name, which names its report folder.
    pub name: String,
    /// One line for people, the report's title.
    pub title: String,
    /// The answer in a sentence or two: value ± error, rivals, what stays open. Plain text.
    pub answer: String,
    /// Free remarks of the job's author on the data and its source.
    pub about: String,
    /// Files read, with their hashes.
    pub inputs: Vec<InputFile>,
    /// Set where the readings were made by Barbule itself from known values. Everything that shows them says so.
    pub synthetic: Option<Truth>,
    /// One case, or several side by side: other models or other assumptions on the same data. The first is the main one.
    pub cases: Vec<Case>,
    /// The cases judged by readings that none of them saw, where there are several and such readings.
    pub comparison: Option<Comparison>,
    /// The job file as read, to repeat it.
    pub job_toml: String,
}

/// A file that went in.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct InputFile {
    /// File name without folders.
    pub name: String,
    /// SHA-256 of its bytes, in hexadecimal.
    pub sha256: String,
    /// Size in bytes.
    pub bytes: u64,
}

/// How synthetic readings were made.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Truth {
    /// True value of each parameter by name.
    pub values: BTreeMap<String, f64>,
    /// Noise: standard deviation as a share of each reading.
    pub noise: f64,
    /// Seed of the noise.
    pub seed: u64,
}

/// One model fitted to the data under one set of assumptions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Case {
    /// Short name: `film`, `law`, `start angle 10°`.
    pub name: String,
    /// What this case assumes, a sentence.
    pub text: String,
    /// The answer of this case alone, a sentence.
    pub answer: String,
    /// The model.
    pub model: ModelNote,
    /// The fit.
    pub fit: Fit,
    /// Measured and fitted side by side.
    pub data: CaseData,
    /// How well readings of spectra that the fit did not see are predicted, where there are such.
    pub held_out: Option<HeldOut>,
    /// What the model at its best values does with light from a few directions, where it scatters at all.
    pub lobes: Option<Lobes>,
    /// Whether the data support a film, where the model has one and there are incidences to leave out.
    pub support: Option<Support>,
    /// The specimens each and together, where the job asks for it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub population: Option<Population>,
    /// What sets the specimens of this case apart from those of the others: species, patch. Empty where nothing does.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub group: String,
    /// Thickness for each order of interference, where the data (peaks alone) do not give the order.
    pub orders: Vec<ThicknessOrder>,
}

/// A model's BSDF for light from azimuth 0 and a few inclinations, 1/sr.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Lobes {
    /// Wavelengths, nm, at most three.
    pub wavelengths_nm: Vec<f64>,
    /// Viewer's angles from the normal in the plane of incidence, degrees: positive on the mirror side, above 90 below the
    /// surface, where the model lets light through.
    pub angles_deg: Vec<f64>,
    /// One an inclination of the light.
    pub lights: Vec<LightLobes>,
}

/// The lobes for one inclination of the light.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LightLobes {
    /// Inclination of the light, degrees.
    pub theta_i_deg: f64,
    /// Values in the plane of incidence: one list a wavelength, in it one value an angle.
    pub in_plane: Vec<Vec<f64>>,
    /// Values for all viewers above the surface at the middle wavelength: rings of equal inclination from the normal outwards,
    /// in each equal steps of azimuth from 0; a value is the mean over its cell.
    pub hemisphere: Vec<Vec<f64>>,
}

/// Errors of prediction, model minus reading, at readings that the fit did not see.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct HeldOut {
    /// Number of readings.
    pub readings: usize,
    /// Root mean square, in the unit of the readings.
    pub rms: f64,
    /// Root mean square of the difference of the cube roots, in the cube root of that unit.
    pub rms_of_cube_roots: f64,
}

/// Several cases on the same readings.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Comparison {
    /// Number of readings behind every `aicc`: the effective readings of the case that follows the fitted ones best.
    pub effective_readings: f64,
    /// One a case, in their order.
    pub rows: Vec<ComparisonRow>,
}

/// One case among several.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ComparisonRow {
    /// Name of the case.
    pub case: String,
    /// Number of free parameters.
    pub free_parameters: usize,
    /// Errors at the readings held out.
    pub held_out: HeldOut,
    /// Akaike's criterion with small-sample correction, on the fitted readings; None where the cases' likelihoods do not
    /// compare (robust losses, readings that only some of them fit) or too few readings are left.
    pub aicc: Option<f64>,
}

/// What the report's methods paragraph says of the model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ModelNote {
    /// Name as in `barbule models`.
    pub kind: String,
    /// The model in words, complete sentences for a methods section: layers from the outside in, materials, instrument.
    pub text: String,
    /// Materials used, with their source.
    pub materials: Vec<MaterialNote>,
    /// Works to cite.
    pub references: Vec<Reference>,
}

/// Measured and fitted values.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum CaseData {
    /// Spectra at given angles.
    Spectra {
        /// Meaning of the values.
        quantity: Quantity,
        /// What of them the fit compared with the model's.
        compare: Compared,
        /// One a geometry.
        spectra: Vec<SpectrumFit>,
    },
    /// Peak wavelengths at given angles.
    Peaks {
        /// One a reading, those kept out of the fit included.
        peaks: Vec<PeakFit>,
        /// Predicted spectra of the best minimum at each angle, where the model has spectra.
        spectra: Vec<Prediction>,
        /// The fitted law or model over a dense list of angles: (inclination in degrees, wavelength in nm).
        curve: Vec<(f64, f64)>,
    },
}

/// One spectrum, measured and fitted.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SpectrumFit {
    /// Name in the table.
    pub id: String,
    /// Angles.
    pub geometry: Geometry,
    /// Whether nobody wrote the angles down; they are then those of the normal and mean nothing.
    #[serde(default)]
    pub without_geometry: bool,
    /// Whether the fit saw it; false for one that was left out and is only predicted.
    pub fitted: bool,
    /// Wavelengths, nm.
    pub wavelengths_nm: Vec<f64>,
    /// Readings.
    pub measured: Vec<f64>,
    /// σ of each, where known.
    pub sigmas: Option<Vec<f64>>,
    /// The model at the best minimum; that of the specimen's own fit where specimens are fitted each by itself.
    pub model: Vec<f64>,
}

/// One peak, measured and fitted.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PeakFit {
    /// Name in the table.
    pub id: String,
    /// Angles.
    pub geometry: Geometry,
    /// Whether the fit saw it.
    pub fitted: bool,
    /// Measured wavelength, nm.
    pub measured_nm: f64,
    /// σ, nm, where known.
    pub sigma_nm: Option<f64>,
    /// The model's, nm; None where its spectrum has no such peak.
    pub model_nm: Option<f64>,
}

/// A spectrum that the model predicts.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Prediction {
    /// Name of the reading it belongs to.
    pub id: String,
    /// Angles.
    pub geometry: Geometry,
    /// Wavelengths, nm.
    pub wavelengths_nm: Vec<f64>,
    /// Reflectance of the film or stack, 0 to 1.
    pub reflectance: Vec<f64>,
}

/// Whether a film is supported: prediction error at incidences left out one at a time, with and without it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Support {
    /// Incidences left out in turn, degrees.
    pub incidences_deg: Vec<f64>,
    /// Mean squared prediction error at each, with the film.
    pub with_film: Vec<f64>,
    /// The same without.
    pub without_film: Vec<f64>,
    /// Mean over incidences of (without − with).
    pub gain: f64,
    /// Its standard error over incidences.
    pub gain_standard_error: f64,
    /// Thickness found in each fold, nm.
    pub thickness_by_fold_nm: Vec<f64>,
    /// Whether every fold's thickness is of the same order of interference.
    pub same_order: bool,
    /// The verdict: gain > 2 standard errors and same order.
    pub supported: bool,
    /// `AICc` with the film minus without, on the effective number of readings; negative favours the film.
    pub delta_aicc: Option<f64>,
    /// Number of readings and the effective number behind that `AICc`.
    pub effective_readings: f64,
    /// The verdict in a sentence.
    pub text: String,
}

/// Thickness under one assumed order of interference.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ThicknessOrder {
    /// Order as the model counts it; a half for a reflection with one phase jump.
    pub order: f64,
    /// Thickness, nm.
    pub thickness_nm: f64,
    /// Its standard error.
    pub standard_error_nm: Option<f64>,
    /// Refractive index that goes with it.
    pub index: f64,
    /// Its standard error.
    pub index_standard_error: Option<f64>,
    /// Root mean square misfit, nm.
    pub rms_nm: f64,
    /// Weight among the orders, 0 to 1.
    pub weight: f64,
}
