//! Peak wavelength against angle, with the fitted curve and the residuals below.

use crate::job::{Case, CaseData, PeakFit};
use crate::report::chart::{Axis, Cell, Chart, Figure, Layer, Look, Mark, Series, around_zero, extent, with_room};
use crate::report::palette::{BLACK, BLUE, VERMILION};

pub(super) fn draw(case: &Case) -> Vec<Figure> {
    let CaseData::Peaks { peaks, curve, .. } = &case.data else { return Vec::new() };
    if peaks.is_empty() {
        return Vec::new();
    }
    let angle = |p: &PeakFit| p.geometry.theta_i_deg;
    let angles = with_room(extent(peaks.iter().map(angle)));
    let angles = (angles.0.max(0.0), angles.1.min(90.0));
    let in_range = |x: f64| (angles.0..=angles.1).contains(&x);
    let wavelengths = with_room(extent(
        peaks
            .iter()
            .flat_map(|p| {
                let sigma = p.sigma_nm.unwrap_or(0.0);
                [p.measured_nm - sigma, p.measured_nm + sigma]
            })
            .chain(curve.iter().filter(|(x, _)| in_range(*x)).map(|(_, y)| *y)),
    ));
    let residual = |p: &PeakFit| Some(p.model_nm? - p.measured_nm);
    let residuals = around_zero(peaks.iter().filter_map(|p| Some(residual(p)?.abs() + p.sigma_nm.unwrap_or(0.0))));
    let of = |fitted: bool| peaks.iter().filter(move |p| p.fitted == fitted);
    let fitted_look = Look::Marks { colour: BLUE, mark: Mark::Disc, open: false };
    let left_out_look = Look::Marks { colour: VERMILION, mark: Mark::Square, open: true };
    let readings = |name: &str, fitted: bool, look: Look| {
        Layer::Series(Series::with_errors(name, of(fitted).map(|p| (angle(p), p.measured_nm, p.sigma_nm)), look))
    };
    let differences = |name: &str, fitted: bool, look: Look| {
        let points = of(fitted).filter_map(|p| Some((angle(p), residual(p)?, p.sigma_nm)));
        Layer::Series(Series::with_errors(name, points, look))
    };
    let x = || Axis::linear("inclination of the light θᵢ (°)", angles);
    let against_angle = Chart {
        x: x(),
        y: Axis::linear("peak wavelength (nm)", wavelengths),
        height: 230.0,
        layers: vec![
            Layer::Series(Series::new(
                "fitted curve",
                curve.iter().filter(|(x, _)| in_range(*x)).copied(),
                Look::Line { colour: BLACK, width: 1.4, dashed: false },
            )),
            readings("measured, fitted", true, fitted_look),
            readings("measured, left out of the fit", false, left_out_look),
        ],
    };
    let below = Chart {
        x: x(),
        y: Axis::linear("residual (nm)", residuals),
        height: 110.0,
        layers: vec![
            Layer::Level(0.0),
            differences("measured, fitted", true, fitted_look),
            differences("measured, left out of the fit", false, left_out_look),
        ],
    };
    let missing = peaks.iter().filter(|p| p.model_nm.is_none()).count();
    let mut caption = "Residual is model − measured.".to_owned();
    if peaks.iter().any(|p| p.sigma_nm.is_some()) {
        caption += " Bars are ± one standard deviation.";
    }
    if missing > 0 {
        caption += &format!(" At {missing} of the readings the model's spectrum has no such peak.");
    }
    vec![Figure {
        name: "peaks".to_owned(),
        title: "Peak wavelength against angle".to_owned(),
        caption,
        width: 660,
        columns: 1,
        cells: vec![Cell { title: String::new(), charts: vec![against_angle, below] }],
    }]
}
