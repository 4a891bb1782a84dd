//! The report as a reader gets it: a folder with a page, plots and tables.

mod fixtures;
pub(crate) mod markup;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use approx::assert_relative_eq;
use barbule::fit::SigmaSource;
use barbule::job::{CaseData, Outcome};
use barbule::measure::colour::Swatch;
use barbule::report::{ReportError, write_report};

/// Writes a report where it can be looked at afterwards: `target/tmp/report/<test>/<name>`.
fn written(test: &str, outcome: &Outcome) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("report").join(test).join(&outcome.name);
    if folder.exists() {
        fs::remove_dir_all(&folder).unwrap();
    }
    let page = write_report(outcome, &folder).unwrap();
    assert_eq!(page, folder.join("index.html"));
    folder
}

/// The report of each fixture, written once for all tests that only read it, and left in `target/tmp/report/fixtures` to
/// be looked at.
fn all_reports() -> &'static [(Outcome, PathBuf)] {
    static REPORTS: LazyLock<Vec<(Outcome, PathBuf)>> = LazyLock::new(|| {
        [fixtures::film(), fixtures::synthetic(), fixtures::paint(), fixtures::peaks(), fixtures::awkward()]
            .into_iter()
            .map(|outcome| {
                let folder = written("fixtures", &outcome);
                (outcome, folder)
            })
            .collect()
    });
    &REPORTS
}

fn report(name: &str) -> &'static (Outcome, PathBuf) {
    all_reports().iter().find(|(outcome, _)| outcome.name == name).unwrap()
}

/// Every file of a folder by its path inside it.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut open = vec![folder.to_owned()];
    while let Some(next) = open.pop() {
        for entry in fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
            } else {
                let name = path.strip_prefix(folder).unwrap().to_str().unwrap().replace('\\', "/");
                found.insert(name, fs::read(&path).unwrap());
            }
        }
    }
    found
}

fn page(folder: &Path) -> String {
    fs::read_to_string(folder.join("index.html")).unwrap()
}

/// Rows of a CSV file as header → entry.
fn table(path: &Path) -> Vec<BTreeMap<String, String>> {
    csv::Reader::from_path(path).unwrap().deserialize().map(Result::unwrap).collect()
}

fn number(row: &BTreeMap<String, String>, column: &str) -> f64 {
    row[column].parse().unwrap_or_else(|_| panic!("column {column} holds {:?}, expected a number", row[column]))
}

#[test]
fn every_page_is_well_formed_and_fetches_nothing() {
    for (outcome, folder) in all_reports() {
        let page = page(folder);
        markup::assert_well_formed(&page);
        for word in ["<script", "<link", "<img", "@import", "url(", " src="] {
            assert!(!page.contains(word), "{}: the page holds {word}", outcome.name);
        }
        for target in markup::attributes(&page, "href") {
            match target.strip_prefix('#') {
                Some(anchor) => assert!(page.contains(&format!("id=\"{anchor}\"")), "no anchor {anchor}"),
                None => assert!(folder.join(&target).is_file(), "{}: the page links to {target}", outcome.name),
            }
        }
    }
}

#[test]
fn the_answer_comes_first() {
    let (outcome, folder) = report("film");
    let page = page(folder);
    let body = page.split_once("<body>").unwrap().1;
    let texts = markup::texts(body);
    assert_eq!(texts[0], outcome.title);
    assert_eq!(texts[1], outcome.answer);
}

#[test]
fn each_line_of_the_answer_is_a_paragraph() {
    let outcome =
        Outcome { answer: "Assuming one: 1 nm.\nAssuming two: 2 nm.".into(), name: "lines".into(), ..fixtures::film() };
    let texts = markup::texts(page(&written("lines", &outcome)).split_once("<body>").unwrap().1);
    assert_eq!(texts[1..3], ["Assuming one: 1 nm.", "Assuming two: 2 nm."]);
}

#[test]
fn a_thickness_of_several_orders_is_not_given_as_one() {
    let mut outcome = fixtures::film();
    outcome.name = "orders".into();
    outcome.cases = fixtures::peaks().cases;
    for case in &mut outcome.cases {
        case.fit = fixtures::film().cases.remove(0).fit;
    }
    let text = markup::texts(&page(&written("orders", &outcome))).join(" ");
    assert!(text.contains("d: order open") && text.contains("One of several orders, see above."));
    assert!(!text.contains("d = "), "a single thickness stands in the comparison");
}

#[test]
fn sums_of_squares_and_errors_have_the_units_of_the_readings() {
    let mut outcome = fixtures::peaks();
    outcome.name = "unknown-sigma".into();
    for case in &mut outcome.cases {
        let goodness = &mut case.fit.goodness;
        goodness.sigma_source = SigmaSource::Estimated;
        (goodness.reduced_chi_squared, goodness.sigma_scale) = (None, 0.574);
    }
    let text = markup::texts(&page(&written("unknown-sigma", &outcome))).join(" ");
    for words in ["Residual sum of squares 2.310 nm²", "Sum of squares (nm²)", "rms (nm)", "σ = 0.574 nm"] {
        assert!(text.contains(words), "the page lacks {words:?}");
    }
    assert!(!text.contains("χ² 2.31"), "without a σ there is no χ²");
}

#[test]
fn every_y_axis_has_at_least_two_labels() {
    let minus = |text: &str| text.replace('−', "-");
    for (_, folder) in all_reports() {
        for name in ["spectra", "profile", "convergence"] {
            let Ok(svg) = fs::read_to_string(folder.join(format!("plots/{name}.svg"))) else { continue };
            // Labels right-aligned against their axis stand in one column; each axis's run rises from the bottom up.
            let ends = markup::end_aligned(&svg);
            let mut runs: Vec<usize> = Vec::new();
            let mut last = f64::INFINITY;
            for value in ends.iter().filter_map(|text| minus(text).parse::<f64>().ok()) {
                if value > last {
                    *runs.last_mut().unwrap() += 1;
                } else {
                    runs.push(1);
                }
                last = value;
            }
            assert!(!runs.is_empty() && runs.iter().all(|labels| *labels >= 2), "{name}: {ends:?}");
        }
    }
}

#[test]
fn a_spike_does_not_turn_a_map_into_one_colour() {
    let mut outcome = fixtures::paint();
    outcome.name = "spike".into();
    let CaseData::Spectra { spectra, .. } = &mut outcome.cases[0].data else { panic!("expected spectra") };
    spectra[0].measured[3] = 4000.0;
    spectra[1].fitted = false;
    let left_out = spectra.iter().filter(|spectrum| !spectrum.fitted).count();
    let folder = written("spike", &outcome);
    let labels = markup::texts(&fs::read_to_string(folder.join("plots/maps.svg")).unwrap());
    assert!(labels.iter().any(|text| text.starts_with("above ") && text.ends_with(": clipped")), "{labels:?}");
    assert!(!labels.iter().any(|text| text == "4000"), "the colour bar reaches up to the spike");
    let text = markup::texts(&page(&folder)).join(" ");
    assert!(text.contains(&format!("{left_out} spectra that were not fitted are left out.")), "{text}");
}

#[test]
fn markup_in_names_is_shown_and_not_obeyed() {
    let (_, folder) = report("awkward");
    let page = page(folder);
    assert!(!page.contains("<script"));
    let shown = markup::texts(&page);
    assert!(
        shown.iter().any(|t| t.contains("<script>alert(\"x\")</script> & 'co'")),
        "the name itself must be legible"
    );
    for (name, bytes) in files(folder) {
        if name.ends_with(".svg") {
            markup::assert_well_formed(std::str::from_utf8(&bytes).unwrap());
        }
    }
}

#[test]
fn an_outcome_without_cases_still_gives_its_answer() {
    let outcome = Outcome { cases: Vec::new(), name: "empty".into(), ..fixtures::film() };
    let page = page(&written("empty", &outcome));
    markup::assert_well_formed(&page);
    assert!(page.contains("The keratin film is"));
}

#[test]
fn every_plot_has_its_picture_and_its_numbers() {
    for (outcome, folder) in all_reports() {
        let found = files(folder);
        let svgs: Vec<&String> = found.keys().filter(|n| n.ends_with(".svg")).collect();
        assert!(!svgs.is_empty(), "{}: no plots", outcome.name);
        for svg in svgs {
            let name = svg.trim_start_matches("plots/").trim_end_matches(".svg");
            let csv = found.get(&format!("curves/{name}.csv")).unwrap_or_else(|| panic!("{name} has no table"));
            assert!(csv.iter().filter(|b| **b == b'\n').count() > 1, "{name}: the table has no rows");
            assert!(found.contains_key(&format!("plots/{name}.png")), "{name} has no PNG");
        }
    }
}

/// Tables have seven significant digits, so 1e-6 is the rounding and no more.
const WRITTEN_DIGITS: f64 = 1e-6;

#[test]
fn tables_hold_the_plotted_spectra() {
    let (outcome, folder) = report("film");
    let CaseData::Spectra { spectra, .. } = &outcome.cases[0].data else { panic!("expected spectra") };
    let readings = table(&folder.join("curves/spectra.csv"));
    let residuals = table(&folder.join("curves/spectra-2.csv"));
    let of = |rows: &[BTreeMap<String, String>], panel: &str, curve: &str, y: &str| -> Vec<(f64, f64)> {
        let chosen = rows.iter().filter(|r| r["panel"] == panel && r["curve"].starts_with(curve));
        chosen.map(|r| (number(r, "wavelength (nm)"), number(r, y))).collect()
    };
    for (spectrum, panel) in [(&spectra[0], "15°"), (&spectra[11], "70°"), (&spectra[12], "75° (not fitted)")] {
        let measured = of(&readings, panel, "measured", "reflectance");
        let model = of(&readings, panel, if spectrum.fitted { "fitted" } else { "predicted" }, "reflectance");
        let residual = of(&residuals, panel, "residual", "residual");
        assert_eq!((measured.len(), model.len(), residual.len()), (401, 401, 401), "{panel}");
        for index in 0..401 {
            assert_relative_eq!(measured[index].0, spectrum.wavelengths_nm[index]);
            assert_relative_eq!(measured[index].1, spectrum.measured[index], max_relative = WRITTEN_DIGITS);
            assert_relative_eq!(model[index].1, spectrum.model[index], max_relative = WRITTEN_DIGITS);
            let expected = spectrum.model[index] - spectrum.measured[index];
            assert_relative_eq!(residual[index].1, expected, max_relative = WRITTEN_DIGITS);
        }
    }
}

#[test]
fn tables_hold_the_plotted_peaks_minima_and_correlations() {
    let (_, folder) = report("peaks");
    let peaks = table(&folder.join("curves/case-1-peaks.csv"));
    let of = |curve: &str| -> Vec<_> { peaks.iter().filter(|r| r["curve"] == curve).collect() };
    assert_eq!(of("measured, fitted").len(), 9);
    let left_out = of("measured, left out of the fit");
    assert_eq!(left_out.len(), 3);
    assert_relative_eq!(number(left_out[2], "peak wavelength (nm)"), 430.2);
    assert_relative_eq!(number(left_out[2], "standard error"), 1.0);

    let (_, folder) = report("film");
    let profile = table(&folder.join("curves/profile.csv"));
    assert_eq!(profile.iter().filter(|r| r["curve"] == "other minima of the fit").count(), 5);
    assert_eq!(profile.iter().filter(|r| r["curve"] == "scan before the fit").count(), 260);
    let correlations = table(&folder.join("curves/correlations.csv"));
    assert_eq!(correlations.len(), 25);
    assert_relative_eq!(number(&correlations[1], "correlation"), -0.962);
    assert_eq!(correlations[3]["correlation"], "", "a correlation that is not available stays empty");
}

#[test]
fn a_large_table_is_shown_by_a_choice_that_is_named() {
    let (_, folder) = report("paint");
    let text = markup::texts(&page(folder)).join(" ");
    assert!(text.contains("Of 240 spectra 12 are shown: at each of the 6 incidences of the light"), "{text}");
    assert!(text.contains("Of 235 spectra, 60 evenly spread"), "a map shows what the fit saw: {text}");
    let rows = table(&folder.join("curves/spectra.csv"));
    let panels: std::collections::BTreeSet<&String> = rows.iter().map(|r| &r["panel"]).collect();
    assert_eq!(panels.len(), 12);
}

#[test]
fn synthetic_readings_are_called_so_everywhere() {
    let (_, folder) = report("synthetic");
    let page = page(folder);
    let text = markup::texts(&page).join(" ");
    assert!(text.contains("SYNTHETIC The readings were not measured."));
    for (name, bytes) in files(folder) {
        if name.ends_with(".svg") {
            let svg = String::from_utf8(bytes).unwrap();
            assert!(
                markup::texts(&svg)[0].starts_with("Synthetic readings"),
                "{name} does not say that it is synthetic"
            );
        }
    }
    // d: (332.417 − 331)/1.234.
    assert!(text.contains("+1.1"), "the deviation from the truth in standard errors");
    assert!(!markup::texts(&page).concat().contains("NaN"));
}

#[test]
fn the_peaks_figure_has_names_units_and_a_legend() {
    let (_, folder) = report("peaks");
    let svg = fs::read_to_string(folder.join("plots/case-1-peaks.svg")).unwrap();
    insta::assert_snapshot!(markup::texts(&svg).join(" | "), @"Peak wavelength against angle · law, start angle 15° | fitted curve | measured, fitted | measured, left out of the fit | 440 | 460 | 480 | 500 | 520 | peak wavelength (nm) | −10 | 0 | 10 | residual (nm) | 15 | 20 | 25 | 30 | 35 | 40 | 45 | 50 | 55 | 60 | 65 | 70 | inclination of the light θᵢ (°)");
}

#[test]
fn no_label_covers_another_or_leaves_its_figure() {
    for (_, folder) in all_reports() {
        for (name, bytes) in files(folder) {
            if name.ends_with(".svg") {
                markup::assert_labels_apart(&name, std::str::from_utf8(&bytes).unwrap());
            }
        }
    }
}

#[test]
fn pictures_decode_and_show_something() {
    for (outcome, folder) in all_reports() {
        let found = files(folder);
        for (name, bytes) in found.iter().filter(|(name, _)| name.ends_with(".png")) {
            let picture = image::load_from_memory(bytes).unwrap().to_rgb8();
            let inked = picture.pixels().filter(|p| p.0 != [255; 3]).count();
            let share = inked as f64 / f64::from(picture.width() * picture.height());
            // The emptiest figure, of axes and one thin line, inks some 3 %.
            assert!(share > 0.01, "{name} of {} is blank: {share}", outcome.name);
            let svg = String::from_utf8(found[&name.replace(".png", ".svg")].clone()).unwrap();
            let width: u32 = markup::attributes(&svg, "width")[0].parse().unwrap();
            assert_eq!(picture.width(), 2 * width, "{name}: two pixels of the PNG are one of the page");
        }
    }
}

#[test]
fn the_same_outcome_gives_the_same_bytes() {
    for (outcome, folder) in all_reports() {
        let once = files(folder);
        let folder = written("again", outcome);
        // Over its own files, too: and nothing temporary stays behind.
        write_report(outcome, &folder).unwrap();
        let again = files(&folder);
        assert_eq!(once.keys().collect::<Vec<_>>(), again.keys().collect::<Vec<_>>());
        for (name, bytes) in &once {
            assert!(bytes == &again[name], "{name} of {} differs between two runs", outcome.name);
        }
    }
}

#[test]
fn a_report_stays_small() {
    for (outcome, folder) in all_reports() {
        let found = files(folder);
        let total: usize = found.values().map(Vec::len).sum();
        // A page that a mail takes, and a folder of which a repository can keep a few.
        assert!(found["index.html"].len() < 700_000, "{}: page of {} bytes", outcome.name, found["index.html"].len());
        assert!(total < 2_300_000, "{}: {total} bytes", outcome.name);
    }
}

#[test]
fn a_folder_that_cannot_be_made_is_named() {
    let blocked = Path::new(env!("CARGO_TARGET_TMPDIR")).join("report-blocked");
    fs::write(&blocked, "a file where a folder should be").unwrap();
    let error = write_report(&fixtures::peaks(), &blocked).unwrap_err();
    assert!(matches!(error, ReportError::Write { .. }));
    let text = error.to_string();
    assert!(text.contains("report-blocked") && text.contains("Check that"), "{text}");
}

#[test]
fn swatches_show_measured_and_fitted_with_their_difference() {
    let (outcome, folder) = report("film");
    let CaseData::Spectra { spectra, .. } = &outcome.cases[0].data else { panic!("expected spectra") };
    let seen = |values: &[f64]| Swatch::new(&spectra[0].wavelengths_nm, values).unwrap();
    let (measured, fitted) = (seen(&spectra[0].measured), seen(&spectra[0].model));
    let page = page(folder);
    for swatch in [&measured, &fitted] {
        assert!(page.contains(&format!("background:{}", swatch.hex)), "no swatch {}", swatch.hex);
    }
    let difference = format!("<td class=\"number\">{:.1}</td>", measured.lab.delta_e_2000(fitted.lab));
    assert!(page.contains(&difference), "no difference {difference}");
}
