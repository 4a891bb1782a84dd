//! Cells in their own colours: what the eye sees over a grid.

use super::chart::{Chart, ColourCells, length};
use super::frame::Frame;
use super::layout::{x_of, y_of};
use super::palette::Colour;
use super::plot::Shape;

/// Draws the cells; neighbours of one colour become one rectangle.
pub(super) fn lay(cells: &ColourCells, chart: &Chart, frame: Frame, shapes: &mut Vec<Shape>) {
    for (index, row) in cells.rows.iter().enumerate() {
        let edges = [index, index + 1].map(|edge| y_of(&chart.y, length(edge), frame));
        let [Some(one), Some(other)] = edges else { continue };
        let (top, bottom) = (one.min(other), one.max(other));
        let border = |column: usize| cells.borders.get(column).and_then(|border| x_of(&chart.x, *border, frame));
        let mut column = 0;
        for run in row.chunk_by(|a, b| a == b) {
            let end = column + run.len();
            if let (Some(left), Some(right)) = (border(column), border(end)) {
                // A little under its neighbour, which is drawn later, so that no seam shows between them.
                let to = ((right + 0.6).min(frame.right), bottom);
                let colour: Colour = run[0];
                shapes.push(Shape::Rectangle { from: (left, top), to, colour });
            }
            column = end;
        }
    }
}
