//! A feather as a drawing for people: SVG, one unit a millimetre.

use std::fmt::Write;

use kurbo::{Point, Rect};

use super::barb::Barb;
use super::file::BetweenBarbs;
use super::{Feather, polygon};

/// Largest distance of a drawn edge from the curve, mm: less than any print shows.
const TOLERANCE_MM: f64 = 5e-3;

/// Free space around the feather as a share of its longer side.
const MARGIN: f64 = 0.03;

/// Lengths of which the longest that fits becomes the scale bar, mm.
const BARS_MM: [f64; 10] = [0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0];

/// What a preview shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Preview {
    /// The feather.
    #[default]
    Feather,
    /// The feather and how each barb was made: its chord, its two inner control points, and the outlines.
    Construction,
}

impl Feather {
    /// The feather as an SVG drawing.
    pub fn svg(&self, preview: Preview) -> String {
        let bounds = self.bounds_mm();
        let longer = bounds.width().max(bounds.height());
        let margin = MARGIN * longer;
        let bar_mm = BARS_MM.into_iter().rev().find(|bar| *bar <= 0.2 * longer).unwrap_or(BARS_MM[0]);
        let text_mm = 0.018 * longer;
        let foot = 3.0 * text_mm;
        let page = Rect::new(
            bounds.x0 - margin,
            bounds.y0 - margin - foot,
            (bounds.x1 + margin).max(bounds.x0 + bar_mm + margin),
            bounds.y1 + margin,
        );
        let mut svg = String::new();
        let mut line = |text: std::fmt::Arguments| {
            // Writing to a text cannot fail.
            let _ = svg.write_fmt(text);
            svg.push('\n');
        };
        let (width, height) = (page.width(), page.height());
        line(format_args!(
            r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.3} {height:.3}" width="{width:.3}mm" height="{height:.3}mm">"#
        ));
        line(format_args!("<title>{}</title>", escaped(&self.title)));
        line(format_args!(r##"<rect width="100%" height="100%" fill="#ffffff"/>"##));
        let pen = Pen { page };

        if self.between_barbs == BetweenBarbs::Barbules {
            for vane in &self.vanes {
                let area = polygon::vane(vane, &self.shaft, TOLERANCE_MM);
                line(format_args!(r##"<path d="{}" fill="#dcd6cc"/>"##, pen.polygon(&area)));
            }
        }
        line(format_args!(
            r##"<g fill="none" stroke="#5d4a36" stroke-width="{:.4}" stroke-linecap="butt">"##,
            self.barb_width_mm
        ));
        for barb in self.vanes.iter().flat_map(|vane| &vane.barbs) {
            line(format_args!(r#"<path d="{}"/>"#, pen.cubic(barb)));
        }
        line(format_args!("</g>"));
        let shaft = polygon::shaft(&self.shaft, TOLERANCE_MM);
        line(format_args!(r##"<path d="{}" fill="#8a7660"/>"##, pen.polygon(&shaft)));
        if preview == Preview::Construction {
            self.construction(pen, longer, &mut line);
        }

        let left = pen.at(Point::new(bounds.x0, 0.0)).0;
        let bottom = height - text_mm;
        line(format_args!(
            r##"<path d="M{left:.3} {bottom:.3}h{bar_mm}" stroke="#000000" stroke-width="{:.3}"/>"##,
            0.15 * text_mm
        ));
        line(format_args!(
            r#"<text x="{left:.3}" y="{:.3}" font-family="sans-serif" font-size="{text_mm:.3}">{bar_mm} mm</text>"#,
            bottom - 0.5 * text_mm
        ));
        line(format_args!("</svg>"));
        svg
    }

    /// Outlines dashed, chords in orange, the way from each end over its control point in blue, as in the first thesis's
    /// Figure 4.1.
    fn construction(&self, pen: Pen, longer_mm: f64, line: &mut impl FnMut(std::fmt::Arguments)) {
        let stroke_mm = 0.0015 * longer_mm;
        let radius_mm = 0.004 * longer_mm;
        line(format_args!(r#"<g fill="none" stroke-width="{stroke_mm:.4}">"#));
        for vane in &self.vanes {
            let outline: Vec<Point> = vane.outline.polyline(TOLERANCE_MM).into_iter().map(|(_, point)| point).collect();
            line(format_args!(
                r##"<path d="{}" stroke="#000000" stroke-dasharray="{:.3}"/>"##,
                pen.open(&outline),
                4.0 * stroke_mm
            ));
        }
        for barb in self.vanes.iter().flat_map(|vane| &vane.barbs) {
            let [p0, p1, p2, p3] = [barb.planned.p0, barb.planned.p1, barb.planned.p2, barb.planned.p3];
            line(format_args!(r##"<path d="{}" stroke="#d55e00"/>"##, pen.open(&[p0, p3])));
            line(format_args!(r##"<path d="{}" stroke="#0072b2"/>"##, pen.open(&[p0, p1])));
            line(format_args!(r##"<path d="{}" stroke="#0072b2"/>"##, pen.open(&[p2, p3])));
            for (point, fill) in [(p0, "#000000"), (p1, "#0072b2"), (p2, "#0072b2"), (p3, "#000000")] {
                let (x, y) = pen.at(point);
                line(format_args!(
                    r#"<circle cx="{x:.3}" cy="{y:.3}" r="{radius_mm:.3}" fill="{fill}" stroke="none"/>"#
                ));
            }
        }
        line(format_args!("</g>"));
    }
}

/// From the feather's plane to the page, whose y runs down.
#[derive(Clone, Copy)]
struct Pen {
    page: Rect,
}

impl Pen {
    fn at(self, point: Point) -> (f64, f64) {
        (point.x - self.page.x0, self.page.y1 - point.y)
    }

    fn open(self, points: &[Point]) -> String {
        let mut path = String::new();
        for (index, &point) in points.iter().enumerate() {
            let (x, y) = self.at(point);
            let _ = write!(path, "{}{x:.3} {y:.3}", if index == 0 { 'M' } else { 'L' });
        }
        path
    }

    fn polygon(self, points: &[Point]) -> String {
        self.open(points) + "Z"
    }

    fn cubic(self, barb: &Barb) -> String {
        let [a, b, c, d] = [barb.curve.p0, barb.curve.p1, barb.curve.p2, barb.curve.p3].map(|point| self.at(point));
        format!("M{:.3} {:.3}C{:.3} {:.3} {:.3} {:.3} {:.3} {:.3}", a.0, a.1, b.0, b.1, c.0, c.1, d.0, d.1)
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
