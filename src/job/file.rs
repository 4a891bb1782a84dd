//! A job as its author types it: the TOML file, before anything in it has been checked against data or model.

use std::collections::BTreeMap;
use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize, de};

use super::population::SpecimensFile;
use super::sweep::SweepFile;
use crate::bsdf::cylinder::{CylinderDesign, FilmedCylinderDesign};
use crate::bsdf::{
    Design, FeatherDesign, FilmAtUnknownAngleDesign, GranierHeidrichDesign, IridescentPlasticDesign, LambertianDesign,
    MicrofacetDesign, PigmentedBaseDesign, RoughPlasticDesign,
};
use crate::fit::Settings;
use crate::measure::{Compared, Instrument, Quantity, TableLayout, ThinFilmLawDesign};

/// A job: which data, which model, which parameters are free, and how to fit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct JobFile {
    /// One line for people: the report's title.
    pub title: String,
    /// Remarks on the data and their source; the report prints them.
    #[serde(default)]
    pub about: String,
    /// Short name of this case, where the job has alternatives.
    #[serde(default = "default_case")]
    pub case: String,
    /// What this case assumes, a sentence.
    #[serde(default)]
    pub assumes: String,
    /// What was measured.
    pub data: DataFile,
    /// What the instrument does to the light.
    #[serde(default)]
    pub instrument: Instrument,
    /// What is assumed to scatter it.
    pub model: ModelFile,
    /// Parameters that are free, fixed away from their default, or tied; the rest keep their defaults.
    #[serde(default)]
    pub parameters: BTreeMap<String, ParameterFile>,
    /// Fits each specimen of the table by itself too, tells how much they differ, and predicts each from the others. For
    /// tables of several individuals; without it all spectra are fitted as one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub specimens: Option<SpecimensFile>,
    /// How to fit.
    #[serde(default)]
    pub fit: Settings,
    /// Other assumptions on the same data, fitted beside the main case and shown in the same report.
    #[serde(default)]
    pub alternative: Vec<AlternativeFile>,
    /// What `sweep` goes through; `fit` does not look at it.
    pub sweep: Option<SweepFile>,
}

/// Name of a case that its author did not name.
pub(super) const MAIN_CASE: &str = "main";

fn default_case() -> String {
    MAIN_CASE.into()
}

/// Where the readings come from: `file` with its `layout`, or `synthetic`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DataFile {
    /// Table of readings, relative to the job file; `$BARBULE_DATA/` at its start stands for the folder that the
    /// environment variable names.
    pub file: Option<PathBuf>,
    /// How the table is laid out.
    pub layout: Option<TableLayout>,
    /// Readings that Barbule makes itself from known values.
    pub synthetic: Option<SyntheticFile>,
    /// Degrees added to both inclinations of every reading, where the start of the scale is uncertain.
    #[serde(default)]
    pub theta_offset_deg: f64,
    /// Names of spectra or peaks that the fit does not see; the report shows how well they are predicted.
    #[serde(default)]
    pub hold_out: Vec<String>,
    /// Keep spectra whose viewer stands closer than this to the mirror direction out of the fit, degrees: a clear
    /// coat's gloss.
    #[serde(default)]
    pub hold_out_near_mirror_deg: f64,
    /// Keep spectra whose inclination of light or viewer exceeds this out of the fit, degrees.
    pub hold_out_beyond_deg: Option<f64>,
    /// Keep each spectrum out of the fit whose place in the table, counted from 0, is a multiple of this: 3 keeps the
    /// first, the fourth, the seventh and so on to judge the fit by.
    pub hold_out_every: Option<usize>,
    /// Of the spectra left, fit each so many and hold the others out.
    #[serde(default = "one")]
    pub fit_every: usize,
    /// What of the readings the fit compares with the model's.
    #[serde(default)]
    pub compare: Compared,
}

fn one() -> usize {
    1
}

/// Readings made from known values, with noise from a seed: to test a method, never to report on a bird.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SyntheticFile {
    /// Meaning of the values.
    pub quantity: Quantity,
    /// Inclinations of light and viewer, in mirror position, degrees.
    #[serde(default)]
    pub mirror_deg: Vec<f64>,
    /// Further geometries by four angles each, degrees: inclination and azimuth of the light, then of the viewer.
    #[serde(default)]
    pub angles_deg: Vec<[f64; 4]>,
    /// First and last wavelength, nm, with `step_nm`; or `wavelengths_nm` alone.
    pub window_nm: Option<[f64; 2]>,
    /// Step between wavelengths, nm.
    pub step_nm: Option<f64>,
    /// The wavelengths themselves, nm, rising.
    pub wavelengths_nm: Option<Vec<f64>>,
    /// Standard deviation of the noise as a share of each reading.
    #[serde(default)]
    pub noise: f64,
    /// Seed of the noise.
    #[serde(default = "first_seed")]
    pub seed: u64,
    /// True values of parameters, by name; the rest have their defaults.
    #[serde(default)]
    pub truth: BTreeMap<String, f64>,
}

fn first_seed() -> u64 {
    1
}

/// The model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum ModelFile {
    /// A film, a stack or a plain interface inside a rough surface, over a diffuse base.
    CoatedBase(Box<Design>),
    /// A rough dielectric interface that reflects and transmits.
    Microfacet(MicrofacetDesign),
    /// A rough dielectric coat over a diffuse base.
    RoughPlastic(RoughPlasticDesign),
    /// A rough plastic with a phase term in each channel, as the second thesis builds it.
    IridescentPlastic(IridescentPlasticDesign),
    /// A diffuse base under a thin clear film, after Granier and Heidrich.
    GranierHeidrich(GranierHeidrichDesign),
    /// A surface that is equally bright from everywhere.
    Lambertian(LambertianDesign),
    /// A dielectric fibre along the tangent, averaged over its width: a barb.
    Cylinder(CylinderDesign),
    /// The same fibre seen so closely that the position across it is known.
    NearFieldCylinder(CylinderDesign),
    /// The same fibre with a film or a stack on its surface: an iridescent barbule.
    FilmedCylinder(FilmedCylinderDesign),
    /// The same fibre with a sponge inside that scatters one band of wavelengths: a blue barb without iridescence.
    SpongyBarb(CylinderDesign),
    /// The vane of a feather: barbs along the tangent, barbules at an angle to them.
    Feather(FeatherDesign),
    /// A layer that scatters and absorbs, over black: pigmented plumage. Needs no geometry.
    PigmentedBase(PigmentedBaseDesign),
    /// One film at an angle that nobody wrote down. Needs no geometry.
    FilmAtUnknownAngle(FilmAtUnknownAngleDesign),
    /// The closed law of a single film's peak wavelengths. For peak tables only.
    ThinFilmLaw(ThinFilmLawDesign),
}

/// What a job says of a parameter: a number fixes it, a text ties it to others, a table frees it.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum ParameterFile {
    /// Kept at this value.
    Fixed(f64),
    /// Computed from other parameters: `"2 * cortex.thickness_nm + 10"`.
    Tied(String),
    /// Fitted.
    Free(FreeFile),
}

/// A free parameter; what is left out comes from its declaration.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct FreeFile {
    /// First start.
    pub start: Option<f64>,
    /// Smallest allowed value.
    pub lower: Option<f64>,
    /// Largest allowed value.
    pub upper: Option<f64>,
    /// What is known beforehand.
    pub prior: Option<PriorFile>,
}

/// A Gaussian prior.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PriorFile {
    /// Expected value.
    pub mean: f64,
    /// Its standard deviation.
    pub sigma: f64,
}

/// Other assumptions on the same data. What is left out is as in the main case.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AlternativeFile {
    /// Short name.
    pub case: String,
    /// What it assumes, a sentence.
    #[serde(default)]
    pub assumes: String,
    /// Another offset of the inclinations, degrees.
    pub theta_offset_deg: Option<f64>,
    /// Another instrument, whole.
    pub instrument: Option<Instrument>,
    /// Another model, whole.
    pub model: Option<ModelFile>,
    /// Another list of parameters, whole.
    pub parameters: Option<BTreeMap<String, ParameterFile>>,
    /// Other settings, whole.
    pub fit: Option<Settings>,
}

impl JobFile {
    /// The main case and the alternatives, each as a job of its own without alternatives.
    pub fn cases(&self) -> Vec<JobFile> {
        let main = JobFile { alternative: Vec::new(), ..self.clone() };
        let others = self.alternative.iter().map(|other| {
            let mut case = main.clone();
            case.case.clone_from(&other.case);
            case.assumes.clone_from(&other.assumes);
            if let Some(offset) = other.theta_offset_deg {
                case.data.theta_offset_deg = offset;
            }
            if let Some(instrument) = &other.instrument {
                case.instrument = instrument.clone();
            }
            if let Some(model) = &other.model {
                case.model = model.clone();
            }
            if let Some(parameters) = &other.parameters {
                case.parameters.clone_from(parameters);
            }
            if let Some(fit) = &other.fit {
                case.fit = fit.clone();
            }
            case
        });
        std::iter::once(main.clone()).chain(others).collect()
    }
}

impl<'de> Deserialize<'de> for ParameterFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(ParameterVisitor)
    }
}

/// Reads the three spellings of a parameter. Written out, since a derived untagged enum would answer every slip with
/// "did not match any variant".
struct ParameterVisitor;

impl<'de> de::Visitor<'de> for ParameterVisitor {
    type Value = ParameterFile;

    fn expecting(&self, formatter: &mut std::fmt::Formatter) -> std::fmt::Result {
        formatter.write_str("a number (fixed), a text (tied) or a table such as { lower = 100, upper = 800 } (free)")
    }

    fn visit_f64<E: de::Error>(self, value: f64) -> Result<Self::Value, E> {
        Ok(ParameterFile::Fixed(value))
    }

    #[expect(clippy::cast_precision_loss, reason = "nobody types an integer beyond 2^53 for a physical quantity")]
    fn visit_i64<E: de::Error>(self, value: i64) -> Result<Self::Value, E> {
        Ok(ParameterFile::Fixed(value as f64))
    }

    fn visit_str<E: de::Error>(self, value: &str) -> Result<Self::Value, E> {
        Ok(ParameterFile::Tied(value.to_owned()))
    }

    fn visit_map<A: de::MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
        FreeFile::deserialize(de::value::MapAccessDeserializer::new(map)).map(ParameterFile::Free)
    }
}
