//! Where a measurement, a model and the engine meet: a job as it is typed, as it is meant, and what came out of it.

mod outcome;

pub use outcome::{
    Case, CaseData, InputFile, ModelNote, Outcome, PeakFit, Prediction, SpectrumFit, Support, ThicknessOrder, Truth,
};

pub use crate::optics::{MaterialNote, Reference};
