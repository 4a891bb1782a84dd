//! Outcomes as real fits give them, from closed forms. No solver runs: a report shows what it is given.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use barbule::fit::{
    Bound, Estimate, Fit, Goodness, Minimum, OpenDirection, ProfilePoint, Settings, SigmaSource, StopReason, TracePoint,
};
use barbule::job::{
    Case, CaseData, InputFile, MaterialNote, ModelNote, Outcome, PeakFit, Prediction, Reference, SpectrumFit, Support,
    ThicknessOrder, Truth,
};
use barbule::measure::{Compared, Geometry, Quantity};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

const INDEX: f64 = 1.56;

/// Two-beam fringe of a film in air: R = R₀ (1 + V cos(4π n d cosθ₁/λ)), cosθ₁ by Snell's law.
pub(super) fn fringe(thickness_nm: f64, theta_deg: f64, wavelength_nm: f64) -> f64 {
    let cos_inside = (1.0 - (theta_deg.to_radians().sin() / INDEX).powi(2)).sqrt();
    let phase = 4.0 * PI * INDEX * thickness_nm * cos_inside / wavelength_nm;
    0.09 * (1.0 + 0.8 * phase.cos())
}

fn estimate(name: &str, symbol: &str, unit: &str, value: f64, error: f64) -> Estimate {
    Estimate {
        name: name.into(),
        symbol: symbol.into(),
        unit: unit.into(),
        text: format!("The {} of the model.", name.replace(['.', '_'], " ")),
        role: "free".into(),
        value,
        start: Some(0.9 * value),
        bounds: Some([0.2 * value, 4.0 * value]),
        prior: None,
        standard_error: Some(error),
        interval_95: Some([value - 1.96 * error, value + 1.96 * error]),
        at_bound: None,
        open: false,
    }
}

fn fit_of_film(sigma_source: SigmaSource) -> Fit {
    let mut index = estimate("cortex.index_scale", "s", "", 1.0012, 0.0031);
    index.prior = Some([1.0, 0.01]);
    let mut absorption = estimate("base.absorption", "k", "", 0.0, 0.004);
    absorption.at_bound = Some(Bound::Lower);
    absorption.interval_95 = Some([0.0, 0.0083]);
    absorption.standard_error = None;
    absorption.bounds = Some([0.0, 0.5]);
    let mut fixed = estimate("coat.index", "n_c", "", 1.5, 0.1);
    (fixed.role, fixed.start, fixed.bounds) = ("fixed".into(), None, None);
    (fixed.standard_error, fixed.interval_95) = (None, None);
    let mut tied = estimate("coat.gain", "g_c", "", 0.871, 0.011);
    (tied.role, tied.start, tied.bounds) = ("tied".into(), None, None);
    let mut open = estimate("roughness", "α", "", 0.21, 0.5);
    open.open = true;
    open.standard_error = None;
    open.interval_95 = None;
    let estimates = vec![
        estimate("cortex.thickness_nm", "d", "nm", 332.417, 1.234),
        index,
        estimate("instrument.gain", "g", "", 0.871, 0.011),
        absorption,
        open,
        fixed,
        tied,
    ];
    let rivals =
        [(332.417, 5301.0), (502.3, 5306.1), (180.4, 9120.0), (671.0, 12030.0), (842.0, 15100.0), (1010.0, 16800.0)];
    let minima = rivals.iter().enumerate().map(|(i, (thickness, cost))| Minimum {
        values: std::iter::once(*thickness).chain(estimates.iter().skip(1).map(|e| e.value)).collect(),
        standard_errors: estimates.iter().map(|e| e.standard_error).collect(),
        cost: *cost,
        rms: (cost / 5213.0).sqrt(),
        weight: [0.926, 0.0739, 0.0001, 0.0, 0.0, 0.0][i],
        hits: [9, 6, 5, 4, 4, 4][i],
        stop: if i == 5 { StopReason::Stalled } else { StopReason::Converged },
    });
    let profile = (0..260).map(|i| {
        let value = 60.0 + 4.0 * f64::from(i);
        let nearest =
            rivals.iter().map(|(d, c)| (c.ln() + ((value - d) / 45.0).powi(2)).min(10.1)).fold(10.1, f64::min);
        ProfilePoint { value, cost: nearest.exp() }
    });
    let free: Vec<String> =
        ["cortex.thickness_nm", "cortex.index_scale", "instrument.gain", "base.absorption", "roughness"]
            .map(String::from)
            .to_vec();
    let correlations = vec![
        vec![Some(1.0), Some(-0.962), Some(0.31), None, None],
        vec![Some(-0.962), Some(1.0), Some(-0.18), None, None],
        vec![Some(0.31), Some(-0.18), Some(1.0), None, None],
        vec![None; 5],
        vec![None; 5],
    ];
    Fit {
        settings: Settings::default(),
        minima: minima.collect(),
        covariance: correlations.clone(),
        correlations,
        free,
        open_directions: vec![OpenDirection {
            shares: vec![("roughness".into(), 0.9), ("instrument.gain".into(), -0.44)],
            relative_singular_value: 3e-9,
            text: "roughness and instrument.gain only as their ratio".into(),
        }],
        goodness: Goodness {
            readings: 4812,
            effective_readings: 402.7,
            free_parameters: 5,
            degrees_of_freedom: 4808,
            chi_squared: 5301.0,
            reduced_chi_squared: (sigma_source == SigmaSource::Known).then_some(1.1025),
            sigma_source,
            sigma_scale: 1.0,
            error_widening: 1.0,
            aicc: Some(453.21),
        },
        profiles: vec![("cortex.thickness_nm".into(), profile.collect())],
        trace: (0..14)
            .map(|i| TracePoint { iteration: i, cost: 5301.0 + 80_000.0 * (-0.9 * f64::from(u32::try_from(i).unwrap())).exp() })
            .collect(),
        stop: StopReason::Converged,
        evaluations: 20_417,
        not_finite: 0,
        warnings: vec!["Residuals are correlated along the wavelength (lag 1: 0.79): errors assume the effective number of readings.".into()],
        estimates,
    }
}

fn model_note() -> ModelNote {
    ModelNote {
        kind: "coated-base".into(),
        text: "The barbule was modelled as one film of keratin over melanin, unpolarised, with the reflectance of Yeh 1988 \
               in the mirror direction."
            .into(),
        materials: vec![MaterialNote {
            name: "keratin".into(),
            text: "Cauchy formula 1.532 + 5890 nm²/λ², 300 to 700 nm; known to about 0.01".into(),
        }],
        references: vec![
            Reference { key: "Yeh 1988".into(), citation: "Yeh P. 1988. Optical Waves in Layered Media. Wiley.".into() },
            Reference {
                key: "Leertouwer et al. 2011".into(),
                citation: "Leertouwer H. L., Wilts B. D., Stavenga D. G. 2011. Refractive index and dispersion of butterfly \
                           chitin and bird keratin measured by polarizing interference microscopy. Optics Express 19, 24061."
                    .into(),
            },
        ],
    }
}

fn outcome(name: &str, title: &str, answer: &str, cases: Vec<Case>) -> Outcome {
    Outcome {
        barbule_version: "0.1.0".into(),
        name: name.into(),
        title: title.into(),
        answer: answer.into(),
        about: "A made-up fringe, to try the report.".into(),
        inputs: vec![InputFile { name: "table.csv".into(), sha256: "9f".repeat(32), bytes: 131_072 }],
        synthetic: None,
        comparison: None,
        cases,
        job_toml: "title = \"A film\"\n\n[[layers]]\nmaterial = \"keratin\"   # <outermost> & first\nthickness_nm = { start = 300.0 }\n".into(),
    }
}

/// Thirteen mirror angles, 401 wavelengths, the last angle left out.
pub(super) fn film() -> Outcome {
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let wavelengths: Vec<f64> = (300..=700).map(f64::from).collect();
    let spectra = (0..13).map(|i| {
        let theta = 15.0 + 5.0 * f64::from(i);
        let brightness = 6.0 * (-f64::from(i) / 5.0).exp();
        let model: Vec<f64> = wavelengths.iter().map(|w| brightness * fringe(332.4, theta, *w)).collect();
        let measured: Vec<f64> = wavelengths
            .iter()
            .map(|w| {
                let noise: f64 = StandardNormal.sample(&mut random);
                brightness * (fringe(331.0, theta, *w) * (1.0 + 0.01 * noise) + 0.004 * (w / 23.0).sin())
            })
            .collect();
        SpectrumFit {
            id: format!("teal-{i}"),
            geometry: Geometry::mirror(theta),
            without_geometry: false,
            fitted: i < 12,
            wavelengths_nm: wavelengths.clone(),
            measured,
            sigmas: None,
            model,
        }
    });
    let incidences: Vec<f64> = (0..12).map(|i| 15.0 + 5.0 * f64::from(i)).collect();
    let support = Support {
        with_film: incidences.iter().map(|t| 2e-4 * (1.0 + (t / 9.0).sin().abs())).collect(),
        without_film: incidences.iter().map(|t| 1.5e-3 * (1.3 + (t / 13.0).cos())).collect(),
        thickness_by_fold_nm: incidences.iter().map(|t| 332.4 + (t / 3.0).sin()).collect(),
        incidences_deg: incidences,
        gain: 1.62e-3,
        gain_standard_error: 2.1e-4,
        same_order: true,
        supported: true,
        delta_aicc: Some(-381.2),
        effective_readings: 402.7,
        text: "Leaving out one incidence at a time, the film lowers the prediction error by 7.7 standard errors, and every fold \
               finds the same order."
            .into(),
    };
    let case = Case {
        name: "film".into(),
        text: "One keratin film on melanin; a gain for each spectrum.".into(),
        answer: "The film is 332.4 ± 1.2 nm thick.".into(),
        model: model_note(),
        fit: fit_of_film(SigmaSource::Estimated),
        data: CaseData::Spectra {
            quantity: Quantity::Reflectance,
            compare: Compared::Values,
            spectra: spectra.collect(),
        },
        held_out: None,
        lobes: None,
        population: None,
        group: String::new(),
        support: Some(support),
        orders: Vec::new(),
    };
    outcome(
        "film",
        "Wing patch of a made-up duck: one film",
        "The keratin film is 332.4 ± 1.2 nm thick; one rival at 502 nm keeps 7 % of the weight, and the roughness stays open.",
        vec![case],
    )
}

/// The film again as synthetic readings with known truth.
pub(super) fn synthetic() -> Outcome {
    let mut outcome = film();
    outcome.name = "synthetic".into();
    outcome.title = "A synthetic film with known truth".into();
    outcome.synthetic = Some(Truth {
        values: BTreeMap::from([("cortex.thickness_nm".into(), 331.0), ("instrument.gain".into(), 0.87)]),
        noise: 0.01,
        seed: 7,
    });
    outcome.cases[0].fit.goodness.sigma_source = SigmaSource::Known;
    outcome.cases[0].fit.goodness.reduced_chi_squared = Some(1.1025);
    outcome
}

/// Six incidences with forty directions each, 31 wavelengths, BRDF, gloss near the mirror held out.
pub(super) fn paint() -> Outcome {
    let wavelengths: Vec<f64> = (40..=70).map(|w| 10.0 * f64::from(w)).collect();
    let mut spectra = Vec::new();
    for theta_i in [10.0, 20.0, 40.0, 50.0, 70.0, 80.0] {
        for direction in 0..40u32 {
            let theta_o = [0.0, 8.11, 16.26, 24.49, 32.86, 41.41, 50.21, 59.34, 68.9, 79.05][direction as usize % 10];
            let phi_o = [0.0, 60.0, 120.0, 180.0][direction as usize / 10];
            let half = 0.5 * f64::hypot(theta_i - theta_o, phi_o / 4.0);
            let lobe = 0.6 * (-(half / 30.0).powi(2)).exp() + 0.05;
            let is_gloss = phi_o > 179.0 && f64::abs(theta_o - theta_i) < 3.0;
            let model: Vec<f64> = wavelengths.iter().map(|w| lobe * 8.0 * fringe(410.0, half, *w)).collect();
            let measured = model
                .iter()
                .enumerate()
                .map(|(k, m)| m * (1.0 + 0.03 * (k as f64 + half).sin()) + if is_gloss { 60.0 } else { 0.0 });
            spectra.push(SpectrumFit {
                id: format!("{theta_i}/{theta_o}/{phi_o}"),
                geometry: Geometry { theta_i_deg: theta_i, phi_i_deg: 0.0, theta_o_deg: theta_o, phi_o_deg: phi_o },
                without_geometry: false,
                fitted: !is_gloss,
                measured: measured.collect(),
                sigmas: Some(model.iter().map(|m| 0.02 * m).collect()),
                wavelengths_nm: wavelengths.clone(),
                model,
            });
        }
    }
    let case = Case {
        name: "flake".into(),
        text: "Flakes under a clear coat of index 1.5.".into(),
        answer: "The flake's film is 332.4 ± 1.2 nm thick.".into(),
        model: model_note(),
        fit: fit_of_film(SigmaSource::Known),
        data: CaseData::Spectra { quantity: Quantity::Brdf, compare: Compared::Values, spectra },
        held_out: None,
        lobes: None,
        population: None,
        group: String::new(),
        support: None,
        orders: Vec::new(),
    };
    outcome("paint", "Colour-shifting paint", "The flake's film is 332.4 ± 1.2 nm thick.", vec![case])
}

/// Twelve peaks, the last three left out, fitted by a law and by a film.
pub(super) fn peaks() -> Outcome {
    let measured = [520.3, 516.0, 510.7, 505.0, 496.7, 488.5, 480.7, 471.8, 462.8, 453.2, 441.4, 430.2];
    let law = |theta: f64| 525.8 * (1.0 - (theta.to_radians().sin() / 1.72).powi(2)).sqrt();
    let thetas: Vec<f64> = (0..12).map(|i| 15.0 + 5.0 * f64::from(i)).collect();
    let readings: Vec<PeakFit> = thetas
        .iter()
        .zip(measured)
        .enumerate()
        .map(|(i, (theta, measured_nm))| PeakFit {
            id: format!("{theta}"),
            geometry: Geometry::mirror(*theta),
            fitted: i < 9,
            measured_nm,
            sigma_nm: Some(1.0),
            model_nm: Some(law(*theta)),
        })
        .collect();
    let wavelengths: Vec<f64> = (300..=700).step_by(2).map(f64::from).collect();
    let predictions = thetas.iter().map(|theta| Prediction {
        id: format!("{theta}"),
        geometry: Geometry::mirror(*theta),
        reflectance: wavelengths.iter().map(|w| fringe(337.0, *theta, *w)).collect(),
        wavelengths_nm: wavelengths.clone(),
    });
    let estimates =
        vec![estimate("peak_at_normal_nm", "λ₀", "nm", 525.8, 0.4), estimate("index", "n", "", 1.722, 0.018)];
    let fit = Fit {
        minima: vec![Minimum {
            values: vec![525.8, 1.722],
            standard_errors: vec![Some(0.4), Some(0.018)],
            cost: 2.31,
            rms: 0.51,
            weight: 1.0,
            hits: 32,
            stop: StopReason::Converged,
        }],
        free: vec!["peak_at_normal_nm".into(), "index".into()],
        correlations: vec![vec![Some(1.0), Some(-0.71)], vec![Some(-0.71), Some(1.0)]],
        covariance: vec![vec![Some(0.16), Some(-0.005)], vec![Some(-0.005), Some(0.0003)]],
        goodness: Goodness {
            readings: 9,
            effective_readings: 9.0,
            free_parameters: 2,
            degrees_of_freedom: 7,
            chi_squared: 2.31,
            reduced_chi_squared: Some(0.33),
            sigma_source: SigmaSource::Known,
            sigma_scale: 1.0,
            error_widening: 1.0,
            aicc: Some(8.3),
        },
        estimates,
        profiles: Vec::new(),
        open_directions: Vec::new(),
        warnings: Vec::new(),
        ..fit_of_film(SigmaSource::Known)
    };
    let law_case = Case {
        name: "law, start angle 15°".into(),
        text: "λ² = λ₀² (1 − sin²θ/n²); the first spectrum at 15°.".into(),
        answer: "The effective index is 1.722 ± 0.018.".into(),
        model: model_note(),
        fit: fit.clone(),
        data: CaseData::Peaks {
            peaks: readings.clone(),
            spectra: Vec::new(),
            curve: (0..=90).map(|t| (f64::from(t), law(f64::from(t)))).collect(),
        },
        held_out: None,
        lobes: None,
        population: None,
        group: String::new(),
        support: None,
        orders: (1..=5)
            .map(|order| {
                let order = f64::from(order);
                ThicknessOrder {
                    order: order - 0.5,
                    thickness_nm: 525.8 / (2.0 * 1.722) * (order - 0.5),
                    standard_error_nm: Some(1.6 * (order - 0.5)),
                    index: 1.722,
                    index_standard_error: Some(0.018),
                    rms_nm: 0.51,
                    weight: 0.2,
                }
            })
            .collect(),
    };
    let film_case = Case {
        name: "film, start angle 15°".into(),
        text: "One film between keratin and melanin; the first spectrum at 15°.".into(),
        answer: "The film is 337 ± 4 nm thick if the peak is of second order.".into(),
        fit,
        data: CaseData::Peaks {
            peaks: readings,
            spectra: predictions.collect(),
            curve: (0..=90).map(|t| (f64::from(t), law(f64::from(t)))).collect(),
        },
        ..law_case.clone()
    };
    outcome(
        "peaks",
        "Twelve peaks of a teal's wing",
        "The effective index is 1.722 ± 0.018; peaks alone leave the thickness open, order by order.",
        vec![law_case, film_case],
    )
}

/// Everything that a page may trip over: markup in names, very long names, no degrees of freedom, numbers that are not.
pub(super) fn awkward() -> Outcome {
    let mut outcome = film();
    let nasty = "<script>alert(\"x\")</script> & 'co'";
    let long = "a_parameter_with_a_name_that_no_table_was_ever_made_for.and_that_goes_on_and_on_without_a_single_space";
    outcome.name = "awkward".into();
    outcome.title = format!("Title {nasty}");
    outcome.answer = format!("Answer {nasty}.");
    outcome.about = nasty.into();
    outcome.inputs[0].name = nasty.into();
    let case = &mut outcome.cases[0];
    case.name = nasty.into();
    case.text = nasty.into();
    case.model.text = nasty.into();
    let renamed = [nasty, long];
    for (index, name) in renamed.iter().enumerate() {
        case.fit.estimates[index].name = (*name).into();
        case.fit.free[index] = (*name).into();
    }
    case.fit.profiles[0].0 = nasty.into();
    case.fit.warnings.push(nasty.into());
    case.fit.goodness.degrees_of_freedom = 0;
    case.fit.goodness.reduced_chi_squared = None;
    case.fit.goodness.sigma_source = SigmaSource::Known;
    case.fit.goodness.aicc = None;
    case.fit.goodness.effective_readings = f64::NAN;
    case.fit.estimates[2].value = f64::NAN;
    case.fit.trace[0].cost = 0.0;
    if let CaseData::Spectra { spectra, .. } = &mut case.data {
        spectra.truncate(2);
        spectra[0].measured[10] = f64::NAN;
        spectra[0].model[20] = f64::INFINITY;
        spectra[1].id = nasty.into();
        spectra[1].model.truncate(3);
    }
    let mut empty = case.clone();
    empty.name = "nothing".into();
    empty.data = CaseData::Spectra { quantity: Quantity::BsdfCos, compare: Compared::Values, spectra: Vec::new() };
    empty.support = None;
    empty.fit.estimates.clear();
    empty.fit.minima.clear();
    empty.fit.free.clear();
    empty.fit.correlations.clear();
    empty.fit.profiles.clear();
    empty.fit.trace.clear();
    let mut no_peaks = empty.clone();
    no_peaks.data = CaseData::Peaks { peaks: Vec::new(), spectra: Vec::new(), curve: Vec::new() };
    outcome.cases.extend([empty, no_peaks]);
    outcome
}
