//! The derivative of a vector of numbers by one of them, with its error.
//!
//! Differences over a step that is halved again and again are extrapolated to step zero (Richardson 1911), each component
//! on its own; of the whole tableau the entry counts whose neighbours agree best, and their disagreement is its error
//! (Ridders 1982), never less than what rounding leaves. No step leaves the range in which the function is defined. Where
//! the range ends, differences to one side are extrapolated instead.
//!
//! Differences to both sides agree perfectly at a kink, on a slope that is on neither side of it. So both sides are
//! extrapolated by themselves too. Half of what lies between them is the least error of any slope; where it is large, their
//! mean is given and the component is marked.

use thiserror::Error;

/// First step, relative to the size of the parameter: less than a fringe of a film whose thickness is the parameter, up
/// to an order of interference of about ten.
const FIRST_STEP: f64 = 0.064;
/// Halvings of the step: down to 1e-4 of the first one, where rounding has long outgrown the curvature.
const LEVELS: i32 = 14;
/// Room to one side that is too little for differences to both, relative to the size of the parameter.
const LEAST_ROOM: f64 = 1e-3;
/// Two slopes differ if they do so by more than this many times their errors, and by more than [`LEAST_KINK`].
const KINK: f64 = 10.0;
/// A kink whose slopes differ by less than this share is none to anybody: half of it is part of the error anyway.
const LEAST_KINK: f64 = 1e-6;

/// Where the function is defined along one parameter, and how large the parameter usually is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// Smallest value.
    pub lower: f64,
    /// Largest value.
    pub upper: f64,
    /// Size that steps are counted in: the value itself, or where it is 0 the extent of what it may be.
    pub size: f64,
}

/// On which sides of the point the differences were taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// On both.
    Both,
    /// Above it alone: the point stands at the lower end of the range.
    Above,
    /// Below it alone: the point stands at the upper end.
    Below,
}

/// Slopes of all components.
#[derive(Debug, Clone, PartialEq)]
pub struct Derivative {
    /// Slope of each component.
    pub slopes: Vec<f64>,
    /// Error of each: what extrapolation, rounding or the difference of both sides leaves open, whichever is most.
    pub errors: Vec<f64>,
    /// Smallest step behind each slope.
    pub steps: Vec<f64>,
    /// Components that have a kink here: the slope is the mean of both sides, its error half their difference.
    pub kinks: Vec<bool>,
    /// Where the differences were taken.
    pub side: Side,
}

/// Why there is no derivative.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum DerivativeError<E> {
    /// The range is empty around the point.
    #[error("there is no room for a step around {at} between {lower} and {upper}")]
    NoRoom {
        /// The point.
        at: f64,
        /// Lower end of the range.
        lower: f64,
        /// Upper end.
        upper: f64,
    },
    /// The function refused a value, in its own words.
    #[error(transparent)]
    Function(E),
}

/// The derivative of `function` at `at`.
///
/// `function` gives the same number of finite components at every value between `range.lower` and `range.upper`, and is
/// called there alone, about thirty times.
///
/// # Errors
/// If the range has no room on either side, or the function refuses a value.
pub fn derivative<E>(
    function: impl Fn(f64) -> Result<Vec<f64>, E>,
    at: f64,
    range: Range,
) -> Result<Derivative, DerivativeError<E>> {
    let (below, above) = (at - range.lower, range.upper - at);
    let least = LEAST_ROOM * range.size;
    let side = match (below >= least, above >= least) {
        (true, true) => Side::Both,
        (_, _) if above >= below => Side::Above,
        (_, _) => Side::Below,
    };
    let room = match side {
        Side::Both => below.min(above),
        Side::Above => above,
        Side::Below => below,
    };
    let first_step = room.min(FIRST_STEP * range.size);
    // A step must change the value at every level.
    if first_step.is_nan() || first_step * 0.5f64.powi(LEVELS) <= f64::EPSILON * at.abs() {
        return Err(DerivativeError::NoRoom { at, lower: range.lower, upper: range.upper });
    }
    let call = |value: f64| function(value).map_err(DerivativeError::Function);
    let here = call(at)?;
    let mut above_by_level = Vec::new();
    let mut below_by_level = Vec::new();
    let mut step = first_step;
    for _ in 0..LEVELS {
        if side != Side::Below {
            above_by_level.push(Probe::new((at + step).min(range.upper), at, call)?);
        }
        if side != Side::Above {
            below_by_level.push(Probe::new((at - step).max(range.lower), at, call)?);
        }
        step /= 2.0;
    }
    let mut result = Derivative { slopes: Vec::new(), errors: Vec::new(), steps: Vec::new(), kinks: Vec::new(), side };
    for (component, &value_here) in here.iter().enumerate() {
        let one_sided = |probes: &[Probe]| {
            let slopes = probes.iter().map(|probe| {
                let change = probe.values[component] - value_here;
                let size = value_here.abs().max(probe.values[component].abs());
                Slope { value: change / probe.step, step: probe.step.abs(), size }
            });
            extrapolated(&slopes.collect::<Vec<_>>(), 1)
        };
        let (found, is_kink) = match side {
            Side::Above => (one_sided(&above_by_level), false),
            Side::Below => (one_sided(&below_by_level), false),
            Side::Both => {
                let slopes = above_by_level.iter().zip(&below_by_level).map(|(up, down)| {
                    let width = up.step - down.step;
                    let change = up.values[component] - down.values[component];
                    let size = up.values[component].abs().max(down.values[component].abs());
                    Slope { value: change / width, step: width / 2.0, size }
                });
                let central = extrapolated(&slopes.collect::<Vec<_>>(), 2);
                let (up, down) = (one_sided(&above_by_level), one_sided(&below_by_level));
                let gap = (up.slope - down.slope).abs();
                let size = up.slope.abs().max(down.slope.abs());
                if gap > KINK * (up.error + down.error) && gap > LEAST_KINK * size {
                    let mean = Extrapolated {
                        slope: (up.slope + down.slope) / 2.0,
                        error: gap / 2.0 + up.error + down.error,
                        step: up.step.min(down.step),
                    };
                    (mean, true)
                } else {
                    // One-sided errors say how much of the gap is their own.
                    let unexplained = (gap - up.error - down.error).max(0.0);
                    (Extrapolated { error: central.error.max(unexplained / 2.0), ..central }, false)
                }
            }
        };
        result.slopes.push(found.slope);
        result.errors.push(found.error);
        result.steps.push(found.step);
        result.kinks.push(is_kink);
    }
    Ok(result)
}

/// The function at one value beside the point.
struct Probe {
    /// Value minus point, as it was really made.
    step: f64,
    values: Vec<f64>,
}

impl Probe {
    fn new<E>(value: f64, at: f64, call: impl Fn(f64) -> Result<Vec<f64>, E>) -> Result<Self, E> {
        Ok(Self { step: value - at, values: call(value)? })
    }
}

/// A difference over one step.
struct Slope {
    value: f64,
    step: f64,
    /// Size of the numbers whose difference it is.
    size: f64,
}

struct Extrapolated {
    slope: f64,
    error: f64,
    step: f64,
}

/// Neville's tableau of differences whose steps halve: their error falls with the powers `order`, 2·`order`, … of the step.
fn extrapolated(slopes: &[Slope], order: i32) -> Extrapolated {
    let ratio = 2f64.powi(order);
    let mut best = Extrapolated { slope: f64::NAN, error: f64::INFINITY, step: f64::NAN };
    let mut previous: Vec<f64> = Vec::new();
    for slope in slopes {
        let mut row = vec![slope.value];
        // Two roundings of the size of the numbers go into a difference, and extrapolation may add as much again.
        let rounding = 4.0 * f64::EPSILON * slope.size / slope.step;
        let mut factor = 1.0;
        for (column, coarser) in previous.iter().enumerate() {
            factor *= ratio;
            let finer = row[column];
            let value = finer + (finer - coarser) / (factor - 1.0);
            let error = (value - finer).abs().max((value - coarser).abs()).max(rounding);
            if error < best.error {
                best = Extrapolated { slope: value, error, step: slope.step };
            }
            row.push(value);
        }
        previous = row;
    }
    best
}
