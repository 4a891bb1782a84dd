//! From bytes to codes, and what the file says of them.
//!
//! Nothing is allocated for a picture before its header was held to the limits, and a decoder that panics has met a damaged
//! file: the panic ends here.

use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use image::error::{DecodingError, UnsupportedErrorKind};
use image::metadata::Orientation;
use image::{DynamicImage, ExtendedColorType, ImageDecoder, ImageError, ImageFormat, ImageReader, Limits};

use super::coding::ColourFacts;
use super::error::PhotographProblem;
use super::exif_facts::ExifFacts;
use super::jpeg_markers::JpegMarkers;

/// Most pixels of a photograph: those of the largest camera sensors, and 2 GB in linear light.
pub(super) const MOST_PIXELS: u64 = 120_000_000;
/// Most bytes of a file: the pixels above with four 32-bit channels.
pub(super) const MOST_BYTES: u64 = 2_000_000_000;
/// Most bytes that a PNG's colour profile and texts may have when unpacked.
const MOST_CHUNK_BYTES: usize = 1 << 24;

/// A picture as its file holds it, turned upright.
pub(super) struct Decoded {
    pub(super) codes: DynamicImage,
    pub(super) format: &'static str,
    pub(super) colours: ColourFacts,
    pub(super) exif: ExifFacts,
    /// Pixels a millimetre along x and y of the upright picture.
    pub(super) pixels_per_mm: Option<[f64; 2]>,
}

/// Decodes a file's bytes; `path` is for its name's ending alone.
pub(super) fn decode(bytes: &[u8], path: &Path, notes: &mut Vec<String>) -> Result<Decoded, PhotographProblem> {
    let format = known_format(bytes, path, notes)?;
    let name = name_of(format);
    let mut noted = Vec::new();
    let decoded = catch_unwind(AssertUnwindSafe(|| decode_as(format, name, bytes, &mut noted)));
    notes.append(&mut noted);
    decoded.unwrap_or_else(|_| {
        Err(PhotographProblem::Damaged { format: name, detail: "its decoder lost its way in it".into() })
    })
}

fn decode_as(
    format: ImageFormat,
    name: &'static str,
    bytes: &[u8],
    notes: &mut Vec<String>,
) -> Result<Decoded, PhotographProblem> {
    let markers = (format == ImageFormat::Jpeg).then(|| JpegMarkers::read(bytes));
    if let Some(markers) = markers {
        if markers.channels == Some(4) {
            return Err(PhotographProblem::Inks);
        }
        if markers.bits.is_some_and(|bits| bits != 8) {
            let detail = format!("{} bits a channel", markers.bits.unwrap_or_default());
            return Err(PhotographProblem::Unsupported { format: name, detail });
        }
    }
    let refused = |error: ImageError| problem(error, name);
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    let mut limits = Limits::no_limits();
    limits.max_alloc = Some(MOST_BYTES);
    reader.limits(limits.clone());
    let mut decoder = reader.into_decoder().map_err(refused)?;
    check_size(decoder.dimensions())?;
    if matches!(decoder.original_color_type(), ExtendedColorType::Cmyk8 | ExtendedColorType::Cmyk16) {
        return Err(PhotographProblem::Inks);
    }
    if markers.is_some_and(|markers| !markers.is_whole) {
        let detail = "its end-of-image marker is missing".to_owned();
        return Err(PhotographProblem::Truncated { format: name, detail });
    }
    decoder.set_limits(limits).map_err(refused)?;

    // A TIFF file is an EXIF chunk itself.
    let chunk = match format {
        ImageFormat::Tiff => Some(bytes.to_vec()),
        _ => decoder.exif_metadata().map_err(refused)?,
    };
    let exif = chunk.map(|chunk| ExifFacts::read(chunk, notes)).unwrap_or_default();
    let mut colours = ColourFacts { exif: exif.colour_space, ..ColourFacts::default() };
    let mut pixels_per_mm = exif.pixels_per_mm;
    if format == ImageFormat::Png {
        note_chunks(bytes, &mut colours, &mut pixels_per_mm);
    } else {
        colours.icc_profile = decoder.icc_profile().map_err(refused)?;
    }
    if let Some((density, unit_um)) = markers.and_then(|markers| markers.density) {
        pixels_per_mm = Some(density.map(|dots| f64::from(dots) * 1000.0 / unit_um));
    }
    let mut codes = DynamicImage::from_decoder(decoder).map_err(refused)?;
    colours.is_float = matches!(codes, DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_));
    colours.is_grey = !codes.color().has_color();
    if let Some(orientation) = exif.orientation.and_then(Orientation::from_exif) {
        codes.apply_orientation(orientation);
    }
    if exif.orientation.is_some_and(|code| code >= 5) {
        pixels_per_mm = pixels_per_mm.map(|[x, y]| [y, x]);
    }
    Ok(Decoded { codes, format: name, colours, exif, pixels_per_mm })
}

/// What a PNG's chunks say of its colours and its resolution.
fn note_chunks(bytes: &[u8], colours: &mut ColourFacts, pixels_per_mm: &mut Option<[f64; 2]>) {
    let limits = png::Limits { bytes: MOST_CHUNK_BYTES };
    // The picture itself is decoded elsewhere, and what is wrong with it said there.
    let Ok(reader) = png::Decoder::new_with_limits(Cursor::new(bytes), limits).read_info() else { return };
    let info = reader.info();
    colours.icc_profile = info.icc_profile.as_ref().map(|profile| profile.to_vec());
    colours.says_srgb = info.srgb.is_some();
    colours.has_code_points = info.coding_independent_code_points.is_some();
    colours.exponent = info.gama_chunk.map(|gamma| 1.0 / f64::from(gamma.into_value())).filter(|e| e.is_finite());
    colours.chromaticities = info.chrm_chunk.map(|chunk| {
        [chunk.white, chunk.red, chunk.green, chunk.blue].map(|(x, y)| [x, y].map(|c| f64::from(c.into_value())))
    });
    if let Some(dims) = info.pixel_dims.filter(|dims| dims.unit == png::Unit::Meter) {
        *pixels_per_mm = Some([dims.xppu, dims.yppu].map(|per_metre| f64::from(per_metre) / 1000.0));
    }
}

fn check_size((width, height): (u32, u32)) -> Result<(), PhotographProblem> {
    if width == 0 || height == 0 {
        return Err(PhotographProblem::NoPixels { width, height });
    }
    if u64::from(width) * u64::from(height) > MOST_PIXELS {
        return Err(PhotographProblem::TooManyPixels { width, height, limit: MOST_PIXELS });
    }
    Ok(())
}

/// The format that the first bytes show, and a note where the name says another.
fn known_format(bytes: &[u8], path: &Path, notes: &mut Vec<String>) -> Result<ImageFormat, PhotographProblem> {
    /// Endings of cameras' raw files that begin like a TIFF.
    const RAW: [&str; 14] =
        ["3fr", "arw", "cr2", "dcr", "dng", "erf", "kdc", "nef", "nrw", "orf", "pef", "rw2", "sr2", "srw"];
    if bytes.is_empty() {
        return Err(PhotographProblem::Empty);
    }
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default();
    if RAW.contains(&ending.as_str()) {
        return Err(PhotographProblem::Raw);
    }
    let format = match image::guess_format(bytes) {
        Ok(format @ (ImageFormat::Jpeg | ImageFormat::Png | ImageFormat::Tiff | ImageFormat::OpenExr)) => format,
        Ok(other) => return Err(PhotographProblem::UnknownFormat { found: format!("a {other:?} file") }),
        Err(_) => return Err(PhotographProblem::UnknownFormat { found: kind_of(bytes).to_owned() }),
    };
    if !ending.is_empty() && !format.extensions_str().contains(&ending.as_str()) {
        notes.push(format!("Its name ends in .{ending}, but it is a {}, and was read as one.", name_of(format)));
    }
    Ok(format)
}

/// What bytes that are no picture are, in words.
fn kind_of(bytes: &[u8]) -> &'static str {
    let start = &bytes[..bytes.len().min(512)];
    let is_text = |byte: &u8| matches!(byte, b'\t' | b'\n' | b'\r' | 0x20..=0x7E);
    match start {
        [_, _, _, _, b'f', b't', b'y', b'p', ..] => "a HEIC picture or a film",
        [b'%', b'P', b'D', b'F', ..] => "a PDF",
        start if start.iter().all(is_text) => "text",
        _ => "bytes of no known format",
    }
}

fn name_of(format: ImageFormat) -> &'static str {
    match format {
        ImageFormat::Jpeg => "JPEG",
        ImageFormat::Png => "PNG",
        ImageFormat::Tiff => "TIFF",
        _ => "EXR",
    }
}

fn problem(error: ImageError, format: &'static str) -> PhotographProblem {
    let detail = |text: String| text.trim_end_matches('.').to_owned();
    match error {
        ImageError::IoError(error) if error.kind() == std::io::ErrorKind::UnexpectedEof => {
            PhotographProblem::Truncated { format, detail: "bytes are missing".into() }
        }
        ImageError::Unsupported(error) => {
            let text = match error.kind() {
                UnsupportedErrorKind::Color(kind) => format!("its colours are of the kind {kind:?}"),
                UnsupportedErrorKind::GenericFeature(feature) => feature,
                _ => error.to_string(),
            };
            PhotographProblem::Unsupported { format, detail: detail(text) }
        }
        ImageError::Limits(_) => {
            PhotographProblem::Damaged { format, detail: "it asks for more memory than its pixels take".into() }
        }
        ImageError::Decoding(error) => PhotographProblem::Damaged { format, detail: detail(said(&error)) },
        error => PhotographProblem::Damaged { format, detail: detail(error.to_string()) },
    }
}

/// What the decoder itself said, without the frame around it.
fn said(error: &DecodingError) -> String {
    std::error::Error::source(error).map_or_else(|| error.to_string(), ToString::to_string)
}
