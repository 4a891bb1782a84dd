//! What a camera wrote beside its picture (Exif 2.32, CIPA DC-008).

use exif::{Context, Error, Exif, Field, In, Reader, Tag, Value};
use serde::Serialize;

use crate::number::significant;

/// What a camera or a scanner says of a picture; missing is missing.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct ExifFacts {
    /// How the picture must be turned to stand upright, 1 to 8.
    pub orientation: Option<u8>,
    /// Exposure time in s.
    pub exposure_time_s: Option<f64>,
    /// Focal length over the aperture's diameter.
    pub f_number: Option<f64>,
    /// Sensitivity.
    pub iso: Option<f64>,
    /// Focal length in mm.
    pub focal_length_mm: Option<f64>,
    /// Colour space as the camera names it.
    pub colour_space: Option<ExifColourSpace>,
    /// When it was taken, as written: `2006:05:13 10:21:44`.
    pub taken: Option<String>,
    /// Who made the camera.
    pub maker: Option<String>,
    /// The camera's name.
    pub camera: Option<String>,
    /// The program that wrote the file.
    pub software: Option<String>,
    /// What the picture shows, in the writer's words.
    pub description: Option<String>,
    /// Pixels a millimetre along x and y.
    pub pixels_per_mm: Option<[f64; 2]>,
}

/// Colour spaces that Exif knows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ExifColourSpace {
    /// sRGB.
    Srgb,
    /// Uncalibrated, with the interoperability index R03 by which cameras mean Adobe RGB (DCF 2.0).
    AdobeRgb,
    /// Another one, which is not named.
    Uncalibrated,
}

impl ExifFacts {
    /// Reads the facts, and says in `notes` what was left out and why. Nothing here fails: a picture is there without them.
    pub(super) fn read(chunk: Vec<u8>, notes: &mut Vec<String>) -> Self {
        let mut damage = Vec::new();
        let exif = Reader::new()
            .continue_on_error(true)
            .read_raw(chunk)
            .or_else(|error| error.distill_partial_result(|errors| damage.extend(errors.iter().map(Error::to_string))));
        let exif = match exif {
            Ok(exif) => exif,
            Err(error) => {
                notes.push(format!("Its EXIF cannot be read ({error}) and was left out."));
                return Self::default();
            }
        };
        if let Some(first) = damage.first() {
            notes.push(format!("Part of its EXIF cannot be read ({first}) and was left out."));
        }
        Self::of(&exif, notes)
    }

    fn of(exif: &Exif, notes: &mut Vec<String>) -> Self {
        let mut within = |tag: Tag, name: &str, unit: &str, (low, high): (f64, f64)| {
            let value = number(field(exif, tag)?)?;
            if (low..=high).contains(&value) {
                return Some(value);
            }
            notes.push(format!(
                "EXIF gives {name} as {}{unit}, expected {low} to {high}; it was left out.",
                significant(value, 4)
            ));
            None
        };
        // An hour's exposure, a lens of f/0.5 and one of 10 m are beyond what photographs feathers.
        let exposure_time_s = within(Tag::ExposureTime, "the exposure time", " s", (1e-6, 3600.0));
        let f_number = within(Tag::FNumber, "the aperture", "", (0.5, 512.0));
        let iso = within(Tag::PhotographicSensitivity, "the sensitivity", "", (1.0, 1e7));
        let focal_length_mm = within(Tag::FocalLength, "the focal length", " mm", (0.1, 10_000.0));
        let orientation = within(Tag::Orientation, "the orientation", "", (1.0, 8.0));
        let per_unit = [Tag::XResolution, Tag::YResolution]
            .map(|tag| within(tag, "the resolution", " pixels a unit", (1e-3, 1e6)));
        // 2 inches, 3 centimetres; without this field inches (Exif 2.32, 4.6.5).
        let unit_mm = match field(exif, Tag::ResolutionUnit).and_then(|field| field.value.get_uint(0)) {
            None | Some(2) => Some(25.4),
            Some(3) => Some(10.0),
            Some(_) => None,
        };
        let adobe = text(exif, Tag::InteroperabilityIndex).is_some_and(|index| index == "R03");
        let colour_space = field(exif, Tag::ColorSpace).and_then(|field| field.value.get_uint(0));
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 1 to 8")]
        Self {
            orientation: orientation.map(|value| value as u8),
            exposure_time_s,
            f_number,
            iso,
            focal_length_mm,
            colour_space: colour_space.map(|code| match code {
                1 => ExifColourSpace::Srgb,
                _ if adobe => ExifColourSpace::AdobeRgb,
                _ => ExifColourSpace::Uncalibrated,
            }),
            taken: text(exif, Tag::DateTimeOriginal).or_else(|| text(exif, Tag::DateTime)),
            maker: text(exif, Tag::Make),
            camera: text(exif, Tag::Model),
            software: text(exif, Tag::Software),
            description: text(exif, Tag::ImageDescription),
            pixels_per_mm: match (per_unit, unit_mm) {
                ([Some(x), Some(y)], Some(unit_mm)) => Some([x / unit_mm, y / unit_mm]),
                _ => None,
            },
        }
    }

    /// Light that the sensor counted for a given scene, up to a factor that all pictures of one camera share: time × ISO / N².
    ///
    /// None where time, aperture or sensitivity is missing.
    pub fn relative_exposure(&self) -> Option<f64> {
        Some(self.exposure_time_s? * self.iso? / self.f_number?.powi(2))
    }

    /// What [`Self::relative_exposure`] lacks, in words; empty where it lacks nothing.
    pub fn lacks_for_exposure(&self) -> String {
        let parts = [
            ("the exposure time", self.exposure_time_s),
            ("the aperture", self.f_number),
            ("the sensitivity", self.iso),
        ];
        let missing: Vec<&str> = parts.iter().filter(|(_, value)| value.is_none()).map(|(name, _)| *name).collect();
        missing.join(" and ")
    }
}

/// A field of the picture itself, not of its thumbnail.
fn field(exif: &Exif, tag: Tag) -> Option<&Field> {
    debug_assert!(matches!(tag.context(), Context::Tiff | Context::Exif | Context::Interop));
    exif.get_field(tag, In::PRIMARY)
}

/// The first number of a field. A fraction over 0 is infinite, and refused as out of range.
fn number(field: &Field) -> Option<f64> {
    match &field.value {
        Value::Rational(values) => values.first().map(exif::Rational::to_f64),
        Value::SRational(values) => values.first().map(exif::SRational::to_f64),
        Value::Float(values) => values.first().map(|value| f64::from(*value)),
        Value::Double(values) => values.first().copied(),
        value => value.get_uint(0).map(f64::from),
    }
}

/// A text without what does not print; None where nothing is left.
fn text(exif: &Exif, tag: Tag) -> Option<String> {
    /// More than any camera's name has.
    const LONGEST: usize = 200;
    let Value::Ascii(parts) = &field(exif, tag)?.value else { return None };
    let printed = String::from_utf8_lossy(parts.first()?);
    let printed: String = printed.chars().filter(|c| !c.is_control()).take(LONGEST).collect();
    let printed = printed.trim();
    (!printed.is_empty()).then(|| printed.to_owned())
}
