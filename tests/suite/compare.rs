//! Two pictures against each other: closed forms, oracle colours, known shifts, and the command.

use std::io::Cursor;
use std::path::Path;

use assert_cmd::Command;
use barbule::compare::{CompareError, PictureKind, compare, structural_similarity};
use barbule::measure::colour::{Lab, LinearRgb, Xyz, decode};
use barbule::measure::photograph::{Camera, Photograph, PhotographOptions, Rectangle, Region};
use image::codecs::openexr::OpenExrEncoder;
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};
use proptest::prelude::*;

use super::oracle::Oracle;

fn exr(light: &[[f32; 3]], width: usize) -> Vec<u8> {
    let bytes: Vec<u8> = light.iter().flatten().flat_map(|channel| channel.to_ne_bytes()).collect();
    let mut file = Cursor::new(Vec::new());
    let (width, height) = (u32::try_from(width).unwrap(), u32::try_from(light.len() / width).unwrap());
    OpenExrEncoder::new(&mut file).write_image(&bytes, width, height, ExtendedColorType::Rgb32F).unwrap();
    file.into_inner()
}

fn picture(light: &[[f32; 3]], width: usize) -> Photograph {
    let bytes = exr(light, width);
    Photograph::from_bytes(&bytes, Path::new("a.exr"), &PhotographOptions::default()).unwrap()
}

fn grey(codes: &[f64], width: usize) -> Photograph {
    #[expect(clippy::cast_possible_truncation, reason = "pictures hold 32-bit numbers")]
    let light: Vec<[f32; 3]> = codes.iter().map(|code| [decode(*code) as f32; 3]).collect();
    picture(&light, width)
}

#[test]
fn a_picture_does_not_differ_from_itself() {
    let codes: Vec<f64> = (0..16 * 12u8).map(|place| f64::from(place % 29) / 29.0).collect();
    let one = grey(&codes, 16);
    let comparison = compare(&one, &one, false, &[]).unwrap();
    assert_eq!((comparison.difference.largest, comparison.psnr_db), (0.0, None));
    let similarity = comparison.similarity.unwrap();
    assert!((similarity.mean - 1.0).abs() < 1e-12);
    assert_eq!(similarity.windows, 6 * 2, "windows of 11 × 11 in 16 × 12");
    assert!(comparison.answer.starts_with("The two pictures do not differ."), "{}", comparison.answer);
}

/// Two even greys: no structure, so that SSIM is its first factor; PSNR is that of one difference.
#[test]
fn even_pictures_have_closed_forms() {
    for (a, b) in [(0.2, 0.3), (0.5, 0.9), (0.05, 0.06)] {
        let comparison = compare(&grey(&[a; 15 * 15], 15), &grey(&[b; 15 * 15], 15), false, &[]).unwrap();
        let c1 = 1e-4;
        let expected = (2.0 * a * b + c1) / (a * a + b * b + c1);
        // Light is held in 32 bits.
        assert!((comparison.similarity.unwrap().mean - expected).abs() < 1e-5);
        let decibel = -20.0 * f64::abs(a - b).log10();
        assert!((comparison.psnr_db.unwrap() - decibel).abs() < 1e-3);
        let lab = |code| LinearRgb([decode(code); 3]).to_lab();
        assert!((comparison.difference.median - lab(a).delta_e_2000(lab(b))).abs() < 1e-4);
    }
}

/// The definition, window by window: weights, means, deviations from them (Wang et al. 2004, equations 13 to 16).
fn by_definition(one: &[f64], other: &[f64], width: usize) -> f64 {
    let weight = |x: usize, y: usize| {
        let away = |at: usize| (at as f64 - 5.0).powi(2);
        (-(away(x) + away(y)) / (2.0 * 1.5 * 1.5)).exp()
    };
    let all: f64 = (0..121).map(|place| weight(place % 11, place / 11)).sum();
    let height = one.len() / width;
    let (mut sum, mut windows) = (0.0, 0.0);
    for top in 0..=height - 11 {
        for left in 0..=width - 11 {
            let mean = |value: &dyn Fn(usize) -> f64| -> f64 {
                (0..121)
                    .map(|place| {
                        let (x, y) = (place % 11, place / 11);
                        weight(x, y) / all * value((top + y) * width + left + x)
                    })
                    .sum()
            };
            let (mx, my) = (mean(&|place| one[place]), mean(&|place| other[place]));
            let vx = mean(&|place| (one[place] - mx).powi(2));
            let vy = mean(&|place| (other[place] - my).powi(2));
            let cov = mean(&|place| (one[place] - mx) * (other[place] - my));
            sum += (2.0 * mx * my + 1e-4) * (2.0 * cov + 9e-4) / ((mx * mx + my * my + 1e-4) * (vx + vy + 9e-4));
            windows += 1.0;
        }
    }
    sum / windows
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn similarity_is_its_definition(
        one in prop::collection::vec(0.0f64..1.0, 14 * 12), other in prop::collection::vec(0.0f64..1.0, 14 * 12),
    ) {
        let expected = by_definition(&one, &other, 14);
        let both = [one, other];
        let found = structural_similarity(&both, 14, &[true; 14 * 12]).unwrap();
        // Variances as differences of means of squares lose a few last bits.
        prop_assert!((found.mean - expected).abs() < 1e-11, "found {}, expected {expected}", found.mean);
        // Symmetric, and none where one pixel in the middle spoils every window.
        let [one, other] = both;
        let turned = structural_similarity(&[other.clone(), one.clone()], 14, &[true; 14 * 12]).unwrap();
        prop_assert!((turned.mean - found.mean).abs() < 1e-12);
        let mut trusted = vec![true; 14 * 12];
        trusted[5 * 14 + 6] = false;
        prop_assert_eq!(structural_similarity(&[one, other], 14, &trusted), None);
    }
}

/// CIELAB back to linear light (CIE 15:2018, 8.2.1.2), against the white of the Rec. 709 primaries.
fn light_of(lab: Lab) -> [f32; 3] {
    let white = LinearRgb([1.0; 3]).to_xyz();
    let y = (lab.l + 16.0) / 116.0;
    let inverse = |root: f64| {
        if root > 6.0 / 29.0 { root.powi(3) } else { 3.0 * (6.0f64 / 29.0).powi(2) * (root - 4.0 / 29.0) }
    };
    let xyz = Xyz {
        x: white.x * inverse(y + lab.a / 500.0),
        y: white.y * inverse(y),
        z: white.z * inverse(y - lab.b / 200.0),
    };
    #[expect(clippy::cast_possible_truncation, reason = "pictures hold 32-bit numbers")]
    xyz.to_linear_rgb().0.map(|channel| channel as f32)
}

/// The published pairs of Sharma, Wu and Dalal (2005) and those of an independent program, as two rows of pixels.
#[test]
fn the_map_holds_the_differences_of_the_oracle() {
    let oracle = Oracle::read("tests/oracles/color_ciede2000.csv");
    let lab = |row: usize, which: &str| Lab {
        l: oracle.number(row, &format!("L{which}")),
        a: oracle.number(row, &format!("a{which}")),
        b: oracle.number(row, &format!("b{which}")),
    };
    let rows = oracle.rows.len();
    let [one, other] = ["1", "2"].map(|which| (0..rows).map(|row| light_of(lab(row, which))).collect::<Vec<_>>());
    let comparison = compare(&picture(&one, rows), &picture(&other, rows), false, &[]).unwrap();
    for (row, found) in comparison.pixels.difference.iter().enumerate() {
        let expected = oracle.number(row, "colour_science");
        let off = (f64::from(found.unwrap()) - expected).abs();
        // Light in 32 bits moves a colour by less than that.
        assert!(off < 1e-3, "pair {row}: found {found:?}, expected {expected}");
    }
}

#[test]
fn what_cannot_be_trusted_is_left_out_and_counted() {
    let pixels = [[10u8, 20, 30, 255], [255, 255, 255, 255], [1, 2, 3, 0], [40, 50, 60, 255]];
    let mut file = Vec::new();
    PngEncoder::new(&mut file).write_image(&pixels.concat(), 4, 1, ExtendedColorType::Rgba8).unwrap();
    let read = |name: &str| Photograph::from_bytes(&file, Path::new(name), &PhotographOptions::default()).unwrap();
    let rectangle = Rectangle { x_px: 0, y_px: 0, width_px: 2, height_px: 1 };
    let region = Region { file: None, name: "edge".into(), rectangle };
    let comparison = compare(&read("a.png"), &read("b.png"), false, &[region]).unwrap();
    assert_eq!((comparison.compared, comparison.left_out), (2, 2));
    assert!(comparison.answer.contains("2 of 4 pixels were left out"), "{}", comparison.answer);
    let edge = &comparison.regions[0];
    assert_eq!((edge.pixels, edge.left_out, edge.difference), (1, 1, Some(0.0)));
    let [light, _] = edge.light.unwrap();
    for (found, code) in light.iter().zip([10.0, 20.0, 30.0]) {
        assert!((found - decode(code / 255.0)).abs() < 1e-7);
    }
}

#[test]
fn pictures_that_cannot_be_compared_are_refused() {
    let (small, large) = (grey(&[0.5; 4], 2), grey(&[0.5; 6], 3));
    let text = compare(&small, &large, false, &[]).unwrap_err().to_string();
    assert!(text.contains("2 × 2 pixels") && text.contains("3 × 2") && text.contains("--register"), "{text}");
    assert!(matches!(compare(&small, &large, true, &[]), Err(CompareError::NotRegistered(_))));

    let dark = picture(&[[f32::NAN; 3]; 4], 2);
    let text = compare(&small, &dark, false, &[]).unwrap_err().to_string();
    assert!(text.contains("no pixel can be trusted") && text.contains("4 no numbers of 4"), "{text}");

    let rectangle = Rectangle { x_px: 1, y_px: 0, width_px: 2, height_px: 1 };
    let region = Region { file: None, name: "tail".into(), rectangle };
    let text = compare(&small, &small, false, &[region]).unwrap_err().to_string();
    assert!(text.contains("region tail (x 1 y 0, 2 × 1 pixels) reaches out"), "{text}");
}

/// A smooth pattern that repeats nowhere in view, as a code at a place.
fn pattern(x: f64, y: f64) -> f64 {
    0.5 + 0.2 * (0.11 * x + 0.05 * y).sin() + 0.15 * (0.031 * x * x / 40.0 - 0.09 * y).sin() + 0.1 * (0.2 * y).cos()
}

fn view(width: usize, height: usize, right: f64, down: f64) -> Photograph {
    let codes: Vec<f64> = (0..width * height)
        .map(|place| pattern((place % width) as f64 + right, (place / width) as f64 + down))
        .collect();
    grey(&codes, width)
}

#[test]
fn a_shift_is_found_to_a_tenth_of_a_pixel() {
    let first = view(120, 90, 0.0, 0.0);
    for (right, down) in [(0.0, 0.0), (17.0, -9.0), (-3.3, 5.6), (0.5, 0.5)] {
        // What lies at x in the first lies at x − right in this view.
        let second = view(110, 95, right, down);
        let comparison = compare(&first, &second, true, &[]).unwrap();
        let found = comparison.registration.unwrap().shift_px;
        for (found, expected) in found.into_iter().zip([-right, -down]) {
            // A parabola through three correlations is not the correlation itself.
            assert!((found - expected).abs() < 0.1, "found {found}, expected {expected}");
        }
        // A tenth of a pixel at the pattern's steepest 0.04 a pixel is 0.004 of the code's range, ΔE below 0.5.
        assert!(comparison.difference.median < 0.5, "{}", comparison.answer);
    }
}

#[test]
fn the_command_writes_a_page_and_says_what_each_picture_was() {
    let folder = tempfile::tempdir().unwrap();
    let light: Vec<[f32; 3]> = (0..48 * 32u16).map(|place| [f32::from(place % 48) / 60.0, 0.3, 0.2]).collect();
    std::fs::write(folder.path().join("render.exr"), exr(&light, 48)).unwrap();
    std::fs::write(folder.path().join("photo.jpg"), Camera::default().photograph(&light, 48).unwrap()).unwrap();
    std::fs::write(folder.path().join("small.exr"), exr(&light[..48], 48)).unwrap();
    std::fs::write(folder.path().join("patches.csv"), "patch,x_px,y_px,width_px,height_px\nmiddle,20,10,8,8\n")
        .unwrap();
    let run = |arguments: &[&str]| {
        Command::cargo_bin("barbule")
            .unwrap()
            .current_dir(folder.path())
            .arg("compare")
            .args(arguments)
            .output()
            .unwrap()
    };
    let done = run(&["render.exr", "photo.jpg", "--regions", "patches.csv", "--out", "report"]);
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let read = |name: &str| std::fs::read_to_string(folder.path().join("report").join(name)).unwrap();
    let json: serde_json::Value = serde_json::from_str(&read("comparison.json")).unwrap();
    let kind = |which: &str| json[which]["kind"].clone();
    assert_eq!(kind("first"), serde_json::to_value(PictureKind::LinearNumbers).unwrap());
    assert_eq!(kind("second"), serde_json::to_value(PictureKind::SyntheticPhotograph).unwrap());
    // Codes and JPEG, and nothing else, lie between them.
    assert!(json["difference"]["median"].as_f64().unwrap() < 1.5, "{}", json["difference"]);
    let page = read("index.html");
    assert!(page.contains("synthetic photograph") && !page.contains("<script"), "the page says what it shows");
    assert!(read("regions.csv").starts_with("region,x_px,y_px"));
    for picture in ["first.png", "second.png", "side-by-side.png", "difference.png"] {
        image::open(folder.path().join("report").join(picture)).unwrap();
    }

    std::fs::write(folder.path().join("other.csv"), "file,patch,x_px,y_px,width_px,height_px\nb.png,wing,0,0,8,8\n")
        .unwrap();
    let refused = run(&["render.exr", "photo.jpg", "--regions", "other.csv"]);
    assert_eq!(refused.status.code(), Some(2));
    let text = String::from_utf8_lossy(&refused.stderr);
    assert!(text.contains("other.csv") && text.contains("no region of render.exr"), "{text}");

    let refused = run(&["render.exr", "small.exr"]);
    assert_eq!(refused.status.code(), Some(2));
    let text = String::from_utf8_lossy(&refused.stderr);
    assert!(text.contains("48 × 32 pixels") && text.contains("48 × 1"), "{text}");
    let missing = run(&["none.png", "small.exr"]);
    assert_eq!(missing.status.code(), Some(2));
    assert_eq!(run(&["render.exr", "photo.jpg", "--first-encoding", "log"]).status.code(), Some(2));
}
