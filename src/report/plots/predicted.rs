//! The spectra that a model fitted to peaks predicts, with the measured peaks marked.

use crate::job::{Case, CaseData, Prediction};
use crate::report::angles;
use crate::report::chart::{Axis, Cell, Chart, Figure, Layer, Look, PAGE_WIDTH, Series, extent, from_zero};
use crate::report::palette::{BLACK, BLUE};

const MEASURED_PEAK: Look = Look::Line { colour: BLUE, width: 1.3, dashed: true };

pub(super) fn draw(case: &Case) -> Vec<Figure> {
    let CaseData::Peaks { peaks, spectra, .. } = &case.data else { return Vec::new() };
    if spectra.is_empty() {
        return Vec::new();
    }
    let names = angles::names(spectra.iter().map(|s| &s.geometry));
    let wavelengths = extent(spectra.iter().flat_map(|s| s.wavelengths_nm.iter().copied()));
    let reflectances = from_zero(extent(spectra.iter().flat_map(|s| s.reflectance.iter().copied())));
    let cell = |spectrum: &Prediction, title: &String| {
        let curve = spectrum.wavelengths_nm.iter().copied().zip(spectrum.reflectance.iter().copied());
        let look = Look::Line { colour: BLACK, width: 1.3, dashed: false };
        let mut layers = vec![Layer::Series(Series::new("predicted", curve, look))];
        let marked = peaks.iter().filter(|p| p.id == spectrum.id);
        layers.extend(marked.map(|p| {
            let upright = [(p.measured_nm, reflectances.0), (p.measured_nm, reflectances.1)];
            Layer::Series(Series::new("measured peak", upright, MEASURED_PEAK))
        }));
        Cell {
            title: title.clone(),
            charts: vec![Chart {
                x: Axis::linear("wavelength (nm)", wavelengths),
                y: Axis::linear("reflectance", reflectances),
                height: 95.0,
                layers,
            }],
        }
    };
    vec![Figure {
        name: "predicted".to_owned(),
        title: "Predicted spectra".to_owned(),
        caption: format!(
            "Reflectance of the fitted model at each angle. {}",
            angles::meaning(spectra.iter().map(|s| &s.geometry))
        ),
        width: PAGE_WIDTH,
        columns: 3,
        cells: spectra.iter().zip(&names).map(|(spectrum, title)| cell(spectrum, title)).collect(),
    }]
}
