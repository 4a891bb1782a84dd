//! Where a measurement, a model and the engine meet: a job as it is typed, as it is meant, and what came out of it.

mod outcome;

pub use outcome::{
    Case, CaseData, InputFile, MaterialNote, ModelNote, Outcome, PeakFit, Prediction, Reference, SpectrumFit, Support,
    ThicknessOrder, Truth,
};
