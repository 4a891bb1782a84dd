//! Spectra and a scattering model as the fit engine sees them.

use std::ops::Range;

use super::JobError;
use crate::bsdf::Model;
use crate::fit::Residuals;
use crate::measure::{Aperture, Band, Calibration, Compared, Instrument, Quantity, Spectrum};
use crate::parameter::{Parameter, Spread};

/// Makes the model for a list of wavelengths.
pub(super) type ModelMaker<'a> = dyn Fn(&[f64]) -> Result<Box<dyn Model>, JobError> + 'a;

/// Readings of spectra against a model seen through an instrument.
#[derive(Debug)]
pub(super) struct SpectraProblem {
    /// The model's parameters, then the instrument's gains and offsets.
    parameters: Vec<Parameter>,
    /// Rows that each parameter touches.
    touched: Vec<Range<usize>>,
    model_parameters: usize,
    /// Spectra of equal wavelengths share a model.
    groups: Vec<Group>,
    compare: Compared,
    residual_count: usize,
    sigma_known: bool,
    coarse: Option<Box<SpectraProblem>>,
}

#[derive(Debug)]
struct Group {
    model: Box<dyn Model>,
    band: Band,
    items: Vec<Item>,
}

#[derive(Debug)]
struct Item {
    aperture: Aperture,
    gain: usize,
    offset: usize,
    /// First of this spectrum's rows.
    first_row: usize,
    /// What is compared with the model: the readings, or their cube roots.
    targets: Vec<f64>,
    inverse_sigmas: Vec<f64>,
}

/// What a problem is made of.
pub(super) struct SpectraSetup<'a> {
    /// Makes the model.
    pub(super) make_model: &'a ModelMaker<'a>,
    /// Meaning of the readings.
    pub(super) quantity: Quantity,
    /// The spectra to compare with.
    pub(super) spectra: &'a [Spectrum],
    /// What of readings and model is compared.
    pub(super) compare: Compared,
    /// What stands between model and readings.
    pub(super) instrument: &'a Instrument,
    /// Rings of directions in an open cone.
    pub(super) rings: usize,
}

impl SpectraProblem {
    /// The full problem, with a coarse one inside it.
    pub(super) fn new(setup: &SpectraSetup) -> Result<Self, JobError> {
        let mut problem = Self::without_coarse(setup)?;
        if let Some(spectra) = coarse_spectra(setup.spectra) {
            let coarse = Self::without_coarse(&SpectraSetup { spectra: &spectra, ..*setup })?;
            // A model with a parameter a channel has others on fewer channels.
            problem.coarse = same_names(&coarse.parameters, &problem.parameters).then(|| Box::new(coarse));
        }
        Ok(problem)
    }

    fn without_coarse(setup: &SpectraSetup) -> Result<Self, JobError> {
        let mut groups: Vec<Group> = Vec::new();
        let mut grids: Vec<&[f64]> = Vec::new();
        let mut parameters = Vec::new();
        let mut model_parameters = 0;
        let mut residual_count = 0;
        for (index, spectrum) in setup.spectra.iter().enumerate() {
            let grid = spectrum.wavelengths_nm.as_slice();
            let position = match grids.iter().position(|known| *known == grid) {
                Some(position) => position,
                None => {
                    let band = Band::new(grid, setup.instrument.bandwidth_nm);
                    let model = (setup.make_model)(&band.wavelengths_nm)?;
                    if groups.is_empty() {
                        parameters = model.parameters().to_vec();
                        model_parameters = parameters.len();
                        parameters.extend(calibration_parameters(setup.instrument, setup.spectra));
                    } else if !same_names(model.parameters(), &parameters[..model_parameters]) {
                        let problem = "a parameter with one value a channel needs every spectrum at the same wavelengths; \
                                       make them the same with `window_nm` and `stride`";
                        return Err(JobError::key("model.per_channel", problem));
                    }
                    grids.push(grid);
                    groups.push(Group { model, band, items: Vec::new() });
                    groups.len() - 1
                }
            };
            let gains = gain_count(setup.instrument.gain, setup.spectra.len());
            groups[position].items.push(Item {
                aperture: Aperture::new(&spectrum.geometry, setup.instrument, setup.quantity, setup.rings),
                gain: model_parameters + if setup.instrument.gain == Calibration::PerSpectrum { index } else { 0 },
                offset: model_parameters
                    + gains
                    + if setup.instrument.offset == Calibration::PerSpectrum { index } else { 0 },
                first_row: residual_count,
                targets: spectrum.values.iter().map(|value| setup.compare.of(*value)).collect(),
                inverse_sigmas: inverse_sigmas(spectrum, setup.compare)?,
            });
            residual_count += grid.len();
        }
        let mut touched = vec![0..residual_count; parameters.len()];
        for item in groups.iter().flat_map(|group| &group.items) {
            let rows = item.first_row..item.first_row + item.targets.len();
            if setup.instrument.gain == Calibration::PerSpectrum {
                touched[item.gain] = rows.clone();
            }
            if setup.instrument.offset == Calibration::PerSpectrum {
                touched[item.offset] = rows;
            }
        }
        let sigma_known = setup.spectra.iter().all(|spectrum| spectrum.sigmas.is_some());
        let compare = setup.compare;
        Ok(Self { parameters, touched, model_parameters, groups, compare, residual_count, sigma_known, coarse: None })
    }

    /// The model's readings at these parameter values, one vector a spectrum, in the order of the table.
    pub(super) fn readings(&self, values: &[f64]) -> Vec<Vec<f64>> {
        let mut rows = vec![0.0; self.residual_count];
        self.for_each_item(values, &mut rows, |item, readings| {
            for reading in readings {
                *reading = values[item.gain] * *reading + values[item.offset];
            }
        });
        let mut items: Vec<&Item> = self.groups.iter().flat_map(|group| &group.items).collect();
        items.sort_by_key(|item| item.first_row);
        items.iter().map(|item| rows[item.first_row..item.first_row + item.targets.len()].to_vec()).collect()
    }

    /// Writes each spectrum's readings before gain and offset into its rows, then calls `finish` on them.
    fn for_each_item(&self, values: &[f64], rows: &mut [f64], finish: impl Fn(&Item, &mut [f64])) {
        let mut scratch = Vec::new();
        let mut channels = Vec::new();
        for group in &self.groups {
            let bsdf = group.model.bind(&values[..self.model_parameters]);
            scratch.resize(group.model.channel_count(), 0.0);
            channels.resize(group.model.channel_count(), 0.0);
            for item in &group.items {
                let readings = &mut rows[item.first_row..item.first_row + item.targets.len()];
                if group.band.is_sharp() {
                    item.aperture.read(&*bsdf, &mut scratch, readings);
                } else {
                    item.aperture.read(&*bsdf, &mut scratch, &mut channels);
                    group.band.average(&channels, readings);
                }
                finish(item, readings);
            }
        }
    }
}

impl Residuals for SpectraProblem {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn count(&self) -> usize {
        self.residual_count
    }

    fn evaluate(&self, values: &[f64], residuals: &mut [f64]) {
        self.for_each_item(values, residuals, |item, readings| {
            let (gain, offset) = (values[item.gain], values[item.offset]);
            for ((reading, target), inverse_sigma) in readings.iter_mut().zip(&item.targets).zip(&item.inverse_sigmas) {
                *reading = (self.compare.of(gain * *reading + offset) - target) * inverse_sigma;
            }
        });
    }

    fn touched(&self, parameter: usize) -> Range<usize> {
        self.touched[parameter].clone()
    }

    fn coarse(&self) -> Option<&dyn Residuals> {
        self.coarse.as_deref().map(|problem| problem as &dyn Residuals)
    }

    fn sigma_known(&self) -> bool {
        self.sigma_known
    }
}

/// 1/σ of what is compared, or 1 where no σ is known.
fn inverse_sigmas(spectrum: &Spectrum, compare: Compared) -> Result<Vec<f64>, JobError> {
    let Some(sigmas) = &spectrum.sigmas else { return Ok(vec![1.0; spectrum.values.len()]) };
    let inverse = |(value, sigma): (&f64, &f64)| {
        let compared = compare.sigma_of(*value, *sigma);
        compared.is_finite().then_some(1.0 / compared).ok_or_else(|| {
            let problem = format!(
                "spectrum `{}` reads 0, and the cube root of 0 has no σ; leave `sigma` out, or compare values",
                spectrum.id
            );
            JobError::key("data.compare", problem)
        })
    };
    spectrum.values.iter().zip(sigmas).map(inverse).collect()
}

fn same_names(a: &[Parameter], b: &[Parameter]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.name == b.name)
}

fn gain_count(calibration: Calibration, spectra: usize) -> usize {
    match calibration {
        Calibration::PerSpectrum => spectra,
        Calibration::Fixed | Calibration::Shared => 1,
    }
}

/// Declarations of the gains, then of the offsets.
fn calibration_parameters(instrument: &Instrument, spectra: &[Spectrum]) -> Vec<Parameter> {
    let gain = |name: String, text: String| Parameter {
        name,
        symbol: "g".into(),
        unit: "",
        default: 1.0,
        lower: 1e-9,
        upper: 1e9,
        spread: Spread::Logarithmic,
        scan_step: None,
        text,
    };
    let offset = |name: String, text: String| Parameter {
        name,
        symbol: "o".into(),
        unit: "",
        default: 0.0,
        lower: -10.0,
        upper: 10.0,
        spread: Spread::Linear,
        scan_step: None,
        text,
    };
    let declare = |calibration, word: &str, what: &str, make: &dyn Fn(String, String) -> Parameter| match calibration {
        Calibration::PerSpectrum => spectra
            .iter()
            .map(|spectrum| make(format!("{word}.{}", spectrum.id), format!("{what} spectrum {}", spectrum.id)))
            .collect(),
        Calibration::Fixed | Calibration::Shared => vec![make(word.to_owned(), format!("{what} all spectra"))],
    };
    let mut parameters = declare(instrument.gain, "gain", "Factor between model and reading, for", &gain);
    parameters.extend(declare(instrument.offset, "offset", "Constant added to the model's reading, for", &offset));
    parameters
}

/// Every so-many-th wavelength of each spectrum, about 60 of them, which resolves six fringes and screens starts at a
/// fraction of the cost; None where the spectra are short already.
fn coarse_spectra(spectra: &[Spectrum]) -> Option<Vec<Spectrum>> {
    const CHANNELS: usize = 60;
    let longest = spectra.iter().map(|spectrum| spectrum.wavelengths_nm.len()).max()?;
    let stride = longest / CHANNELS;
    if stride < 2 {
        return None;
    }
    let thin = |values: &[f64]| values.iter().copied().step_by(stride).collect::<Vec<f64>>();
    Some(
        spectra
            .iter()
            .map(|spectrum| Spectrum {
                id: spectrum.id.clone(),
                geometry: spectrum.geometry,
                origin: spectrum.origin.clone(),
                wavelengths_nm: thin(&spectrum.wavelengths_nm),
                values: thin(&spectrum.values),
                sigmas: spectrum.sigmas.as_deref().map(thin),
            })
            .collect(),
    )
}
