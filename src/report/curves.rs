//! The numbers behind a figure, as tables that any program reads.

use plotters::style::RGBColor;

use super::chart::{AxisKind, Chart, ColourCells, Figure, Layer, Map, Series, length};
use super::disc::{Disc, Dome};
use super::layout::series_of;

/// A table of a figure's numbers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct CurveTable {
    /// File name.
    pub(crate) file: String,
    pub(crate) csv: String,
}

/// Every curve and map of a figure, one table for each pair of quantities on the axes.
///
/// Curves have one row a point: panel, curve, x, y, and the length of the error bar where there is one. Maps have one
/// row a cell. Numbers have seven significant digits, more than any plot shows.
pub(crate) fn tables(figure: &Figure) -> Result<Vec<CurveTable>, csv::Error> {
    let charts: Vec<(&str, &Chart)> =
        figure.cells.iter().flat_map(|cell| cell.charts.iter().map(|chart| (cell.title.as_str(), chart))).collect();
    let mut kinds: Vec<(&str, &str)> = Vec::new();
    for (_, chart) in &charts {
        let kind = (chart.x.label.as_str(), chart.y.label.as_str());
        if !kinds.contains(&kind) {
            kinds.push(kind);
        }
    }
    let mut tables = Vec::new();
    for (index, (x, y)) in kinds.iter().enumerate() {
        let same: Vec<_> = charts.iter().filter(|(_, c)| c.x.label == *x && c.y.label == *y).copied().collect();
        let disc = same.iter().find_map(|(_, chart)| chart.as_disc());
        let csv = match (first_map(&same), first_colours(&same), disc) {
            (Some(map), ..) => map_table(&same, x, y, &map.label)?,
            (None, Some(cells), _) => colour_table(&same, x, y, &cells.label)?,
            (None, None, Some(Disc::Dome(dome))) => dome_table(&same, dome)?,
            (None, None, Some(Disc::Lobes(lobes))) => curve_table(&same, ANGLE, &lobes.label)?,
            (None, None, None) => curve_table(&same, x, y)?,
        };
        let suffix = if index == 0 { String::new() } else { format!("-{}", index + 1) };
        tables.push(CurveTable { file: format!("{}{suffix}.csv", figure.name), csv });
    }
    Ok(tables)
}

/// What the curves of lobes run over.
const ANGLE: &str = "viewer's angle from the normal, mirror side positive (°)";

fn curve_table(charts: &[(&str, &Chart)], x: &str, y: &str) -> Result<String, csv::Error> {
    let series: Vec<(&str, &Series)> = charts
        .iter()
        .flat_map(|(panel, chart)| chart.layers.iter().flat_map(series_of).map(|series| (*panel, series)))
        .collect();
    let has_errors = series.iter().any(|(_, s)| s.points.iter().any(|p| p.error.is_some()));
    let mut writer = csv::Writer::from_writer(Vec::new());
    let mut header = vec!["panel", "curve", x, y];
    if has_errors {
        header.push("standard error");
    }
    writer.write_record(&header)?;
    for (panel, series) in series {
        for point in &series.points {
            let mut record = vec![panel.to_owned(), series.name.clone(), written(point.x), written(point.y)];
            if has_errors {
                record.push(point.error.map(written).unwrap_or_default());
            }
            writer.write_record(&record)?;
        }
    }
    finished(writer)
}

fn map_table(charts: &[(&str, &Chart)], x: &str, y: &str, value: &str) -> Result<String, csv::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(["panel", y, x, value])?;
    for (panel, chart) in charts {
        let Some(map) = first_map(&[(panel, chart)]) else { continue };
        for (index, row) in map.rows.iter().enumerate() {
            let row_name = row_name(chart, index);
            for (column, cell) in row.iter().enumerate() {
                let column_name = column_name(chart, &map.borders, column);
                let number = cell.map(written).unwrap_or_default();
                writer.write_record([*panel, row_name.as_str(), column_name.as_str(), number.as_str()])?;
            }
        }
    }
    finished(writer)
}

fn colour_table(charts: &[(&str, &Chart)], x: &str, y: &str, colour: &str) -> Result<String, csv::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(["panel", y, x, colour])?;
    for (panel, chart) in charts {
        let Some(cells) = first_colours(&[(panel, chart)]) else { continue };
        for (index, row) in cells.rows.iter().enumerate() {
            for (column, RGBColor(red, green, blue)) in row.iter().enumerate() {
                let hex = format!("#{red:02x}{green:02x}{blue:02x}");
                writer.write_record([
                    *panel,
                    &row_name(chart, index),
                    &column_name(chart, &cells.borders, column),
                    &hex,
                ])?;
            }
        }
    }
    finished(writer)
}

/// One row a cell of a hemisphere, by the angles of its middle.
fn dome_table(charts: &[(&str, &Chart)], first: &Dome) -> Result<String, csv::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(["panel", "viewer's inclination (°)", "viewer's azimuth (°)", first.colours.label.as_str()])?;
    for (panel, chart) in charts {
        let Some(Disc::Dome(dome)) = chart.as_disc() else { continue };
        let middle = |index: usize, count: usize, range: f64| written(range * (length(index) + 0.5) / length(count));
        for (index, ring) in dome.rings.iter().enumerate() {
            let inclination = middle(index, dome.rings.len(), 90.0);
            for (place, value) in ring.iter().enumerate() {
                let azimuth = middle(place, ring.len(), 360.0);
                writer.write_record([*panel, inclination.as_str(), azimuth.as_str(), written(*value).as_str()])?;
            }
        }
    }
    finished(writer)
}

fn row_name(chart: &Chart, index: usize) -> String {
    match &chart.y.kind {
        AxisKind::Bands(names) => names.get(index).cloned().unwrap_or_default(),
        AxisKind::Linear | AxisKind::Counts | AxisKind::Logarithmic => index.to_string(),
    }
}

/// The band's name, or the middle of the column.
fn column_name(chart: &Chart, borders: &[f64], column: usize) -> String {
    match (&chart.x.kind, borders.get(column..column + 2)) {
        (AxisKind::Bands(names), _) => names.get(column).cloned().unwrap_or_default(),
        (_, Some([from, to])) => written((from + to) / 2.0),
        _ => String::new(),
    }
}

fn first_colours<'a>(charts: &[(&str, &'a Chart)]) -> Option<&'a ColourCells> {
    let layers = charts.iter().flat_map(|(_, c)| &c.layers);
    layers.into_iter().find_map(|l| if let Layer::ColourCells(cells) = l { Some(cells) } else { None })
}

fn first_map<'a>(charts: &[(&str, &'a Chart)]) -> Option<&'a Map> {
    charts.iter().flat_map(|(_, c)| &c.layers).find_map(|l| if let Layer::Map(map) = l { Some(map) } else { None })
}

/// Seven significant digits, in the shortest form that reads back as the same number.
fn written(value: f64) -> String {
    let rounded: f64 = format!("{value:.6e}").parse().unwrap_or(value);
    rounded.to_string()
}

fn finished(writer: csv::Writer<Vec<u8>>) -> Result<String, csv::Error> {
    let bytes = writer.into_inner().map_err(|error| csv::Error::from(error.into_error()))?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}
