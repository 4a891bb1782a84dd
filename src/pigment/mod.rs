//! Absorbers, and the absorption behind a colour. Knows nothing of the bodies that hold them.
//!
//! A fibre's absorption is a sum over its absorbers, σₐ(λ) = Σ amount · spectrum(λ), in 1/radius of the fibre. A spectrum
//! here is a pure shape, about 1 at its reference, so that an amount is the absorption there: σₐ per radius needs no
//! knowledge of the radius, while a concentration does. To get 1/mm, divide by the radius in mm.
//!
//! [`PigmentDesign`] is an absorber as a job types it, [`AbsorptionSpectrum`] is one absorber: a power law (melanins), a sum of bands (carotenoids and others), a table.
//! [`absorption_from_concentrations`] is the customary pair of melanins in linear RGB. [`chiang_absorption`] guesses the absorption
//! behind a colour by a published fit, [`solve_decreasing`] finds it exactly for any body whose albedo can be computed.

mod design;
mod inversion;
mod spectrum;

pub use design::{BandDesign, ColourRule, PigmentDesign};
pub use inversion::{InversionError, chiang_absorption, solve_decreasing};
pub use spectrum::{AbsorptionSpectrum, AbsorptionTable, Band, PigmentError, Scale};

/// Absorption of human-hair eumelanin for one unit of concentration, linear RGB, in 1/radius (d'Eon et al. 2011, used by Chiang
/// et al. 2016). Known at second hand, from renderers that agree; the unit of concentration is theirs and arbitrary.
pub const EUMELANIN_RGB: [f64; 3] = [0.419, 0.697, 1.37];

/// The same for pheomelanin, the reddish one.
pub const PHEOMELANIN_RGB: [f64; 3] = [0.187, 0.4, 1.05];

/// σₐ in linear RGB, 1/radius, of these concentrations of [`EUMELANIN_RGB`] and [`PHEOMELANIN_RGB`].
///
/// # Errors
/// If a concentration is negative or no number.
pub fn absorption_from_concentrations(eumelanin: f64, pheomelanin: f64) -> Result<[f64; 3], PigmentError> {
    for amount in [eumelanin, pheomelanin] {
        if !(amount >= 0.0 && amount.is_finite()) {
            return Err(PigmentError::Amount(amount));
        }
    }
    Ok(std::array::from_fn(|c| eumelanin * EUMELANIN_RGB[c] + pheomelanin * PHEOMELANIN_RGB[c]))
}
