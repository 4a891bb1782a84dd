//! The program as its user meets it: what it says to a mistake, what it prints, what it leaves behind.

use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::process::Stdio;
use std::thread::sleep;
use std::time::Duration;

use super::desk::{Desk, FILM, film_with, replaced, shipped};

/// Checks a job and expects a sentence with these parts.
#[track_caller]
fn refused(job: &str, parts: &[&str]) {
    Desk::with("film.toml", job).barbule("check film.toml").complains(parts);
}

#[test]
fn every_command_shows_an_example() {
    let desk = Desk::empty();
    desk.barbule("--help").succeeds().prints("Example");
    for command in ["new", "fit", "simulate", "sweep", "check", "geometry", "render", "models", "schema"] {
        desk.barbule(&format!("{command} --help")).succeeds().prints("Example").prints(&format!("barbule {command}"));
    }
}

#[test]
fn a_job_that_is_not_there() {
    let desk = Desk::with("binary.toml", b"\xff\xfe\x00").and("empty.toml", "");
    fs::create_dir(desk.path("folder")).unwrap();
    desk.barbule("check nosuch.toml").complains(&["nosuch.toml: there is no such file", "job.toml in it"]);
    desk.barbule("fit folder").complains(&["folder: this folder has no job.toml"]);
    desk.barbule("check binary.toml").complains(&["binary.toml", "not UTF-8"]);
    desk.barbule("check empty.toml").complains(&["empty.toml", "`title` is missing"]);
}

#[test]
fn a_job_of_a_gigabyte_is_not_read() {
    let desk = Desk::empty();
    fs::File::create(desk.path("big.toml")).unwrap().set_len(1 << 30).unwrap();
    desk.barbule("check big.toml").complains(&["big.toml", "1073741824 bytes"]);
    fs::rename(desk.path("big.toml"), desk.path("big.csv")).unwrap();
    desk.barbule("new big.csv").complains(&["big.csv", "zero byte"]);
}

#[test]
fn a_slip_in_the_toml_is_shown_with_its_line() {
    refused(&film_with("title = \"A film\"", "title = \"A film"), &["film.toml", "line 1", "title = \"A film"]);
    refused(&film_with("step_nm = 20", "step_nm = 20\nstep_nm = 25"), &["line 8", "duplicate key"]);
}

#[test]
fn an_unknown_key_is_named_with_its_nearest() {
    for (piece, slip, parts) in [
        ("[data.synthetic]\n", "titel = 1\n[data.synthetic]\n", ["line 3: titel", "no key `titel`", "mean `title`"]),
        ("step_nm", "stepnm", ["line 7: data.synthetic.stepnm", "no key `stepnm`", "mean `step_nm`"]),
        ("starts = 4", "start = 4", ["line 23: fit.start", "no key `start`", "mean `starts`"]),
        ("lower = 100", "low = 100", ["line 20: parameters.\"film.thickness_nm\".low", "no key `low`", "mean `lower`"]),
        ("substrate", "substrat", ["line 17: model.substrat", "no key `substrat`", "mean `substrate`"]),
        ("material =", "matter =", ["line 16: model.layers[1]", "no key `matter`", "known are name, material"]),
        ("[fit]", "[fits]", ["line 22: fits", "no key `fits`", "mean `fit`"]),
    ] {
        refused(&film_with(piece, slip), &parts);
    }
}

#[test]
fn a_value_of_the_wrong_kind_is_named_with_the_right_one() {
    for (piece, slip, parts) in [
        ("starts = 4", "starts = \"four\"", ["line 23: fit.starts", "the text \"four\"", "a whole number"]),
        ("starts = 4", "starts = 4.5", ["line 23: fit.starts", "found 4.5", "a whole number"]),
        ("starts = 4", "starts = -4", ["line 23: fit.starts", "found -4", "a whole number"]),
        ("step_nm = 20", "step_nm = \"20\"", ["line 7: data.synthetic.step_nm", "the text \"20\"", "a number"]),
        ("lower = 100", "lower = \"100\"", ["thickness_nm\".lower", "the text \"100\"", "a number"]),
        ("{ lower = 100, upper = 800 }", "true", ["line 20", "found true", "a number (fixed), a text (tied)"]),
        ("[400, 700]", "[400]", ["line 6: data.synthetic.window_nm", "a list of 1", "one of 2"]),
        ("title = \"A film\"", "title = 5", ["line 1: title", "found 5", "a text in quotes"]),
        ("\"reflectance\"", "\"reflectanse\"", ["line 4", "found `reflectanse`", "mean `reflectance`"]),
        ("\"coated-base\"", "\"coated-bas\"", ["line 15: model.kind", "found `coated-bas`", "mean `coated-base`"]),
        ("kind = \"coated-base\"\n", "", ["line 14: model", "`kind` is missing", "add it"]),
    ] {
        refused(&film_with(piece, slip), &parts);
    }
}

#[test]
fn a_parameter_that_makes_no_sense() {
    let place = "film.toml, line 20: parameters.\"film.thickness_nm\"";
    for (slip, parts) in [
        ("{ lower = 900, upper = 800 }", ["lower 900 is not below upper 800", "exchange them"]),
        ("{ start = 900, lower = 100, upper = 800 }", ["start 900 is not between", "move it"]),
        ("{ lower = -5, upper = 800 }", ["found -5", "from 5 to 5000 nm"]),
        ("{ lower = nan, upper = 800 }", ["found NaN", "from 5 to 5000 nm"]),
        ("{ lower = 100, upper = inf }", ["found inf", "from 5 to 5000 nm"]),
    ] {
        refused(&film_with("{ lower = 100, upper = 800 }", slip), &[place, parts[0], parts[1]]);
    }
    let unknown = film_with("\"film.thickness_nm\" = {", "\"film.thicknes_nm\" = {");
    refused(&unknown, &["film.toml, line 20", "no such parameter", "did you mean `film.thickness_nm`"]);
    let truth = film_with("\"film.thickness_nm\" = 330", "\"film.thicknes_nm\" = 330");
    refused(&truth, &["film.toml, line 12: data.synthetic.truth.\"film.thicknes_nm\"", "no such parameter"]);
}

#[test]
fn a_tie_to_nothing_or_to_a_tied_parameter() {
    let tied = |tie: &str| film_with("\"film.thickness_nm\" = {", &format!("{tie}\n\"film.thickness_nm\" = {{"));
    refused(&tied("\"keratin.index_scale\" = \"nosuch * 2\""), &["line 20", "`nosuch`, which is no parameter"]);
    refused(&tied("\"keratin.index_scale\" = \"2 * * x\""), &["line 20", "`*` at character 5"]);
    refused(&tied("\"keratin.index_scale\" = \"film.thickness_nm\""), &["line 20", "outside its range 0.8 to 1.25"]);
    let circle = "\"keratin.index_scale\" = \"bird_melanin.index_scale\"\n\"bird_melanin.index_scale\" = \"keratin.index_scale\"";
    refused(&tied(circle), &["film.toml, line 20", "which is tied itself", "tie it to what"]);
}

#[test]
fn a_material_or_a_layer_that_cannot_be() {
    refused(
        &film_with("\"keratin\"", "\"keratine\""),
        &["line 16", "no material \"keratine\"", "did you mean \"keratin\""],
    );
    refused(&film_with("thickness_nm = 300", "thickness_nm = -3"), &["film.toml, line 14: model", "-3"]);
}

#[test]
fn settings_beyond_reason() {
    for (piece, slip, parts) in [
        ("starts = 4", "starts = 1000000000", ["line 23", "`starts` is 1000000000", "from 1 to 65536"]),
        ("starts = 4", "starts = 0", ["line 23", "`starts` is 0", "from 1 to 65536"]),
        ("starts = 4", "max_iterations = 0", ["line 23", "`max_iterations` is 0", "at least 1"]),
        (
            "step_nm = 20",
            "step_nm = 1e-300",
            ["line 7: data.synthetic.step_nm", "more than 1e7 readings", "larger step"],
        ),
        ("noise = 0.01", "noise = -0.1", ["line 8: data.synthetic.noise", "found -0.1", "from 0 to below 1"]),
    ] {
        refused(&film_with(piece, slip), &parts);
    }
}

#[test]
fn a_slip_in_an_alternative_is_found_there() {
    let other = "[[alternative]]\ncase = \"other\"\n[alternative.parameters]\n\"film.thicknes_nm\" = 300\n";
    refused(&format!("{FILM}\n{other}"), &["film.toml, line 28, case \"other\"", "did you mean `film.thickness_nm`"]);
    let other = "[[alternative]]\ncase = \"other\"\nmodel = { kind = \"coated-base\", substrat = \"air\" }\n";
    refused(&format!("{FILM}\n{other}"), &["line 27: alternative[1].model.substrat", "did you mean `substrate`"]);
}

#[test]
fn options_that_make_no_sense() {
    let desk = Desk::with("film.toml", FILM).and("file", "");
    for (words, parts) in [
        ("fit film.toml --threads 0", ["'0'", "--threads"]),
        ("fit film.toml --threads many", ["'many'", "--threads"]),
        ("fit film.toml --seed -1", ["'-1'", "--seed"]),
        ("fit film.toml --out file", ["file cannot be written to", "--out"]),
        ("fit film.toml --out file/below", ["file/below cannot be written to", "--out"]),
        ("simulate film.toml --out file/below.csv", ["cannot write file/below.csv", "may be written"]),
        ("simulate film.toml --out film.toml", ["film.toml is what this job reads", "another name"]),
        ("simulate film.toml --set nonsense", ["'nonsense'", "expected NAME=VALUE"]),
        ("simulate film.toml --set film.thickness_nm=thick", ["`thick` is not a number", "--set"]),
        (
            "simulate film.toml --set film.thicknes_nm=300",
            ["--set: film.thicknes_nm: this model and instrument have no such parameter", "mean `film.thickness_nm`"],
        ),
        ("simulate film.toml --set film.thickness_nm=-4", ["--set: film.thickness_nm: found -4", "from 5 to 5000"]),
        ("simulate film.toml --noise -1", ["--noise: found -1", "from 0 to below 1"]),
        ("schema --out file", ["cannot write file/job.schema.json", "may be written"]),
        ("modles", ["unrecognized subcommand", "'models'"]),
        ("new film.toml --out film.toml", ["film.toml is there already", "--out"]),
        ("new nosuch.csv", ["nosuch.csv: there is no such file", "correct the path"]),
    ] {
        desk.barbule(words).complains(&parts.map(|part| part.trim_end()));
    }
}

#[test]
fn synthetic_readings_that_cannot_be() {
    let twice = film_with("[15, 45, 70]", "[15, 45, 15]");
    refused(&twice, &["film.toml, line 5: data.synthetic.mirror_deg", "found 15 twice"]);
    let (data, _) = FILM.split_once("\"film.thickness_nm\" = 330").unwrap();
    let black = format!("{data}albedo = 0\n[model]\nkind = \"lambertian\"\n");
    refused(&black, &["film.toml, line 8: data.synthetic.noise", "the model reads 0", "or write 0"]);
}

#[test]
fn a_table_that_is_wrong_is_named_with_its_line() {
    let job = "title = \"Peaks\"\n[data]\nfile = \"peaks.csv\"\n[data.layout.peaks]\nangles = { mirror = \"angle\" }\n\
               wavelength = \"peak_nm\"\n[model]\nkind = \"thin-film-law\"\n[parameters]\n\"film.thickness_nm\" = {}\n";
    let with = |table: &str| Desk::with("job.toml", job).and("peaks.csv", table);
    with("angle,peak_nm\n15,560\n30,548\n").barbule("check job.toml").succeeds().prints("2 of 2 peak wavelengths");
    for (table, parts) in [
        ("angle,peak_nm\n15,560\n30,NaN\n", ["peaks.csv, line 3", "NaN"]),
        ("angle,peak_nm\n15,0.560\n30,0.548\n", ["peaks.csv", "micrometres"]),
        ("angle,peak\n15,560\n", ["peaks.csv, line 1", "did you mean \"peak\""]),
        ("", ["peaks.csv", "empty"]),
    ] {
        with(table).barbule("check job.toml").complains(&parts);
    }
    let law = film_with(
        "kind = \"coated-base\"\nlayers = [{ name = \"film\", material = \"keratin\", thickness_nm = 300 }]\nsubstrate = \"bird_melanin\"",
        "kind = \"thin-film-law\"",
    );
    refused(&law, &["film.toml, line 15: ", "model.kind", "not spectra", "use `coated-base`"]);
}

#[test]
fn a_path_in_the_folder_of_measurements_needs_that_folder() {
    let words = format!("check {}", shipped("teal-table"));
    Desk::empty().barbule_without_data(&words).complains(&[
        "job.toml, line",
        "data.file",
        "BARBULE_DATA",
        "is not set",
    ]);
}

#[test]
fn the_same_seed_gives_the_same_bytes_on_one_thread_and_on_two() {
    let desk = Desk::with("film.toml", FILM);
    for (threads, out) in [(1, "one"), (2, "two"), (2, "again")] {
        desk.barbule(&format!("fit film.toml --threads {threads} --out {out}")).succeeds();
    }
    for file in ["result.json", "index.html"] {
        let one = desk.read(&format!("one/{file}"));
        assert!(one == desk.read(&format!("two/{file}")), "{file} differs between one thread and two");
        assert!(one == desk.read(&format!("again/{file}")), "{file} differs between two runs");
    }
}

#[test]
fn a_reader_that_has_enough_is_no_error() {
    // 18,000 lines do not fit into a pipe's buffer, so that the program is still writing when its reader leaves.
    let desk = Desk::with("film.toml", film_with("step_nm = 20", "step_nm = 0.05"));
    let mut child = desk.command("simulate film.toml").stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut first = String::new();
    BufReader::new(child.stdout.take().unwrap()).read_line(&mut first).unwrap();
    assert!(first.starts_with("id,theta_i_deg"), "{first}");
    let output = child.wait_with_output().unwrap();
    assert_eq!((output.status.code(), output.stderr.as_slice()), (Some(0), &b""[..]));
}

/// A job whose fit takes longer than any test waits.
fn endless() -> String {
    let duck = fs::read_to_string(shipped("duck-synthetic/job.toml")).unwrap();
    replaced(&duck, "starts = 64", "starts = 65536")
}

#[cfg(unix)]
fn signal(child: &std::process::Child, name: &str) {
    let status = std::process::Command::new("kill").args(["-s", name, &child.id().to_string()]).status().unwrap();
    assert!(status.success());
}

#[cfg(unix)]
#[test]
fn ctrl_c_ends_with_the_best_so_far() {
    let desk = Desk::with("endless.toml", endless());
    let mut child =
        desk.command("fit endless.toml --out report").stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    // Time enough to read the job and to begin, far too little to end.
    sleep(Duration::from_secs(2));
    assert!(child.try_wait().unwrap().is_none(), "the fit was to take longer");
    signal(&child, "INT");
    let mut out = String::new();
    child.stdout.take().unwrap().read_to_string(&mut out).unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(out.contains("stopped early; this is the best so far"), "{out}");
    assert_eq!(desk.result("report")["cases"][0]["fit"]["stop"], "cancelled");
}

#[cfg(unix)]
#[test]
fn a_killed_run_leaves_the_old_report_whole() {
    let desk = Desk::with("film.toml", FILM).and("endless.toml", endless());
    desk.barbule("fit film.toml --out report").succeeds();
    let before = desk.files();
    let mut child = desk.command("fit endless.toml --out report").spawn().unwrap();
    sleep(Duration::from_secs(1));
    signal(&child, "KILL");
    child.wait().unwrap();
    assert!(before == desk.files(), "a run that was killed before its end touched the report");
    let hidden = |path: &std::path::PathBuf| path.file_name().unwrap().to_string_lossy().starts_with('.');
    assert!(!before.keys().any(hidden), "temporary files stay behind: {:?}", before.keys());
}

#[test]
fn a_reused_folder_holds_the_new_report() {
    let desk = Desk::with("film.toml", FILM);
    desk.barbule("fit film.toml --out report --seed 1").succeeds().prints("Report: report/index.html");
    desk.barbule("fit film.toml --out report --seed 2").succeeds();
    assert_eq!(desk.result("report")["cases"][0]["fit"]["settings"]["seed"], 2);
}

#[test]
fn by_default_the_report_stands_under_the_name_of_the_job() {
    let desk = Desk::with("film.toml", FILM);
    desk.barbule("fit film.toml").succeeds().prints("Report: reports/film/index.html").prints("330");
}
