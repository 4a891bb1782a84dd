//! The absorbers of a model: σ(λ) = Σ amount · shape(λ), each with parameters of its own.
//!
//! | parameter | unit | meaning |
//! | --- | --- | --- |
//! | `<name>.amount` | of the model | absorption at the shape's reference (500 nm for a power law, the top of bands) |
//! | `<name>.shift_per_cm` | 1/cm | carotenoids: how far the bands lie to the red of those in hexane |
//! | `<name>.shift_nm` | nm | other bands: how far they lie to the red of where the job puts them |
//! | `<name>.width` | | bands: width over that in the job, or in hexane; their height stays |
//!
//! Shapes that do not move are sampled once, when the model is made. A sum of bands describes a spectrum; that it fits does
//! not say which molecules absorb.

use super::ModelError;
use super::channel_parameters::{Declarations, place_in_rgb};
use super::coated_base::check_name;
use super::cylinder::absorption_for_albedo;
use crate::parameter::{Parameter, Spread};
use crate::pigment::{
    AbsorptionSpectrum, AbsorptionTable, Band, ColourRule, EUMELANIN_RGB, InversionError, PHEOMELANIN_RGB,
    PigmentDesign, PigmentError, Scale, chiang_absorption,
};

/// What an amount means in the model that holds the absorbers.
#[derive(Debug, Clone, Copy)]
pub(super) struct AmountScale {
    /// Unit of an amount.
    pub(super) unit: &'static str,
    /// Amount where a job says nothing.
    pub(super) default: f64,
    /// Largest amount.
    pub(super) upper: f64,
    /// Whether the model is a fibre, whose absorption a colour can give.
    pub(super) fibre: bool,
}

/// Several absorbers, for a fixed list of wavelengths.
#[derive(Debug, Clone)]
pub(super) struct Absorbers {
    wavelengths_nm: Vec<f64>,
    absorbers: Vec<Absorber>,
}

#[derive(Debug, Clone)]
struct Absorber {
    /// Position of its amount among the values.
    amount: usize,
    shape: Shape,
}

#[derive(Debug, Clone)]
enum Shape {
    /// Absorption of one unit in each channel.
    Still(Vec<f64>),
    /// Bands; the positions of shift and width among the values.
    Moving { scale: Scale, bands: Vec<Band>, shift: usize, width: usize },
}

impl Absorbers {
    /// Declares the parameters of these absorbers.
    ///
    /// # Errors
    /// Two of one name, a name that cannot be one, a colour or a band that cannot be, RGB where there are not three channels.
    pub(super) fn declare(
        designs: &[PigmentDesign],
        wavelengths_nm: &[f64],
        scale: AmountScale,
        declarations: &mut Declarations,
    ) -> Result<Self, ModelError> {
        let mut absorbers = Vec::new();
        for (position, design) in designs.iter().enumerate() {
            let name = design.name();
            check_name("pigment", name)?;
            if designs[..position].iter().any(|other| other.name() == name) {
                return Err(ModelError::TwoPigments { name: name.to_owned() });
            }
            let amount = declarations.number(Parameter {
                name: format!("{name}.amount"),
                symbol: format!("c {name}"),
                unit: scale.unit,
                default: scale.default,
                lower: 0.0,
                upper: scale.upper,
                spread: Spread::Linear,
                scan_step: None,
                text: format!("absorption of {name} at its reference"),
            });
            absorbers.push(Absorber { amount, shape: shape(design, wavelengths_nm, scale.fibre, declarations)? });
        }
        Ok(Self { wavelengths_nm: wavelengths_nm.to_vec(), absorbers })
    }

    /// Σ amount · shape in each channel, for these values of all the model's parameters.
    pub(super) fn absorption(&self, values: &[f64]) -> Vec<f64> {
        let mut sums = vec![0.0; self.wavelengths_nm.len()];
        for absorber in &self.absorbers {
            let amount = values[absorber.amount];
            match &absorber.shape {
                Shape::Still(shape) => {
                    for (sum, shape) in sums.iter_mut().zip(shape) {
                        *sum += amount * shape;
                    }
                }
                Shape::Moving { scale, bands, shift, width } => {
                    // To the red is to smaller wavenumbers, and to longer wavelengths.
                    let shift = match scale {
                        Scale::Wavenumber => values[*shift],
                        Scale::Wavelength => -values[*shift],
                    };
                    for (sum, &wavelength_nm) in sums.iter_mut().zip(&self.wavelengths_nm) {
                        let position = scale.position(wavelength_nm) + shift;
                        let each = bands.iter().map(|band| {
                            let x = (position - band.peak) / (band.width * values[*width]);
                            band.height * (-0.5 * x * x).exp()
                        });
                        *sum += amount * each.sum::<f64>();
                    }
                }
            }
        }
        sums
    }
}

/// The shape of one absorber, with the parameters that move it.
fn shape(
    design: &PigmentDesign,
    wavelengths_nm: &[f64],
    fibre: bool,
    declarations: &mut Declarations,
) -> Result<Shape, ModelError> {
    let name = design.name();
    let pigment = |problem: PigmentError| ModelError::Pigment { name: name.to_owned(), problem };
    let sampled = |spectrum: AbsorptionSpectrum| spectrum.sample(wavelengths_nm).map(Shape::Still).map_err(pigment);
    match design {
        PigmentDesign::Eumelanin { .. } => sampled(AbsorptionSpectrum::eumelanin()),
        PigmentDesign::Pheomelanin { .. } => sampled(AbsorptionSpectrum::pheomelanin()),
        PigmentDesign::EumelaninRgb { .. } => in_rgb(name, wavelengths_nm, EUMELANIN_RGB),
        PigmentDesign::PheomelaninRgb { .. } => in_rgb(name, wavelengths_nm, PHEOMELANIN_RGB),
        PigmentDesign::Carotenoid { .. } => match AbsorptionSpectrum::carotenoid(0.0) {
            AbsorptionSpectrum::Bands { scale, bands, .. } => moving(name, scale, bands, declarations),
            still => sampled(still),
        },
        PigmentDesign::Bands { bands, .. } => {
            if bands.is_empty() {
                return Err(pigment(PigmentError::NoBands));
            }
            let bands: Vec<Band> = bands
                .iter()
                .map(|band| Band { peak: band.peak_nm, width: band.width_nm, height: band.height })
                .collect();
            for band in &bands {
                band.at(band.peak).map_err(pigment)?;
            }
            moving(name, Scale::Wavelength, bands, declarations)
        }
        PigmentDesign::Table { rows, .. } => {
            let table = AbsorptionTable::new(rows.clone()).map_err(pigment)?;
            let values = AbsorptionSpectrum::Table(table).sample(wavelengths_nm).map_err(pigment)?;
            match values.iter().zip(wavelengths_nm).find(|(value, _)| **value < 0.0) {
                Some((&absorption, &wavelength_nm)) => {
                    Err(pigment(PigmentError::Negative { wavelength_nm, absorption }))
                }
                None => Ok(Shape::Still(values)),
            }
        }
        PigmentDesign::Colour { .. } if !fibre => Err(ModelError::PigmentNeedsFibre { name: name.to_owned() }),
        PigmentDesign::Colour { colour, by, beta_n, eta, .. } => {
            let absorption = |colour: f64| match by {
                ColourRule::Chiang => chiang_absorption(colour, beta_n.unwrap_or(0.3)),
                ColourRule::Albedo => {
                    let eta = eta.unwrap_or(1.55);
                    if !(1.0..=3.0).contains(&eta) {
                        return Err(InversionError::Index(eta));
                    }
                    absorption_for_albedo(eta, 0.0, colour)
                }
            };
            let [red, green, blue] = colour.map(absorption);
            let of = |channel: Result<f64, InversionError>| {
                channel.map_err(|problem| ModelError::Colour { name: name.to_owned(), problem })
            };
            in_rgb(name, wavelengths_nm, [of(red)?, of(green)?, of(blue)?])
        }
    }
}

/// A shape known in red, green and blue.
fn in_rgb(name: &str, wavelengths_nm: &[f64], rgb: [f64; 3]) -> Result<Shape, ModelError> {
    if wavelengths_nm.len() != 3 {
        return Err(ModelError::PigmentNeedsRgb { name: name.to_owned(), channels: wavelengths_nm.len() });
    }
    Ok(Shape::Still((0..3).map(|channel| rgb[place_in_rgb(wavelengths_nm, channel)]).collect()))
}

/// Bands with parameters that shift and widen them.
fn moving(name: &str, scale: Scale, bands: Vec<Band>, declarations: &mut Declarations) -> Result<Shape, ModelError> {
    let (suffix, unit, lower, upper) = match scale {
        Scale::Wavenumber => ("shift_per_cm", "1/cm", -1000.0, 4000.0),
        Scale::Wavelength => ("shift_nm", "nm", -100.0, 100.0),
    };
    let shift = declarations.number(Parameter {
        name: format!("{name}.{suffix}"),
        symbol: format!("Δ {name}"),
        unit,
        default: 0.0,
        lower,
        upper,
        spread: Spread::Linear,
        scan_step: None,
        text: format!("how far the bands of {name} are moved to the red"),
    });
    let width = declarations.number(Parameter {
        name: format!("{name}.width"),
        symbol: format!("w {name}"),
        unit: "",
        default: 1.0,
        lower: 0.3,
        upper: 5.0,
        spread: Spread::Logarithmic,
        scan_step: None,
        text: format!("width of the bands of {name} over that of the undisturbed ones"),
    });
    Ok(Shape::Moving { scale, bands, shift, width })
}
