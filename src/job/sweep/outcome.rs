//! What came of a sweep: all that its report needs.

use super::grid::SweepAxis;
use crate::job::{InputFile, ModelNote};
use crate::measure::colour::{Lab, Xyz};
use crate::measure::{Geometry, Quantity};
use crate::parameter::{Parameter, Spread};
use crate::sensitivity::{Indices, Side, SobolSettings};

/// The result of a sweep. Same inputs, same bytes.
#[derive(Debug, Clone, PartialEq)]
pub struct Sweep {
    /// Version of Barbule that made it.
    pub barbule_version: String,
    /// The job's name, which names its report folder.
    pub name: String,
    /// The job's title.
    pub title: String,
    /// The job's remarks.
    pub about: String,
    /// The answer in a few sentences.
    pub answer: String,
    /// Files read, with their hashes.
    pub inputs: Vec<InputFile>,
    /// The job file as read, to repeat it.
    pub job_toml: String,
    /// Values that the command line set, `name = value`.
    pub settings: Vec<String>,
    /// The model.
    pub model: ModelNote,
    /// Meaning of the readings.
    pub quantity: Quantity,
    /// The geometries that are read, in the order of the job's data.
    pub views: Vec<View>,
    /// The swept parameters; cells run through the last one first.
    pub axes: Vec<SweepAxis>,
    /// Every combination of the axes' values.
    pub cells: Vec<Cell>,
    /// The job's own values.
    pub own: Own,
    /// What a reader must know of the colours, or why there are none.
    pub colour_note: String,
    /// Slopes at the job's own values, one a parameter that is swept or free.
    pub slopes: Vec<Slope>,
    /// Slopes along the sweep, by the swept parameter, where there is one; one a cell.
    pub slopes_along: Vec<Slope>,
    /// What each parameter does on its own over its range.
    pub excursions: Vec<Excursion>,
    /// Shares of the variance, or the reason why there are none.
    pub variance: Result<Variance, String>,
}

/// One geometry's wavelengths.
#[derive(Debug, Clone, PartialEq)]
pub struct View {
    /// Name in the data.
    pub id: String,
    /// Angles of light and viewer.
    pub geometry: Geometry,
    /// Wavelengths, nm.
    pub wavelengths_nm: Vec<f64>,
}

/// A colour as numbers and on a screen.
#[derive(Debug, Clone, PartialEq)]
pub struct Colour {
    /// Tristimulus values.
    pub xyz: Xyz,
    /// CIELAB.
    pub lab: Lab,
    /// As the web writes it: `#1a2b3c`.
    pub hex: String,
    /// Whether a screen cannot show it and `hex` is the nearest in each channel.
    pub clipped: bool,
}

/// One cell of the grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    /// Value of each axis.
    pub values: Vec<f64>,
    /// Value of every parameter, in the order of [`Own::parameters`].
    pub parameters: Vec<f64>,
    /// Readings, one list a view.
    pub readings: Vec<Vec<f64>>,
    /// Colours, one a view; empty where readings have none.
    pub colours: Vec<Colour>,
}

/// The job's own values and what they give.
#[derive(Debug, Clone, PartialEq)]
pub struct Own {
    /// Every parameter with its value.
    pub parameters: Vec<(Parameter, f64)>,
    /// Readings, one list a view.
    pub readings: Vec<Vec<f64>>,
    /// Colours, one a view; empty where readings have none.
    pub colours: Vec<Colour>,
}

/// How fast readings and colours change with one parameter at one point.
#[derive(Debug, Clone, PartialEq)]
pub struct Slope {
    /// The parameter's declaration.
    pub parameter: Parameter,
    /// Its value at the point.
    pub at: f64,
    /// On which sides differences were taken.
    pub side: Side,
    /// ∂reading/∂parameter, one list a view.
    pub readings: Vec<Vec<Rate>>,
    /// ΔE2000 per unit, one a view; empty where readings have no colour.
    pub differences: Vec<Rate>,
}

/// A rate of change per unit of the parameter, with its error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rate {
    /// Change per unit.
    pub per_unit: f64,
    /// Its numerical error.
    pub error: f64,
    /// Smallest step of the parameter behind it.
    pub step: f64,
    /// Whether the slopes on the two sides differ; their mean is given, with half their difference as error.
    pub is_kink: bool,
}

impl Slope {
    /// Change where the parameter grows by 1 % of its value, to first order; none where the value is 0.
    pub fn per_percent(&self, rate: Rate) -> Option<f64> {
        (self.at != 0.0).then(|| 0.01 * self.at.abs() * rate.per_unit)
    }
}

/// One parameter moved over its range, all others at the job's own values.
#[derive(Debug, Clone, PartialEq)]
pub struct Excursion {
    /// The parameter's declaration.
    pub parameter: Parameter,
    /// The job's own value.
    pub own: f64,
    /// Where the values lie in the range, from 0 to 1, and how it is spread.
    pub shares: Vec<f64>,
    /// Values over the range, rising, the own one among them if it lies inside.
    pub values: Vec<f64>,
    /// How they are spread.
    pub spread: Spread,
    /// ΔE2000 to the job's own values, one list a view; empty where readings have no colour.
    pub differences: Vec<Vec<f64>>,
    /// Root mean square change of the readings, one list a view.
    pub changes: Vec<Vec<f64>>,
}

/// Shares of the variance over the ranges of all free parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Variance {
    /// How it was estimated.
    pub settings: SobolSettings,
    /// The free parameters and their ranges.
    pub inputs: Vec<(Parameter, [f64; 2], Spread)>,
    /// One a view and quantity.
    pub outputs: Vec<VarianceOf>,
}

/// What varies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Varying {
    /// The readings of a view, all wavelengths together.
    Readings,
    /// ΔE2000 to the job's own values.
    Difference,
}

/// Shares of the variance of one quantity.
#[derive(Debug, Clone, PartialEq)]
pub struct VarianceOf {
    /// Index of the view.
    pub view: usize,
    /// What varies.
    pub what: Varying,
    /// Its mean over the ranges.
    pub mean: f64,
    /// Its standard deviation; of readings, the root of the mean variance over wavelengths.
    pub standard_deviation: f64,
    /// One an input; none where nothing varies.
    pub indices: Option<Vec<Indices>>,
}
