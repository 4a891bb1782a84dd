//! Angle × wavelength maps: measured, fitted, and their difference.

use crate::job::{Case, CaseData, SpectrumFit};
use crate::number::significant;
use crate::report::angles;
use crate::report::chart::{Axis, Cell, Chart, Figure, Layer, Map, PAGE_WIDTH, extent, length};
use crate::report::palette::Scale;
use crate::report::readings::{self, Reading, quantity_label};

/// Columns of a map; more cannot be told apart at its width.
const MOST_COLUMNS: usize = 100;
/// The share of all values that a colour scale reaches over: one spike must not turn all the rest into one colour.
const MOST_OF_ALL: f64 = 0.98;

pub(super) fn draw(case: &Case) -> Vec<Figure> {
    let CaseData::Spectra { quantity, spectra, .. } = &case.data else { return Vec::new() };
    if !readings::are_spectra(spectra) {
        return Vec::new();
    }
    // What the fit did not see is often what would outshine all the rest: gloss, grazing angles.
    let fitted_spectra: Vec<SpectrumFit> = spectra.iter().filter(|s| s.fitted).cloned().collect();
    let left_out = spectra.len() - fitted_spectra.len();
    let spectra = &fitted_spectra;
    // Specimens are shown each with its own fit.
    if spectra.len() < 2 || case.population.is_some() {
        return Vec::new();
    }
    let selection = angles::rows(spectra);
    let shown: Vec<&SpectrumFit> = selection.indices.iter().map(|i| &spectra[*i]).collect();
    let all_names = angles::spectrum_names(spectra);
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
    let readings = || measured.iter().chain(&fitted).flatten().flatten().copied();
    let residuals = || residual.iter().flatten().flatten().copied();
    let readings_scale = Scale::Sequential {
        low: at_share(readings(), 1.0 - MOST_OF_ALL).min(0.0),
        high: at_share(readings(), MOST_OF_ALL),
    };
    let residual_scale = Scale::Diverging { limit: at_share(residuals().map(f64::abs), MOST_OF_ALL) };
    let height = (length(names.len()) * 15.0).clamp(120.0, 360.0);
    let is_mirror = spectra.iter().all(|s| angles::is_mirror(&s.geometry));
    let y_label = if spectra.iter().any(|s| s.without_geometry) {
        "spectrum"
    } else if is_mirror {
        "inclination θ"
    } else {
        "θᵢ → θₒ, φ"
    };
    let cell = |title: &str, rows: Vec<Vec<Option<f64>>>, scale: Scale, label: &str, clipped: &str| Cell {
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
                clipped: clipped.to_owned(),
                with_numbers: false,
            })],
        }],
    };
    let label = quantity_label(*quantity);
    let readings_clipped = clipped(readings_scale, extent(readings()));
    let residuals_clipped = clipped(residual_scale, extent(residuals()));
    let not_fitted = match left_out {
        0 => String::new(),
        1 => "One spectrum that was not fitted is left out.".to_owned(),
        many => format!("{many} spectra that were not fitted are left out."),
    };
    let caption = [
        not_fitted,
        selection.text.unwrap_or_default(),
        "Measured and fitted share one scale; residual is model − measured. Scales reach over 98 % of the values; what is \
         beyond has the colour of the end. Hatched: no reading."
            .to_owned(),
    ];
    let caption = caption.iter().filter(|s| !s.is_empty()).cloned().collect::<Vec<_>>().join(" ");
    vec![Figure {
        name: "maps".to_owned(),
        title: "Angle × wavelength".to_owned(),
        caption,
        width: PAGE_WIDTH,
        columns: 3,
        cells: vec![
            cell("measured", measured, readings_scale, label, &readings_clipped),
            cell("fitted", fitted, readings_scale, label, &readings_clipped),
            cell("residual", residual, residual_scale, "model − measured", &residuals_clipped),
        ],
    }]
}

/// The value below which this share of the values lies; 1 where there is none above 0, so that a scale has an extent.
fn at_share(values: impl Iterator<Item = f64>, share: f64) -> f64 {
    let mut sorted: Vec<f64> = values.filter(|v| v.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place in the list")]
    let place = (share * length(sorted.len().saturating_sub(1))).round() as usize;
    sorted.get(place).copied().filter(|v| *v != 0.0).unwrap_or(1.0)
}

/// Which values lie beyond the ends of a scale.
fn clipped(scale: Scale, (lowest, highest): (f64, f64)) -> String {
    let (low, high) = scale.range();
    // The ends are written short; what is beyond by less is not beyond to the eye.
    let slack = 1e-3 * (high - low);
    let [below, above] = [low, high].map(|end| significant(end, 2));
    match (lowest < low - slack, highest > high + slack) {
        (false, false) => String::new(),
        (true, true) => format!("below {below}, above {above}: clipped"),
        (true, false) => format!("below {below}: clipped"),
        (false, true) => format!("above {above}: clipped"),
    }
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
