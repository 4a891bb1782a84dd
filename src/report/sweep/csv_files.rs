//! The tables of a sweep. Numbers are written in full, in the shortest form that reads back as the same number.

use crate::job::{Cell, Slope, Sweep, SweepAxis, Varying, View};
use crate::measure::Geometry;
use crate::parameter::Spread;
use crate::sensitivity::Side;

/// File name and text of each table.
pub(super) fn all(sweep: &Sweep) -> Result<Vec<(&'static str, String)>, csv::Error> {
    Ok(vec![
        ("readings.csv", readings(sweep)?),
        ("colours.csv", colours(sweep)?),
        ("sensitivities.csv", sensitivities(sweep)?),
        ("excursions.csv", excursions(sweep)?),
        ("sobol.csv", sobol(sweep)?),
    ])
}

const VIEW: [&str; 5] = ["id", "theta_i_deg", "phi_i_deg", "theta_o_deg", "phi_o_deg"];

fn view_entries(view: &View) -> [String; 5] {
    let Geometry { theta_i_deg, phi_i_deg, theta_o_deg, phi_o_deg } = view.geometry;
    let angles = [theta_i_deg, phi_i_deg, theta_o_deg, phi_o_deg].map(|angle| angle.to_string());
    let [a, b, c, d] = angles;
    [view.id.clone(), a, b, c, d]
}

/// A table that is being written.
struct Table(csv::Writer<Vec<u8>>);

impl Table {
    fn new<'a>(header: impl IntoIterator<Item = &'a str>) -> Result<Self, csv::Error> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record(header)?;
        Ok(Self(writer))
    }

    fn row(&mut self, entries: impl IntoIterator<Item = String>) -> Result<(), csv::Error> {
        self.0.write_record(entries.into_iter().map(String::into_bytes))
    }

    fn finished(self) -> Result<String, csv::Error> {
        let bytes = self.0.into_inner().map_err(|error| csv::Error::from(error.into_error()))?;
        Ok(String::from_utf8_lossy(&bytes).into_owned())
    }
}

/// Number of the cell from 1, and the value of each parameter that the grid moves.
fn cell_entries(sweep: &Sweep, number: usize, cell: &Cell) -> impl Iterator<Item = String> {
    let moved = sweep.axes.iter().zip(&cell.values).flat_map(|(axis, value)| axis.at(*value));
    std::iter::once((number + 1).to_string()).chain(moved.map(|(_, value)| value.to_string()))
}

fn cell_header(sweep: &Sweep) -> impl Iterator<Item = &str> {
    let moved = sweep.axes.iter().flat_map(SweepAxis::parameters);
    std::iter::once("cell").chain(moved.map(|parameter| parameter.name.as_str()))
}

fn readings(sweep: &Sweep) -> Result<String, csv::Error> {
    let mut table = Table::new(cell_header(sweep).chain(VIEW).chain(["wavelength_nm", sweep.quantity.column()]))?;
    for (number, cell) in sweep.cells.iter().enumerate() {
        for (view, readings) in sweep.views.iter().zip(&cell.readings) {
            for (nm, reading) in view.wavelengths_nm.iter().zip(readings) {
                let reading = [nm.to_string(), reading.to_string()];
                table.row(cell_entries(sweep, number, cell).chain(view_entries(view)).chain(reading))?;
            }
        }
    }
    table.finished()
}

fn colours(sweep: &Sweep) -> Result<String, csv::Error> {
    let header = ["X", "Y", "Z", "x", "y", "L", "a", "b", "srgb", "outside_srgb", "delta_e_2000_to_first"];
    let mut table = Table::new(cell_header(sweep).chain(VIEW).chain(header))?;
    for (number, cell) in sweep.cells.iter().enumerate() {
        for ((view, colour), first) in sweep.views.iter().zip(&cell.colours).zip(&sweep.cells[0].colours) {
            let [x, y] = colour.xyz.chromaticity().map_or_else(Default::default, |place| place.map(|v| v.to_string()));
            let numbers = [colour.xyz.x, colour.xyz.y, colour.xyz.z].map(|v| v.to_string());
            let lab = [colour.lab.l, colour.lab.a, colour.lab.b].map(|v| v.to_string());
            let outside = if colour.clipped { "yes" } else { "no" };
            let rest = [colour.hex.clone(), outside.to_owned(), colour.lab.delta_e_2000(first.lab).to_string()];
            let entries = cell_entries(sweep, number, cell).chain(view_entries(view)).chain(numbers).chain([x, y]);
            table.row(entries.chain(lab).chain(rest))?;
        }
    }
    table.finished()
}

/// Slopes at the job's own values, then along the sweep.
fn sensitivities(sweep: &Sweep) -> Result<String, csv::Error> {
    let header =
        ["quantity", "wavelength_nm", "per_unit", "error", "per_percent", "smallest_step", "differences", "kink"];
    let mut table = Table::new(["at", "parameter", "value", "unit"].into_iter().chain(VIEW).chain(header))?;
    let own = sweep.slopes.iter().map(|slope| ("own values".to_owned(), slope));
    let along = sweep.slopes_along.iter().enumerate().map(|(cell, slope)| (format!("cell {}", cell + 1), slope));
    for (at, slope) in own.chain(along) {
        slope_rows(sweep, &at, slope, &mut table)?;
    }
    table.finished()
}

fn slope_rows(sweep: &Sweep, at: &str, slope: &Slope, table: &mut Table) -> Result<(), csv::Error> {
    let side = match slope.side {
        Side::Both => "both sides",
        Side::Above => "above",
        Side::Below => "below",
    };
    let parameter = &slope.parameter;
    for (number, view) in sweep.views.iter().enumerate() {
        let difference = slope.differences.get(number).map(|rate| ("delta_e_2000", String::new(), *rate));
        let readings = slope.readings.get(number).into_iter().flat_map(|rates| {
            let nm = view.wavelengths_nm.iter().map(f64::to_string);
            nm.zip(rates).map(|(nm, rate)| (sweep.quantity.column(), nm, *rate))
        });
        for (quantity, nm, rate) in difference.into_iter().chain(readings) {
            let first = [at.to_owned(), parameter.name.clone(), slope.at.to_string(), parameter.unit.to_owned()];
            let rest = [
                quantity.to_owned(),
                nm,
                rate.per_unit.to_string(),
                rate.error.to_string(),
                slope.per_percent(rate).map_or_else(String::new, |change| change.to_string()),
                rate.step.to_string(),
                side.to_owned(),
                if rate.is_kink { "yes" } else { "no" }.to_owned(),
            ];
            table.row(first.into_iter().chain(view_entries(view)).chain(rest))?;
        }
    }
    Ok(())
}

fn excursions(sweep: &Sweep) -> Result<String, csv::Error> {
    let header = ["parameter", "unit", "own_value", "value"];
    let numbers = ["delta_e_2000_to_own", "rms_change_of_readings"];
    let mut table = Table::new(header.into_iter().chain(VIEW).chain(numbers))?;
    for excursion in &sweep.excursions {
        let parameter = &excursion.parameter;
        for (number, view) in sweep.views.iter().enumerate() {
            for (place, value) in excursion.values.iter().enumerate() {
                let first =
                    [parameter.name.clone(), parameter.unit.to_owned(), excursion.own.to_string(), value.to_string()];
                let difference = excursion.differences.get(number).map(|list| list[place].to_string());
                let rest = [difference.unwrap_or_default(), excursion.changes[number][place].to_string()];
                table.row(first.into_iter().chain(view_entries(view)).chain(rest))?;
            }
        }
    }
    table.finished()
}

/// One row a geometry, quantity and free parameter; no rows where no variance was shared out.
fn sobol(sweep: &Sweep) -> Result<String, csv::Error> {
    let header = [
        "quantity",
        "mean",
        "standard_deviation",
        "parameter",
        "lower",
        "upper",
        "spread",
        "first_order",
        "first_order_standard_error",
        "total",
        "total_standard_error",
        "samples",
        "replicates",
        "seed",
    ];
    let mut table = Table::new(VIEW.into_iter().chain(header))?;
    let Ok(variance) = &sweep.variance else { return table.finished() };
    for output in &variance.outputs {
        let quantity = match output.what {
            Varying::Readings => sweep.quantity.column(),
            Varying::Difference => "delta_e_2000_to_own",
        };
        for (place, (parameter, [lower, upper], spread)) in variance.inputs.iter().enumerate() {
            let spread = match spread {
                Spread::Linear => "linear",
                Spread::Logarithmic => "logarithmic",
            };
            let indices = output.indices.as_ref().map(|indices| indices[place]);
            let estimates = indices.map(|indices| [indices.first_order, indices.total]);
            let numbers = estimates.map_or_else(Default::default, |[first_order, total]| {
                [first_order.value, first_order.standard_error, total.value, total.standard_error]
                    .map(|v| v.to_string())
            });
            let what = [quantity.to_owned(), output.mean.to_string(), output.standard_deviation.to_string()];
            let of = [parameter.name.clone(), lower.to_string(), upper.to_string(), spread.to_owned()];
            let settings = &variance.settings;
            let how = [settings.samples.to_string(), settings.replicates.to_string(), settings.seed.to_string()];
            let entries = view_entries(&sweep.views[output.view]).into_iter().chain(what).chain(of);
            table.row(entries.chain(numbers).chain(how))?;
        }
    }
    table.finished()
}
