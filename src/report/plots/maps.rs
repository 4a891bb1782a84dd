//! Angle × wavelength maps: measured, fitted, and their difference.

use crate::job::{Case, CaseData, SpectrumFit};
use crate::report::angles;
use crate::report::chart::{Axis, Cell, Chart, Figure, Layer, Map, PAGE_WIDTH, around_zero, extent, length};
use crate::report::palette::Scale;
use crate::report::readings::{self, Reading, quantity_label};

/// Columns of a map; more cannot be told apart at its width.
const MOST_COLUMNS: usize = 100;

pub(super) fn draw(case: &Case) -> Vec<Figure> {
    let CaseData::Spectra { quantity, spectra } = &case.data else { return Vec::new() };
    if spectra.len() < 2 {
        return Vec::new();
    }
    let selection = angles::rows(spectra);
    let shown: Vec<&SpectrumFit> = selection.indices.iter().map(|i| &spectra[*i]).collect();
    let all_names = angles::names(spectra.iter().map(|s| &s.geometry));
    let names: Vec<String> = selection.indices.iter().map(|i| all_names[*i].clone()).collect();
    let wavelengths = extent(shown.iter().flat_map(|s| s.wavelengths_nm.iter().copied()));
    let columns = shown.iter().map(|s| s.wavelengths_nm.len()).max().unwrap_or(1).clamp(1, MOST_COLUMNS);
    let borders: Vec<f64> =
        (0..=columns).map(|c| wavelengths.0 + (wavelengths.1 - wavelengths.0) * length(c) / length(columns)).collect();
    let rows = |value: fn(&Reading) -> f64| -> Vec<Vec<Option<f64>>> {
        shown.iter().map(|s| means(s, &borders, value)).collect()
    };
    let (measured, fitted) = (rows(|r| r.measured), rows(|r| r.model));
    let residual = rows(Reading::residual);
    let (low, high) = extent(measured.iter().chain(&fitted).flatten().flatten().copied());
    let readings_scale = Scale::Sequential { low: low.min(0.0), high };
    let residual_scale = Scale::Diverging { limit: around_zero(residual.iter().flatten().flatten().copied()).1 };
    let height = (length(names.len()) * 15.0).clamp(120.0, 360.0);
    let is_mirror = spectra.iter().all(|s| angles::is_mirror(&s.geometry));
    let y_label = if is_mirror { "inclination θ" } else { "θᵢ → θₒ, φ" };
    let cell = |title: &str, rows: Vec<Vec<Option<f64>>>, scale: Scale, label: &str| Cell {
        title: title.to_owned(),
        charts: vec![Chart {
            x: Axis::linear("wavelength (nm)", wavelengths),
            y: Axis::bands(y_label, names.clone()),
            height,
            layers: vec![Layer::Map(Map {
                borders: borders.clone(),
                rows,
                scale,
                label: label.to_owned(),
                with_numbers: false,
            })],
        }],
    };
    let label = quantity_label(*quantity);
    let caption = [
        selection.text.unwrap_or_default(),
        "Measured and fitted share one scale; residual is model − measured. Hatched: no reading.".to_owned(),
    ]
    .join(" ");
    vec![Figure {
        name: "maps".to_owned(),
        title: "Angle × wavelength".to_owned(),
        caption: caption.trim().to_owned(),
        width: PAGE_WIDTH,
        columns: 3,
        cells: vec![
            cell("measured", measured, readings_scale, label),
            cell("fitted", fitted, readings_scale, label),
            cell("residual", residual, residual_scale, "model − measured"),
        ],
    }]
}

/// The mean of a spectrum's readings in each column, and the nearest one where a column falls between two readings.
fn means(spectrum: &SpectrumFit, borders: &[f64], value: fn(&Reading) -> f64) -> Vec<Option<f64>> {
    let readings: Vec<Reading> = readings::of(spectrum).collect();
    borders
        .windows(2)
        .map(|pair| {
            let middle = (pair[0] + pair[1]) / 2.0;
            let inside = |r: &&Reading| (pair[0]..=pair[1]).contains(&r.wavelength_nm);
            let mut chosen: Vec<&Reading> = readings.iter().filter(inside).collect();
            if chosen.is_empty() {
                let distance = |r: &Reading| (r.wavelength_nm - middle).abs();
                chosen.extend(
                    readings
                        .iter()
                        .min_by(|a, b| distance(a).total_cmp(&distance(b)))
                        .filter(|r| distance(r) <= 2.0 * (pair[1] - pair[0])),
                );
            }
            let values: Vec<f64> = chosen.into_iter().map(value).filter(|v| v.is_finite()).collect();
            (!values.is_empty()).then(|| values.iter().sum::<f64>() / length(values.len()))
        })
        .collect()
}
