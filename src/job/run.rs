//! Runs a job: every case is fitted, judged and put beside its readings.

use super::answer::{case_answer, job_answer};
use super::case::{CheckedCase, Comparison, extent};
use super::file::ModelFile;
use super::film_peaks::FilmPeaks;
use super::held_out::{comparison, held_out};
use super::lobes::lobes_of_fit;
use super::model_note::model_note;
use super::outcome::{Case, CaseData, Outcome, PeakFit, Prediction, SpectrumFit, ThicknessOrder, Truth};
use super::peaks::PeaksProblem;
use super::population::{Population, population};
use super::predict::predict;
use super::support::film_support;
use super::values::values_by_name;
use super::{Job, JobError, JobFile};
use crate::fit::{Control, Fit};
use crate::measure::{Geometry, GonioTable, PeakReading, PeakTable};

/// Fits every case of a job.
pub fn run(job: &Job, control: &Control) -> Result<Outcome, JobError> {
    let (checked, inputs) = job.cases()?;
    let cases: Vec<Case> = checked.iter().map(|case| run_case(case, control)).collect::<Result<_, _>>()?;
    let synthetic = job.file.data.synthetic.as_ref().map(|recipe| Truth {
        values: recipe.truth.clone(),
        noise: recipe.noise,
        seed: recipe.seed,
    });
    let mut outcome = Outcome {
        barbule_version: env!("CARGO_PKG_VERSION").to_owned(),
        name: job.name.clone(),
        title: job.file.title.clone(),
        answer: String::new(),
        about: job.file.about.clone(),
        inputs,
        synthetic,
        comparison: comparison(&cases),
        cases,
        job_toml: job.text.clone(),
    };
    outcome.answer = job_answer(&outcome);
    Ok(outcome)
}

fn run_case(case: &CheckedCase, control: &Control) -> Result<Case, JobError> {
    let found = case.fit(control)?;
    let support = film_support(case, &found, control)?;
    let population = population(case, &found, control)?;
    let group = match &case.comparison {
        Comparison::Spectra(table, ..) => table.spectra[0].origin.group.clone(),
        Comparison::Peaks(..) => String::new(),
    };
    let lobes = match &case.comparison {
        // Where nobody wrote the angles down, a lobe at the normal would be taken for the measured one.
        Comparison::Spectra(table, fitted, _) if !table.spectra[0].origin.without_geometry => {
            Some(lobes_of_fit(&case.file, table, fitted, &values_by_name(&found))?)
        }
        Comparison::Spectra(..) | Comparison::Peaks(..) => None,
    };
    let (data, orders) = match &case.comparison {
        Comparison::Spectra(table, fitted, _) => {
            (spectra_data(&case.file, table, fitted, &found, population.as_ref())?, Vec::new())
        }
        Comparison::Peaks(table, fitted, problem) => {
            (peaks_data(&case.file, problem, table, fitted, &found)?, thickness_orders(problem, &found))
        }
    };
    let mut found = found;
    if orders.len() > 1 {
        // One thickness of several that fit alike is no answer.
        for estimate in found.estimates.iter_mut().filter(|estimate| estimate.name.ends_with(".thickness_nm")) {
            estimate.open = true;
        }
    }
    let mut result = Case {
        name: case.file.case.clone(),
        text: case.file.assumes.clone(),
        answer: String::new(),
        model: model_note(case)?,
        fit: found,
        held_out: held_out(&data),
        lobes,
        data,
        support,
        population,
        group,
        orders,
    };
    result.answer = case_answer(&result);
    Ok(result)
}

fn spectra_data(
    file: &JobFile,
    table: &GonioTable,
    fitted: &[bool],
    fit: &Fit,
    population: Option<&Population>,
) -> Result<CaseData, JobError> {
    let model = predict(file, table, &values_by_name(fit))?;
    // Where specimens are fitted each by itself, a spectrum's model is that of its specimen.
    let of_specimen = |id: &str| {
        let mut all = population.iter().flat_map(|all| &all.specimens).flat_map(|specimen| &specimen.spectra);
        all.find(|one| one.id == id).map(|one| one.fitted.clone())
    };
    let spectra = table.spectra.iter().zip(model).zip(fitted).map(|((spectrum, model), fitted)| SpectrumFit {
        id: spectrum.id.clone(),
        geometry: spectrum.geometry,
        without_geometry: spectrum.origin.without_geometry,
        fitted: *fitted,
        wavelengths_nm: spectrum.wavelengths_nm.clone(),
        measured: spectrum.values.clone(),
        sigmas: spectrum.sigmas.clone(),
        model: of_specimen(&spectrum.id).unwrap_or(model),
    });
    Ok(CaseData::Spectra { quantity: table.quantity, compare: file.data.compare, spectra: spectra.collect() })
}

/// Degrees between the points of the fitted curve of a peak plot.
const CURVE_STEP_DEG: f64 = 0.5;

fn peaks_data(
    file: &JobFile,
    problem: &PeaksProblem,
    table: &PeakTable,
    fitted: &[bool],
    fit: &Fit,
) -> Result<CaseData, JobError> {
    let values: Vec<f64> = fit.estimates.iter().map(|estimate| estimate.value).collect();
    let implied = problem.implied_order(&values);
    let peaks = table.readings.iter().zip(fitted).map(|(reading, fitted)| PeakFit {
        id: reading.id.clone(),
        geometry: reading.geometry,
        fitted: *fitted,
        measured_nm: reading.wavelength_nm,
        sigma_nm: reading.sigma_nm,
        model_nm: problem.peak_nm(&values, reading, implied),
    });
    let [first_deg, last_deg] = extent(table.readings.iter().map(|reading| reading.geometry.theta_i_deg));
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "angles are from 0 to 90")]
    let steps = ((last_deg - first_deg) / CURVE_STEP_DEG).ceil() as u32;
    let curve = (0..=steps).filter_map(|step| {
        let theta_deg = (first_deg + CURVE_STEP_DEG * f64::from(step)).min(last_deg);
        // The nearest reading says where to look, and which maximum where readings name it.
        let nearest = table.readings.iter().min_by(|a, b| {
            let off = |reading: &PeakReading| (reading.geometry.theta_i_deg - theta_deg).abs();
            off(a).total_cmp(&off(b))
        })?;
        let reading = PeakReading { geometry: Geometry::mirror(theta_deg), ..nearest.clone() };
        problem.peak_nm(&values, &reading, implied).map(|nm| (theta_deg, nm))
    });
    Ok(CaseData::Peaks {
        peaks: peaks.collect(),
        spectra: predicted_spectra(file, table, &values)?,
        curve: curve.collect(),
    })
}

/// Spectra that the best minimum predicts at each reading's angles, where the model has spectra at all.
fn predicted_spectra(file: &JobFile, table: &PeakTable, values: &[f64]) -> Result<Vec<Prediction>, JobError> {
    let ModelFile::CoatedBase(design) = &file.model else { return Ok(Vec::new()) };
    let [shortest_nm, longest_nm] = extent(table.readings.iter().map(|reading| reading.wavelength_nm));
    let model = FilmPeaks::new(design, shortest_nm)?;
    // An octave around the readings, every 4 nm: what a plot can show.
    let first = (shortest_nm * 0.7 / 4.0).floor() * 4.0;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "wavelengths of peaks, some 1e3 nm")]
    let count = ((longest_nm * 1.4 - first) / 4.0) as u32;
    let wavelengths_nm: Vec<f64> = (0..=count).map(|step| first + 4.0 * f64::from(step)).collect();
    let predictions = table.readings.iter().map(|reading| {
        let mut reflectance = vec![0.0; wavelengths_nm.len()];
        model.spectrum(values, &reading.geometry, &wavelengths_nm, &mut reflectance);
        Prediction {
            id: reading.id.clone(),
            geometry: reading.geometry,
            wavelengths_nm: wavelengths_nm.clone(),
            reflectance,
        }
    });
    Ok(predictions.collect())
}

/// Every order's thickness, where the readings do not name the order and the model has one thickness and one index.
fn thickness_orders(problem: &PeaksProblem, fit: &Fit) -> Vec<ThicknessOrder> {
    let find = |ending: &str| {
        let mut found = fit.estimates.iter().enumerate().filter(|(_, estimate)| estimate.name.ends_with(ending));
        found.next().map(|(index, _)| index).filter(|_| found.next().is_none())
    };
    let (Some(thickness), Some(index)) = (find(".thickness_nm"), find(".index")) else { return Vec::new() };
    let bounds = fit.estimates[thickness].bounds;
    let orders = fit.minima.iter().filter_map(|minimum| {
        // A thickness that leans on its bound fits no order.
        let inside = |[lower, upper]: [f64; 2]| lower < minimum.values[thickness] && minimum.values[thickness] < upper;
        bounds.filter(|bounds| inside(*bounds))?;
        let order = problem.implied_order(&minimum.values)?;
        Some(ThicknessOrder {
            order: problem.interference_order(order),
            thickness_nm: minimum.values[thickness],
            standard_error_nm: minimum.standard_errors[thickness],
            index: minimum.values[index],
            index_standard_error: minimum.standard_errors[index],
            rms_nm: minimum.rms,
            weight: minimum.weight,
        })
    });
    let mut orders: Vec<ThicknessOrder> = orders.collect();
    orders.sort_by(|a, b| a.thickness_nm.total_cmp(&b.thickness_nm));
    orders
}
