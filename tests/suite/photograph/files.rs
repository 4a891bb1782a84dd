//! Formats, orientation, masks and scale.

use std::io::Cursor;
use std::path::Path;

use barbule::measure::colour::decode;
use barbule::measure::photograph::{
    Photograph, PhotographOptions, Rectangle, Regions, Scale, Validity, ValidityCounts,
};
use exif::experimental::Writer;
use exif::{Field, In, Rational, Tag, Value};
use image::codecs::openexr::OpenExrEncoder;
use image::codecs::png::PngEncoder;
use image::codecs::tiff::TiffEncoder;
use image::{ExtendedColorType, ImageEncoder};
use proptest::prelude::*;

use super::super::oracle::Oracle;
use super::{assert_close, read};

/// Half a step of a 32-bit number just below 1.
const SINGLE: f64 = 3e-8;

pub(super) fn exif_of(fields: &[(Tag, Value)]) -> Vec<u8> {
    let fields: Vec<Field> =
        fields.iter().map(|(tag, value)| Field { tag: *tag, ifd_num: In::PRIMARY, value: value.clone() }).collect();
    let mut writer = Writer::new();
    fields.iter().for_each(|field| writer.push_field(field));
    let mut chunk = Cursor::new(Vec::new());
    writer.write(&mut chunk, false).unwrap();
    chunk.into_inner()
}

pub(super) fn png_of(bytes: &[u8], size: (u32, u32), kind: ExtendedColorType, exif: Option<Vec<u8>>) -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = PngEncoder::new(&mut file);
    if let Some(chunk) = exif {
        encoder.set_exif_metadata(chunk).unwrap();
    }
    encoder.write_image(bytes, size.0, size.1, kind).unwrap();
    file
}

fn native(words: &[u16]) -> Vec<u8> {
    words.iter().flat_map(|word| word.to_ne_bytes()).collect()
}

/// The sRGB curve of an independent program, through a 16-bit PNG.
#[test]
fn a_png_of_16_bits_gives_the_light_of_its_codes() {
    let oracle = Oracle::read("tests/oracles/color_srgb_transfer.csv");
    let rows: Vec<(f64, f64)> = (0..oracle.rows.len())
        .map(|row| (oracle.number(row, "encoded"), oracle.number(row, "linear")))
        .filter(|(code, _)| (0.0..1.0).contains(code))
        .collect();
    assert!(rows.len() > 20, "the table holds codes within 0 and 1");
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 0 to 65535")]
    let words: Vec<u16> = rows.iter().flat_map(|(code, _)| [(code * 65535.0).round() as u16; 3]).collect();
    let width = u32::try_from(rows.len()).unwrap();
    let photograph = read(&png_of(&native(&words), (width, 1), ExtendedColorType::Rgb16, None), "a.png");
    for (pixel, (_, linear)) in photograph.pixels.iter().zip(&rows) {
        // The code was rounded by half a step; the curve rises by at most 2.28.
        assert_close(*pixel, [*linear; 3], 2.28 * 0.5 / 65535.0 + SINGLE);
    }
    assert!(photograph.notes.iter().any(|note| note.contains("taken as sRGB")), "{:?}", photograph.notes);
}

#[test]
fn an_exr_and_a_floating_tiff_come_back_bit_by_bit() {
    let light: Vec<f32> = vec![0.0, 0.25, 1.0, 7.5, -0.125, 1e-7, 3.0, 0.5, f32::MIN_POSITIVE, 0.1, 0.2, 0.3];
    let bytes: Vec<u8> = light.iter().flat_map(|number| number.to_ne_bytes()).collect();
    let (mut exr, mut tiff) = (Cursor::new(Vec::new()), Cursor::new(Vec::new()));
    OpenExrEncoder::new(&mut exr).write_image(&bytes, 2, 2, ExtendedColorType::Rgb32F).unwrap();
    TiffEncoder::new(&mut tiff).write_image(&bytes, 2, 2, ExtendedColorType::Rgb32F).unwrap();
    for (file, name) in [(exr, "a.exr"), (tiff, "a.tif")] {
        let photograph = read(&file.into_inner(), name);
        assert_eq!(photograph.pixels.concat(), light, "{name}");
        assert_eq!(photograph.counts(), ValidityCounts { valid: 4, ..ValidityCounts::default() }, "{name}");
    }
}

#[test]
fn a_tiff_of_8_and_16_bits_and_grey_are_read() {
    let mut file = Cursor::new(Vec::new());
    TiffEncoder::new(&mut file).write_image(&[10, 20, 30], 1, 1, ExtendedColorType::Rgb8).unwrap();
    let expected = [10.0, 20.0, 30.0].map(|code| decode(code / 255.0));
    assert_close(read(&file.into_inner(), "a.tiff").pixels[0], expected, SINGLE);

    let mut file = Cursor::new(Vec::new());
    TiffEncoder::new(&mut file).write_image(&native(&[1000]), 1, 1, ExtendedColorType::L16).unwrap();
    assert_close(read(&file.into_inner(), "a.tiff").pixels[0], [decode(1000.0 / 65535.0); 3], SINGLE);

    let grey = png_of(&[99, 255], (1, 1), ExtendedColorType::La8, None);
    assert_close(read(&grey, "a.png").pixels[0], [decode(99.0 / 255.0); 3], SINGLE);
}

#[test]
fn a_palette_gives_its_colours() {
    let mut file = Vec::new();
    {
        let mut encoder = png::Encoder::new(&mut file, 3, 1);
        encoder.set_color(png::ColorType::Indexed);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_palette(vec![0, 0, 0, 200, 100, 50, 1, 2, 3]);
        encoder.set_trns(vec![0, 255, 255]);
        encoder.write_header().unwrap().write_image_data(&[2, 1, 0]).unwrap();
    }
    let photograph = read(&file, "a.png");
    for (pixel, codes) in photograph.pixels.iter().zip([[1.0, 2.0, 3.0], [200.0, 100.0, 50.0]]) {
        assert_close(*pixel, codes.map(|code| decode(code / 255.0)), SINGLE);
    }
    assert_eq!(photograph.validity, [Validity::Valid, Validity::Valid, Validity::Transparent]);
}

/// Exif 2.32, 4.6.4 A: which side of the upright picture the first stored row and the first stored column are.
fn stored(upright: &[[u8; 3]], (width, height): (usize, usize), orientation: u8) -> (Vec<[u8; 3]>, (usize, usize)) {
    let size = if orientation < 5 { (width, height) } else { (height, width) };
    let mut stored = vec![[0; 3]; upright.len()];
    for y in 0..height {
        for x in 0..width {
            let (left, right, top, bottom) = (x, width - 1 - x, y, height - 1 - y);
            let (row, column) = match orientation {
                1 => (top, left),
                2 => (top, right),
                3 => (bottom, right),
                4 => (bottom, left),
                5 => (left, top),
                6 => (right, top),
                7 => (right, bottom),
                _ => (left, bottom),
            };
            stored[row * size.0 + column] = upright[y * width + x];
        }
    }
    (stored, size)
}

#[test]
fn every_orientation_gives_the_same_upright_picture() {
    let (width, height) = (5, 3);
    let upright: Vec<[u8; 3]> = (0..15u8).map(|place| [10 * place, 200 - 7 * place, 3 * place]).collect();
    let plain = read(&png_of(&upright.concat(), (5, 3), ExtendedColorType::Rgb8, None), "a.png");
    for orientation in 1..=8 {
        let (pixels, size) = stored(&upright, (width, height), orientation);
        let exif = exif_of(&[(Tag::Orientation, Value::Short(vec![orientation.into()]))]);
        let size = (u32::try_from(size.0).unwrap(), u32::try_from(size.1).unwrap());
        let turned = read(&png_of(&pixels.concat(), size, ExtendedColorType::Rgb8, Some(exif)), "a.png");
        assert_eq!((turned.width, turned.height), (width, height), "orientation {orientation}");
        assert_eq!(turned.pixels, plain.pixels, "orientation {orientation}");
        assert_eq!(turned.exif.orientation, Some(orientation));
    }
}

/// The same through a JPEG, whose blocks of 8 × 8 pixels of one colour come back within a code or two.
#[test]
fn a_jpeg_is_turned_upright_too() {
    let (blocks_across, blocks_down, block) = (3, 2, 8);
    let (width, height) = (blocks_across * block, blocks_down * block);
    let greys: [u8; 6] = [20, 60, 100, 140, 180, 220];
    let upright: Vec<[u8; 3]> = (0..width * height)
        .map(|place| [greys[(place / width / block) * blocks_across + place % width / block]; 3])
        .collect();
    for orientation in 1..=8 {
        let (pixels, size) = stored(&upright, (width, height), orientation);
        let mut file = Vec::new();
        let mut encoder = image::codecs::jpeg::JpegEncoder::new_with_quality(&mut file, 95);
        encoder.set_exif_metadata(exif_of(&[(Tag::Orientation, Value::Short(vec![orientation.into()]))])).unwrap();
        let (columns, rows) = (u32::try_from(size.0).unwrap(), u32::try_from(size.1).unwrap());
        encoder.write_image(&pixels.concat(), columns, rows, ExtendedColorType::Rgb8).unwrap();
        let photograph = read(&file, "a.jpg");
        assert_eq!((photograph.width, photograph.height), (width, height));
        for (pixel, code) in photograph.pixels.iter().zip(&upright) {
            let [low, high] = [-2.0, 2.0].map(|off| decode((f64::from(code[0]) + off) / 255.0));
            assert!(pixel.iter().all(|channel| (low..=high).contains(&f64::from(*channel))), "{pixel:?} for {code:?}");
        }
    }
}

#[test]
fn what_cannot_be_trusted_is_masked_with_its_reason() {
    let pixels = [[255, 0, 0, 255], [254, 254, 254, 255], [255, 255, 255, 0], [9, 9, 9, 254]];
    let photograph = read(&png_of(&pixels.concat(), (4, 1), ExtendedColorType::Rgba8, None), "a.png");
    use Validity::{Clipped, NotANumber, Transparent, Valid};
    assert_eq!(photograph.validity, [Clipped, Valid, Transparent, Transparent]);
    assert_eq!(photograph.counts(), ValidityCounts { valid: 1, clipped: 1, transparent: 2, not_a_number: 0 });

    let light = [f32::NAN, 0.0, 0.0, 2.0, 2.0, 2.0, 0.0, f32::INFINITY, 0.0];
    let bytes: Vec<u8> = light.iter().flat_map(|number| number.to_ne_bytes()).collect();
    let mut exr = Cursor::new(Vec::new());
    OpenExrEncoder::new(&mut exr).write_image(&bytes, 3, 1, ExtendedColorType::Rgb32F).unwrap();
    assert_eq!(read(&exr.into_inner(), "a.exr").validity, [NotANumber, Valid, NotANumber]);
}

#[test]
fn a_scan_takes_its_scale_from_the_file_and_a_photograph_does_not() {
    let scan = PhotographOptions { scale: Some(Scale::Scan), ..PhotographOptions::default() };
    let scale = |file: &[u8], options: &PhotographOptions| {
        Photograph::from_bytes(file, Path::new("a"), options).map(|p| p.pixels_per_mm)
    };

    // A PNG says it in pixels a metre.
    let mut file = Vec::new();
    {
        let mut encoder = png::Encoder::new(&mut file, 1, 1);
        encoder.set_color(png::ColorType::Grayscale);
        let dims = png::PixelDimensions { xppu: 11_811, yppu: 11_811, unit: png::Unit::Meter };
        encoder.set_pixel_dims(Some(dims));
        encoder.write_header().unwrap().write_image_data(&[7]).unwrap();
    }
    assert_eq!(scale(&file, &scan), Ok(Some(11.811)));
    assert_eq!(scale(&file, &PhotographOptions::default()), Ok(None));
    let ruler = PhotographOptions { scale: Some(Scale::PixelsPerMm(2.5)), ..PhotographOptions::default() };
    assert_eq!(scale(&file, &ruler), Ok(Some(2.5)));

    // A JPEG in dots an inch; 25.4 mm are one.
    let mut file = Vec::new();
    let mut encoder = image::codecs::jpeg::JpegEncoder::new(&mut file);
    encoder.set_pixel_density(image::codecs::jpeg::PixelDensity::dpi(254));
    encoder.write_image(&[7; 3], 1, 1, ExtendedColorType::Rgb8).unwrap();
    assert_eq!(scale(&file, &scan), Ok(Some(10.0)));

    // EXIF in pixels a centimetre.
    let per_cm = || Value::Rational(vec![Rational { num: 300, denom: 1 }]);
    let exif = exif_of(&[
        (Tag::XResolution, per_cm()),
        (Tag::YResolution, per_cm()),
        (Tag::ResolutionUnit, Value::Short(vec![3])),
    ]);
    assert_eq!(scale(&png_of(&[7], (1, 1), ExtendedColorType::L8, Some(exif)), &scan), Ok(Some(30.0)));

    let unknown = scale(&png_of(&[7], (1, 1), ExtendedColorType::L8, None), &scan).unwrap_err().to_string();
    assert!(unknown.contains("names no resolution"), "{unknown}");
    let none = PhotographOptions { scale: Some(Scale::PixelsPerMm(0.0)), ..PhotographOptions::default() };
    let sentence = scale(&file, &none).unwrap_err().to_string();
    assert!(sentence.contains("expected a number above 0"), "{sentence}");
}

#[test]
fn a_table_of_regions_is_read_and_its_mistakes_said() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("patches.csv");
    let regions = |text: &str| {
        std::fs::write(&path, text).unwrap();
        Regions::read(&path).map_err(|error| error.to_string())
    };
    let table =
        "file,patch,x_px,y_px,width_px,height_px,look\na.png,throat,1,2,3,4,red\n,back,5,6,7,8,\nb.png,tail,0,0,1,1,\n";
    let found = regions(table).unwrap().of(Path::new("folder/a.png"));
    let names: Vec<&str> = found.iter().map(|region| region.name.as_str()).collect();
    assert_eq!(names, ["throat", "back"]);
    assert_eq!(found[0].rectangle, Rectangle { x_px: 1, y_px: 2, width_px: 3, height_px: 4 });

    let cell = regions("region,x_px,y_px,width_px,height_px\na,1,two,3,4\n").unwrap_err();
    assert!(cell.contains("line 2, column y_px: found `two`"), "{cell}");
    let column = regions("region,x_px,y_px,width_px\na,1,2,3\n").unwrap_err();
    assert!(column.contains("height_px") && column.contains("region, x_px, y_px, width_px"), "{column}");
    let empty = regions("region,x_px,y_px,width_px,height_px\n").unwrap_err();
    assert!(empty.contains("no row"), "{empty}");
}

proptest! {
    /// A part of a picture is what stands there in the whole.
    #[test]
    fn a_part_agrees_with_the_whole(
        width in 1usize..20, height in 1usize..20, x in 0usize..20, y in 0usize..20, across in 0usize..22, down in 0usize..22,
    ) {
        let bytes: Vec<u8> = (0..=250).cycle().step_by(7).take(width * height).collect();
        let size = (u32::try_from(width).unwrap(), u32::try_from(height).unwrap());
        let whole = read(&png_of(&bytes, size, ExtendedColorType::L8, None), "a.png");
        let rectangle = Rectangle { x_px: x, y_px: y, width_px: across, height_px: down };
        let fits = across > 0 && down > 0 && x + across <= width && y + down <= height;
        match whole.cut(rectangle) {
            Ok(part) => {
                prop_assert!(fits);
                for row in 0..down {
                    for column in 0..across {
                        let bits = |pixel: [f32; 3]| pixel.map(f32::to_bits);
                        let there = whole.pixels[(y + row) * width + x + column];
                        prop_assert_eq!(bits(part.pixels[row * across + column]), bits(there));
                    }
                }
            }
            Err(error) => {
                prop_assert!(!fits);
                prop_assert!(error.to_string().contains("reaches out of the picture"));
            }
        }
    }
}
