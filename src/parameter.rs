//! The one declaration of a thing that can be fitted.
//!
//! A model, a layer or an instrument declares each of its parameters once, here. The command line, the schema, the
//! start points of a fit, the table of its result, the labels of plots and the report are all made from it.

/// How start points and steps are spread over a parameter's range.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Spread {
    /// Evenly: an index, an angle, an albedo.
    Linear,
    /// Evenly in the logarithm: a thickness, a gain. Needs a positive lower bound.
    Logarithmic,
}

/// A parameter as its owner declares it.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Name in job files and results, unique in its model: `cortex.thickness_nm`.
    pub name: String,
    /// Symbol on plots and in tables: `d`.
    pub symbol: String,
    /// Unit as written after a value, empty for a pure number: `nm`.
    pub unit: &'static str,
    /// Value that is used where a job says nothing.
    pub default: f64,
    /// Smallest value that makes physical sense.
    pub lower: f64,
    /// Largest value that makes physical sense.
    pub upper: f64,
    /// How starts are spread between the bounds.
    pub spread: Spread,
    /// Set where the misfit has many minima along this parameter (a film's thickness): a scan at this spacing, in the
    /// parameter's unit, does not step over any of them.
    pub scan_step: Option<f64>,
    /// One line that says what it means.
    pub text: String,
}

impl Parameter {
    /// Whether a value is a number inside the bounds.
    pub fn allows(&self, value: f64) -> bool {
        (self.lower..=self.upper).contains(&value)
    }
}
