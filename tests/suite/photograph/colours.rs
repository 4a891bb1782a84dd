//! What the file says of its colours is done: ICC profiles, a PNG's chunks, EXIF.

use std::path::Path;

use barbule::measure::colour::decode;
use barbule::measure::photograph::{Encoding, Photograph, PhotographOptions};
use exif::{Tag, Value};
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};
use moxcms::ColorProfile;
use nalgebra::{Matrix3, Vector3};

use super::files::{exif_of, png_of};
use super::{assert_close, read};

const D65: [f64; 2] = [0.3127, 0.3290];
const REC_709: [[f64; 2]; 3] = [[0.64, 0.33], [0.30, 0.60], [0.15, 0.06]];
/// SMPTE EG 432-1.
const DISPLAY_P3: [[f64; 2]; 3] = [[0.680, 0.320], [0.265, 0.690], [0.150, 0.060]];
/// Adobe RGB (1998) Color Image Encoding, 4.3.1.
const ADOBE_RGB: [[f64; 2]; 3] = [[0.64, 0.33], [0.21, 0.71], [0.15, 0.06]];

/// From RGB of these primaries to XYZ: columns of the primaries, scaled so that their sum is the white.
fn to_xyz(primaries: [[f64; 2]; 3], white: [f64; 2]) -> Matrix3<f64> {
    let column = |[x, y]: [f64; 2]| Vector3::new(x / y, 1.0, (1.0 - x - y) / y);
    let matrix = Matrix3::from_columns(&primaries.map(column));
    let scale = matrix.try_inverse().unwrap() * column(white);
    matrix * Matrix3::from_diagonal(&scale)
}

/// To Rec. 709 from primaries with the same white.
fn to_rec_709(primaries: [[f64; 2]; 3]) -> Matrix3<f64> {
    to_xyz(REC_709, D65).try_inverse().unwrap() * to_xyz(primaries, D65)
}

const CODES: [[u8; 3]; 5] = [[200, 100, 50], [10, 240, 30], [0, 0, 254], [128, 128, 128], [3, 2, 1]];

fn png_with_profile(profile: Vec<u8>) -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = PngEncoder::new(&mut file);
    encoder.set_icc_profile(profile).unwrap();
    encoder.write_image(&CODES.concat(), 5, 1, ExtendedColorType::Rgb8).unwrap();
    file
}

#[track_caller]
fn assert_colours(photograph: &Photograph, curve: impl Fn(f64) -> f64, matrix: Matrix3<f64>, tolerance: f64) {
    for (pixel, codes) in photograph.pixels.iter().zip(CODES) {
        let own = Vector3::from(codes.map(|code| curve(f64::from(code) / 255.0)));
        assert_close(*pixel, (matrix * own).into(), tolerance);
    }
}

/// A profile holds numbers in steps of 1.5e-5, which the way back to RGB multiplies by up to 3, thrice in a row of its matrix;
/// as much comes from white being adapted to D50 by a matrix of four decimals, and back.
const PROFILE: f64 = 3e-4;

#[test]
fn an_srgb_profile_changes_nothing() {
    let with = read(&png_with_profile(ColorProfile::new_srgb().encode().unwrap()), "a.png");
    assert_colours(&with, decode, Matrix3::identity(), PROFILE);
    assert!(with.coding.contains("ICC profile \"sRGB IEC61966-2.1\""), "{}", with.coding);
    assert!(!with.notes.iter().any(|note| note.contains("taken as sRGB")), "{:?}", with.notes);
}

#[test]
fn wide_profiles_give_the_light_of_their_primaries() {
    let p3 = read(&png_with_profile(ColorProfile::new_display_p3().encode().unwrap()), "a.png");
    assert_colours(&p3, decode, to_rec_709(DISPLAY_P3), PROFILE);
    // Light beyond Rec. 709 is negative in a channel, not cut off.
    assert!(p3.pixels[1][0] < -0.01, "{:?}", p3.pixels[1]);

    // Adobe RGB (1998), 4.3.4.2: the exponent is 2 51/256.
    let adobe = read(&png_with_profile(ColorProfile::new_adobe_rgb().encode().unwrap()), "a.png");
    assert_colours(&adobe, |code| code.powf(2.0 + 51.0 / 256.0), to_rec_709(ADOBE_RGB), PROFILE);
}

#[test]
fn adobe_rgb_by_exif_is_the_profile() {
    let fields = [
        (Tag::ColorSpace, Value::Short(vec![65535])),
        (Tag::InteroperabilityIndex, Value::Ascii(vec![b"R03".to_vec()])),
    ];
    let photograph = read(&png_of(&CODES.concat(), (5, 1), ExtendedColorType::Rgb8, Some(exif_of(&fields))), "a.png");
    assert_colours(&photograph, |code| code.powf(2.0 + 51.0 / 256.0), to_rec_709(ADOBE_RGB), PROFILE);
    assert!(photograph.coding.contains("Adobe RGB"), "{}", photograph.coding);

    let uncalibrated =
        read(&png_of(&CODES.concat(), (5, 1), ExtendedColorType::Rgb8, Some(exif_of(&fields[..1]))), "a.png");
    assert_colours(&uncalibrated, decode, Matrix3::identity(), 1e-7);
    assert!(uncalibrated.notes.iter().any(|note| note.contains("uncalibrated")), "{:?}", uncalibrated.notes);
}

fn png_with_chunks(gamma: Option<f32>, primaries: Option<[[f64; 2]; 3]>) -> Vec<u8> {
    let mut file = Vec::new();
    {
        let mut encoder = png::Encoder::new(&mut file, 5, 1);
        encoder.set_color(png::ColorType::Rgb);
        if let Some(gamma) = gamma {
            encoder.set_source_gamma(png::ScaledFloat::new(gamma));
        }
        if let Some(primaries) = primaries {
            #[expect(clippy::cast_possible_truncation, reason = "the crate's type")]
            let [white, red, green, blue] =
                [D65, primaries[0], primaries[1], primaries[2]].map(|[x, y]| (x as f32, y as f32));
            encoder.set_source_chromaticities(png::SourceChromaticities::new(white, red, green, blue));
        }
        encoder.write_header().unwrap().write_image_data(&CODES.concat()).unwrap();
    }
    file
}

/// Chromaticities have five decimals, and the matrix multiplies their errors by less than 10.
const CHUNK: f64 = 1e-4;

#[test]
fn chunks_of_a_png_say_curve_and_primaries() {
    let both = read(&png_with_chunks(Some(0.5), Some(DISPLAY_P3)), "a.png");
    assert_colours(&both, |code| code * code, to_rec_709(DISPLAY_P3), CHUNK);
    assert!(both.coding.contains("gAMA") && both.coding.contains("cHRM"), "{}", both.coding);

    // As the plate of the spoonbill: sRGB's primaries, and nothing else.
    let primaries = read(&png_with_chunks(None, Some(REC_709)), "a.png");
    assert_colours(&primaries, decode, Matrix3::identity(), 1e-7);
    assert!(primaries.notes.iter().any(|note| note.contains("not its curve")), "{:?}", primaries.notes);

    let curve = read(&png_with_chunks(Some(1.0), None), "a.png");
    assert_colours(&curve, |code| code, Matrix3::identity(), 1e-7);
    assert!(curve.notes.iter().any(|note| note.contains("not its primaries")), "{:?}", curve.notes);
}

#[test]
fn the_users_word_goes_first() {
    let options = PhotographOptions { encoding: Some(Encoding::Linear), ..PhotographOptions::default() };
    let file = png_with_profile(ColorProfile::new_adobe_rgb().encode().unwrap());
    let photograph = Photograph::from_bytes(&file, Path::new("a.png"), &options).unwrap();
    assert_colours(&photograph, |code| code, Matrix3::identity(), 1e-7);
    assert!(photograph.notes.iter().any(|note| note.contains("set aside")), "{:?}", photograph.notes);
}

#[test]
fn a_grey_profile_gives_its_curve_and_others_are_refused() {
    let mut file = Vec::new();
    let mut encoder = PngEncoder::new(&mut file);
    encoder.set_icc_profile(ColorProfile::new_gray_with_gamma(2.0).encode().unwrap()).unwrap();
    encoder.write_image(&[51], 1, 1, ExtendedColorType::L8).unwrap();
    // Curves of one exponent hold it in steps of 1/256; 2 is exact.
    assert_close(read(&file, "a.png").pixels[0], [0.04; 3], 1e-6);

    let refused = super::refusal(&png_with_profile(ColorProfile::new_gray_with_gamma(2.0).encode().unwrap()), "a.png");
    assert!(refused.contains("three channels") && refused.contains("convert the picture to sRGB"), "{refused}");
    let refused = super::refusal(&png_with_profile(vec![1; 200]), "a.png");
    assert!(refused.contains("ICC profile cannot be read"), "{refused}");
}
