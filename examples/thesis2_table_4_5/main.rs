//! Table 4.5 of the second thesis: how much longer a picture takes with its model than with that of Granier and Heidrich.
//!
//! Other programs on the machine slow both; so the two run in turn, A B A B, and what counts is the median over pairs of the
//! ratio within a pair. The time given is shared out over the rows, the dear ones last; a row whose pair does not fit any
//! more says so.
//!
//! `cargo run --release --example thesis2_table_4_5 -- 600 reports/examples/theses/table-4.5.csv`

mod scenes;

use std::path::Path;
use std::time::Instant;

use anyhow::{Context, Result};
use barbule::report::write_file;
use scenes::{Lighting, Model, picture, scene};

/// Samples a pixel of the thesis's rows, and what it prints: by how many per cent its own model takes longer.
const ROWS: [(Lighting, [(u32, f64); 6]); 2] = [
    (Lighting::Direct, [(16, 2.67), (64, 8.02), (128, 7.26), (256, 9.11), (512, 8.42), (1024, 3.78)]),
    (Lighting::Global, [(16, 5.96), (64, 3.67), (128, 4.47), (256, 3.44), (512, 8.83), (1024, 12.01)]),
];
/// Most pairs of a row: enough for a median.
const MOST_PAIRS: u32 = 15;

fn main() -> Result<()> {
    let mut arguments = std::env::args().skip(1);
    let usage = "give the seconds to spend and the CSV file to write";
    let budget: f64 = arguments.next().context(usage)?.parse().context(usage)?;
    let path = arguments.next().context(usage)?;

    let mut rows: Vec<(Lighting, u32, f64)> = Vec::new();
    for (lighting, list) in ROWS {
        rows.extend(list.map(|(samples, printed)| (lighting, samples, printed)));
    }
    // A path costs some four times what a sample of direct light does.
    let cost = |lighting: Lighting| if lighting == Lighting::Direct { 1 } else { 4 };
    rows.sort_by_key(|(lighting, samples, _)| samples * cost(*lighting));

    let began = Instant::now();
    let mut per_sample = [Lighting::Direct, Lighting::Global].map(|lighting| (lighting, 0.0));
    for (lighting, seconds) in &mut per_sample {
        // The first pair warms caches and tables, and does not count.
        *seconds = pair(*lighting, 16)?.iter().sum::<f64>() / 16.0;
    }
    let mut csv = String::from(
        "lighting,samples,pairs,granier_median_s,iridescent_median_s,longer_percent_median,longer_percent_least,\
         longer_percent_most,printed_percent\n",
    );
    for (number, (lighting, samples, printed)) in rows.iter().enumerate() {
        let left = budget - began.elapsed().as_secs_f64();
        let estimate = per_sample.iter().find(|(of, _)| of == lighting).map_or(0.0, |(_, s)| s * f64::from(*samples));
        let share = left / f64::from(u32::try_from(rows.len() - number)?);
        let most = (1..=MOST_PAIRS).take_while(|pairs| f64::from(*pairs) * estimate <= share.max(0.0)).last();
        // A dear row may use what others leave.
        let pairs = most.unwrap_or(u32::from(estimate <= left));
        let name = if *lighting == Lighting::Direct { "direct" } else { "global" };
        if pairs == 0 {
            println!("{name}, {samples} samples: not run, a pair would take {estimate:.0} s");
            continue;
        }
        let times: Vec<[f64; 2]> = (0..pairs).map(|_| pair(*lighting, *samples)).collect::<Result<_>>()?;
        let longer = sorted(times.iter().map(|[granier, own]| 100.0 * (own / granier - 1.0)));
        let [granier, own] = [0, 1].map(|model| median(&sorted(times.iter().map(|pair| pair[model]))));
        let (least, most) = (longer[0], longer[longer.len() - 1]);
        let middle = median(&longer);
        println!(
            "{name}, {samples} samples: {granier:.2} s and {own:.2} s, {middle:+.1} % ({least:+.1} to {most:+.1} over \
             {pairs} pairs); printed {printed:+.2} %"
        );
        csv += &format!("{name},{samples},{pairs},{granier:.3},{own:.3},{middle:.2},{least:.2},{most:.2},{printed}\n");
    }
    write_file(Path::new(&path), csv.as_bytes())?;
    Ok(())
}

/// Seconds of one picture with the model of Granier and Heidrich, then of one with the thesis's.
fn pair(lighting: Lighting, samples: u32) -> Result<[f64; 2]> {
    let time = |model: Model| -> Result<f64> {
        let scene = scene(model, lighting, samples)?;
        let began = Instant::now();
        picture(&scene)?;
        Ok(began.elapsed().as_secs_f64())
    };
    Ok([time(Model::Granier)?, time(Model::IridescentPlastic)?])
}

fn sorted(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values
}

/// Of rising values.
fn median(values: &[f64]) -> f64 {
    let (low, high) = (values[(values.len() - 1) / 2], values[values.len() / 2]);
    0.5 * (low + high)
}
