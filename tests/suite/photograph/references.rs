//! From light to reflectance, and exposures against each other.

use barbule::measure::photograph::{Photograph, Rectangle, Reference, relative_exposures};
use exif::{Rational, Tag, Value};
use image::ExtendedColorType;

use super::files::{exif_of, png_of};
use super::{assert_close, read};

/// A row of eight pixels: a bluish grey card of four, then feather.
fn picture(card: [[u8; 3]; 4]) -> Photograph {
    let pixels = [card.as_slice(), &[[30, 60, 20]; 4]].concat();
    read(&png_of(&pixels.concat(), (8, 1), ExtendedColorType::Rgb8, None), "card.png")
}

const CARD: Rectangle = Rectangle { x_px: 0, y_px: 0, width_px: 4, height_px: 1 };

#[test]
fn a_grey_card_becomes_its_reflectance_on_average() {
    let photograph = picture([[100, 110, 130], [104, 110, 126], [96, 112, 131], [100, 108, 133]]);
    let gain = Reference::Patch { rectangle: CARD, reflectance: 0.18 }.gain(&photograph, None).unwrap().unwrap();
    assert_eq!((gain.pixels, gain.left_out), (4, 0));
    assert!(gain.spread.iter().all(|spread| *spread > 0.0 && *spread < 0.1), "{:?}", gain.spread);
    let scaled = photograph.scaled(gain.gain);
    let mean = [0, 1, 2].map(|channel| scaled.pixels[..4].iter().map(|pixel| pixel[channel]).sum::<f32>() / 4.0);
    // Rounding of 32-bit numbers.
    assert_close(mean, [0.18; 3], 1e-7);

    let background: Vec<bool> = (0..8).map(|place| place < 4).collect();
    let photograph = picture([[100, 110, 130], [104, 110, 126], [96, 112, 131], [100, 108, 133]]);
    let same = Reference::Background { reflectance: 0.18 }.gain(&photograph, Some(&background)).unwrap().unwrap();
    assert_eq!(same, gain);
    assert_eq!(Reference::Free.gain(&photograph, None), Ok(None));
}

#[test]
fn a_reference_that_cannot_serve_is_refused() {
    let even = picture([[100; 3]; 4]);
    let sentence = |photograph: &Photograph, reference: Reference| {
        reference.gain(photograph, None).expect_err("this reference cannot serve").to_string()
    };
    let clipped = sentence(&picture([[255, 90, 90]; 4]), Reference::Patch { rectangle: CARD, reflectance: 0.9 });
    assert!(clipped.contains("4 pixels, of which 4 are clipped"), "{clipped}");
    let black = sentence(&picture([[0, 90, 90]; 4]), Reference::Patch { rectangle: CARD, reflectance: 0.9 });
    assert!(black.contains("black in a channel"), "{black}");
    for reflectance in [0.0, -1.0, 1.5, f64::NAN] {
        let text = sentence(&even, Reference::Patch { rectangle: CARD, reflectance });
        assert!(text.contains("above 0 and at most 1"), "{text}");
    }
    let out = sentence(&even, Reference::Patch { rectangle: Rectangle { x_px: 5, ..CARD }, reflectance: 0.5 });
    assert!(out.contains("x 5 y 0, 4 × 1 pixels reaches out of the picture, which has 8 × 1 pixels"), "{out}");
    let unknown = sentence(&even, Reference::Background { reflectance: 0.5 });
    assert!(unknown.contains("give a patch"), "{unknown}");
}

fn exposed(time: (u32, u32), f_number: (u32, u32), iso: u16) -> Photograph {
    let fraction = |(num, denom)| Value::Rational(vec![Rational { num, denom }]);
    let exif = exif_of(&[
        (Tag::ExposureTime, fraction(time)),
        (Tag::FNumber, fraction(f_number)),
        (Tag::PhotographicSensitivity, Value::Short(vec![iso])),
    ]);
    read(&png_of(&[7], (1, 1), ExtendedColorType::L8, Some(exif)), "a.png")
}

#[test]
fn exposures_follow_time_aperture_and_sensitivity() {
    // Twice the time; half the aperture's diameter, a quarter of its area; four times the sensitivity.
    let photographs =
        [exposed((1, 80), (28, 10), 100), exposed((1, 40), (28, 10), 100), exposed((1, 80), (56, 10), 400)];
    let ratios = relative_exposures(&photographs.iter().collect::<Vec<_>>()).unwrap();
    for (found, expected) in ratios.iter().zip([1.0, 2.0, 1.0]) {
        assert!((found - expected).abs() < 1e-12, "{ratios:?}");
    }
    let bare = read(&png_of(&[7], (1, 1), ExtendedColorType::L8, None), "bare.png");
    let sentence = relative_exposures(&[&photographs[0], &bare]).unwrap_err().to_string();
    assert!(sentence.contains("bare.png") && sentence.contains("the exposure time and the aperture"), "{sentence}");
}
