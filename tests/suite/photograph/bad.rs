//! Photographs that are none, or not whole, or lie: a sentence each, and never a panic.

use std::io::Cursor;
use std::path::Path;

use barbule::measure::photograph::{Camera, Photograph, PhotographOptions};
use exif::{Rational, Tag, Value};
use image::codecs::openexr::OpenExrEncoder;
use image::codecs::png::PngEncoder;
use image::codecs::tiff::TiffEncoder;
use image::{ExtendedColorType, ImageEncoder};
use moxcms::ColorProfile;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::files::{exif_of, png_of};
use super::{read, refusal};

fn jpeg() -> Vec<u8> {
    let light: Vec<[f32; 3]> = (0..32 * 24u16).map(|place| [f32::from(place) / 800.0, 0.3, 0.5]).collect();
    Camera::default().photograph(&light, 32).unwrap()
}

fn tiff(kind: ExtendedColorType, bytes: &[u8]) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    TiffEncoder::new(&mut file).write_image(bytes, 4, 2, kind).unwrap();
    file.into_inner()
}

fn exr() -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    OpenExrEncoder::new(&mut file).write_image(&[0; 4 * 2 * 12], 4, 2, ExtendedColorType::Rgb32F).unwrap();
    file.into_inner()
}

fn png_with_everything() -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = PngEncoder::new(&mut file);
    encoder.set_icc_profile(ColorProfile::new_display_p3().encode().unwrap()).unwrap();
    encoder.set_exif_metadata(exif_of(&[(Tag::Orientation, Value::Short(vec![6]))])).unwrap();
    encoder.write_image(&[77; 4 * 4 * 2], 4, 2, ExtendedColorType::Rgba8).unwrap();
    file
}

#[test]
fn whole_files_end_and_cut_ones_are_told_apart() {
    for (file, name, format) in [
        (jpeg(), "a.jpg", "JPEG"),
        (png_with_everything(), "a.png", "PNG"),
        (tiff(ExtendedColorType::Rgb16, &[9; 4 * 2 * 6]), "a.tif", "TIFF"),
        (exr(), "a.exr", "EXR"),
    ] {
        read(&file, name);
        for share in [0.3, 0.6, 0.9] {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a length")]
            let kept = (share * file.len() as f64) as usize;
            let text = refusal(&file[..kept], name);
            assert!(text.starts_with(&format!("{name}: ")) && text.contains(format), "{text}");
        }
    }
    // Two bytes short, in the last marker: the decoder itself would not mind.
    let file = jpeg();
    let text = refusal(&file[..file.len() - 2], "a.jpg");
    assert!(text.contains("ends before its last row"), "{text}");
}

#[test]
fn names_that_lie_are_noted_and_other_files_are_named() {
    let photograph = read(&png_of(&[7], (1, 1), ExtendedColorType::L8, None), "a.jpg");
    assert!(
        photograph.notes.iter().any(|note| note.contains("ends in .jpg, but it is a PNG")),
        "{:?}",
        photograph.notes
    );
    assert!(refusal(b"a,b\n1,2\n", "table.jpg").contains("found text, expected a JPEG, PNG, TIFF or EXR"));
    assert!(refusal(b"GIF89a\x01\x00\x01\x00", "a.gif").contains("found a Gif file"));
    assert!(refusal(b"%PDF-1.4", "a.pdf").contains("found a PDF"));
    assert!(refusal(b"\0\0\0\x18ftypheic", "a.heic").contains("HEIC"));
    assert!(refusal(&[0, 1, 2, 3, 200], "a.png").contains("bytes of no known format"));
    assert!(refusal(b"", "a.png").contains("the file is empty"));
    // Raw files begin like a TIFF, and the first picture in them is a thumbnail.
    assert!(refusal(&tiff(ExtendedColorType::Rgb8, &[9; 24]), "DSC_0001.NEF").contains("raw file"));
}

#[test]
fn what_is_no_file_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let sentence = |path: &Path| Photograph::read(path, &PhotographOptions::default()).unwrap_err().to_string();
    assert!(sentence(folder.path()).contains("found a folder"));
    assert!(sentence(&folder.path().join("none.jpg")).contains("there is no such file"));
}

#[test]
fn inks_are_no_light() {
    // Start of image, a frame of four channels, and nothing else.
    let frame = [0xFF, 0xC0, 0, 20, 8, 0, 8, 0, 8, 4, 1, 0x11, 0, 2, 0x11, 0, 3, 0x11, 0, 4, 0x11, 0];
    let jpeg = [&[0xFF, 0xD8], frame.as_slice(), &[0xFF, 0xD9]].concat();
    assert!(refusal(&jpeg, "a.jpg").contains("found inks (CMYK)"));

    // A TIFF of one pixel: tag, kind (3: 16 bits, 4: 32 bits), count, value.
    let tags: [(u16, u16, u32, u32); 9] = [
        (256, 3, 1, 1),   // width
        (257, 3, 1, 1),   // height
        (258, 3, 4, 122), // bits a channel, behind the directory
        (259, 3, 1, 1),   // not compressed
        (262, 3, 1, 5),   // inks
        (273, 4, 1, 130), // where the pixels are
        (277, 3, 1, 4),   // channels
        (278, 3, 1, 1),   // rows a strip
        (279, 4, 1, 4),   // bytes of the strip
    ];
    let mut tiff = b"II*\0\x08\0\0\0\x09\0".to_vec();
    for (tag, kind, count, value) in tags {
        tiff.extend(tag.to_le_bytes());
        tiff.extend(kind.to_le_bytes());
        tiff.extend(count.to_le_bytes());
        tiff.extend(value.to_le_bytes());
    }
    tiff.extend([0; 4]);
    assert_eq!(tiff.len(), 122);
    tiff.extend([8, 0, 8, 0, 8, 0, 8, 0, 10, 20, 30, 40]);
    assert!(refusal(&tiff, "a.tif").contains("found inks (CMYK)"));
}

/// 900 million pixels in a hundred bytes: refused by the header, before memory is asked for.
#[test]
fn a_picture_too_large_to_hold_is_refused_by_its_header() {
    let mut file = Vec::new();
    {
        let mut encoder = png::Encoder::new(&mut file, 30_000, 30_000);
        encoder.set_color(png::ColorType::Rgb);
        encoder.write_header().unwrap().write_chunk(png::chunk::IDAT, &[0x78, 0x9C, 3, 0]).unwrap();
    }
    let text = refusal(&file, "bomb.png");
    assert!(text.contains("30000 × 30000 pixels, and at most 120000000"), "{text}");

    let mut jpeg = jpeg();
    let frame = jpeg.windows(2).position(|pair| pair == [0xFF, 0xC0]).unwrap();
    jpeg[frame + 5..frame + 9].copy_from_slice(&[0xEA, 0x60, 0xEA, 0x60]);
    let text = refusal(&jpeg, "bomb.jpg");
    assert!(text.contains("60000 × 60000 pixels"), "{text}");
}

#[test]
fn one_pixel_is_a_picture() {
    let photograph = read(&png_of(&[1, 2, 3], (1, 1), ExtendedColorType::Rgb8, None), "a.png");
    assert_eq!((photograph.width, photograph.height, photograph.pixels.len()), (1, 1, 1));
}

#[test]
fn exif_that_runs_in_circles_or_lies_is_left_out_and_the_picture_read() {
    let with = |chunk: Vec<u8>| read(&png_of(&[7], (1, 1), ExtendedColorType::L8, Some(chunk)), "a.png");

    // A directory of one entry whose successor is itself, and one whose EXIF directory is itself.
    let entry = |tag: u16, value: u32| [&tag.to_le_bytes()[..], &[4, 0, 1, 0, 0, 0], &value.to_le_bytes()].concat();
    let directory = |entry: &[u8], next: u32| [b"II*\0\x08\0\0\0\x01\0", entry, &next.to_le_bytes()].concat();
    for chunk in [directory(&entry(256, 1), 8), directory(&entry(0x8769, 8), 0), directory(&entry(0x8769, 8), 8)] {
        let photograph = with(chunk);
        assert!(photograph.notes.iter().any(|note| note.contains("EXIF cannot be read")), "{:?}", photograph.notes);
    }
    assert!(with(b"no EXIF at all".to_vec()).notes.iter().any(|note| note.contains("EXIF cannot be read")));

    let fraction = |num, denom| Value::Rational(vec![Rational { num, denom }]);
    let photograph = with(exif_of(&[
        (Tag::ExposureTime, fraction(1, 0)),
        (Tag::FNumber, fraction(0, 10)),
        (Tag::PhotographicSensitivity, Value::Short(vec![0])),
        (Tag::FocalLength, fraction(0, 0)),
        (Tag::Orientation, Value::Short(vec![9])),
        (Tag::Make, Value::Ascii(vec![b"\x07\x1b[31mred".to_vec()])),
    ]));
    let exif = &photograph.exif;
    assert_eq!((exif.exposure_time_s, exif.f_number, exif.iso, exif.focal_length_mm), (None, None, None, None));
    assert_eq!((exif.orientation, exif.relative_exposure()), (None, None));
    for name in ["exposure time", "aperture", "sensitivity", "focal length", "orientation"] {
        assert!(photograph.notes.iter().any(|note| note.contains(name)), "{name}: {:?}", photograph.notes);
    }
    assert_eq!(exif.maker.as_deref(), Some("[31mred"), "what does not print is not printed");
}

/// Small files of every kind, to be spoiled.
fn seeds() -> Vec<Vec<u8>> {
    vec![
        jpeg(),
        png_with_everything(),
        png_of(&[5; 4 * 2 * 2], (4, 2), ExtendedColorType::L16, None),
        tiff(ExtendedColorType::Rgb8, &[9; 24]),
        tiff(ExtendedColorType::Rgb32F, &[0; 96]),
        exr(),
    ]
}

/// A seed with some bytes changed, cut out or doubled.
fn spoiled(seeds: &[Vec<u8>], number: u64) -> Vec<u8> {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    random.set_stream(number);
    let mut bytes = seeds[random.random_range(0..seeds.len())].clone();
    for _ in 0..random.random_range(1..=4) {
        if bytes.len() < 2 {
            break;
        }
        let at = random.random_range(0..bytes.len());
        match random.random_range(0..6) {
            0 => bytes[at] = random.random(),
            1 => bytes[at] ^= 1 << random.random_range(0..8),
            2 => bytes[at] = [0, 1, 0x7F, 0x80, 0xFF][random.random_range(0..5)],
            3 => bytes.truncate(at),
            4 => {
                let end = (at + random.random_range(1..16)).min(bytes.len());
                bytes.drain(at..end);
            }
            _ => {
                let end = (at + random.random_range(1..16)).min(bytes.len());
                let doubled = bytes[at..end].to_vec();
                bytes.splice(at..at, doubled);
            }
        }
    }
    bytes
}

/// Reads spoiled files: each is a picture of as many pixels as it says, or a sentence.
fn read_spoiled(count: u64) {
    let seeds = seeds();
    let refused = (0..count)
        .into_par_iter()
        .filter(|number| {
            let bytes = spoiled(&seeds, *number);
            match Photograph::from_bytes(&bytes, Path::new("spoiled"), &PhotographOptions::default()) {
                Ok(photograph) => {
                    assert_eq!(photograph.pixels.len(), photograph.width * photograph.height, "file {number}");
                    assert_eq!(photograph.validity.len(), photograph.pixels.len(), "file {number}");
                    false
                }
                Err(error) => {
                    let text = error.to_string();
                    assert!(text.starts_with("spoiled: ") && text.len() > 30, "file {number}: {text}");
                    true
                }
            }
        })
        .count() as u64;
    // Most changes meet something that matters, and some do not: a test that saw only one kind would see nothing.
    assert!(refused > count / 10 && refused < count, "{refused} of {count} refused");
    println!("{refused} of {count} spoiled files refused, the others read");
}

#[test]
fn twenty_thousand_spoiled_files_are_read_or_refused() {
    read_spoiled(20_000);
}

#[test]
#[ignore = "long: run by .ci/long"]
fn a_million_spoiled_files_are_read_or_refused() {
    read_spoiled(1_000_000);
}
