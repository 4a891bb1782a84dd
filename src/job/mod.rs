//! Where a measurement, a model and the engine meet: a job as it is typed, as it is meant, and what came out of it.

mod answer;
mod case;
mod describe;
mod draft;
mod error;
mod file;
mod film_peaks;
mod held_out;
mod json;
mod load;
mod lobes;
mod model_note;
mod models;
mod origin;
mod outcome;
mod peaks;
mod pigments;
mod population;
mod predict;
mod run;
mod schema;
mod simulate;
mod spectra;
mod support;
mod sweep;
mod syntax;
mod synthetic;
mod values;

pub use case::CheckedCase;
pub use describe::describe;
pub use draft::draft;
pub use error::JobError;
pub use file::{AlternativeFile, DataFile, FreeFile, JobFile, ModelFile, ParameterFile, PriorFile, SyntheticFile};
pub use load::Job;
pub use lobes::{ModelLobes, model_lobes};
pub use models::{ModelEntry, models};
pub use outcome::{
    Case, CaseData, Comparison, ComparisonRow, HeldOut, InputFile, LightLobes, Lobes, ModelNote, Outcome, PeakFit,
    Prediction, SpectrumFit, Support, ThicknessOrder, Truth,
};
pub use population::{
    AbsorberTest, Effects, LeftOut, ParameterSpread, Population, Specimen, SpecimenSpectrum, SpecimensFile,
};
pub use run::run;
pub use schema::schemas;
pub use simulate::{Noise, simulate};
pub use sweep::{
    AxisFile, Cell, Colour, Companion, Excursion, Own, Rate, RenderFile, Slope, SobolFile, Spacing, Sweep, SweepAxis,
    SweepFile, Variance, VarianceOf, Varying, View, sweep,
};

pub(crate) use syntax::model_slip;

pub use crate::optics::{MaterialNote, Reference};
