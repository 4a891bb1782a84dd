//! The camera that never was: what it writes is read back as the light that went in.

use barbule::measure::colour::{decode, encode};
use barbule::measure::photograph::{Camera, Validity};

use super::read;

/// Light that is even over blocks of 8 × 8 pixels, so that a JPEG keeps it.
fn blocks(lights: &[[f32; 3]]) -> (Vec<[f32; 3]>, usize) {
    let width = 8 * lights.len();
    ((0..8 * width).map(|place| lights[place % width / 8]).collect(), width)
}

#[test]
fn light_comes_back_within_the_steps_of_its_codes() {
    let lights: Vec<[f32; 3]> = (1..12u8).map(|step| [f32::from(step) / 12.0; 3]).collect();
    let (light, width) = blocks(&lights);
    let camera = Camera { jpeg_quality: 100, ..Camera::default() };
    let photograph = read(&camera.photograph(&light, width).unwrap(), "a.jpg");
    assert_eq!((photograph.width, photograph.height), (width, 8));
    for (found, put) in photograph.pixels.iter().zip(&light) {
        let code = 255.0 * encode(put[0].into());
        // A code is rounded when written, and once more by the JPEG.
        let [low, high] = [-1.0, 1.0].map(|off| decode((code + off) / 255.0));
        assert!(found.iter().all(|channel| (low..=high).contains(&f64::from(*channel))), "{found:?} for {put:?}");
    }
}

#[test]
fn its_exif_says_that_it_is_synthetic_and_how_it_exposed() {
    let camera =
        Camera { exposure_time_s: 1.0 / 250.0, f_number: 5.6, iso: 200, focal_length_mm: 105.0, ..Camera::default() };
    let photograph = read(&camera.photograph(&[[0.5; 3]; 64], 8).unwrap(), "a.jpg");
    let exif = &photograph.exif;
    assert!(exif.description.as_ref().unwrap().starts_with("Synthetic photograph"), "{exif:?}");
    assert_eq!(exif.camera.as_deref(), Some("synthetic camera"));
    assert_eq!(
        (exif.exposure_time_s, exif.f_number, exif.iso, exif.focal_length_mm),
        (Some(0.004), Some(5.6), Some(200.0), Some(105.0))
    );
    assert!(photograph.coding.contains("EXIF says sRGB"), "{}", photograph.coding);
}

#[test]
fn corners_lose_what_vignetting_says() {
    let camera = Camera { vignetting: 0.5, jpeg_quality: 100, ..Camera::default() };
    let width = 160;
    let photograph = read(&camera.photograph(&vec![[0.8; 3]; width * width], width).unwrap(), "a.jpg");
    for (place, pixel) in photograph.pixels.iter().enumerate() {
        let [x, y] = [place % width, place / width].map(|at| (at as f64 + 0.5) / 80.0 - 1.0);
        let expected = 0.8 * (1.0 - 0.5 * (x * x + y * y) / 2.0);
        // Two codes: one of rounding, one of the JPEG's.
        let off = 255.0 * (encode(pixel[1].into()) - encode(expected)).abs();
        assert!(off <= 2.0, "{off} codes off at {place}");
    }
}

/// Electrons scatter by the root of their number; reading adds its own.
#[test]
fn noise_has_the_variance_of_its_electrons() {
    let (white, read_noise, light, count) = (2000.0, 20.0, 0.4f32, 128 * 128);
    let camera =
        Camera { white_electrons: white, read_noise_electrons: read_noise, jpeg_quality: 100, ..Camera::default() };
    let file = camera.photograph(&vec![[light; 3]; count], 128).unwrap();
    // A JPEG averages colour over neighbours and keeps brightness: Y′ of ITU-T T.871, of three channels that scatter apart.
    let weights = [0.299, 0.587, 0.114];
    let brightness: Vec<f64> = read(&file, "a.jpg")
        .pixels
        .iter()
        .map(|pixel| pixel.iter().zip(weights).map(|(channel, weight)| weight * encode(f64::from(*channel))).sum())
        .collect();
    let mean = brightness.iter().sum::<f64>() / count as f64;
    let variance = brightness.iter().map(|code| (code - mean).powi(2)).sum::<f64>() / count as f64;
    let put = f64::from(light);
    let slope = 1.055 / 2.4 * put.powf(1.0 / 2.4 - 1.0);
    let of_light = (put * white + read_noise * read_noise) / (white * white);
    let expected = slope * slope * of_light * weights.map(|weight| weight * weight).iter().sum::<f64>();
    // The encoder cuts each of a block's 64 coefficients down to a whole code: of a number x that scatters by s, what is
    // left has the mean square s² − E|x| + 1/3, where E|x| = s √(2/π).
    let codes = 255.0 * expected.sqrt();
    let left = codes * codes - codes * (2.0 / std::f64::consts::PI).sqrt() + 1.0 / 3.0;
    // Five standard errors of a variance of as many numbers, the curve's bend over one deviation (a thousandth), and a
    // code's rounding, once a channel, once as brightness and colour, and once more as channels.
    let allowed = codes * codes * (5.0 * (2.0 / count as f64).sqrt() + 1e-3) + 3.0 / 12.0;
    let found = 255.0 * 255.0 * variance;
    assert!((found - left).abs() < allowed, "found {found}, expected {left}, allowed {allowed}");
    // Half the second derivative times the variance moves the mean by 1e-4.
    let off = (mean - encode(put)).abs();
    assert!(off < 5.0 * (expected / count as f64).sqrt() + 2e-4, "the mean is {off:e} off");

    assert_eq!(file, camera.photograph(&vec![[light; 3]; count], 128).unwrap(), "the same seed gives the same bytes");
    let other = Camera { seed: 2, ..camera };
    assert_ne!(file, other.photograph(&vec![[light; 3]; count], 128).unwrap());
}

#[test]
fn contrast_bends_the_curve_as_it_says() {
    let lights: Vec<[f32; 3]> = (1..10u8).map(|step| [f32::from(step) / 10.0; 3]).collect();
    let (light, width) = blocks(&lights);
    let camera = Camera { contrast: 0.6, jpeg_quality: 100, ..Camera::default() };
    let photograph = read(&camera.photograph(&light, width).unwrap(), "a.jpg");
    for (found, put) in photograph.pixels.iter().zip(&light) {
        let code = encode(put[0].into());
        let bent = code - 0.6 * (std::f64::consts::TAU * code).sin() / std::f64::consts::TAU;
        let off = 255.0 * (encode(found[0].into()) - bent).abs();
        assert!(off <= 1.5, "{off} codes off for {put:?}");
    }
}

#[test]
fn more_than_white_is_clipped_and_senseless_settings_are_refused() {
    let camera = Camera { exposure: 4.0, ..Camera::default() };
    let photograph = read(&camera.photograph(&[[0.5; 3]; 64], 8).unwrap(), "a.jpg");
    assert!(photograph.validity.iter().all(|validity| *validity == Validity::Clipped));

    let refused = |camera: Camera, width: usize| camera.photograph(&[[0.5; 3]; 64], width).unwrap_err().to_string();
    let text = refused(Camera { contrast: 1.0, ..Camera::default() }, 8);
    assert!(text.contains("contrast: found 1, expected a number between -1 and 1"), "{text}");
    let text = refused(Camera { vignetting: f64::NAN, ..Camera::default() }, 8);
    assert!(text.contains("vignetting"), "{text}");
    let text = refused(Camera { jpeg_quality: 0, ..Camera::default() }, 8);
    assert!(text.contains("jpeg_quality"), "{text}");
    let text = refused(Camera::default(), 7);
    assert!(text.contains("64 pixels in rows of 7"), "{text}");
}
