//! `barbule geometry` as its user meets it: what it writes, and what it says to a mistake.

use std::fs;

use barbule::geometry::FeatherMap;
use serde_json::{Value, json};

use super::desk::{Desk, replaced, shipped};

const FEATHER: &str = r#"{
  "title": "A feather",
  "shaft": {
    "control_points_mm": [[0, 0], [1, 20], [0, 40]],
    "base_width_mm": 1.5,
    "tip_width_mm": 0.2,
    "calamus_length_mm": 8
  },
  "left_vane": { "control_points_mm": [[-8, 10], [-8, 38]], "barb_angle_deg": 35 },
  "right_vane": { "control_points_mm": [[9, 10], [9, 38]], "barb_angle_deg": 40 },
  "barbs": { "count_per_vane": 50, "width_um": 40 }
}
"#;

/// Draws the feather with one piece of its text replaced, and expects a sentence with these parts.
#[track_caller]
fn refused(piece: &str, replacement: &str, parts: &[&str]) {
    let desk = Desk::with("feather.json", replaced(FEATHER, piece, replacement));
    desk.barbule("geometry feather.json --out out").complains(parts);
}

#[test]
fn a_feather_is_drawn_into_four_files() {
    let desk = Desk::with("feather.json", FEATHER);
    desk.barbule("geometry feather.json --out out --pixels-per-mm 10")
        .succeeds()
        .prints("left vane: 50 barbs")
        .prints("10 a millimetre")
        .prints("map.png");
    let map = FeatherMap::read(&desk.path("out/map.png")).unwrap();
    let summary: Value = serde_json::from_str(&desk.read("out/geometry.json")).unwrap();
    assert_eq!(summary["map"]["width"], json!(map.width()));
    assert_eq!(summary["map"]["height"], json!(map.height()));
    let svg = desk.read("out/preview.svg");
    assert!(svg.starts_with("<svg") && svg.matches("<path").count() > 100 && svg.contains("5 mm"), "{svg}");
    assert_eq!(svg.matches("<circle").count(), 0);
    assert!(desk.read("out/barbs.csv").starts_with("vane,barb,x_mm,y_mm,tangent_x,tangent_y\nleft,1,"));

    let first = fs::read(desk.path("out/map.png")).unwrap();
    desk.barbule("geometry feather.json --out again --pixels-per-mm 10 --construction").succeeds();
    assert_eq!(first, fs::read(desk.path("again/map.png")).unwrap());
    // Two ends and two inner control points of each barb.
    assert_eq!(desk.read("again/preview.svg").matches("<circle").count(), 400);
}

#[test]
fn shipped_feathers_are_drawn() {
    for name in ["feather-primary", "feather-tail", "feather-contour", "thesis1-figure-4.1", "thesis1-figure-4.2"] {
        let desk = Desk::empty();
        desk.barbule(&format!("geometry {} --pixels-per-mm 4", shipped(name))).succeeds().prints("reports/");
        assert!(desk.path(&format!("reports/{name}/map.png")).exists());
    }
}

#[test]
fn a_file_that_is_no_feather() {
    let desk =
        Desk::with("half.json", &FEATHER[..100]).and("two.json", format!("{FEATHER}{FEATHER}")).and("empty.json", "");
    fs::create_dir(desk.path("folder")).unwrap();
    for (words, parts) in [
        ("geometry nosuch.json", ["nosuch.json: there is no such file", "feather.json"]),
        ("geometry folder", ["folder: this folder has no feather.json", ""]),
        ("geometry half.json", ["half.json, line 5", "this is not JSON"]),
        ("geometry two.json", ["two.json, line 13", "this is not JSON"]),
        ("geometry empty.json", ["empty.json, line", "this is not JSON"]),
    ] {
        desk.barbule(words).complains(&parts);
    }
}

#[test]
fn a_slip_is_named_with_its_line() {
    refused("tip_width_mm", "tip_with_mm", &["feather.json, line 6", "no key `tip_with_mm`", "mean `tip_width_mm`"]);
    refused("[1, 20]", "[1]", &["line 4: shaft.control_points_mm[2]", "a list of 1", "one of 2"]);
    refused("[1, 20]", "[1, NaN]", &["line 4", "this is not JSON"]);
    refused("[1, 20]", "[1, 1e999]", &["line 4", "out of range"]);
    refused("[1, 20]", "[1, null]", &["line 4: shaft.control_points_mm[2][2]", "found null", "a number"]);
    refused(
        "\"barb_angle_deg\": 35",
        "\"barb_angle_deg\": \"35\"",
        &["line 9: left_vane.barb_angle_deg", "the text \"35\""],
    );
    refused(
        "\"count_per_vane\": 50",
        "\"count_per_vane\": -5",
        &["line 11: barbs.count_per_vane", "found -5", "whole number"],
    );
    refused("\"width_um\": 40", "\"width_um\": 40, \"width_um\": 41", &["line 11", "`width_um` stands there twice"]);
    refused("\"width_um\": 40", "\"width_um\": 40, \"between\": \"air\"", &["found `air`", "barbules, nothing"]);
}

#[test]
fn numbers_that_make_no_sense() {
    let count = |count: &str| format!("\"count_per_vane\": {count}");
    for number in ["0", "1000000000"] {
        refused(
            &count("50"),
            &count(number),
            &["feather.json: barbs.count_per_vane", &format!("found {number}"), "from 1 to"],
        );
    }
    let angle = |angle: &str| format!("\"barb_angle_deg\": {angle}");
    for number in ["0", "-20", "90", "135"] {
        let parts = ["left_vane.barb_angle_deg", "above 0 and below 90°"];
        refused(&angle("35"), &angle(number), &parts);
    }
    for (piece, slip, parts) in [
        ("[[0, 0], [1, 20], [0, 40]]", "[[0, 0]]", ["shaft.control_points_mm", "one point", "from 2 to 64"]),
        ("[[0, 0], [1, 20], [0, 40]]", "[[0, 0], [0, 0]]", ["shaft.control_points_mm", "a shaft of 0 mm", "in mm?"]),
        ("[1, 20]", "[1, 2e9]", ["shaft.control_points_mm[2]", "found 2 × 10⁹", "20000"]),
        (
            "[1, 20]",
            "[30, 60], [30, -20]",
            ["shaft.control_points_mm", "the shaft crosses itself at", "without a loop"],
        ),
        ("[1, 20]", "[0, 90]", ["shaft.control_points_mm", "turns back on the spot", "apart"]),
        ("\"base_width_mm\": 1.5", "\"base_width_mm\": 0", ["shaft.base_width_mm", "found 0", "from 0.001 to 50 mm"]),
        ("_length_mm\": 8", "_length_mm\": 80", ["shaft.calamus_length_mm", "found 80", "make it shorter"]),
        ("[[-8, 10], [-8, 38]]", "[]", ["left_vane.control_points_mm", "no point", "from 1 to 62"]),
        (
            "[[-8, 10], [-8, 38]]",
            "[[8, 10], [8, 38]]",
            ["left_vane.control_points_mm", "not lie on the left", "exchange"],
        ),
        ("[[-8, 10], [-8, 38]]", "[[-20, 10], [30, 30]]", ["left_vane", "crosses the rachis at", "one side"]),
        ("[[9, 10], [9, 38]]", "[[30, 60], [30, -20]]", ["right_vane", "crosses itself", "loop"]),
        ("\"width_um\": 40", "\"width_um\": 400", ["barbs.width_um", "found 400", "fewer or narrower"]),
        ("\"width_um\": 40", "\"width_um\": 40, \"v1\": 0", ["barbs.v1", "found 0", "from 0.01 to 1"]),
        ("\"width_um\": 40", "\"width_um\": 40, \"v1\": 0.9", ["barbs.v3", "v1 + v3 is 1.2333", "1 at most"]),
        ("\"width_um\": 40", "\"width_um\": 40, \"v4\": 3", ["barbs.v4", "found 3", "from −1 to 1"]),
    ] {
        refused(piece, slip, &parts);
    }
}

/// Where the rachis bends towards the left vane, a barb at a small angle meets it again.
#[test]
fn barbs_that_never_meet_the_outline() {
    let hooked = "[[0, 0], [30, 25], [0, 40]]";
    let left = "\"control_points_mm\": [[-8, 10], [-8, 38]], \"barb_angle_deg\": 35";
    let flat = "\"control_points_mm\": [[-8, 10], [-8, 38]], \"barb_angle_deg\": 3";
    let text = replaced(&replaced(FEATHER, "[[0, 0], [1, 20], [0, 40]]", hooked), left, flat);
    let desk = Desk::with("feather.json", text);
    desk.barbule("geometry feather.json --out out").complains(&[
        "feather.json: left_vane.barb_angle_deg",
        "barb ",
        " of 50, which leaves the rachis",
        "meets the rachis before the outline",
        "make the angle larger",
    ]);
}

#[test]
fn a_map_too_large_or_of_no_size() {
    let desk = Desk::with("feather.json", FEATHER).and("file", "");
    for (words, parts) in [
        ("--pixels-per-mm 2500", ["--pixels-per-mm: found 2500", "texels", "or less for this feather"]),
        ("--pixels-per-mm 0", ["--pixels-per-mm: found 0", "from 0.01 to 10000", ""]),
        ("--pixels-per-mm -4", ["--pixels-per-mm: found -4", "from 0.01", ""]),
        ("--pixels-per-mm nan", ["--pixels-per-mm: found NaN", "from 0.01", ""]),
        ("--out file", ["file cannot be written to", "--out", ""]),
    ] {
        desk.barbule(&format!("geometry feather.json {words}")).complains(&parts);
    }
}

#[test]
fn a_picture_that_is_no_map() {
    let desk = Desk::with("feather.json", FEATHER).and("text.png", "hello");
    desk.barbule("geometry feather.json --out out --pixels-per-mm 4").succeeds();
    let whole = fs::read(desk.path("out/map.png")).unwrap();
    fs::write(desk.path("half.png"), &whole[..whole.len() / 2]).unwrap();
    let picture = image::open(desk.path("out/map.png")).unwrap();
    picture.to_rgb8().save(desk.path("colour.png")).unwrap();
    picture.save(desk.path("no-size.png")).unwrap();
    for (name, part) in [
        ("nosuch.png", "there is no such file"),
        ("text.png", "no whole PNG"),
        ("half.png", "no whole PNG"),
        ("colour.png", "found a PNG of 8 bits"),
        ("no-size.png", "how many texels a metre"),
    ] {
        let error = FeatherMap::read(&desk.path(name)).unwrap_err().to_string();
        assert!(error.contains(name) && error.contains(part), "{error}");
    }
}
