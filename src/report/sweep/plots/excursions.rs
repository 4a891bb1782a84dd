//! Each parameter on its own over its range.

use crate::job::Sweep;
use crate::report::chart::{Axis, Cell, Chart, Figure, Layer, PAGE_WIDTH, Series, extent, from_zero};
use crate::report::readings::quantity_label;
use crate::report::sweep::swept::{MOST_LINES, line, views, views_note};

pub(super) fn draw(sweep: &Sweep) -> Vec<Figure> {
    let shown = &sweep.excursions[..sweep.excursions.len().min(MOST_LINES)];
    let has_colours = !sweep.own.colours.is_empty();
    let numbers = |view: usize, place: usize| {
        if has_colours { &shown[place].differences[view] } else { &shown[place].changes[view] }
    };
    let views = views(sweep);
    let all = views.iter().flat_map(|(view, _)| (0..shown.len()).flat_map(|place| numbers(*view, place)));
    let range = from_zero(extent(all.copied()));
    let label = if has_colours {
        "ΔE₀₀ to the job's own values".to_owned()
    } else {
        format!("rms change of {}", quantity_label(sweep.quantity))
    };
    let of_view = |(view, name): &(usize, String)| {
        let lines = shown.iter().enumerate().map(|(place, excursion)| {
            let points = excursion.shares.iter().zip(numbers(*view, place)).map(|(share, y)| (100.0 * share, *y));
            Layer::Series(Series::new(&excursion.parameter.name, points, line(place)))
        });
        let chart = Chart {
            x: Axis::linear("share of the range (%)", (0.0, 100.0)),
            y: Axis::linear(&label, range),
            height: 200.0,
            layers: lines.collect(),
        };
        Cell { title: name.clone(), charts: vec![chart] }
    };
    let cells: Vec<Cell> = views.iter().map(of_view).collect();
    let crowded = match sweep.excursions.len() - shown.len() {
        0 => String::new(),
        more => format!(" {more} further parameters are in excursions.csv alone."),
    };
    vec![Figure {
        name: "excursions".to_owned(),
        title: "Each parameter on its own over its range".to_owned(),
        caption: format!(
            "One parameter is moved over its range, evenly or evenly in its logarithm as the table says, while all others \
             keep the job's own values; a line touches 0 at the own value. Steps are CIEDE2000's own, where two hues lie opposite each other.{crowded} {}",
            views_note(sweep)
        ),
        width: PAGE_WIDTH,
        columns: 2.min(cells.len()),
        cells,
    }]
}
