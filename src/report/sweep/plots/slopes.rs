//! What 1 % of each parameter does to the readings, over wavelength.

use crate::job::{Slope, Sweep};
use crate::report::chart::{Axis, Cell, Chart, Figure, Layer, PAGE_WIDTH, Series, around_zero, extent, with_room};
use crate::report::readings::quantity_label;
use crate::report::sweep::swept::{MOST_LINES, line, marked_line, views, views_note};

pub(super) fn draw(sweep: &Sweep) -> Vec<Figure> {
    let (shown, left_out): (Vec<&Slope>, Vec<&Slope>) = sweep.slopes.iter().partition(|slope| slope.at != 0.0);
    let crowded = shown.len().saturating_sub(MOST_LINES);
    let shown = &shown[..shown.len().min(MOST_LINES)];
    if shown.is_empty() {
        return Vec::new();
    }
    let change = |slope: &Slope, view: usize, channel: usize| slope.per_percent(slope.readings[view][channel]);
    let views = views(sweep);
    let all = views.iter().flat_map(|(view, _)| {
        shown
            .iter()
            .flat_map(|slope| (0..slope.readings[*view].len()).filter_map(|channel| change(slope, *view, channel)))
    });
    let range = around_zero(all);
    let of_view = |(view, name): &(usize, String)| {
        let nm = &sweep.views[*view].wavelengths_nm;
        let is_few = nm.len() <= MOST_LINES;
        let lines = shown.iter().enumerate().map(|(place, slope)| {
            let points = nm.iter().enumerate().filter_map(|(channel, nm)| Some((*nm, change(slope, *view, channel)?)));
            let look = if is_few { marked_line(place) } else { line(place) };
            Layer::Series(Series::new(&slope.parameter.name, points, look))
        });
        let mut layers = vec![Layer::Level(0.0)];
        layers.extend(lines);
        let wavelengths = extent(nm.iter().copied());
        let chart = Chart {
            x: Axis::linear("wavelength (nm)", if is_few { with_room(wavelengths) } else { wavelengths }),
            y: Axis::linear(format!("change of {} by 1 %", quantity_label(sweep.quantity)), range),
            height: 200.0,
            layers,
        };
        Cell { title: name.clone(), charts: vec![chart] }
    };
    let cells: Vec<Cell> = views.iter().map(of_view).collect();
    let mut caption = vec![
        "Change of the readings where a parameter grows by 1 % of the job's own value, to first order.".to_owned(),
    ];
    if !left_out.is_empty() {
        let names: Vec<&str> = left_out.iter().map(|slope| slope.parameter.name.as_str()).collect();
        caption.push(format!("Without {}, whose value is 0.", names.join(", ")));
    }
    if crowded > 0 {
        caption.push(format!("{crowded} further parameters are in the table alone."));
    }
    caption.push(views_note(sweep));
    vec![Figure {
        name: "slopes".to_owned(),
        title: "What 1 % of each parameter does to the readings".to_owned(),
        caption: caption.join(" "),
        width: PAGE_WIDTH,
        columns: 2.min(cells.len()),
        cells,
    }]
}
