//! Maps of values by column and row, and the bar of their colours.

use super::chart::{Axis, Chart, Map, length};
use super::frame::Frame;
use super::layout::{
    LABEL_ROW_HEIGHT, LABEL_SIZE, TICK_LENGTH, TICK_ROW_HEIGHT, TICK_SIZE, line, shortened, text, x_of, x_ticks, y_of,
};
use super::palette::{BLACK, GREY, PALE, Scale, WHITE, is_light};
use super::plot::{Align, Shape};

const BAR_HEIGHT: f64 = 10.0;

/// Draws a map into its chart.
pub(super) fn lay_map(map: &Map, chart: &Chart, frame: Frame, shapes: &mut Vec<Shape>) {
    for (index, row) in map.rows.iter().enumerate() {
        let (Some(one), Some(other)) = (y_of(&chart.y, length(index), frame), y_of(&chart.y, length(index + 1), frame))
        else {
            continue;
        };
        let (top, bottom) = (one.min(other), one.max(other));
        let border = |column: usize| map.borders.get(column).and_then(|b| x_of(&chart.x, *b, frame));
        // Neighbours of one colour become one rectangle: a smooth map is then a tenth of its size.
        let mut column = 0;
        while column < row.len() {
            let colour = row[column].map(|v| map.scale.colour(stepped(v, map.scale)));
            let mut end = column + 1;
            while !map.with_numbers
                && end < row.len()
                && row[end].map(|v| map.scale.colour(stepped(v, map.scale))) == colour
            {
                end += 1;
            }
            if let (Some(left), Some(right)) = (border(column), border(end)) {
                // A little under its neighbours, which are drawn later, so that no seam shows between them.
                let overlap = if map.with_numbers { 0.0 } else { 0.6 };
                let (from, to) =
                    ((left, top), ((right + overlap).min(frame.right), (bottom + overlap).min(frame.bottom)));
                shapes.push(Shape::Rectangle { from, to, colour: colour.unwrap_or(PALE) });
                match (colour, row[column]) {
                    (Some(colour), Some(value)) if map.with_numbers => {
                        let ink = if is_light(colour) { BLACK } else { WHITE };
                        let number = crate::number::correlation(value, 2);
                        let at = ((left + right) / 2.0, (top + bottom) / 2.0);
                        shapes.push(text(number, at, TICK_SIZE, Align::Middle).coloured(ink));
                    }
                    (None, _) => hatch(from, to, shapes),
                    _ => {}
                }
            }
            column = end;
        }
    }
}

/// A value moved to the middle of one of 64 steps of the scale, more than an eye tells apart.
fn stepped(value: f64, scale: Scale) -> f64 {
    const STEPS: f64 = 64.0;
    let (low, high) = scale.range();
    let share = ((value - low) / (high - low)).clamp(0.0, 1.0);
    low + (high - low) * (share * STEPS).round() / STEPS
}

fn hatch(from: (f64, f64), to: (f64, f64), shapes: &mut Vec<Shape>) {
    let (width, height) = (to.0 - from.0, to.1 - from.1);
    let mut offset = 6.0;
    while offset < width + height {
        let start = (from.0 + offset.min(width), from.1 + (offset - width).max(0.0));
        let end = (from.0 + (offset - height).max(0.0), from.1 + offset.min(height));
        shapes.push(line(&[start, end], GREY, 0.7));
        offset += 6.0;
    }
}

/// Draws the bar of a map's colours below it and returns where it ends.
pub(super) fn colour_bar(map: &Map, frame: Frame, top: f64, shapes: &mut Vec<Shape>) -> f64 {
    const STEPS: u32 = 64;
    let (low, high) = map.scale.range();
    let bar = Frame { left: frame.left, top, right: frame.right, bottom: top + BAR_HEIGHT };
    for step in 0..STEPS {
        let edge = |s: u32| bar.left + bar.width() * f64::from(s) / f64::from(STEPS);
        let value = low + (high - low) * (f64::from(step) + 0.5) / f64::from(STEPS);
        let colour = map.scale.colour(value);
        shapes.push(Shape::Rectangle {
            from: (edge(step), top),
            to: ((edge(step + 1) + 0.6).min(bar.right), bar.bottom),
            colour,
        });
    }
    let axis = Axis::linear(map.label.clone(), (low, high));
    x_ticks(&axis, bar, shapes);
    let at = ((bar.left + bar.right) / 2.0, bar.bottom + TICK_LENGTH + TICK_ROW_HEIGHT + 5.0);
    let label = shortened(&map.label, LABEL_SIZE, false, bar.width() + 40.0);
    shapes.push(text(label, at, LABEL_SIZE, Align::Middle).into());
    if map.clipped.is_empty() {
        return at.1 + LABEL_ROW_HEIGHT / 2.0;
    }
    let below = (at.0, at.1 + LABEL_ROW_HEIGHT - 2.0);
    let clipped = shortened(&map.clipped, TICK_SIZE, false, bar.width() + 40.0);
    shapes.push(text(clipped, below, TICK_SIZE, Align::Middle).into());
    below.1 + LABEL_ROW_HEIGHT / 2.0
}
