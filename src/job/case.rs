//! A case as it is meant: readings, model and parameters, checked against each other.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::file::{DataFile, FreeFile, ModelFile, ParameterFile};
use super::film_peaks::FilmPeaks;
use super::load::input_file;
use super::origin::check_geometry;
use super::peaks::PeaksProblem;
use super::spectra::{SpectraProblem, SpectraSetup};
use super::values::{Values, check_inside, index_of, places_of, said_of};
use super::{InputFile, JobError, JobFile, synthetic};
use crate::bsdf::channel_suffix;
use crate::fit::{Assignment, Control, Fit, FitError, Loss, Prior, Residuals, Role, check, fit, parse_tie};
use crate::measure::{
    Calibration, Compared, Geometry, GonioTable, Instrument, PeakModel, PeakReading, PeakTable, Spectrum, Table,
    TableText, ThinFilmLaw, read_table,
};
use crate::parameter::{Parameter, Spread};

/// A case, checked and ready to be fitted.
#[derive(Debug)]
pub struct CheckedCase {
    /// The job with this case's assumptions.
    pub(super) file: JobFile,
    /// Readings and model.
    pub(super) comparison: Comparison,
    /// Each parameter's role.
    pub(super) assignments: Vec<Assignment>,
}

/// Readings, which of them the fit sees, and what the engine fits to those.
#[derive(Debug)]
pub(super) enum Comparison {
    /// Spectra against a scattering model.
    Spectra(GonioTable, Vec<bool>, SpectraProblem),
    /// Peak wavelengths against a peak model.
    Peaks(PeakTable, Vec<bool>, PeaksProblem),
}

impl Comparison {
    fn residuals(&self) -> &dyn Residuals {
        match self {
            Self::Spectra(_, _, problem) => problem,
            Self::Peaks(_, _, problem) => problem,
        }
    }

    /// Shortest and longest wavelength of all readings, nm.
    pub(super) fn wavelengths_nm(&self) -> [f64; 2] {
        match self {
            Self::Spectra(table, ..) => extent(table.spectra.iter().flat_map(|s| s.wavelengths_nm.iter().copied())),
            Self::Peaks(table, ..) => extent(table.readings.iter().map(|reading| reading.wavelength_nm)),
        }
    }
}

/// Smallest and largest of some numbers.
pub(super) fn extent(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)])
}

/// The readings of a job's data section and the file they came from.
pub(super) fn read_data(
    data: &DataFile,
    folder: &Path,
    file: &JobFile,
) -> Result<(Table, Option<InputFile>), JobError> {
    let mut input = None;
    let mut table = match (&data.file, &data.layout, &data.synthetic) {
        (Some(name), Some(layout), None) => {
            let path = resolve("data.file", name, folder)?;
            let text = TableText::load(&path)?;
            // Read once more for its hash, which must be that of the bytes as they are; the size has been checked.
            let bytes = std::fs::read(&path).map_err(|error| JobError::key("data.file", error.to_string()))?;
            input = Some(input_file(&path, &bytes));
            read_table(&text, layout)?
        }
        (None, None, Some(recipe)) => Table::Spectra(synthetic::readings(recipe, file)?),
        (Some(_), None, None) => {
            let problem = "the table's layout is missing; `barbule new TABLE.csv` writes a job with one";
            return Err(JobError::key("data.layout", problem));
        }
        _ => {
            let problem = "expected either `file` with its `layout`, or `synthetic` alone";
            return Err(JobError::key("data", problem));
        }
    };
    let offset_deg = data.theta_offset_deg;
    let geometries: Vec<&mut Geometry> = match &mut table {
        Table::Spectra(table) => table.spectra.iter_mut().map(|spectrum| &mut spectrum.geometry).collect(),
        Table::Peaks(table) => table.readings.iter_mut().map(|reading| &mut reading.geometry).collect(),
    };
    for geometry in geometries {
        geometry.theta_i_deg += offset_deg;
        geometry.theta_o_deg += offset_deg;
        if !(0.0..90.0).contains(&geometry.theta_i_deg) || !(0.0..90.0).contains(&geometry.theta_o_deg) {
            let problem = format!("{offset_deg}° moves an inclination out of 0 to 90°; choose a smaller offset");
            return Err(JobError::key("data.theta_offset_deg", problem));
        }
    }
    Ok((table, input))
}

/// `$BARBULE_DATA/` at the start of a path stands for the folder that the environment variable names.
pub(super) fn resolve(key: &str, name: &Path, folder: &Path) -> Result<PathBuf, JobError> {
    match name.strip_prefix("$BARBULE_DATA") {
        Err(_) => Ok(folder.join(name)),
        Ok(rest) => match std::env::var_os("BARBULE_DATA") {
            Some(data) => Ok(PathBuf::from(data).join(rest)),
            None => Err(JobError::key(
                key,
                format!(
                    "`{}` lies in the folder of measurements, and the environment variable BARBULE_DATA, which names \
                     that folder, is not set; set it, or write the table's own path",
                    name.display()
                ),
            )),
        },
    }
}

/// Which readings the fit sees.
fn fitted(data: &DataFile, ids: &[(&str, &Geometry)]) -> Result<Vec<bool>, JobError> {
    for name in &data.hold_out {
        if !ids.iter().any(|(id, _)| id == name) {
            let known: Vec<&str> = ids.iter().map(|(id, _)| *id).take(20).collect();
            let problem = format!("there is no reading named `{name}`; the table has {}", known.join(", "));
            return Err(JobError::key("data.hold_out", problem));
        }
    }
    if let Some(every @ (0 | 1)) = data.hold_out_every {
        let problem = format!("found {every}; expected 2 (hold out every other) or more");
        return Err(JobError::key("data.hold_out_every", problem));
    }
    if data.fit_every == 0 {
        return Err(JobError::key("data.fit_every", "found 0; expected 1 (fit all) or more"));
    }
    let mut eligible = 0;
    let fitted: Vec<bool> = ids
        .iter()
        .enumerate()
        .map(|(place, (id, geometry))| {
            let near_mirror = geometry.degrees_from_mirror() < data.hold_out_near_mirror_deg;
            let steep = geometry.theta_i_deg.max(geometry.theta_o_deg);
            let beyond = data.hold_out_beyond_deg.is_some_and(|limit| steep > limit);
            let every = data.hold_out_every.is_some_and(|every| place % every == 0);
            let out = near_mirror || beyond || every || data.hold_out.iter().any(|name| name == id);
            if !out {
                eligible += 1;
            }
            !out && (eligible - 1) % data.fit_every == 0
        })
        .collect();
    if fitted.iter().any(|fitted| *fitted) {
        Ok(fitted)
    } else {
        Err(JobError::key("data", "every reading is held out of the fit; loosen `hold_out` or its angles"))
    }
}

impl CheckedCase {
    /// Fits the free parameters.
    pub fn fit(&self, control: &Control) -> Result<Fit, JobError> {
        Ok(fit(self.residuals(), &self.assignments, &self.file.fit, control)?)
    }

    /// Readings and model as the engine sees them.
    pub fn residuals(&self) -> &dyn Residuals {
        self.comparison.residuals()
    }

    /// Checks one case of a job against its readings.
    pub(super) fn new(file: JobFile, table: Table) -> Result<Self, JobError> {
        check_instrument(&file.instrument)?;
        let mut gains = Values::new();
        let comparison = match table {
            Table::Spectra(table) => {
                check_geometry(&file, &table)?;
                let ids: Vec<_> = table.spectra.iter().map(|s| (s.id.as_str(), &s.geometry)).collect();
                let fitted = fitted(&file.data, &ids)?;
                let problem = spectra_problem(&file, &table, &fitted)?;
                gains = first_gains(&problem, &seen_spectra(&table, &fitted), &file.instrument);
                Comparison::Spectra(table, fitted, problem)
            }
            Table::Peaks(table) => {
                if file.data.compare != Compared::Values {
                    let problem = "peak wavelengths are compared as they are; leave this out";
                    return Err(JobError::key("data.compare", problem));
                }
                let ids: Vec<_> = table.readings.iter().map(|r| (r.id.as_str(), &r.geometry)).collect();
                let fitted = fitted(&file.data, &ids)?;
                let seen = table.readings.iter().zip(&fitted).filter(|(_, fitted)| **fitted);
                let seen: Vec<PeakReading> = seen.map(|(reading, _)| reading.clone()).collect();
                let problem = PeaksProblem::new(peak_model(&file.model, &table)?, seen);
                Comparison::Peaks(table, fitted, problem)
            }
        };
        let residuals = comparison.residuals();
        if file.fit.loss != Loss::Squares && !residuals.sigma_known() {
            let problem = "a robust loss needs to know how large a residual is usual; give the readings a σ \
                           (`sigma` in data.layout), or use `loss = \"squares\"`";
            return Err(JobError::key("fit.loss", problem));
        }
        let assignments = assign(residuals.parameters(), &file.parameters, &file.instrument, &gains)?;
        // With nothing free there is nothing to fit, but a model to look at.
        match check(residuals, &assignments, &file.fit) {
            Ok(()) | Err(FitError::NothingFree) => {}
            Err(error) => return Err(error.into()),
        }
        Ok(Self { file, comparison, assignments })
    }
}

/// The problem of the fitted spectra.
pub(super) fn spectra_problem(file: &JobFile, table: &GonioTable, fitted: &[bool]) -> Result<SpectraProblem, JobError> {
    let spectra = seen_spectra(table, fitted);
    SpectraProblem::new(&SpectraSetup {
        make_model: &|wavelengths_nm| file.model.scattering(wavelengths_nm),
        quantity: table.quantity,
        spectra: &spectra,
        compare: file.data.compare,
        instrument: &file.instrument,
        rings: cone_rings(file)?,
    })
}

fn seen_spectra(table: &GonioTable, fitted: &[bool]) -> Vec<Spectrum> {
    let seen = table.spectra.iter().zip(fitted).filter(|(_, fitted)| **fitted);
    seen.map(|(spectrum, _)| spectrum.clone()).collect()
}

/// Most rings of directions in a cone; a reading then costs up to (4 · 12²)² evaluations.
const MOST_RINGS: usize = 12;

/// Rings of directions in an open cone: enough to resolve the narrowest lobe that the fit may try.
///
/// A Beckmann lobe of roughness α falls to 1/e at a tilt of the half-vector of about α, and a ray that turns by δ tilts the
/// half-vector by δ/2. Gauss–Legendre with 3 + 2a/α rings across a half-angle a holds a reading to 1e-3; the test below
/// measures it.
fn cone_rings(file: &JobFile) -> Result<usize, JobError> {
    let widest_deg = file.instrument.light_half_angle_deg.max(file.instrument.viewer_half_angle_deg);
    let narrowest = match file.parameters.get("roughness") {
        Some(ParameterFile::Fixed(value)) => *value,
        Some(ParameterFile::Free(free)) => free.lower.unwrap_or(0.01),
        // A tie may go anywhere in the declared range; left out, the roughness has its default.
        Some(ParameterFile::Tied(_)) => 0.01,
        None => 0.1,
    };
    let wanted = 3.0 + 2.0 * widest_deg.to_radians() / narrowest;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small positive number, or caught")]
    let rings = wanted.ceil() as usize;
    if rings <= MOST_RINGS {
        return Ok(rings);
    }
    let least = 2.0 * widest_deg.to_radians() / (as_f64(MOST_RINGS) - 3.0);
    let problem = format!(
        "cones of {widest_deg}° are too wide to be summed over a lobe as narrow as roughness {narrowest} allows; give \
         `roughness` a lower bound (or value) of at least {least:.3}, or narrow the cones"
    );
    Err(JobError::key("instrument", problem))
}

#[expect(clippy::cast_precision_loss, reason = "a small count")]
fn as_f64(count: usize) -> f64 {
    count as f64
}

fn check_instrument(instrument: &Instrument) -> Result<(), JobError> {
    let angle = |key: &str, value: f64| {
        if (0.0..=45.0).contains(&value) {
            return Ok(());
        }
        Err(JobError::key(format!("instrument.{key}"), format!("found {value}; expected 0 to 45 degrees")))
    };
    angle("light_half_angle_deg", instrument.light_half_angle_deg)?;
    angle("viewer_half_angle_deg", instrument.viewer_half_angle_deg)?;
    if !(0.0..=100.0).contains(&instrument.bandwidth_nm) {
        let problem = format!("found {}; expected 0 to 100 nm", instrument.bandwidth_nm);
        return Err(JobError::key("instrument.bandwidth_nm", problem));
    }
    Ok(())
}

/// The peak model of a design.
fn peak_model(model: &ModelFile, table: &PeakTable) -> Result<Box<dyn PeakModel>, JobError> {
    let shortest_nm = table.readings.iter().map(|reading| reading.wavelength_nm).fold(f64::INFINITY, f64::min);
    Ok(match model {
        ModelFile::ThinFilmLaw(design) => Box::new(ThinFilmLaw::new(design.clone(), shortest_nm)),
        ModelFile::CoatedBase(design) => Box::new(FilmPeaks::new(design, shortest_nm)?),
        other => {
            let problem = format!(
                "`{}` has no peaks of interference, and the table holds peak wavelengths; use `thin-film-law` or \
                 `coated-base`",
                other.card().kind
            );
            return Err(JobError::key("model.kind", problem));
        }
    })
}

/// First start of each gain: what makes the model as bright as the readings, at the default of all else.
pub(super) fn first_gains(problem: &SpectraProblem, spectra: &[Spectrum], instrument: &Instrument) -> Values {
    let defaults: Vec<f64> = problem.parameters().iter().map(|parameter| parameter.default).collect();
    let readings = problem.readings(&defaults);
    let ratio = |pairs: &mut dyn Iterator<Item = (&Vec<f64>, &Spectrum)>| {
        let (mut measured, mut modelled) = (0.0, 0.0);
        for (model, spectrum) in pairs {
            modelled += model.iter().sum::<f64>();
            measured += spectrum.values.iter().sum::<f64>();
        }
        let ratio = measured / modelled;
        if ratio.is_finite() && ratio > 0.0 { ratio } else { 1.0 }
    };
    let mut pairs = readings.iter().zip(spectra);
    match instrument.gain {
        Calibration::Fixed => Values::new(),
        Calibration::Shared => Values::from([("gain".to_owned(), ratio(&mut pairs))]),
        Calibration::PerSpectrum => {
            pairs.map(|pair| (format!("gain.{}", pair.1.id), ratio(&mut std::iter::once(pair)))).collect()
        }
    }
}

/// Each declared parameter's role, from the job's list.
pub(super) fn assign(
    declared: &[Parameter],
    typed: &BTreeMap<String, ParameterFile>,
    instrument: &Instrument,
    gains: &Values,
) -> Result<Vec<Assignment>, JobError> {
    for name in typed.keys() {
        places_of(declared, name).map_err(|problem| JobError::key(format!("parameters.\"{name}\""), problem))?;
    }
    declared
        .iter()
        .map(|parameter| {
            let key = || format!("parameters.\"{}\"", parameter.name);
            match said_of(typed, &parameter.name) {
                Some(ParameterFile::Fixed(value)) => {
                    check_inside(parameter, *value).map_err(|problem| JobError::key(key(), problem))?;
                    Ok(Assignment { role: Role::Fixed(*value), prior: None })
                }
                Some(ParameterFile::Tied(expression)) => {
                    // What is tied in each channel is tied to the same channel of what has channels.
                    let suffix =
                        typed.keys().find_map(|name| channel_suffix(&parameter.name, name)).unwrap_or_default();
                    let place = |name: &str| {
                        index_of(declared, name).or_else(|_| index_of(declared, &format!("{name}{suffix}")))
                    };
                    let role = parse_tie(expression, |name| place(name).ok());
                    let role = role.map_err(|error| JobError::key(key(), error.to_string()))?;
                    Ok(Assignment { role, prior: None })
                }
                Some(ParameterFile::Free(free)) => {
                    free_assignment(parameter, free, gains).map_err(|problem| JobError::key(key(), problem))
                }
                None if calibrated(&parameter.name, instrument) => {
                    free_assignment(parameter, &FreeFile::default(), gains)
                        .map_err(|problem| JobError::key(key(), problem))
                }
                None => Ok(Assignment { role: Role::Fixed(parameter.default), prior: None }),
            }
        })
        .collect()
}

/// Whether the instrument's section frees this parameter.
fn calibrated(name: &str, instrument: &Instrument) -> bool {
    let is = |word: &str, calibration| {
        calibration != Calibration::Fixed && (name == word || name.starts_with(&format!("{word}.")))
    };
    is("gain", instrument.gain) || is("offset", instrument.offset)
}

/// How far a gain may move from its first estimate, each way.
const GAIN_RANGE: f64 = 1e4;

fn free_assignment(parameter: &Parameter, free: &FreeFile, gains: &Values) -> Result<Assignment, String> {
    let gain = gains.get(&parameter.name).copied();
    let lower = free.lower.unwrap_or_else(|| gain.map_or(parameter.lower, |gain| gain / GAIN_RANGE));
    let upper = free.upper.unwrap_or_else(|| gain.map_or(parameter.upper, |gain| gain * GAIN_RANGE));
    check_inside(parameter, lower)?;
    check_inside(parameter, upper)?;
    if lower >= upper {
        return Err(format!("lower {lower} is not below upper {upper}; exchange them, or write one number to fix it"));
    }
    let middle = match parameter.spread {
        Spread::Logarithmic => (lower * upper).sqrt(),
        Spread::Linear => 0.5 * (lower + upper),
    };
    let usual = gain.unwrap_or(parameter.default);
    let start = free.start.unwrap_or(if (lower..=upper).contains(&usual) { usual } else { middle });
    if !(lower..=upper).contains(&start) {
        return Err(format!("start {start} is not between lower {lower} and upper {upper}; move it between them"));
    }
    let prior = free.prior.as_ref().map(|prior| Prior { mean: prior.mean, sigma: prior.sigma });
    Ok(Assignment { role: Role::Free { start, lower, upper }, prior })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::{CoatedBase, Model};
    use crate::measure::{Aperture, Quantity};

    /// The bar is 1e-3 of the reading in mirror position, where a lobe is narrowest against its cones.
    #[test]
    fn rings_resolve_the_lobe() {
        for (half_angle_deg, roughness) in
            [(1.0, 0.02), (2.0, 0.01), (4.0, 0.05), (8.0, 0.05), (12.0, 0.1), (12.0, 0.5)]
        {
            let text = format!(
                "title = \"cones\"\n[data]\n[instrument]\nlight_half_angle_deg = {half_angle_deg}\n\
                 viewer_half_angle_deg = {half_angle_deg}\n[model]\nkind = \"coated-base\"\nsubstrate = \"keratin\"\n\
                 [parameters]\nroughness = {roughness}\n"
            );
            let file: JobFile = toml::from_str(&text).unwrap();
            let ModelFile::CoatedBase(design) = &file.model else { unreachable!("the text says so") };
            let model = CoatedBase::new(design, &[550.0]).unwrap();
            let values: Vec<f64> = model
                .parameters()
                .iter()
                .map(|parameter| if parameter.name == "roughness" { roughness } else { parameter.default })
                .collect();
            let bsdf = model.bind(&values);
            let reading = |rings: usize| {
                let (mut scratch, mut reading) = ([0.0], [0.0]);
                let geometry = Geometry::mirror(40.0);
                Aperture::new(&geometry, &file.instrument, Quantity::Reflectance, rings).read(
                    &*bsdf,
                    &mut scratch,
                    &mut reading,
                );
                reading[0]
            };
            let rings = cone_rings(&file).unwrap();
            approx::assert_relative_eq!(reading(rings), reading(2 * rings), max_relative = 1e-3);
        }
    }

    #[test]
    fn a_lobe_that_cannot_be_resolved_is_refused() {
        let text = "title = \"cones\"\n[data]\n[instrument]\nlight_half_angle_deg = 8\n[model]\n\
                    kind = \"coated-base\"\nsubstrate = \"keratin\"\n[parameters]\nroughness = {}\n";
        let file: JobFile = toml::from_str(text).unwrap();
        let message = cone_rings(&file).unwrap_err().to_string();
        assert!(message.contains("at least 0.031"), "{message}");
    }
}
