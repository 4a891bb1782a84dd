//! The one place that speaks to plotters.
//!
//! A figure is laid out as a list of [`Shape`]s in page pixels; this file paints that list as SVG and as PNG. plotters
//! has whole-pixel coordinates, so both are painted larger than shown: the SVG's view box undoes it, and the PNG is
//! averaged down, which also smooths its edges.

use std::sync::OnceLock;

use image::RgbImage;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use plotters::backend::DrawingBackend;
use plotters::element::{Circle, PathElement, Polygon, Rectangle, Text};
use plotters::prelude::{BitMapBackend, DrawingArea, IntoDrawingArea, IntoFont, SVGBackend};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontStyle, FontTransform, ShapeStyle, TextStyle, register_font};

use super::palette::{Colour, WHITE};

/// Units of the SVG's view box to a page pixel: a tenth of a pixel is finer than an eye sees.
const SVG_UNITS: i32 = 10;
/// Pixels of the PNG to a page pixel: 2 keeps it sharp on dense screens and at 180 dots an inch in print.
pub(crate) const PNG_PIXELS: i32 = 2;
/// Pixels painted, each way, for one of the PNG.
const OVERSAMPLING: i32 = 2;

/// Where a text stands relative to its point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Align {
    Start,
    Middle,
    End,
}

/// One thing to paint. Coordinates are page pixels from the upper left corner; texts are centred on their height.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Shape {
    Line { points: Vec<(f64, f64)>, colour: Colour, width: f64 },
    Polygon { points: Vec<(f64, f64)>, colour: Colour },
    Rectangle { from: (f64, f64), to: (f64, f64), colour: Colour },
    Disc { centre: (f64, f64), radius: f64, colour: Colour },
    Text { text: String, at: (f64, f64), size: f64, align: Align, colour: Colour, bold: bool, upwards: bool },
}

/// A laid-out figure.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Drawing {
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) shapes: Vec<Shape>,
}

/// Why a figure could not be painted, in plotters' or the encoder's words.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub(crate) struct PaintError(String);

fn failed(error: impl std::fmt::Display) -> PaintError {
    PaintError(error.to_string())
}

/// Width in page pixels of a text at this size, in the embedded font.
pub(crate) fn text_width(text: &str, size: f64, bold: bool) -> f64 {
    // Measured large, because plotters rounds to whole pixels.
    const SCALE: f64 = 16.0;
    let style = if bold { FontStyle::Bold } else { FontStyle::Normal };
    match use_font()
        .and_then(|()| ("sans-serif", size * FONT_SIZE_TO_EM * SCALE, style).into_font().box_size(text).map_err(failed))
    {
        Ok((width, _)) => f64::from(width) / SCALE,
        // Without its font a figure cannot be painted either, and that error is the one to show.
        Err(_) => 0.6 * size * f64::from(u32::try_from(text.chars().count()).unwrap_or(u32::MAX)),
    }
}

/// The drawing as an SVG that stands alone. `label` is what a screen reader says.
pub(crate) fn svg(drawing: &Drawing, label: &str) -> Result<String, PaintError> {
    use_font()?;
    let units = SVG_UNITS.unsigned_abs();
    let size = (drawing.width * units, drawing.height * units);
    let mut text = String::new();
    {
        let area = SVGBackend::with_string(&mut text, size).into_drawing_area();
        paint(&area, drawing, SVG_UNITS, true)?;
        area.present().map_err(failed)?;
    }
    let painted = format!("<svg width=\"{}\" height=\"{}\"", size.0, size.1);
    let shown = format!(
        "<svg role=\"img\" aria-label=\"{}\" stroke-linejoin=\"round\" width=\"{}\" height=\"{}\"",
        escaped(label),
        drawing.width,
        drawing.height
    );
    // What plotters writes beyond SVG's own defaults is a fifth of a map's bytes.
    Ok(text.replacen(&painted, &shown, 1).replace(" opacity=\"1\"", "").replace(" stroke=\"none\"", ""))
}

/// A picture to stand in a drawing's PNG as it is, one of its pixels a pixel of the PNG, of which there are
/// [`PNG_PIXELS`] to a page pixel.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Pasted {
    pub(crate) picture: RgbImage,
    /// Its upper left corner, pixels of the PNG.
    pub(crate) at: (u32, u32),
}

/// The drawing as PNG bytes.
pub(crate) fn png(drawing: &Drawing) -> Result<Vec<u8>, PaintError> {
    let mut bytes = Vec::new();
    // Flat areas compress better without a filter: a fifth less on line plots.
    let encoder = PngEncoder::new_with_quality(&mut bytes, CompressionType::Best, FilterType::NoFilter);
    bitmap(drawing)?.write_with_encoder(encoder).map_err(failed)?;
    Ok(bytes)
}

/// The drawing with these pictures in it as PNG bytes.
pub(crate) fn png_with(drawing: &Drawing, pictures: &[Pasted]) -> Result<Vec<u8>, PaintError> {
    let mut painted = bitmap(drawing)?;
    for Pasted { picture, at } in pictures {
        image::imageops::replace(&mut painted, picture, at.0.into(), at.1.into());
    }
    let mut bytes = Vec::new();
    let encoder = PngEncoder::new_with_quality(&mut bytes, CompressionType::Best, FilterType::Adaptive);
    painted.write_with_encoder(encoder).map_err(failed)?;
    Ok(bytes)
}

fn bitmap(drawing: &Drawing) -> Result<RgbImage, PaintError> {
    use_font()?;
    let scale = PNG_PIXELS * OVERSAMPLING;
    let (width, height) = (drawing.width * scale.unsigned_abs(), drawing.height * scale.unsigned_abs());
    let mut painted = RgbImage::new(width, height);
    {
        let area = BitMapBackend::with_buffer(&mut painted, (width, height)).into_drawing_area();
        paint(&area, drawing, scale, false)?;
        area.present().map_err(failed)?;
    }
    Ok(averaged(&painted, OVERSAMPLING.unsigned_abs()))
}

/// plotters takes a font's size as its line height, 1.24 of the em that typographers name.
const FONT_SIZE_TO_EM: f64 = 1.24;

/// Paints every shape. A backend that does not round the joints of a line lets the tip of a sharp spike shoot far beyond
/// its point; there a wide line is painted as its segments with a disc at each joint.
fn paint<B: DrawingBackend>(
    area: &DrawingArea<B, plotters::coord::Shift>,
    drawing: &Drawing,
    scale: i32,
    rounds_joints: bool,
) -> Result<(), PaintError> {
    let at = |(x, y): (f64, f64)| (whole(x * f64::from(scale)), whole(y * f64::from(scale)));
    let all = |points: &[(f64, f64)]| points.iter().map(|p| at(*p)).collect::<Vec<_>>();
    area.fill(&WHITE).map_err(failed)?;
    for shape in &drawing.shapes {
        match shape {
            Shape::Line { points, colour, width } => {
                let stroke_width = whole(width * f64::from(scale)).max(1).unsigned_abs();
                let style = ShapeStyle { color: colour.to_rgba(), filled: false, stroke_width };
                if rounds_joints || stroke_width < 2 || points.len() < 3 {
                    area.draw(&PathElement::new(all(points), style))
                } else {
                    let points = all(points);
                    // One pixel under the line's width, or the joints of a smooth curve stand out as beads.
                    let radius = i32::try_from(stroke_width / 2).unwrap_or(i32::MAX) - 1;
                    points.windows(2).try_for_each(|ends| area.draw(&PathElement::new(ends.to_vec(), style))).and_then(
                        |()| {
                            let mut joints = points[1..points.len() - 1].iter();
                            joints.try_for_each(|joint| area.draw(&Circle::new(*joint, radius, colour.filled())))
                        },
                    )
                }
            }
            Shape::Polygon { points, colour } => area.draw(&Polygon::new(all(points), colour.filled())),
            Shape::Rectangle { from, to, colour } => area.draw(&Rectangle::new([at(*from), at(*to)], colour.filled())),
            Shape::Disc { centre, radius, colour } => {
                area.draw(&Circle::new(at(*centre), whole(radius * f64::from(scale)), colour.filled()))
            }
            Shape::Text { text, at: point, size, align, colour, bold, upwards } => {
                let style = if *bold { FontStyle::Bold } else { FontStyle::Normal };
                let mut font = ("sans-serif", size * FONT_SIZE_TO_EM * f64::from(scale), style).into_font();
                if *upwards {
                    font = font.transform(FontTransform::Rotate270);
                }
                let across = match align {
                    Align::Start => HPos::Left,
                    Align::Middle => HPos::Center,
                    Align::End => HPos::Right,
                };
                let style = TextStyle::from(font).color(colour).pos(Pos::new(across, VPos::Center));
                area.draw(&Text::new(text.as_str(), at(*point), style))
            }
        }
        .map_err(failed)?;
    }
    Ok(())
}

/// Hands plotters its font; it has none of its own, and draws broken text without.
fn use_font() -> Result<(), PaintError> {
    static REGISTERED: OnceLock<bool> = OnceLock::new();
    let registered = REGISTERED.get_or_init(|| {
        register_font("sans-serif", FontStyle::Normal, dejavu::sans::regular()).is_ok()
            && register_font("sans-serif", FontStyle::Bold, dejavu::sans::bold()).is_ok()
    });
    if *registered { Ok(()) } else { Err(failed("the embedded font could not be read")) }
}

#[expect(clippy::cast_possible_truncation, reason = "a pixel of a page; a cast saturates where it is far outside")]
fn whole(position: f64) -> i32 {
    position.round() as i32
}

/// The picture made smaller by the mean over squares of `factor` pixels.
fn averaged(picture: &RgbImage, factor: u32) -> RgbImage {
    let mut small = RgbImage::new(picture.width() / factor, picture.height() / factor);
    for (x, y, pixel) in small.enumerate_pixels_mut() {
        let mut sums = [0u32; 3];
        for (dx, dy) in (0..factor).flat_map(|dx| (0..factor).map(move |dy| (dx, dy))) {
            let source = picture.get_pixel(x * factor + dx, y * factor + dy);
            for (sum, channel) in sums.iter_mut().zip(source.0) {
                *sum += u32::from(channel);
            }
        }
        for (channel, sum) in pixel.0.iter_mut().zip(sums) {
            *channel = u8::try_from(sum / (factor * factor)).unwrap_or(u8::MAX);
        }
    }
    small
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
