//! Measured and fitted spectra, one panel a geometry, with the residuals below each.

use crate::job::{Case, CaseData, SpectrumFit};
use crate::report::angles;
use crate::report::chart::{
    Axis, Cell, Chart, Figure, Layer, Look, PAGE_WIDTH, Series, around_zero, extent, from_zero,
};
use crate::report::palette::{BLACK, GREEN, SKY, VERMILION};
use crate::report::readings::{self, quantity_label, quantity_note};

const MEASURED: Look = Look::Line { colour: SKY, width: 2.6, dashed: false };
const FITTED: Look = Look::Line { colour: BLACK, width: 1.3, dashed: false };
const PREDICTED: Look = Look::Line { colour: VERMILION, width: 1.5, dashed: true };

pub(super) fn draw(case: &Case) -> Vec<Figure> {
    let CaseData::Spectra { quantity, spectra, .. } = &case.data else { return Vec::new() };
    // Specimens are shown each with its own fit.
    if !readings::are_spectra(spectra) || case.population.is_some() {
        return Vec::new();
    }
    let selection = angles::representative(spectra);
    let shown: Vec<&SpectrumFit> = selection.indices.iter().map(|i| &spectra[*i]).collect();
    let names = angles::spectrum_names(spectra);
    let wavelengths = extent(shown.iter().flat_map(|s| s.wavelengths_nm.iter().copied()));
    let is_few = shown.len() <= 4;
    let cells = selection.indices.iter().map(|index| {
        let spectrum = &spectra[*index];
        let title = if spectrum.fitted { names[*index].clone() } else { format!("{} (not fitted)", names[*index]) };
        let x = || Axis::linear("wavelength (nm)", wavelengths);
        let shown_values = extent(readings::of(spectrum).flat_map(|r| [r.measured, r.model]));
        let (model_name, model_look) =
            if spectrum.fitted { ("fitted", FITTED) } else { ("predicted, not fitted", PREDICTED) };
        let spectrum_chart = Chart {
            x: x(),
            y: Axis::linear(quantity_label(*quantity), from_zero(shown_values)),
            height: if is_few { 200.0 } else { 120.0 },
            layers: vec![
                Layer::Series(Series::new(
                    "measured",
                    readings::of(spectrum).map(|r| (r.wavelength_nm, r.measured)),
                    MEASURED,
                )),
                Layer::Series(Series::new(
                    model_name,
                    readings::of(spectrum).map(|r| (r.wavelength_nm, r.model)),
                    model_look,
                )),
            ],
        };
        let residual_chart = Chart {
            x: x(),
            y: Axis::linear("residual", around_zero(readings::of(spectrum).map(|r| r.residual()))),
            height: if is_few { 80.0 } else { 56.0 },
            layers: vec![
                Layer::Level(0.0),
                Layer::Series(Series::new(
                    "residual",
                    readings::of(spectrum).map(|r| (r.wavelength_nm, r.residual())),
                    Look::Line { colour: GREEN, width: 1.1, dashed: false },
                )),
            ],
        };
        Cell { title, charts: vec![spectrum_chart, residual_chart] }
    });
    let sentences = [
        selection.text.unwrap_or_default(),
        angles::spectrum_meaning(spectra).to_owned(),
        quantity_note(*quantity).to_owned(),
        "Residuals are model − measured, in the same unit. Each panel has its own scale of readings and its own of \
         residuals."
            .to_owned(),
    ];
    let caption = sentences.iter().filter(|s| !s.is_empty()).cloned().collect::<Vec<_>>().join(" ");
    vec![Figure {
        name: "spectra".to_owned(),
        title: "Measured and fitted spectra".to_owned(),
        caption,
        width: PAGE_WIDTH,
        columns: if is_few { 2 } else { 3 },
        cells: cells.collect(),
    }]
}
