//! The page: what stands where. Texts and tables come ready from their own files; this one only puts them in order.

use askama::Template;

use super::methods::{self, Methods};
use super::plots::Place;
use super::specimens::{self, Specimens};
use super::swatch::{self, Swatches};
use super::tables::{self, Minima, OrderRow, ParameterRow};
use super::{Chapter, Picture, ReportError, readings};
use crate::fit::Settings;
use crate::job::{Comparison, Outcome, Support};
use crate::measure::colour::Swatch;
use crate::number::{count, significant, to_place};

/// The page as HTML.
pub(crate) fn html(outcome: &Outcome, chapters: &[Chapter]) -> Result<String, ReportError> {
    let cases: Vec<CaseView> =
        chapters.iter().enumerate().map(|(index, chapter)| CaseView::new(outcome, index, chapter)).collect();
    let methods = methods::of(outcome, cases.iter().any(|c| c.swatches.is_some()));
    let page = Page {
        outcome,
        synthetic: outcome.synthetic.as_ref().map(tables::truth_sentence),
        several: cases.len() > 1,
        comparison: chapters
            .iter()
            .enumerate()
            .map(|(index, chapter)| ComparisonRow::new(index, chapter, outcome.comparison.as_ref()))
            .collect(),
        judged: outcome.comparison.as_ref().map(tables::comparison_sentence),
        cases,
        methods,
        strong_threshold: tables::STRONG_CORRELATION,
        settings: outcome.cases.first().map(|c| &c.fit.settings),
        inputs: outcome.inputs.iter().map(|i| (i.name.as_str(), i.sha256.as_str(), count(i.bytes))).collect(),
    };
    page.render().map_err(|error| ReportError::Page(error.to_string()))
}

#[derive(Template)]
#[template(path = "report.html")]
struct Page<'a> {
    outcome: &'a Outcome,
    synthetic: Option<String>,
    several: bool,
    comparison: Vec<ComparisonRow>,
    /// What the table of cases says of the readings held out, where there are any.
    judged: Option<String>,
    cases: Vec<CaseView<'a>>,
    methods: Methods,
    strong_threshold: f64,
    settings: Option<&'a Settings>,
    /// Name, hash, bytes.
    inputs: Vec<(&'a str, &'a str, String)>,
}

/// One line of the table of cases.
struct ComparisonRow {
    anchor: String,
    name: String,
    text: String,
    parameters: Vec<String>,
    rms: String,
    /// Free parameters, rms held out, the same of cube roots, `AICc`, where the cases are judged by what they did not see.
    judged: Option<[String; 4]>,
}

impl ComparisonRow {
    fn new(index: usize, chapter: &Chapter, comparison: Option<&Comparison>) -> Self {
        let case = chapter.case;
        Self {
            anchor: anchor(index),
            name: case.name.clone(),
            text: case.text.clone(),
            parameters: tables::main_parameters(case),
            rms: readings::rms(case).unwrap_or_default(),
            judged: comparison.and_then(|comparison| tables::judged(comparison, index)),
        }
    }
}

/// One case.
struct CaseView<'a> {
    anchor: String,
    name: &'a str,
    text: &'a str,
    answer: &'a str,
    figures: Vec<(Place, FigureView<'a>)>,
    swatches: Option<SwatchTable>,
    specimens: Option<Specimens>,
    orders: Vec<OrderRow>,
    has_truth: bool,
    parameters: Vec<ParameterRow>,
    fixed: Vec<ParameterRow>,
    minima: Minima,
    strong_correlations: Vec<String>,
    open_directions: Vec<&'a str>,
    support: Option<SupportView<'a>>,
    goodness: Vec<(&'static str, String)>,
    warnings: &'a [String],
}

impl<'a> CaseView<'a> {
    fn new(outcome: &'a Outcome, index: usize, chapter: &'a Chapter) -> Self {
        let case = chapter.case;
        Self {
            anchor: anchor(index),
            name: &case.name,
            text: &case.text,
            answer: &case.answer,
            figures: chapter.pictures.iter().map(|(place, picture)| (*place, FigureView::new(picture))).collect(),
            swatches: swatch::of(case).map(|s| SwatchTable::new(&s)),
            specimens: case.population.as_ref().map(|all| specimens::of(all, readings::units(case).following)),
            orders: tables::orders(&case.orders),
            has_truth: outcome.synthetic.is_some(),
            parameters: tables::parameters(case, outcome.synthetic.as_ref(), false),
            fixed: tables::parameters(case, outcome.synthetic.as_ref(), true),
            minima: tables::minima(case),
            strong_correlations: tables::strong_correlations(&case.fit),
            open_directions: case.fit.open_directions.iter().map(|d| d.text.as_str()).collect(),
            support: case.support.as_ref().map(SupportView::new),
            goodness: tables::goodness(case),
            warnings: &case.fit.warnings,
        }
    }

    fn figures_of_data(&self) -> impl Iterator<Item = &FigureView<'a>> {
        self.at(Place::Data)
    }

    fn figures_of_minima(&self) -> impl Iterator<Item = &FigureView<'a>> {
        self.at(Place::Minima)
    }

    fn figures_of_correlations(&self) -> impl Iterator<Item = &FigureView<'a>> {
        self.at(Place::Correlations)
    }

    fn figures_of_support(&self) -> impl Iterator<Item = &FigureView<'a>> {
        self.at(Place::Support)
    }

    fn figures_of_convergence(&self) -> impl Iterator<Item = &FigureView<'a>> {
        self.at(Place::Convergence)
    }

    fn at(&self, place: Place) -> impl Iterator<Item = &FigureView<'a>> {
        self.figures.iter().filter(move |(of, _)| *of == place).map(|(_, figure)| figure)
    }
}

/// A figure on the page.
pub(super) struct FigureView<'a> {
    pub(super) name: &'a str,
    pub(super) caption: &'a str,
    pub(super) svg: &'a str,
    pub(super) tables: Vec<&'a str>,
}

impl<'a> FigureView<'a> {
    pub(super) fn new(picture: &'a Picture) -> Self {
        Self {
            name: &picture.figure.name,
            caption: &picture.figure.caption,
            svg: &picture.svg,
            tables: picture.tables.iter().map(|t| t.file.as_str()).collect(),
        }
    }
}

/// The table of colours.
struct SwatchTable {
    pairs: Vec<SwatchRow>,
    caption: String,
}

/// One geometry's colours.
struct SwatchRow {
    name: String,
    /// Measured and fitted.
    cells: [SwatchCell; 2],
    difference: String,
}

/// A colour as style and as numbers.
struct SwatchCell {
    hex: String,
    lab: [String; 3],
    clipped: bool,
}

impl SwatchTable {
    fn new(swatches: &Swatches) -> Self {
        let cell = |seen: &Swatch| SwatchCell {
            hex: seen.hex.clone(),
            lab: [seen.lab.l, seen.lab.a, seen.lab.b].map(|v| to_place(v, -1)),
            clipped: seen.clipped,
        };
        let row = |pair: &swatch::Pair| SwatchRow {
            name: pair.name.clone(),
            cells: [cell(&pair.measured), cell(&pair.fitted)],
            difference: to_place(pair.difference(), -1),
        };
        Self { pairs: swatches.pairs.iter().map(row).collect(), caption: swatches.caption.clone() }
    }
}

/// The verdict on a film.
struct SupportView<'a> {
    text: &'a str,
    numbers: Vec<(&'static str, String)>,
}

impl<'a> SupportView<'a> {
    fn new(support: &'a Support) -> Self {
        let mut numbers = vec![
            (
                "Gain in mean squared prediction error",
                crate::number::with_error(support.gain, Some(support.gain_standard_error)),
            ),
            ("Same order of interference in every fold", if support.same_order { "yes" } else { "no" }.to_owned()),
        ];
        if let Some(delta) = support.delta_aicc {
            let text = format!(
                "{}, on {} effective readings; decides nothing by itself",
                significant(delta, 3),
                significant(support.effective_readings, 3)
            );
            numbers.push(("AICc with film − without", text));
        }
        Self { text: &support.text, numbers }
    }
}

fn anchor(index: usize) -> String {
    format!("case-{}", index + 1)
}
