//! The barbs as a table of points.

use std::fmt::Write;

use super::Feather;
use super::bezier::Bezier;

/// Largest distance of a polyline from its barb, mm: a twentieth of a usual barb's width.
const TOLERANCE_MM: f64 = 1e-3;

/// Pieces of the polyline of a barb that is so short, or so straight, that fewer would be as near to it.
const FEWEST_PIECES: f64 = 20.0;

impl Feather {
    /// Every barb as a polyline, CSV: vane, barb (from 1 at the base), place (mm) and unit tangent, from root to end. A
    /// polyline is nowhere farther than 1 µm from its barb.
    pub fn barbs_csv(&self) -> String {
        let mut text = String::from("vane,barb,x_mm,y_mm,tangent_x,tangent_y\n");
        for vane in &self.vanes {
            for (number, barb) in (1..).zip(&vane.barbs) {
                let longest_mm = (barb.curve.p3 - barb.curve.p0).hypot() / FEWEST_PIECES;
                for (t, point) in Bezier::from(barb.curve).polyline_in_pieces(TOLERANCE_MM, longest_mm) {
                    let tangent = barb.tangent(t);
                    // Writing to a text cannot fail.
                    let _ = writeln!(
                        text,
                        "{},{number},{:.6},{:.6},{:.7},{:.7}",
                        vane.side.name(),
                        point.x,
                        point.y,
                        tangent.x,
                        tangent.y
                    );
                }
            }
        }
        text
    }
}
