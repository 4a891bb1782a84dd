//! From a colour back to an absorption.

/// Why no absorption gives a colour.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum InversionError {
    /// A colour that no reflectance can be.
    #[error("a colour must be a number above 0 and at most 1, linear and not sRGB-encoded, but {0} was given")]
    Colour(f64),
    /// A roughness out of range.
    #[error("the roughness beta_n must be between 0 and 1, but {0} was given")]
    Roughness(f64),
    /// An index that no fibre has.
    #[error("the refractive index eta of the fibre must be between 1 and 3, but {0} was given")]
    Index(f64),
    /// Brighter than without absorption.
    #[error("an albedo of {target} cannot be reached: without any absorption this body has {brightest}")]
    TooBright {
        /// What was asked.
        target: f64,
        /// Albedo without absorption.
        brightest: f64,
    },
    /// Darker than with endless absorption.
    #[error(
        "an albedo of {target} cannot be reached: what the surface alone reflects is {darkest}, and no pigment takes that away"
    )]
    TooDark {
        /// What was asked.
        target: f64,
        /// Albedo of the surface alone.
        darkest: f64,
    },
}

/// σₐ, 1/radius, of fibres that look `colour` in one channel of linear light, by the fit of Chiang et al. 2016 (eq. 9):
/// (ln c / (5.969 − 0.215 β + 2.532 β² − 10.73 β³ + 5.574 β⁴ + 0.245 β⁵))², β = βₙ.
///
/// The fit is for many scatterings in dense white-lit fur, where light has passed many fibres. For a single fibre, or a feather
/// of few layers, it gives far too little absorption: there the albedo of the model itself is to be inverted.
///
/// # Errors
/// If the colour is not in (0, 1] or the roughness not in [0, 1].
pub fn chiang_absorption(colour: f64, beta_n: f64) -> Result<f64, InversionError> {
    if !(colour > 0.0 && colour <= 1.0) {
        return Err(InversionError::Colour(colour));
    }
    if !(0.0..=1.0).contains(&beta_n) {
        return Err(InversionError::Roughness(beta_n));
    }
    let b = beta_n;
    let denominator = 5.969 + b * (-0.215 + b * (2.532 + b * (-10.73 + b * (5.574 + b * 0.245))));
    let root = colour.ln() / denominator;
    Ok(root * root)
}

/// The x ≥ 0 at which a decreasing function has a given value, to 1e-13 of it or of 1.
///
/// `at` is the albedo over absorption, `at_infinity` its limit, what the surface alone reflects. Bisection inside a
/// bracket that is doubled until it holds the value: it cannot fail on a function that decreases, whatever its slope.
///
/// # Errors
/// If the value is above `at(0)`, or at or below the limit.
pub fn solve_decreasing(at: impl Fn(f64) -> f64, at_infinity: f64, target: f64) -> Result<f64, InversionError> {
    let brightest = at(0.0);
    if target.is_nan() || target > brightest + 1e-12 {
        return Err(InversionError::TooBright { target, brightest });
    }
    if target <= at_infinity {
        return Err(InversionError::TooDark { target, darkest: at_infinity });
    }
    if target >= brightest {
        return Ok(0.0);
    }
    let (mut low, mut high) = (0.0, 1.0);
    while at(high) > target {
        low = high;
        high *= 2.0;
        // Nothing is darker at 1e6 radii than at infinity, in double precision.
        if high > 1e6 {
            return Err(InversionError::TooDark { target, darkest: at_infinity });
        }
    }
    while high - low > 1e-13 * high.max(1.0) {
        let middle = 0.5 * (low + high);
        // Neighbouring numbers have no middle.
        if middle <= low || middle >= high {
            break;
        }
        if at(middle) > target {
            low = middle;
        } else {
            high = middle;
        }
    }
    Ok(0.5 * (low + high))
}
