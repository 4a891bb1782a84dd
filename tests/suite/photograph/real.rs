//! Photographs that others took.

use barbule::measure::colour::encode;
use barbule::measure::photograph::{ExifColourSpace, Photograph, PhotographOptions, Validity};

use super::super::data::data_file;

fn photo(name: &str) -> Photograph {
    Photograph::read(&data_file(&format!("photos/{name}")), &PhotographOptions::default()).unwrap()
}

/// Median sRGB code of each channel over some pixels.
fn median_codes(photograph: &Photograph, counts: impl Fn([f64; 3], Validity) -> bool) -> [f64; 3] {
    let codes: Vec<[f64; 3]> = photograph
        .pixels
        .iter()
        .zip(&photograph.validity)
        .map(|(pixel, validity)| (pixel.map(|channel| 255.0 * encode(channel.into())), *validity))
        .filter(|(codes, validity)| counts(*codes, *validity))
        .map(|(codes, _)| codes)
        .collect();
    [0, 1, 2].map(|channel| {
        let mut values: Vec<f64> = codes.iter().map(|codes| codes[channel]).collect();
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    })
}

/// One specimen in two editions of its authors: the data's notes give the medians by another program.
#[test]
#[cfg_attr(not(barbule_data), ignore = "set BARBULE_DATA to the folder of measurements")]
fn two_editions_of_one_tanager_have_the_medians_that_are_known() {
    let png = photo("Tangara_gyrola_LACM43661.png");
    assert_eq!((png.width, png.height), (800, 1200));
    assert!(png.notes.iter().any(|note| note.contains("Nothing in the file says")), "{:?}", png.notes);
    let opaque = median_codes(&png, |_, validity| validity != Validity::Transparent);
    let jpeg = photo("Tangara_gyrola_whitebg_01.jpeg");
    assert_eq!((jpeg.width, jpeg.height), (1210, 1815));
    assert!(jpeg.coding.contains("ICC profile"), "{}", jpeg.coding);
    let not_white = median_codes(&jpeg, |codes, _| codes.iter().any(|code| *code < 250.0));
    // Medians are whole codes; where the background is cut may move one by a code.
    for (found, expected) in [(opaque, [118.0, 125.0, 63.0]), (not_white, [74.0, 132.0, 33.0])] {
        for (found, expected) in found.into_iter().zip(expected) {
            assert!((found - expected).abs() <= 1.5, "found {found}, expected {expected}");
        }
    }
}

#[test]
#[cfg_attr(not(barbule_data), ignore = "set BARBULE_DATA to the folder of measurements")]
fn a_real_camera_says_how_it_exposed() {
    let jay = photo("jay_feather_fujifilm_e500.jpg");
    assert_eq!((jay.width, jay.height), (59, 100));
    assert!(jay.exif.relative_exposure().is_some() && jay.exif.focal_length_mm.is_some(), "{:?}", jay.exif);
    assert_eq!(jay.exif.colour_space, Some(ExifColourSpace::Srgb));
    assert!(jay.coding.contains("EXIF says sRGB"), "{}", jay.coding);
}

#[test]
#[cfg_attr(not(barbule_data), ignore = "set BARBULE_DATA to the folder of measurements")]
fn a_plate_with_primaries_and_no_curve_says_what_was_assumed() {
    let plate = photo("roseate_spoonbill_wing_feathers.png");
    assert_eq!((plate.width, plate.height), (800, 446));
    assert!(plate.notes.iter().any(|note| note.contains("not its curve")), "{:?}", plate.notes);
}
