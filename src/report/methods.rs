//! A methods section that could go into a paper, with numbered citations.

use super::tables::with_unit;
use crate::fit::{Fit, Loss, SigmaSource, Solver};
use crate::job::{CaseData, ModelNote, Outcome, Reference};
use crate::measure::Compared;

/// Paragraphs and the works that they cite by number.
pub(crate) struct Methods {
    pub(crate) paragraphs: Vec<Paragraph>,
    pub(crate) references: Vec<String>,
}

/// A paragraph with its heading.
pub(crate) struct Paragraph {
    pub(crate) heading: String,
    pub(crate) text: String,
}

/// Works cited so far; a work's number is its place in the list.
#[derive(Default)]
pub(super) struct Bibliography {
    pub(super) works: Vec<Reference>,
}

impl Bibliography {
    fn number(&mut self, work: &Reference) -> usize {
        match self.works.iter().position(|w| w.key == work.key) {
            Some(position) => position + 1,
            None => {
                self.works.push(work.clone());
                self.works.len()
            }
        }
    }

    pub(super) fn cite(&mut self, (key, citation): (&str, &str)) -> String {
        format!("[{}]", self.number(&Reference { key: key.to_owned(), citation: citation.to_owned() }))
    }
}

pub(super) type Work = (&'static str, &'static str);
const MORE: Work = (
    "Moré 1978",
    "Moré J. J. 1978. The Levenberg–Marquardt algorithm: implementation and theory. In: Watson G. A. (ed.) Numerical \
     Analysis. Lecture Notes in Mathematics 630, 105–116. Springer.",
);
const LIU: Work = (
    "Liu and Nocedal 1989",
    "Liu D. C., Nocedal J. 1989. On the limited memory BFGS method for large scale optimization. Mathematical Programming \
     45, 503–528.",
);
const NELDER: Work = (
    "Nelder and Mead 1965",
    "Nelder J. A., Mead R. 1965. A simplex method for function minimization. The Computer Journal 7, 308–313.",
);
const KENNEDY: Work = (
    "Kennedy and Eberhart 1995",
    "Kennedy J., Eberhart R. 1995. Particle swarm optimization. Proceedings of ICNN'95, 1942–1948.",
);
const ARGMIN: Work = (
    "argmin",
    "Kroboth S. and contributors. argmin: numerical optimization in pure Rust, version 0.11. argmin-rs.org.",
);
pub(super) const BURLEY: Work = (
    "Burley 2020",
    "Burley B. 2020. Practical hash-based Owen scrambling. Journal of Computer Graphics Techniques 9 (4), 1–20.",
);
const TIERNEY: Work = (
    "Tierney and Kadane 1986",
    "Tierney L., Kadane J. B. 1986. Accurate approximations for posterior moments and marginal densities. Journal of the \
     American Statistical Association 81, 82–86.",
);
const STONE: Work = (
    "Stone 1974",
    "Stone M. 1974. Cross-validatory choice and assessment of statistical predictions. Journal of the Royal Statistical \
     Society B 36, 111–147.",
);
const VIECHTBAUER_2005: Work = (
    "Viechtbauer 2005",
    "Viechtbauer W. 2005. Bias and efficiency of meta-analytic variance estimators in the random-effects model. Journal of \
     Educational and Behavioral Statistics 30, 261–293.",
);
const VIECHTBAUER_2007: Work = (
    "Viechtbauer 2007",
    "Viechtbauer W. 2007. Confidence intervals for the amount of heterogeneity in meta-analysis. Statistics in Medicine 26, \
     37–52.",
);
const KNAPP: Work = (
    "Knapp and Hartung 2003",
    "Knapp G., Hartung J. 2003. Improved tests for a random effects meta-regression with a single covariate. Statistics in \
     Medicine 22, 2693–2710.",
);
const HURVICH: Work = (
    "Hurvich and Tsai 1989",
    "Hurvich C. M., Tsai C.-L. 1989. Regression and time series model selection in small samples. Biometrika 76, 297–307.",
);
const HUBER: Work = (
    "Huber 1964",
    "Huber P. J. 1964. Robust estimation of a location parameter. The Annals of Mathematical Statistics 35, 73–101.",
);
const CARROLL: Work = (
    "Carroll and Ruppert 1984",
    "Carroll R. J., Ruppert D. 1984. Power transformations when fitting theoretical models to data. Journal of the American \
     Statistical Association 79, 321–328.",
);
const FORES: Work = (
    "Fores et al. 2012",
    "Fores A., Ferwerda J., Gu J. 2012. Toward a perceptually based metric for BRDF modeling. Color and Imaging Conference 20, \
     142–148.",
);
pub(super) const SHARMA: Work = (
    "Sharma et al. 2005",
    "Sharma G., Wu W., Dalal E. N. 2005. The CIEDE2000 color-difference formula: implementation notes, supplementary test \
     data, and mathematical observations. Color Research & Application 30, 21–30.",
);

/// The methods of all cases; what several share is said once.
pub(crate) fn of(outcome: &Outcome, has_swatches: bool) -> Methods {
    let mut bibliography = Bibliography::default();
    let mut paragraphs: Vec<Paragraph> = Vec::new();
    let mut models: Vec<(&ModelNote, Vec<&str>)> = Vec::new();
    for case in &outcome.cases {
        match models.iter_mut().find(|(note, _)| **note == case.model) {
            Some((_, names)) => names.push(&case.name),
            None => models.push((&case.model, vec![&case.name])),
        }
    }
    for (note, names) in &models {
        let heading = if models.len() == 1 { "Model".to_owned() } else { format!("Model of {}", names.join(", ")) };
        paragraphs.push(Paragraph { heading, text: model_text(note, &mut bibliography) });
    }
    if let Some(case) = outcome.cases.first() {
        let mut text = fit_text(&case.fit, &mut bibliography);
        if matches!(case.data, CaseData::Spectra { compare: Compared::CubeRoots, .. }) {
            let (carroll, fores) = (bibliography.cite(CARROLL), bibliography.cite(FORES));
            text += &format!(
                " Cube roots of model and readings were compared {carroll}, of which observers' judgements of BRDFs follow \
                 best {fores}."
            );
        }
        paragraphs.push(Paragraph { heading: "Fit".to_owned(), text });
        paragraphs.push(Paragraph {
            heading: "Uncertainty and rivals".to_owned(),
            text: uncertainty_text(&case.fit, &mut bibliography),
        });
    }
    if outcome.cases.iter().any(|c| c.support.is_some()) {
        let stone = bibliography.cite(STONE);
        let hurvich = bibliography.cite(HURVICH);
        paragraphs.push(Paragraph {
            heading: "Support for a film".to_owned(),
            text: format!(
                "The readings at each incidence were left out in turn and predicted by fits, with the film and without it, \
                 to all the others {stone}. A film is called supported only if it lowers the mean squared prediction error \
                 by more than two standard errors over the incidences and the thickness stays in the same order of \
                 interference in every fold. Residuals of spectra are correlated along the wavelength, so that Akaike's \
                 criterion with small-sample correction {hurvich} is given on an effective number of readings, from their \
                 lag-1 correlation, and decides nothing."
            ),
        });
    }
    if outcome.cases.iter().any(|c| c.population.is_some()) {
        let text = specimens_text(&mut bibliography);
        paragraphs.push(Paragraph { heading: "Specimens".to_owned(), text });
    }
    if has_swatches {
        let sharma = bibliography.cite(SHARMA);
        paragraphs.push(Paragraph {
            heading: "Colour".to_owned(),
            text: format!(
                "Swatches are for the CIE 1931 standard observer under illuminant D65, shown in sRGB; colour differences are \
                 CIEDE2000 {sharma}."
            ),
        });
    }
    Methods { paragraphs, references: bibliography.works.into_iter().map(|w| w.citation).collect() }
}

fn specimens_text(bibliography: &mut Bibliography) -> String {
    let (reml, profile) = (bibliography.cite(VIECHTBAUER_2005), bibliography.cite(VIECHTBAUER_2007));
    let (knapp, stone) = (bibliography.cite(KNAPP), bibliography.cite(STONE));
    format!(
        "Each specimen was fitted by itself. The mean of all residuals at each wavelength, which is misfit that all share, was \
         taken out of the specimens' errors, and the estimates were combined as random effects: the variance between individuals is that of restricted maximum likelihood {reml} with its Q-profile interval \
         {profile}, and the mean has the error and the interval of Knapp and Hartung {knapp}, whose factor was not let below \
         1. Specimens that left a parameter at a bound or undetermined were left out of its mean and spread. Where it was \
         asked for, each specimen was left out in turn and predicted by a fit to all the others {stone}, and by the mean of \
         their spectra."
    )
}

/// The model's own text, its works cited where it names them, the others at its end; then its materials.
pub(super) fn model_text(note: &ModelNote, bibliography: &mut Bibliography) -> String {
    let mut text = note.text.trim().to_owned();
    let mut unnamed = Vec::new();
    // Numbers rise through the text: works in the order in which it names them, the others last.
    let mut works: Vec<&Reference> = note.references.iter().collect();
    works.sort_by_key(|work| note.text.find(&work.key).unwrap_or(usize::MAX));
    for work in works {
        let number = bibliography.number(work);
        if work.key.is_empty() || !text.contains(&work.key) {
            unnamed.push(number.to_string());
        } else {
            text = text.replacen(&work.key, &format!("{} [{number}]", work.key), 1);
        }
    }
    if !unnamed.is_empty() {
        let citation = format!(" [{}]", unnamed.join(", "));
        text = match text.strip_suffix('.') {
            Some(sentence) => format!("{sentence}{citation}."),
            None => format!("{text}{citation}"),
        };
    }
    for material in &note.materials {
        text += &format!(" Material {}: {}", material.name, material.text.trim());
        if !text.ends_with('.') {
            text.push('.');
        }
    }
    text
}

fn fit_text(fit: &Fit, bibliography: &mut Bibliography) -> String {
    let s = &fit.settings;
    let solver = match s.solver {
        Solver::LeastSquares => format!(
            "the Levenberg–Marquardt method {} for bounded parameters, parameters at an active bound being taken out of the \
             normal equations",
            bibliography.cite(MORE)
        ),
        Solver::LBfgs => {
            format!("limited-memory BFGS {} through a smooth change of variable for the bounds", bibliography.cite(LIU))
        }
        Solver::NelderMead => format!(
            "the Nelder–Mead simplex {} through a smooth change of variable for the bounds",
            bibliography.cite(NELDER)
        ),
        Solver::ParticleSwarm => format!(
            "a particle swarm in the box of bounds {}, polished by the Levenberg–Marquardt method {}",
            bibliography.cite(KENNEDY),
            bibliography.cite(MORE)
        ),
    };
    let cost = match s.loss {
        Loss::Squares => "the sum of squared residuals".to_owned(),
        robust => format!(
            "a robust sum of residuals ({} beyond {} σ {})",
            loss_name(robust),
            crate::number::plain(s.loss_scale),
            bibliography.cite(HUBER)
        ),
    };
    let argmin = bibliography.cite(ARGMIN);
    let starts = match s.starts {
        0 | 1 => "from the start values given".to_owned(),
        n => format!(
            "from {n} start points spread between the bounds by a scrambled Sobol sequence {}",
            bibliography.cite(BURLEY)
        ),
    };
    let weights = match fit.goodness.sigma_source {
        SigmaSource::Known => "Residuals were weighted by the known standard deviation of each reading.",
        SigmaSource::Estimated => {
            "No standard deviations were given; all readings of a kind were weighted alike, and σ was estimated from the \
             residuals of the best fit."
        }
    };
    format!(
        "The {} free parameters were fitted to {} readings by minimising {cost} with {solver}, in the optimisation framework \
         argmin {argmin}, {starts} (at most {} iterations each, seed {}). Derivatives are finite differences with a step \
         chosen for each parameter. {weights}",
        fit.goodness.free_parameters,
        crate::number::count(u64::try_from(fit.goodness.readings).unwrap_or(u64::MAX)),
        s.max_iterations,
        s.seed
    )
}

fn loss_name(loss: Loss) -> &'static str {
    match loss {
        Loss::Squares => "squares",
        Loss::SoftL1 => "soft L1",
        Loss::Huber => "Huber's loss",
        Loss::Cauchy => "Cauchy's loss",
    }
}

fn uncertainty_text(fit: &Fit, bibliography: &mut Bibliography) -> String {
    let tierney = bibliography.cite(TIERNEY);
    let scaled = match fit.goodness.sigma_source {
        SigmaSource::Known => "",
        SigmaSource::Estimated => ", scaled by the σ found from the residuals",
    };
    let priors: Vec<String> = fit
        .estimates
        .iter()
        .filter_map(|e| {
            let [mean, sigma] = e.prior?;
            Some(format!("{} {}", e.name, with_unit(&crate::number::with_error(mean, Some(sigma)), &e.unit)))
        })
        .collect();
    let priors =
        if priors.is_empty() { String::new() } else { format!(" Gaussian priors were used: {}.", priors.join(", ")) };
    format!(
        "Standard errors come from the inverse of JᵀJ at the best minimum{scaled}; they hold where the model is right and \
         nearly linear within them. Every distinct minimum is listed, minima closer than one standard error being counted \
         as one, with a weight by Laplace's approximation to its share of the posterior {tierney}: prior × exp(−χ²/2) × \
         √det C, or from N ln RSS where σ is unknown, N being the effective number of readings. Where nothing was known \
         beforehand, a thickness, a gain or a roughness was taken as equally likely per decade, and any other parameter per \
         unit.{priors}"
    )
}
