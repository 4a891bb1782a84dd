//! Tables of a few channels: each reading against the model's, and both against the angle from the mirror direction.

use crate::job::{Case, CaseData, SpectrumFit};
use crate::report::chart::{
    Axis, Cell, Chart, Figure, Layer, Look, Mark, PAGE_WIDTH, Series, extent, from_zero, with_room_logarithmic,
};
use crate::report::palette::{BLACK, BLUE, GREY, VERMILION};
use crate::report::readings::{self, Reading, quantity_label, quantity_note};

/// A range of readings from here on is drawn in logarithms.
const WIDE: f64 = 20.0;

pub(super) fn draw(case: &Case) -> Vec<Figure> {
    let CaseData::Spectra { quantity, spectra, .. } = &case.data else { return Vec::new() };
    if readings::are_spectra(spectra) || spectra.is_empty() {
        return Vec::new();
    }
    let mut wavelengths: Vec<f64> = spectra.iter().flat_map(|s| s.wavelengths_nm.iter().copied()).collect();
    wavelengths.sort_by(f64::total_cmp);
    wavelengths.dedup();
    let values = || spectra.iter().flat_map(readings::of).flat_map(|r| [r.measured, r.model]).filter(|v| v.is_finite());
    let (low, high) = extent(values());
    let range =
        if low > 0.0 && high > WIDE * low { with_room_logarithmic((low, high)) } else { from_zero((low, high)) };
    let axis = |label: String| {
        if low > 0.0 && high > WIDE * low { Axis::logarithmic(label, range) } else { Axis::linear(label, range) }
    };
    let label = quantity_label(*quantity);
    let cells = wavelengths.iter().flat_map(|&nm| {
        let title = |what: &str| if wavelengths.len() > 1 { format!("{what}, {nm} nm") } else { what.to_owned() };
        let points = |fitted: bool, point: &dyn Fn(&SpectrumFit, &Reading) -> (f64, f64)| {
            let chosen = spectra.iter().filter(|spectrum| spectrum.fitted == fitted);
            let at = |spectrum| readings::of(spectrum).filter(move |r| r.wavelength_nm.total_cmp(&nm).is_eq());
            chosen
                .flat_map(|spectrum| at(spectrum).map(|r| point(spectrum, &r)).collect::<Vec<_>>())
                .collect::<Vec<_>>()
        };
        let against = |_: &SpectrumFit, r: &Reading| (r.measured, r.model);
        let off_mirror = |spectrum: &SpectrumFit| spectrum.geometry.degrees_from_mirror();
        let measured = |spectrum: &SpectrumFit, r: &Reading| (off_mirror(spectrum), r.measured);
        let model = |spectrum: &SpectrumFit, r: &Reading| (off_mirror(spectrum), r.model);
        let all =
            |point: &dyn Fn(&SpectrumFit, &Reading) -> (f64, f64)| [points(true, point), points(false, point)].concat();
        let marks = |colour, mark, open| Look::Marks { colour, mark, open };
        [
            Cell {
                title: title("Model against reading"),
                charts: vec![Chart {
                    x: axis(format!("measured {label}")),
                    y: axis(format!("model {label}")),
                    height: 330.0,
                    layers: vec![
                        Layer::Series(Series::new(
                            "model = measured",
                            [(range.0, range.0), (range.1, range.1)],
                            Look::Line { colour: GREY, width: 1.0, dashed: true },
                        )),
                        Layer::Series(Series::new("fitted", points(true, &against), marks(BLUE, Mark::Disc, false))),
                        Layer::Series(Series::new(
                            "held out",
                            points(false, &against),
                            marks(VERMILION, Mark::Square, true),
                        )),
                    ],
                }],
            },
            Cell {
                title: title(&format!("{label} away from the mirror direction")),
                charts: vec![Chart {
                    x: Axis::linear(
                        "viewer's angle from the mirror direction (°)",
                        from_zero(extent(all(&measured).iter().map(|p| p.0))),
                    ),
                    y: axis(label.to_owned()),
                    height: 330.0,
                    layers: vec![
                        Layer::Series(Series::new("measured", all(&measured), marks(BLACK, Mark::Disc, true))),
                        Layer::Series(Series::new("model", all(&model), marks(VERMILION, Mark::Diamond, false))),
                    ],
                }],
            },
        ]
    });
    let held_out = if spectra.iter().all(|spectrum| spectrum.fitted) {
        "All readings were fitted."
    } else {
        "Readings held out were not seen by the fit."
    };
    vec![Figure {
        name: "readings".to_owned(),
        title: "Readings and model".to_owned(),
        caption: [held_out, quantity_note(*quantity)].join(" ").trim().to_owned(),
        width: PAGE_WIDTH,
        columns: 2,
        cells: cells.collect(),
    }]
}
