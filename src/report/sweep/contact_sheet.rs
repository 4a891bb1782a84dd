//! The pictures of all cells side by side: the axis with most values across, the other one down, each labelled.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use image::RgbImage;

use super::swept::{columns, inner, outer, setting};
use crate::job::{Sweep, SweepAxis};
use crate::report::ReportError;
use crate::report::chart::length;
use crate::report::palette::INK;
use crate::report::plot::{Align, Drawing, PNG_PIXELS, Pasted, Shape, png_with, text_width};
use crate::scene::ContactSheet;

/// Name of the sheet's file.
pub(super) const FILE: &str = "contact-sheet.png";

/// Pictures in a row where only one parameter is swept.
const MOST_IN_A_ROW: usize = 6;
/// All lengths are page pixels.
const LABEL_SIZE: f64 = 11.0;
const LINE: f64 = 14.0;
const GAP: u32 = 3;

/// A painted sheet.
#[derive(Debug)]
pub(super) struct Sheet {
    pub(super) png: Vec<u8>,
    /// Page pixels.
    pub(super) width: u32,
    pub(super) caption: String,
}

impl Sheet {
    /// Labels and pictures.
    pub(super) fn paint(sweep: &Sweep, sheet: &ContactSheet) -> Result<Self, ReportError> {
        let failed = |text: String| ReportError::Paint { figure: "contact-sheet".to_owned(), text };
        let layout = Layout::new(sweep, sheet);
        let (drawing, places) = layout.drawing();
        let pasted = sheet.pictures.iter().zip(places).map(|(picture, at)| {
            let bytes = picture.pixels.iter().flat_map(|pixel| sheet.tone.bytes(*pixel)).collect();
            let picture = RgbImage::from_raw(picture.width, picture.height, bytes);
            Ok(Pasted { picture: picture.ok_or_else(|| failed("a picture's size is not its own".to_owned()))?, at })
        });
        let pasted = pasted.collect::<Result<Vec<_>, ReportError>>()?;
        let png = png_with(&drawing, &pasted).map_err(|error| failed(error.to_string()))?;
        Ok(Self { png, width: drawing.width, caption: caption(sheet) })
    }

    /// As a page embeds it.
    pub(super) fn base64(&self) -> String {
        STANDARD.encode(&self.png)
    }
}

fn caption(sheet: &ContactSheet) -> String {
    let nm = sheet.wavelengths_nm.iter().map(f64::to_string).collect::<Vec<_>>().join(", ");
    let shown = match sheet.wavelengths_nm.len() {
        3 => "which are shown as the linear red, green and blue of Rec. 709",
        _ => "whose colour under D65 is shown",
    };
    format!(
        "{}, one picture a cell, path-traced with {} samples a pixel at {nm} nm, {shown}; the exposure is the same in all. \
         Digest of the scene: {}.",
        sheet.scene, sheet.samples, sheet.fingerprint
    )
}

/// Where pictures and labels stand. Pictures lie at whole pixels of the PNG.
struct Layout {
    /// Cells of each row, in the order of the sweep's, and what stands left of them.
    rows: Vec<(Vec<usize>, Vec<String>)>,
    /// What stands above the pictures: above the first row where `repeats` is false, else above each picture of every row.
    above: Vec<Vec<String>>,
    repeats: bool,
    cells: usize,
    /// Size of a picture, pixels of the PNG.
    size: [u32; 2],
}

impl Layout {
    fn new(sweep: &Sweep, sheet: &ContactSheet) -> Self {
        let across = columns(inner(sweep));
        let size = sheet.pictures.first().map_or([0, 0], |picture| [picture.width, picture.height]);
        let lines = |axis: &SweepAxis, place: usize| -> Vec<String> {
            setting(axis, axis.values[place]).split(", ").map(str::to_owned).collect()
        };
        let above = across.iter().map(|place| lines(inner(sweep), *place)).collect();
        let (rows, repeats) = match outer(sweep) {
            Some(axis) => {
                let row = |outer: usize| {
                    let cells = across.iter().map(|column| super::swept::cell(sweep, outer, *column)).collect();
                    (cells, lines(axis, outer))
                };
                ((0..axis.values.len()).map(row).collect(), false)
            }
            None => (across.chunks(MOST_IN_A_ROW).map(|row| (row.to_vec(), Vec::new())).collect(), true),
        };
        Self { rows, above, repeats, cells: sweep.cells.len(), size }
    }

    /// The labels, and the upper left corner of each cell's picture in pixels of the PNG.
    fn drawing(&self) -> (Drawing, Vec<(u32, u32)>) {
        let scale = PNG_PIXELS.unsigned_abs();
        let [width, height] = self.size;
        let page = |pixels: u32| f64::from(pixels) / f64::from(scale);
        let widest =
            |lines: &[String]| lines.iter().map(|line| text_width(line, LABEL_SIZE, false)).fold(0.0, f64::max);
        let left = whole(self.rows.iter().map(|(_, lines)| widest(lines)).fold(0.0, f64::max)) + 3 * GAP;
        // A label may be wider than a small picture.
        let column = width.max(scale * whole(self.above.iter().map(|lines| widest(lines)).fold(0.0, f64::max) + 4.0));
        let head = whole(LINE * length(self.above.iter().map(Vec::len).max().unwrap_or(0))) + GAP;
        let label = |lines: &[String], x: f64, middle: f64, align: Align, shapes: &mut Vec<Shape>| {
            let first = middle - LINE * (length(lines.len()) - 1.0) / 2.0;
            shapes.extend(lines.iter().enumerate().map(|(number, line)| Shape::Text {
                text: line.clone(),
                at: (x, first + LINE * length(number)),
                size: LABEL_SIZE,
                align,
                colour: INK,
                bold: false,
                upwards: false,
            }));
        };
        let mut shapes = Vec::new();
        let mut places = vec![(0, 0); self.cells];
        let (mut top, mut next) = (GAP, 0);
        for (row, (cells, lines)) in self.rows.iter().enumerate() {
            if row == 0 || self.repeats {
                top += head;
            }
            label(
                lines,
                page(scale * left) - f64::from(GAP),
                f64::from(top) + page(height) / 2.0,
                Align::End,
                &mut shapes,
            );
            let mut x = scale * left;
            for (place, cell) in cells.iter().enumerate() {
                if row == 0 || self.repeats {
                    let above = if self.repeats { next } else { place };
                    let middle = f64::from(top) - f64::from(head) / 2.0;
                    label(&self.above[above], page(x + column / 2), middle, Align::Middle, &mut shapes);
                    next += 1;
                }
                places[*cell] = (x + (column - width) / 2, scale * top);
                x += column + scale * GAP;
            }
            top += height.div_ceil(scale) + GAP;
        }
        let columns =
            u32::try_from(self.rows.iter().map(|(cells, _)| cells.len()).max().unwrap_or(0)).unwrap_or(u32::MAX);
        (Drawing { width: left + columns * (column.div_ceil(scale) + GAP) + GAP, height: top, shapes }, places)
    }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a length on a page, some thousand pixels")]
fn whole(length: f64) -> u32 {
    length.ceil() as u32
}
