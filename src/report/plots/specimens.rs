//! Each specimen's spectra with its own fit and its prediction from the others; and the values of all specimens.

use crate::job::{Case, CaseData, Effects, Population, SpecimenSpectrum};
use crate::report::chart::{
    Axis, Cell, Chart, Figure, Layer, Look, Mark, PAGE_WIDTH, Series, extent, from_zero, length, with_room,
};
use crate::report::palette::{BLACK, BLUE, GREY, SKY, VERMILION};
use crate::report::readings::quantity_label;

/// Most spectra that are shown one by one.
const MOST_PANELS: usize = 15;
/// Most parameters whose values are shown.
const MOST_PARAMETERS: usize = 9;

pub(super) fn draw(case: &Case) -> Vec<Figure> {
    let (Some(population), CaseData::Spectra { quantity, .. }) = (&case.population, &case.data) else {
        return Vec::new();
    };
    let mut figures = vec![spectra(population, quantity_label(*quantity))];
    figures.extend(values(population));
    figures
}

fn spectra(population: &Population, label: &str) -> Figure {
    let all: Vec<&SpecimenSpectrum> = population.specimens.iter().flat_map(|specimen| &specimen.spectra).collect();
    let shown: Vec<&SpecimenSpectrum> = all.iter().copied().take(MOST_PANELS).collect();
    let wavelengths = extent(shown.iter().flat_map(|one| one.wavelengths_nm.iter().copied()));
    // One scale for all, since it is the difference between specimens that matters.
    let values = extent(
        shown
            .iter()
            .flat_map(|one| one.measured.iter().chain(&one.fitted).chain(one.predicted.iter().flatten()).copied()),
    );
    let cells = shown.iter().map(|one| {
        let curve = |name: &str, values: &[f64], look| {
            Layer::Series(Series::new(name, one.wavelengths_nm.iter().copied().zip(values.iter().copied()), look))
        };
        let mut layers = vec![
            curve("measured", &one.measured, Look::Line { colour: SKY, width: 2.6, dashed: false }),
            curve("its own fit", &one.fitted, Look::Line { colour: BLACK, width: 1.3, dashed: false }),
        ];
        if let Some(predicted) = &one.predicted {
            let look = Look::Line { colour: VERMILION, width: 1.5, dashed: true };
            layers.push(curve("predicted from the others", predicted, look));
        }
        let x = Axis::linear("wavelength (nm)", wavelengths);
        let chart = Chart { x, y: Axis::linear(label, from_zero(values)), height: 120.0, layers };
        Cell { title: one.id.clone(), charts: vec![chart] }
    });
    let left_out = all.len() - shown.len();
    let more = if left_out > 0 { format!(" {left_out} more spectra are in result.json.") } else { String::new() };
    Figure {
        name: "specimens".to_owned(),
        title: if population.left_out.is_some() {
            "Each specimen, its own fit and its prediction from the others".to_owned()
        } else {
            "Each specimen and its own fit".to_owned()
        },
        caption: format!("All panels have one scale.{more}"),
        width: PAGE_WIDTH,
        columns: 3,
        cells: cells.collect(),
    }
}

fn values(population: &Population) -> Option<Figure> {
    let names: Vec<String> = population.specimens.iter().map(|specimen| specimen.name.clone()).collect();
    let parameters = population.parameters.iter().enumerate().take(MOST_PARAMETERS);
    let cells: Vec<Cell> = parameters
        .map(|(index, parameter)| {
            let points = population
                .specimens
                .iter()
                .enumerate()
                .map(|(row, specimen)| (specimen.values[index], length(row) + 0.5, specimen.own_errors[index]));
            let ends = points.clone().flat_map(|(value, _, error)| {
                let error = error.unwrap_or(0.0);
                [value - error, value + error]
            });
            let whole = ends.chain(parameter.effects.iter().flat_map(|effects| effects.mean_interval_95));
            let range = with_room(extent(whole));
            let determined: Vec<(f64, f64, f64)> =
                points.clone().filter_map(|(value, row, error)| Some((value, row, error?))).collect();
            let open = points.filter(|point| point.2.is_none()).map(|(value, row, _)| (value, row));
            let bars = determined.iter().map(|(value, row, error)| {
                let ends = [(value - error, *row), (value + error, *row)];
                Layer::Series(Series::new(
                    "± its own error",
                    ends,
                    Look::Line { colour: BLUE, width: 1.2, dashed: false },
                ))
            });
            let mut layers: Vec<Layer> = Vec::new();
            if let Some(Effects { mean, mean_interval_95: [low, high], .. }) = &parameter.effects {
                let whole_height = |x: f64| [(x, 0.0), (x, length(names.len()))];
                let dashed = |dashed| Look::Line { colour: GREY, width: 1.2, dashed };
                layers.push(Layer::Series(Series::new("mean", whole_height(*mean), dashed(false))));
                layers.push(Layer::Series(Series::new("its 95 % interval", whole_height(*low), dashed(true))));
                layers.push(Layer::Series(Series::new("its 95 % interval", whole_height(*high), dashed(true))));
            }
            layers.extend(bars);
            let marks = |open| Look::Marks { colour: BLUE, mark: Mark::Disc, open };
            let at = determined.iter().map(|(value, row, _)| (*value, *row));
            layers.push(Layer::Series(Series::new("specimen", at, marks(false))));
            layers.push(Layer::Series(Series::new("not determined", open, marks(true))));
            let unit = if parameter.unit.is_empty() { String::new() } else { format!(", {}", parameter.unit) };
            let chart = Chart {
                x: Axis::linear("value", range),
                y: Axis::bands("specimen", names.clone()).reversed(),
                height: (length(names.len()) * 18.0).clamp(90.0, 320.0),
                layers,
            };
            Cell { title: format!("{} ({}{unit})", parameter.name, parameter.symbol), charts: vec![chart] }
        })
        .collect();
    (!cells.is_empty()).then(|| Figure {
        name: "values".to_owned(),
        title: "Parameters of each specimen".to_owned(),
        caption: "Each specimen's own fit; errors leave out the misfit that all share. Lines are the mean of the population and its 95 % interval. \
                  Open marks stand at a bound, or where the spectra do not determine the parameter."
            .to_owned(),
        width: PAGE_WIDTH,
        columns: if cells.len() == 1 { 1 } else { 2 },
        cells,
    })
}
