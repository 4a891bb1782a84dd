//! Sweeps, from the job to the report.

use std::collections::BTreeMap;
use std::f64::consts::{FRAC_1_PI, PI};
use std::path::Path;

use barbule::job::{self, Job, Sweep, Varying};
use barbule::measure::colour::{Swatch, Xyz};
use barbule::sensitivity::Side;

use super::desk::{Desk, FILM, film_with, replaced, shipped};
use super::report::markup;

/// A grey diffuse surface whose every number is known: f = ρ/π.
const GREY: &str = r#"title = "Grey"

[data.synthetic]
quantity = "brdf"
mirror_deg = [0, 60]
window_nm = [380, 780]
step_nm = 5

[model]
kind = "lambertian"

[parameters]
albedo = { start = 0.5, lower = 0.2, upper = 0.8 }

[sweep.grid]
albedo = { from = 0.25, to = 0.75, steps = 3 }
"#;

fn swept(text: &str) -> Sweep {
    let job = Job::from_text("sweep", text, Path::new(".")).unwrap();
    job::sweep(&job, &BTreeMap::new()).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn grey_with(piece: &str, replacement: &str) -> String {
    replaced(GREY, piece, replacement)
}

#[track_caller]
fn close(found: f64, expected: f64, relative: f64) {
    let off = (found - expected).abs();
    assert!(off <= relative * expected.abs(), "found {found}, expected {expected}, off by {off:e}");
}

/// L* of a grey and the weight `S_L` of a difference around it (CIE 15:2018; Sharma, Wu and Dalal 2005, eq. 15).
fn lightness(albedo: f64) -> f64 {
    116.0 * albedo.cbrt() - 16.0
}

fn weight(lightness: f64) -> f64 {
    1.0 + 0.015 * (lightness - 50.0).powi(2) / (20.0 + (lightness - 50.0).powi(2)).sqrt()
}

#[test]
fn every_number_of_a_grey_surface_is_known() {
    let sweep = swept(GREY);
    assert_eq!(sweep.cells.iter().map(|cell| cell.values[0]).collect::<Vec<_>>(), [0.25, 0.5, 0.75]);
    let white = Xyz::white();
    for cell in &sweep.cells {
        let albedo = cell.values[0];
        assert!(cell.readings.iter().flatten().all(|reading| (reading - albedo * FRAC_1_PI).abs() < 1e-15));
        let middle = (lightness(albedo) + lightness(0.25)) / 2.0;
        for (colour, first) in cell.colours.iter().zip(&sweep.cells[0].colours) {
            // Rounding of sums of 81 terms, and of a cube root.
            close(colour.xyz.x, albedo * white.x, 1e-13);
            close(colour.xyz.y, albedo, 1e-13);
            close(colour.xyz.z, albedo * white.z, 1e-13);
            close(colour.lab.l, lightness(albedo), 1e-13);
            let difference = (lightness(albedo) - lightness(0.25)).abs() / weight(middle);
            assert!((colour.lab.delta_e_2000(first.lab) - difference).abs() < 1e-10);
        }
    }
    let [slope] = sweep.slopes.as_slice() else { panic!("one parameter is free and swept") };
    // f = ρ/π is a line: the slope is 1/π up to rounding, which the stated error covers.
    for rate in slope.readings.iter().flatten() {
        assert!((rate.per_unit - FRAC_1_PI).abs() <= rate.error && rate.error < 1e-13, "{rate:?}");
        close(slope.per_percent(*rate).unwrap(), 0.005 * FRAC_1_PI, 1e-12);
    }
    let per_unit = 116.0 / 3.0 * 0.5f64.powf(-2.0 / 3.0) / weight(lightness(0.5));
    for rate in &slope.differences {
        close(rate.per_unit, per_unit, 1e-9); // ΔE2000 over a step of 1e-3, whose square is the relative error
    }
    for (cell, slope) in sweep.cells.iter().zip(&sweep.slopes_along) {
        let albedo = cell.values[0];
        let expected = 116.0 / 3.0 * albedo.powf(-2.0 / 3.0) / weight(lightness(albedo));
        close(slope.differences[1].per_unit, expected, 1e-9);
    }
    let [excursion] = sweep.excursions.as_slice() else { panic!("one parameter is free and swept") };
    assert_eq!((excursion.values[0], *excursion.values.last().unwrap()), (0.2, 0.8));
    let largest = excursion.differences[0].iter().copied().fold(0.0, f64::max);
    close(largest, (lightness(0.5) - lightness(0.2)) / weight((lightness(0.5) + lightness(0.2)) / 2.0), 1e-9);
}

/// A film without absorption at normal incidence: R = (A + B u)/(C + B u), u = cos(4πnd/λ) (Born & Wolf 1999, 7.6).
#[test]
fn the_slope_of_a_film_by_its_thickness_is_that_of_the_closed_form() {
    let text = r#"title = "A film"
[data.synthetic]
quantity = "brdf"
mirror_deg = [0]
window_nm = [400, 700]
step_nm = 10
[model]
kind = "coated-base"
layers = [{ name = "film", material = { name = "film", index = 1.5 }, thickness_nm = 400 }]
substrate = { name = "below", index = 1.8 }
[sweep.grid]
"film.thickness_nm" = { values = [400] }
"#;
    let sweep = swept(text);
    let (outer, inner) = ((1.0 - 1.5) / (1.0 + 1.5), (1.5 - 1.8) / (1.5 + 1.8f64));
    let (a, b, c) = (outer * outer + inner * inner, 2.0 * outer * inner, 1.0 + (outer * inner).powi(2));
    let rates = sweep.slopes[0].readings[0].iter().zip(&sweep.own.readings[0]).zip(&sweep.views[0].wavelengths_nm);
    for ((rate, reading), nm) in rates {
        let phase = 4.0 * PI * 1.5 * 400.0 / nm;
        let (u, du) = (phase.cos(), -phase.sin() * 4.0 * PI * 1.5 / nm);
        let logarithmic = b * du / (a + b * u) - b * du / (c + b * u);
        // The lobe in front of R is the same in both. Slopes of fringes are good to 1e-10 of the steepest, (∂R/∂d)/R ≲ 0.01.
        assert!((rate.per_unit / reading - logarithmic).abs() < 1e-11, "{nm} nm: {rate:?}, expected {logarithmic}");
        assert!(rate.error < 1e-11 && !rate.is_kink);
    }
}

#[test]
fn at_a_bound_the_slope_is_taken_inwards() {
    let sweep = swept(&grey_with("start = 0.5, lower = 0.2, upper = 0.8", "start = 1.0, lower = 0.2, upper = 1.0"));
    assert_eq!(sweep.slopes[0].side, Side::Below);
    let rates = sweep.slopes[0].readings.iter().flatten();
    rates.for_each(|rate| assert!((rate.per_unit - FRAC_1_PI).abs() <= rate.error.max(1e-15), "{rate:?}"));
}

/// Gain × albedo, each over its range: V = (v₁ + m₁²)(v₂ + m₂²) − m₁²m₂², S₁ = v₁m₂²/V. The gain is spread evenly in its
/// logarithm: m = (b − a)/ln(b/a), ⟨x²⟩ = (b² − a²)/(2 ln(b/a)).
#[test]
fn shares_of_the_variance_of_a_product_are_known() {
    let sweep = swept(&grey_with("\n[sweep.grid]", "gain = { start = 1, lower = 0.5, upper = 2 }\n[sweep.grid]"));
    let variance = sweep.variance.unwrap();
    let ratio = 4f64.ln();
    let (gain_mean, gain_square) = (1.5 / ratio, 3.75 / (2.0 * ratio));
    let (albedo_mean, albedo_square) = (0.5, 0.25 + 0.36 / 12.0);
    let whole = gain_square * albedo_square - (gain_mean * albedo_mean).powi(2);
    let by_name = |name: &str| match name {
        "albedo" => {
            let own: f64 = (albedo_square - albedo_mean * albedo_mean) / whole;
            (own * gain_mean.powi(2), own * gain_square)
        }
        _ => {
            let own: f64 = (gain_square - gain_mean * gain_mean) / whole;
            (own * albedo_mean.powi(2), own * albedo_square)
        }
    };
    let names: Vec<&str> = variance.inputs.iter().map(|(parameter, ..)| parameter.name.as_str()).collect();
    assert_eq!(names, ["albedo", "gain"]);
    for output in variance.outputs.iter().filter(|output| output.what == Varying::Readings) {
        close(output.standard_deviation, whole.sqrt() * FRAC_1_PI, 1e-3); // 16 sequences of 256 points
        for (name, indices) in names.iter().zip(output.indices.as_ref().unwrap()) {
            let (first_order, total) = by_name(name);
            for (found, expected) in [(indices.first_order, first_order), (indices.total, total)] {
                // Four standard errors, and errors of less than a hundredth.
                let off = (found.value - expected).abs();
                assert!(
                    off <= 4.0 * found.standard_error && found.standard_error < 0.01,
                    "{name}: {found:?}, {expected}"
                );
            }
        }
    }
}

#[test]
fn two_parameters_make_a_grid_of_all_pairs() {
    let text = grey_with("to = 0.75, steps = 3 }", "to = 0.75, steps = 3 }\ngain = { values = [2, 1] }");
    let sweep = swept(&text);
    let values: Vec<[f64; 2]> = sweep.cells.iter().map(|cell| [cell.values[0], cell.values[1]]).collect();
    assert_eq!(values, [[2.0, 0.25], [2.0, 0.5], [2.0, 0.75], [1.0, 0.25], [1.0, 0.5], [1.0, 0.75]]);
    for cell in &sweep.cells {
        close(cell.readings[1][40], cell.values[0] * cell.values[1] * FRAC_1_PI, 1e-14);
    }
    // 2 × 0.75 outshines the white standard: all colours are darkened until it does not.
    let brightest = sweep.cells.iter().flat_map(|cell| &cell.colours).map(|colour| colour.xyz.y).fold(0.0, f64::max);
    close(brightest, 1.0, 1e-14);
    assert!(sweep.colour_note.contains("darkened by the factor 0.667"), "{}", sweep.colour_note);
}

#[test]
fn values_are_spread_as_asked() {
    let values = |axis: &str| {
        let sweep = swept(&grey_with("{ from = 0.25, to = 0.75, steps = 3 }", axis));
        sweep.cells.iter().map(|cell| cell.values[0]).collect::<Vec<f64>>()
    };
    let even = values("{ from = 0.1, to = 1, steps = 10 }");
    assert_eq!((even.len(), even[0], even[9]), (10, 0.1, 1.0));
    even.windows(2).for_each(|pair| close(pair[1] - pair[0], 0.1, 1e-14));
    let logarithmic = values("{ from = 0.01, to = 0.9, steps = 7, spacing = \"logarithmic\" }");
    assert_eq!((logarithmic.len(), logarithmic[0], logarithmic[6]), (7, 0.01, 0.9));
    logarithmic.windows(2).for_each(|pair| close(pair[1] / pair[0], 90f64.powf(1.0 / 6.0), 1e-14));
    assert_eq!(values("{ values = [0.3] }"), [0.3]);
    assert_eq!(values("{ values = [0.9, 0.1, 0.5] }"), [0.9, 0.1, 0.5]);
}

/// Three channels are a renderer's colours: white is white, and Y is Rec. 709's (ITU-R BT.709-6, item 3.2).
#[test]
fn three_channels_are_linear_rgb() {
    let text = r#"title = "RGB"
[data.synthetic]
quantity = "reflectance"
angles_deg = [[30, 0, 10, 90]]
wavelengths_nm = [445, 525, 645]
[model]
kind = "lambertian"
per_channel = ["albedo"]
[parameters]
albedo_r = 0.9
albedo_g = 0.5
albedo_b = 0.2
[sweep.grid]
gain = { values = [1.0, 0.5] }
"#;
    let sweep = swept(text);
    assert!(sweep.colour_note.contains("(645, 525, 445 nm)") && sweep.colour_note.contains("Rec. 709"));
    let colour = &sweep.cells[0].colours[0];
    sweep.cells[0].readings[0].iter().zip([0.2, 0.5, 0.9]).for_each(|(found, expected)| close(*found, expected, 1e-14));
    close(colour.xyz.y, 0.2126 * 0.9 + 0.7152 * 0.5 + 0.0722 * 0.2, 1e-4); // its weights have four decimals
    // 0.9, 0.5 and 0.2 encoded by IEC 61966-2-1: 1.055 v^(1/2.4) − 0.055, times 255.
    assert_eq!(colour.hex, "#f3bc7c");
    assert!(sweep.variance.unwrap_err().contains("No parameter of the job is free"));
}

#[test]
fn spectra_that_miss_the_visible_get_a_sentence_instead_of_a_colour() {
    for (piece, slip, part) in [
        ("[380, 780]", "[300, 600]", "reaches from 300 to 600 nm"),
        ("[380, 780]\nstep_nm = 5", "[380, 780]\nstep_nm = 25", "a gap of 25 nm"),
    ] {
        let sweep = swept(&grey_with(piece, slip));
        assert!(sweep.cells.iter().all(|cell| cell.colours.is_empty()));
        assert!(sweep.colour_note.contains("There are no colours") && sweep.colour_note.contains(part));
        assert!(sweep.answer.contains("the readings of 2 geometries"), "{}", sweep.answer);
        assert!(sweep.slopes[0].differences.is_empty() && !sweep.slopes[0].readings[0].is_empty());
        let desk = Desk::with("grey.toml", grey_with(piece, slip));
        desk.barbule("sweep grey.toml --out report").succeeds();
        assert_eq!(desk.read("report/colours.csv").lines().count(), 1);
        assert!(desk.read("report/index.html").contains("There are no colours"));
        assert!(!desk.path("report/plots/chromaticity.png").exists());
    }
}

/// A colour is that of its spectrum, as the report's swatches have it.
#[test]
fn colours_are_those_of_the_spectra() {
    // Rough and not too steep, so that nothing outshines the white standard.
    let text = replaced(&with_sweep("[400, 700]", "[380, 780]"), "[15, 45, 70]", "[15, 45]");
    let sweep = swept(&replaced(&text, "\n[fit]", "roughness = 0.5\n\n[fit]"));
    assert!(!sweep.colour_note.contains("darkened"), "{}", sweep.colour_note);
    for cell in &sweep.cells {
        for ((view, readings), colour) in sweep.views.iter().zip(&cell.readings).zip(&cell.colours) {
            let swatch = Swatch::new(&view.wavelengths_nm, readings).unwrap();
            assert_eq!((&swatch.hex, swatch.lab), (&colour.hex, colour.lab));
        }
    }
}

/// The film's job with one piece replaced and a sweep added.
fn with_sweep(piece: &str, replacement: &str) -> String {
    format!(
        "{}\n[sweep.grid]\n\"film.thickness_nm\" = {{ from = 200, to = 500, steps = 4 }}\n",
        film_with(piece, replacement)
    )
}

#[test]
fn a_job_that_is_fitted_can_be_swept_too() {
    let desk = Desk::with("film.toml", with_sweep("starts = 4", "starts = 2"));
    desk.barbule("fit film.toml --out fit").succeeds();
    desk.barbule("check film.toml").succeeds().prints("4 values of film.thickness_nm, 48 readings each");
    desk.barbule("sweep film.toml --out sweep").succeeds().prints("film.thickness_nm from 200 to 500 nm (4 values)");
    let page = desk.read("sweep/index.html");
    assert!(page.contains("do not reach over 380 to 780 nm"));
    markup::assert_well_formed(&page);
    for target in markup::attributes(&page, "href") {
        assert!(desk.path(&format!("sweep/{target}")).is_file(), "the page links to {target}");
    }
    // What simulate makes of the same value is what the sweep says.
    let simulated = desk.barbule("simulate film.toml --set film.thickness_nm=300").succeeds().out;
    let last = |text: &str| text.trim_end().rsplit(',').next().map(str::to_owned);
    let swept = desk.read("sweep/readings.csv");
    let second = swept.lines().filter(|line| line.starts_with("2,")).map(|line| last(line).unwrap());
    assert_eq!(
        second.collect::<Vec<_>>(),
        simulated.lines().skip(1).map(|line| last(line).unwrap()).collect::<Vec<_>>()
    );
}

#[test]
fn ties_follow_what_is_swept() {
    let two = |below: &str| {
        let layers = "layers = [{ name = \"film\", material = \"keratin\", thickness_nm = 300 }, \
                      { name = \"below\", material = \"bird_melanin\", thickness_nm = 100 }]";
        let job = with_sweep("layers = [{ name = \"film\", material = \"keratin\", thickness_nm = 300 }]", layers);
        replaced(&job, "\n[fit]", &format!("\"below.thickness_nm\" = {below}\n\n[fit]"))
    };
    let tied = swept(&two("\"0.5 * film.thickness_nm\""));
    for cell in &tied.cells {
        let free = swept(&replaced(
            &two(&(0.5 * cell.values[0]).to_string()),
            "{ from = 200, to = 500, steps = 4 }",
            &format!("{{ values = [{}] }}", cell.values[0]),
        ));
        assert_eq!(free.cells[0].readings, cell.readings);
    }
    let job = replaced(&two("\"0.5 * film.thickness_nm\""), "[sweep.grid]\n\"film", "[sweep.grid]\n\"below");
    Desk::with("tied.toml", job).barbule("sweep tied.toml").complains(&["it is tied", "sweep film.thickness_nm, or"]);
}

/// What moves along has the values of its place, in readings, in slopes along the sweep and in the tables.
#[test]
fn a_parameter_moves_along_with_another() {
    let albedo = "albedo = { from = 0.25, to = 0.75, steps = 3 }";
    let along = "albedo = { values = [0.75, 0.25, 0.5], along = { gain = [2, 1, 0.5] } }";
    let sweep = swept(&grey_with(albedo, along));
    for (cell, [albedo, gain]) in sweep.cells.iter().zip([[0.75, 2.0], [0.25, 1.0], [0.5, 0.5]]) {
        // f = gain · ρ/π, and the slope by ρ is gain/π.
        cell.readings.iter().flatten().for_each(|reading| close(*reading, gain * albedo * FRAC_1_PI, 1e-14));
    }
    // L* goes with (gain · ρ · exposure)^⅓, so that ΔE2000 per unit of ρ is (116/3) L* slope over S_L at the cell's gain.
    let exposure = 1.0 / 1.5; // the brightest, 2 · 0.75, is darkened to 1
    for (slope, [albedo, gain]) in sweep.slopes_along.iter().zip([[0.75, 2.0], [0.25, 1.0], [0.5, 0.5f64]]) {
        let y: f64 = gain * albedo * exposure;
        close(slope.differences[0].per_unit, 116.0 / 3.0 * y.cbrt() / albedo / weight(lightness(y)), 1e-9);
    }
    let desk = Desk::with("grey.toml", grey_with(albedo, along));
    desk.barbule("sweep grey.toml --out out").succeeds().prints("Over albedo with gain from 0.75 to 0.5 (3 values)");
    assert!(desk.read("out/colours.csv").starts_with("cell,albedo,gain,id,"));
    assert!(desk.read("out/colours.csv").contains("\n2,0.25,1,"));
}

#[test]
fn command_line_settings_move_the_own_values() {
    let job = Job::from_text("grey", GREY, Path::new(".")).unwrap();
    let sweep = job::sweep(&job, &BTreeMap::from([("albedo".to_owned(), 0.3)])).unwrap();
    assert!(sweep.own.readings.iter().flatten().all(|reading| (reading - 0.3 * FRAC_1_PI).abs() < 1e-15));
    assert_eq!(sweep.settings, ["albedo = 0.3"]);
    let refused = job::sweep(&job, &BTreeMap::from([("albedo".to_owned(), 3.0)])).unwrap_err().to_string();
    assert!(refused.contains("--set: albedo: found 3") && refused.contains("from 0 to 1"), "{refused}");
}

#[test]
fn a_mistake_in_a_sweep_is_a_sentence() {
    let axis = "albedo = { from = 0.25, to = 0.75, steps = 3 }";
    for (slip, parts) in [
        ("albdo = { values = [0.5] }", ["line 16: sweep.grid.\"albdo\"", "no such parameter", "did you mean `albedo`"]),
        (
            "albedo = { from = 0.75, to = 0.25, steps = 3 }",
            ["line 16", "from = 0.75 and to = 0.25", "`from` below `to`"],
        ),
        ("albedo = { from = 0.25, to = 0.75, steps = 0 }", ["line 16", "found 0 steps", "2 or more"]),
        ("albedo = { from = 0.25, to = 0.75, steps = 1 }", ["line 16", "found 1 steps", "{ values = [0.25] }"]),
        ("albedo = { from = 0.25, to = 0.75, steps = -1 }", ["line 16", "found -1", "a whole number from 0 up"]),
        ("albedo = { from = 0.25, to = 0.75, steps = 1000000000 }", ["line 16", "found 1000000000 steps", "at most"]),
        (
            "albedo = { from = 0.25, to = 0.75, steps = 99999 }",
            ["line 15: sweep.grid", "99999 cells of 162", "fewer steps"],
        ),
        ("albedo = { from = 0.25, to = 1.75, steps = 3 }", ["line 16", "found 1.75", "from 0 to 1"]),
        ("albedo = { from = nan, to = 0.75, steps = 3 }", ["line 16", "from = NaN", "`from` below `to`"]),
        ("albedo = { from = 0.25, to = 0.75 }", ["line 16", "either `from`, `to` and `steps`", "`values` alone"]),
        ("albedo = { from = 0.25, values = [0.5] }", ["line 16", "either `from`, `to` and `steps`", "alone"]),
        ("albedo = { values = [] }", ["line 16", "the list of values is empty", "at least one"]),
        ("albedo = { values = [0.5, nan] }", ["line 16", "found NaN", "from 0 to 1"]),
        ("albedo = { values = [0.5, 0.1, 0.5] }", ["line 16", "found 0.5 twice", "once"]),
        ("albedo = { values = [0.5], stesp = 3 }", ["line 16", "no key `stesp`", "did you mean `steps`"]),
        (
            "albedo = { from = 0, to = 0.75, steps = 3, spacing = \"logarithmic\" }",
            ["line 16", "logarithmic spacing", "above 0"],
        ),
        (
            "albedo = { values = [0.5, 0.1], along = { gain = [1] } }",
            ["line 16", "along.\"gain\": found 1 values", "expected 2, one for each of albedo"],
        ),
        (
            "albedo = { values = [0.5, 0.1], along = { albedo = [1, 0] } }",
            ["line 16", "albedo: this grid moves it twice", "take one of the two away"],
        ),
        ("albedo = { values = [0.5], along = { gian = [1] } }", ["line 16", "along.\"gian\"", "did you mean `gain`"]),
        ("", ["line 15: sweep.grid", "found 0 parameters", "one or two"]),
        (
            "albedo = { values = [0.5] }\n[sweep.sobol]\nsamples = 1000",
            ["line 18: sweep.sobol.samples", "found 1000", "a power of two from 16 to 65536"],
        ),
        (
            "albedo = { values = [0.5] }\n[sweep.sobol]\nreplicates = 1",
            ["line 18: sweep.sobol.replicates", "found 1", "4 to 1000"],
        ),
        (
            "albedo = { values = [0.5] }\n[sweep.sobol]\nsamples = 65536\nreplicates = 1000",
            ["sweep.sobol.samples", "more than", "fewer points"],
        ),
    ] {
        Desk::with("grey.toml", grey_with(axis, slip)).barbule("sweep grey.toml").complains(&parts);
    }
    let nothing_free = replaced(
        &grey_with(axis, &format!("{axis}\n[sweep.sobol]\nseed = 2")),
        "{ start = 0.5, lower = 0.2, upper = 0.8 }",
        "0.5",
    );
    let parts = ["line 17: sweep.sobol", "no parameter of this job is free", "free one under `parameters`"];
    Desk::with("grey.toml", &nothing_free).barbule("sweep grey.toml").complains(&parts);
    Desk::with("grey.toml", &nothing_free).barbule("check grey.toml").complains(&parts);
    let without = replaced(GREY, &format!("[sweep.grid]\n{axis}\n"), "");
    Desk::with("grey.toml", without).barbule("sweep grey.toml").complains(&["sweep: this job has none", "[sweep]"]);
    let peaks = "title = \"Peaks\"\n[data]\nfile = \"peaks.csv\"\n[data.layout.peaks]\nangles = { mirror = \"angle\" }\n\
                 wavelength = \"peak_nm\"\n[model]\nkind = \"thin-film-law\"\n[sweep.grid]\n\
                 \"film.thickness_nm\" = { values = [300] }\n";
    let desk = Desk::with("peaks.toml", peaks).and("peaks.csv", "angle,peak_nm\n15,560\n30,548\n");
    desk.barbule("sweep peaks.toml").complains(&["peaks.toml, line 2: data", "peak wavelengths", "`data.synthetic`"]);
}

#[test]
fn a_recipe_of_readings_that_cannot_be() {
    for (piece, slip, parts) in [
        (
            "window_nm = [380, 780]\nstep_nm = 5",
            "wavelengths_nm = [500, 400]",
            ["wavelengths_nm", "found 500 before 400"],
        ),
        ("window_nm = [380, 780]\nstep_nm = 5", "wavelengths_nm = []", ["wavelengths_nm", "at least one"]),
        ("window_nm = [380, 780]\nstep_nm = 5", "wavelengths_nm = [-5]", ["wavelengths_nm", "found -5"]),
        ("step_nm = 5", "wavelengths_nm = [500]", ["window_nm", "`wavelengths_nm` alone"]),
        ("mirror_deg = [0, 60]", "angles_deg = [[45, 0, 95, 0]]", ["angles_deg", "0 to below 90 degrees"]),
        ("mirror_deg = [0, 60]", "angles_deg = [[45, 0, 9, 0], [45, 0, 9, 0]]", ["angles_deg", "twice"]),
        ("mirror_deg = [0, 60]\n", "", ["mirror_deg", "at least one inclination"]),
    ] {
        Desk::with("grey.toml", grey_with(piece, slip)).barbule("sweep grey.toml").complains(&parts);
    }
}

#[test]
fn the_same_bytes_on_one_thread_and_on_two() {
    let job = replaced(
        &with_sweep("starts = 4", "starts = 2"),
        "\n[fit]",
        "roughness = { lower = 0.1, upper = 0.3 }\n\n[fit]",
    );
    let desk = Desk::with("film.toml", job);
    for (threads, out) in [(1, "one"), (2, "two")] {
        desk.barbule(&format!("sweep film.toml --threads {threads} --out {out}")).succeeds();
    }
    let mut compared = 0;
    for path in desk.files().into_keys() {
        let Ok(inside) = path.strip_prefix(desk.path("one")) else { continue };
        if path.is_file() {
            let other = std::fs::read(desk.path("two").join(inside)).unwrap();
            assert!(std::fs::read(&path).unwrap() == other, "{} differs", inside.display());
            compared += 1;
        }
    }
    assert!(compared > 20, "only {compared} files");
}

#[test]
fn shipped_sweeps_can_be_run() {
    for (name, says) in [
        ("sweep-thickness", "381 values of cortex.thickness_nm, 162 readings each"),
        ("sweep-roughness", "7 values of roughness × 96 values of cortex.thickness_nm"),
        ("sweep-iridescent", "4 values of roughness × 309 values of thickness_nm, 6 readings each"),
        ("sweep-thesis2-figure-4.2", "3 values of eta_r with eta_b with eta_g × 5 values of thickness_nm"),
        ("sweep-thesis2-figure-4.3", "3 values of eta_r with eta_b with eta_g × 5 values of thickness_nm"),
        ("sweep-thesis2-figure-4.4", "5 values of roughness × 5 values of thickness_nm"),
    ] {
        Desk::empty().barbule(&format!("check {}", shipped(name))).succeeds().prints(says);
    }
}

#[test]
fn the_film_of_the_desk_has_no_sweep() {
    Desk::with("film.toml", FILM).barbule("sweep film.toml").complains(&["film.toml", "sweep: this job has none"]);
}
