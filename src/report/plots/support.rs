//! Prediction error at incidences left out one at a time, with the film and without.

use crate::job::{Case, CaseData};
use crate::report::chart::{
    Axis, Cell, Chart, Figure, Layer, Look, Mark, Series, extent, from_zero, with_room, with_room_logarithmic,
};
use crate::report::palette::{BLUE, VERMILION};

pub(super) fn draw(case: &Case) -> Vec<Figure> {
    let Some(support) = &case.support else { return Vec::new() };
    let incidences = &support.incidences_deg;
    if incidences.is_empty() {
        return Vec::new();
    }
    let against =
        |values: &[f64]| -> Vec<(f64, f64)> { incidences.iter().copied().zip(values.iter().copied()).collect() };
    let errors = extent(support.with_film.iter().chain(&support.without_film).copied());
    let has_sigma =
        matches!(&case.data, CaseData::Spectra { spectra, .. } if spectra.iter().all(|s| s.sigmas.is_some()));
    let y_label = if has_sigma { "mean squared error (σ²)" } else { "mean squared error (share)" };
    let y = if errors.0 > 0.0 && errors.1 > 20.0 * errors.0 {
        Axis::logarithmic(y_label, with_room_logarithmic(errors))
    } else {
        Axis::linear(y_label, from_zero(errors))
    };
    let x = || Axis::linear("incidence left out (°)", with_room(extent(incidences.iter().copied())));
    let with_look = Look::Both { colour: BLUE, mark: Mark::Disc, dashed: false };
    let without_look = Look::Both { colour: VERMILION, mark: Mark::Square, dashed: true };
    let mut charts = vec![Chart {
        x: x(),
        y,
        height: 190.0,
        layers: vec![
            Layer::Series(Series::new("with film", against(&support.with_film), with_look)),
            Layer::Series(Series::new("without film", against(&support.without_film), without_look)),
        ],
    }];
    if !support.thickness_by_fold_nm.is_empty() {
        charts.push(Chart {
            x: x(),
            y: Axis::linear("thickness (nm)", with_room(extent(support.thickness_by_fold_nm.iter().copied()))),
            height: 110.0,
            layers: vec![Layer::Series(Series::new(
                "thickness found without that incidence",
                against(&support.thickness_by_fold_nm),
                Look::Marks { colour: BLUE, mark: Mark::Diamond, open: true },
            ))],
        });
    }
    vec![Figure {
        name: "support".to_owned(),
        title: "Prediction at incidences left out one at a time".to_owned(),
        caption: format!(
            "The readings at each incidence are predicted by a fit to all the others; lower is better. Errors are {}.",
            if has_sigma { "in units of each reading's σ²" } else { "a share of the mean squared reading there" }
        ),
        width: 660,
        columns: 1,
        cells: vec![Cell { title: String::new(), charts }],
    }]
}
