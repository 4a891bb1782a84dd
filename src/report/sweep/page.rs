//! The page of a sweep: what stands where.

use askama::Template;

use super::contact_sheet::Sheet;
use super::plots::Place;
use super::swept::{columns, inner, outer, setting, views};
use crate::job::{Rate, Slope, Sweep, Varying};
use crate::number::{count, plain, significant, with_error};
use crate::report::angles::evenly;
use crate::report::methods::{BURLEY, Bibliography, Paragraph, SHARMA, Work, model_text};
use crate::report::page::FigureView;
use crate::report::tables::with_unit;
use crate::report::{Picture, ReportError};
use crate::sensitivity::{Estimate, Side};

/// Most rows of the table of colours.
const MOST_ROWS: usize = 24;

const SALTELLI: Work = (
    "Saltelli et al. 2010",
    "Saltelli A., Annoni P., Azzini I., Campolongo F., Ratto M., Tarantola S. 2010. Variance based sensitivity analysis of \
     model output. Design and estimator for the total sensitivity index. Computer Physics Communications 181, 259–270.",
);
const JANSEN: Work = (
    "Jansen 1999",
    "Jansen M. J. W. 1999. Analysis of variance designs for model output. Computer Physics Communications 117, 35–43.",
);
const LAMBONI: Work = (
    "Lamboni et al. 2011",
    "Lamboni M., Monod H., Makowski D. 2011. Multivariate sensitivity analysis to measure global contribution of input \
     factors in dynamic models. Reliability Engineering & System Safety 96, 450–459.",
);
const RIDDERS: Work = (
    "Ridders 1982",
    "Ridders C. J. F. 1982. Accurate computation of F′(x) and F′(x)F″(x). Advances in Engineering Software 4, 75–76.",
);

/// The page as HTML.
pub(super) fn html(sweep: &Sweep, pictures: &[(Place, Picture)], sheet: Option<&Sheet>) -> Result<String, ReportError> {
    let (paragraphs, references) = methods(sweep);
    let page = Page {
        sweep,
        sheet,
        figures: pictures.iter().map(|(place, picture)| (*place, FigureView::new(picture))).collect(),
        own: sweep
            .own
            .parameters
            .iter()
            .map(|(p, value)| (p.symbol.as_str(), p.name.as_str(), with_unit(&plain(*value), p.unit), p.text.as_str()))
            .collect(),
        colours: ColourTable::new(sweep),
        slopes: slope_rows(sweep),
        variance: variance_rows(sweep),
        no_variance: sweep.variance.as_ref().err().map(String::as_str),
        paragraphs,
        references,
        inputs: sweep.inputs.iter().map(|i| (i.name.as_str(), i.sha256.as_str(), count(i.bytes))).collect(),
    };
    page.render().map_err(|error| ReportError::Page(error.to_string()))
}

#[derive(Template)]
#[template(path = "sweep.html")]
struct Page<'a> {
    sweep: &'a Sweep,
    sheet: Option<&'a Sheet>,
    figures: Vec<(Place, FigureView<'a>)>,
    /// Symbol, name, value, meaning.
    own: Vec<(&'a str, &'a str, String, &'a str)>,
    colours: Option<ColourTable>,
    slopes: Vec<SlopeRow>,
    variance: Vec<VarianceRow>,
    no_variance: Option<&'a str>,
    paragraphs: Vec<Paragraph>,
    references: Vec<String>,
    /// Name, hash, bytes.
    inputs: Vec<(&'a str, &'a str, String)>,
}

impl<'a> Page<'a> {
    fn figures_of_grid(&self) -> impl Iterator<Item = &FigureView<'a>> {
        self.at(Place::Grid)
    }

    fn figures_of_slopes(&self) -> impl Iterator<Item = &FigureView<'a>> {
        self.at(Place::Slopes)
    }

    fn figures_of_excursions(&self) -> impl Iterator<Item = &FigureView<'a>> {
        self.at(Place::Excursions)
    }

    fn figures_of_variance(&self) -> impl Iterator<Item = &FigureView<'a>> {
        self.at(Place::Variance)
    }

    fn at(&self, place: Place) -> impl Iterator<Item = &FigureView<'a>> {
        self.figures.iter().filter(move |(of, _)| *of == place).map(|(_, figure)| figure)
    }
}

/// Some colours of the grid as swatches and numbers.
struct ColourTable {
    views: Vec<String>,
    rows: Vec<ColourRow>,
    left_out: usize,
}

struct ColourRow {
    setting: String,
    /// Swatch, CIELAB and difference to the first, one a view.
    cells: Vec<ColourCell>,
}

struct ColourCell {
    hex: String,
    lab: String,
    difference: String,
}

impl ColourTable {
    fn new(sweep: &Sweep) -> Option<Self> {
        if sweep.own.colours.is_empty() {
            return None;
        }
        let shown = views(sweep);
        let first = &sweep.cells[0];
        let columns = columns(inner(sweep));
        let rows = outer(sweep).map_or(vec![0], super::swept::columns);
        let all: Vec<usize> =
            rows.iter().flat_map(|row| columns.iter().map(|column| super::swept::cell(sweep, *row, *column))).collect();
        let rows = evenly(all.len(), MOST_ROWS).into_iter().map(|place| {
            let cell = &sweep.cells[all[place]];
            let settings = sweep.axes.iter().zip(&cell.values).map(|(axis, value)| setting(axis, *value));
            let cells = shown.iter().map(|(view, _)| {
                let colour = &cell.colours[*view];
                let lab = [colour.lab.l, colour.lab.a, colour.lab.b].map(|v| crate::number::to_place(v, -1));
                let mark = if colour.clipped { "*" } else { "" };
                ColourCell {
                    hex: colour.hex.clone(),
                    lab: format!("{}{mark}", lab.join(", ")),
                    difference: crate::number::to_place(colour.lab.delta_e_2000(first.colours[*view].lab), -1),
                }
            });
            ColourRow { setting: settings.collect::<Vec<_>>().join(", "), cells: cells.collect() }
        });
        let rows: Vec<ColourRow> = rows.collect();
        let left_out = sweep.cells.len() - rows.len();
        Some(Self { views: shown.into_iter().map(|(_, name)| name).collect(), rows, left_out })
    }
}

/// What one parameter does to the colour of one geometry, or to its readings where there is no colour.
struct SlopeRow {
    parameter: String,
    value: String,
    view: String,
    per_unit: String,
    per_percent: String,
    note: String,
    largest: String,
}

fn slope_rows(sweep: &Sweep) -> Vec<SlopeRow> {
    let mut rows = Vec::new();
    for (slope, excursion) in sweep.slopes.iter().zip(&sweep.excursions) {
        for (view, name) in views(sweep) {
            let rate = match slope.differences.get(view) {
                Some(rate) => *rate,
                None => strongest(&slope.readings[view]),
            };
            let reached = excursion.differences.get(view).unwrap_or(&excursion.changes[view]);
            let largest = reached.iter().copied().fold(0.0, f64::max);
            let (low, high) = (excursion.values[0], excursion.values[excursion.values.len() - 1]);
            rows.push(SlopeRow {
                parameter: slope.parameter.name.clone(),
                value: with_unit(&plain(slope.at), slope.parameter.unit),
                view: name,
                per_unit: per_unit(rate),
                per_percent: slope.per_percent(rate).map_or_else(|| "–".to_owned(), |change| significant(change, 3)),
                note: slope_note(slope, rate),
                largest: format!("{} over {} to {}", significant(largest, 3), plain(low), plain(high)),
            });
        }
    }
    rows
}

/// Numerical errors are far below what a reader can use; one that is not is shown.
fn per_unit(rate: Rate) -> String {
    let is_plain = rate.error <= 1e-4 * rate.per_unit.abs();
    if is_plain { significant(rate.per_unit, 3) } else { with_error(rate.per_unit, Some(rate.error)) }
}

/// The fastest of the readings' rates.
fn strongest(rates: &[Rate]) -> Rate {
    let size = |rate: &&Rate| rate.per_unit.abs();
    let none = Rate { per_unit: 0.0, error: 0.0, step: 0.0, is_kink: false };
    rates.iter().max_by(|a, b| size(a).total_cmp(&size(b))).copied().unwrap_or(none)
}

fn slope_note(slope: &Slope, rate: Rate) -> String {
    let side = match slope.side {
        Side::Both => "",
        Side::Above => "at its lower bound: towards larger values",
        Side::Below => "at its upper bound: towards smaller values",
    };
    let kink = if rate.is_kink { "a kink: mean of both sides ± half their difference" } else { "" };
    [side, kink].into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join("; ")
}

struct VarianceRow {
    view: String,
    what: String,
    deviation: String,
    parameter: String,
    range: String,
    first_order: String,
    total: String,
}

fn variance_rows(sweep: &Sweep) -> Vec<VarianceRow> {
    let Ok(variance) = &sweep.variance else { return Vec::new() };
    let mut rows = Vec::new();
    for (view, name) in views(sweep) {
        for output in variance.outputs.iter().filter(|output| output.view == view) {
            let what = match output.what {
                Varying::Readings => "readings",
                Varying::Difference => "ΔE₀₀",
            };
            for (place, (parameter, [lower, upper], _)) in variance.inputs.iter().enumerate() {
                let indices = output.indices.as_ref().map(|indices| indices[place]);
                let written = |estimate: Option<Estimate>| match estimate {
                    Some(estimate) => with_error(estimate.value, Some(estimate.standard_error)),
                    None => "does not vary".to_owned(),
                };
                rows.push(VarianceRow {
                    view: name.clone(),
                    what: what.to_owned(),
                    deviation: significant(output.standard_deviation, 3),
                    parameter: parameter.name.clone(),
                    range: with_unit(&format!("{} to {}", plain(*lower), plain(*upper)), parameter.unit),
                    first_order: written(indices.map(|indices| indices.first_order)),
                    total: written(indices.map(|indices| indices.total)),
                });
            }
        }
    }
    rows
}

fn methods(sweep: &Sweep) -> (Vec<Paragraph>, Vec<String>) {
    let mut bibliography = Bibliography::default();
    let mut paragraphs =
        vec![Paragraph { heading: "Model".to_owned(), text: model_text(&sweep.model, &mut bibliography) }];
    if !sweep.own.colours.is_empty() {
        let text = format!("{} Colour differences are CIEDE2000 {}.", sweep.colour_note, bibliography.cite(SHARMA));
        paragraphs.push(Paragraph { heading: "Colour".to_owned(), text });
    }
    let text = format!(
        "Slopes are finite differences over steps that are halved fourteen times, extrapolated to step zero for each number \
         on its own, with the disagreement of the last two extrapolations as error {}. Where a parameter stands at the end \
         of its range, differences to one side are used; where the slopes to both sides differ by more than ten times their \
         errors, their mean is given with half their difference as error. Where the colour changes by L*, a* and b* at \
         known rates, ΔE₀₀ grows at the rate that CIEDE2000 gives to a small step in that direction. A change by 1 % is \
         the slope times a hundredth of the value.",
        bibliography.cite(RIDDERS)
    );
    paragraphs.push(Paragraph { heading: "Sensitivity at the job's own values".to_owned(), text });
    if let Ok(variance) = &sweep.variance {
        let settings = &variance.settings;
        let text = format!(
            "The free parameters vary independently, each evenly over its range or, where it is declared so, evenly in its \
             logarithm; priors are not used. First-order indices by the estimator of {}, total indices by that of {}, on {} \
             Sobol sequences of {} points under independent scrambles {} from seed {}; standard errors are the jackknife's \
             over the sequences. Indices of the readings are those of all wavelengths together {}.",
            cited(SALTELLI, &mut bibliography),
            cited(JANSEN, &mut bibliography),
            settings.replicates,
            settings.samples,
            bibliography.cite(BURLEY),
            settings.seed,
            bibliography.cite(LAMBONI)
        );
        paragraphs.push(Paragraph { heading: "Shares of the variance".to_owned(), text });
    }
    (paragraphs, bibliography.works.into_iter().map(|work| work.citation).collect())
}

/// A work by its key and its number.
fn cited(work: Work, bibliography: &mut Bibliography) -> String {
    format!("{} {}", work.0, bibliography.cite(work))
}
