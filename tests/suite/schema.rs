//! The schemas say what the files hold: they are current, and every job and result agrees with them.

use std::fs;
use std::path::Path;

use jsonschema::Validator;
use serde_json::Value;

use super::desk::{Desk, FILM};

fn shipped(folder: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(folder)
}

fn schema(name: &str) -> Validator {
    let text = fs::read_to_string(shipped("data-schema").join(name)).unwrap();
    jsonschema::validator_for(&serde_json::from_str(&text).unwrap()).unwrap()
}

fn assert_agrees(schema: &Validator, what: &str, value: &Value) {
    let problems: Vec<String> =
        schema.iter_errors(value).map(|error| format!("{}: {error}", error.instance_path())).collect();
    assert!(problems.is_empty(), "{what} disagrees with its schema:\n{}", problems.join("\n"));
}

fn job_as_json(text: &str) -> Value {
    serde_json::to_value(toml::from_str::<toml::Table>(text).unwrap()).unwrap()
}

#[test]
fn the_schemas_are_those_of_this_version() {
    let schemas =
        barbule::job::schemas().into_iter().chain(barbule::scene::schemas()).chain(barbule::geometry::schemas());
    for (name, expected) in schemas {
        let found = fs::read_to_string(shipped("data-schema").join(name)).unwrap_or_default();
        // Git may have turned the line ends.
        assert!(
            found.replace("\r\n", "\n") == expected,
            "data-schema/{name} is old; run `cargo run --release -- schema`"
        );
    }
}

#[test]
fn every_shipped_job_agrees_with_the_schema() {
    let schema = schema("job.schema.json");
    let mut jobs = 0;
    for folder in fs::read_dir(shipped("fits")).unwrap() {
        let path = folder.unwrap().path().join("job.toml");
        // Some folders hold a feather or a scene instead.
        if !path.exists() {
            continue;
        }
        let text = fs::read_to_string(&path).unwrap();
        assert_agrees(&schema, &path.display().to_string(), &job_as_json(&text));
        jobs += 1;
    }
    assert!(jobs > 0);
}

#[test]
fn every_shipped_scene_agrees_with_the_schema() {
    let schema = schema("scene.schema.json");
    let mut scenes = 0;
    for folder in fs::read_dir(shipped("fits")).unwrap() {
        let path = folder.unwrap().path().join("scene.json");
        if path.exists() {
            let scene = serde_json::from_str(&fs::read_to_string(&path).unwrap()).unwrap();
            assert_agrees(&schema, &path.display().to_string(), &scene);
            scenes += 1;
        }
    }
    assert!(scenes > 0);
}

#[test]
fn feathers_and_their_summaries_agree_with_the_schemas() {
    let feathers = schema("feather.schema.json");
    let summaries = schema("geometry.schema.json");
    for name in ["feather-primary", "feather-tail", "feather-contour"] {
        let path = shipped("fits").join(name).join("feather.json");
        let text = fs::read_to_string(&path).unwrap();
        let value: Value = serde_json::from_str(&text).unwrap();
        assert_agrees(&feathers, name, &value);
        assert!(!feathers.is_valid(&serde_json::from_str(&text.replace("tip_width_mm", "tip_with_mm")).unwrap()));

        let desk = Desk::empty();
        desk.barbule(&format!("geometry {} --out out --pixels-per-mm 2", path.display())).succeeds();
        assert_agrees(&summaries, name, &serde_json::from_str(&desk.read("out/geometry.json")).unwrap());
    }
}

#[test]
fn the_schema_refuses_what_the_program_refuses() {
    let schema = schema("job.schema.json");
    assert_agrees(&schema, "the film's job", &job_as_json(FILM));
    for (piece, slip) in [
        ("title = \"A film\"", "titel = \"A film\""),
        ("starts = 4", "start = 4"),
        ("starts = 4", "starts = \"four\""),
        ("\"reflectance\"", "\"reflectanse\""),
        ("lower = 100", "low = 100"),
    ] {
        let job = super::desk::film_with(piece, slip);
        assert!(!schema.is_valid(&job_as_json(&job)), "the schema lets pass\n{job}");
    }
}

#[test]
fn a_printed_result_agrees_with_the_schema() {
    let schema = schema("result.schema.json");
    let desk = Desk::with("film.toml", FILM);
    for job in ["film.toml", &super::desk::shipped("teal-peaks")] {
        let run = desk.barbule(&format!("fit {job} --out report --format json")).succeeds();
        let printed: Value = serde_json::from_str(&run.out).unwrap();
        assert_agrees(&schema, job, &printed);
        assert_eq!(printed, desk.result("report"), "what is printed is what is kept");
    }
}
