//! How much of a texel an area covers.
//!
//! Areas that are wider than a texel, shaft and vane, are filled by tiny-skia. It samples at 4 × 4 places, which would put
//! an edge along the grid off by an eighth of a texel; so each texel is filled as 4 × 4 of its own, and good to 1/32. A
//! single barb may be narrower than a texel, and is nearly straight over it: the share of a square beside a straight line
//! has a closed form.

use kurbo::{Point, Vec2};
use rayon::prelude::*;
use tiny_skia::{FillRule, Mask, Path, PathBuilder, Transform};

use super::grid::Grid;

/// A texel is filled as this many squared.
const FINER: u32 = 4;

/// Rows of texels that are filled at once.
const BAND_ROWS: u32 = 32;

/// The share of each texel that the union of these polygons covers, 0 to 255, in rows from the top. Each polygon runs
/// counter-clockwise, so that where two overlap the area is still covered, once.
pub(super) fn union(grid: &Grid, polygons: &[Vec<Point>]) -> Vec<u8> {
    let path = path(grid, polygons);
    let bands: Vec<u32> = (0..grid.height).step_by(BAND_ROWS as usize).collect();
    let filled: Vec<Vec<u8>> = bands
        .into_par_iter()
        .map(|first_row| {
            let rows = BAND_ROWS.min(grid.height - first_row);
            let fine = fill(path.as_ref(), grid.width, first_row, rows, FINER, true);
            means(&fine, (FINER * grid.width) as usize)
        })
        .collect();
    filled.concat()
}

/// Whether the centre of each texel lies in the polygon.
pub(super) fn inside(grid: &Grid, polygon: Vec<Point>) -> Vec<bool> {
    let path = path(grid, &[polygon]);
    fill(path.as_ref(), grid.width, 0, grid.height, 1, false).into_iter().map(|share| share > 0).collect()
}

/// Fills these rows at a finer grid, each texel as `finer` squared.
fn fill(path: Option<&Path>, width: u32, first_row: u32, rows: u32, finer: u32, antialiased: bool) -> Vec<u8> {
    // A grid has texels.
    Mask::new(finer * width, finer * rows).map_or_else(Vec::new, |mut mask| {
        #[expect(clippy::cast_precision_loss, reason = "a map has fewer rows than single precision has digits")]
        let (scale, up) = (finer as f32, -((finer * first_row) as f32));
        if let Some(path) = path {
            mask.fill_path(path, FillRule::Winding, antialiased, Transform::from_row(scale, 0.0, 0.0, scale, 0.0, up));
        }
        mask.take()
    })
}

/// Means over squares of a finer grid, rounded.
fn means(fine: &[u8], fine_width: usize) -> Vec<u8> {
    let side = FINER as usize;
    fine.chunks_exact(side * fine_width)
        .flat_map(|rows| {
            (0..fine_width / side).map(move |column| {
                let row = |index: usize| &rows[index * fine_width + side * column..][..side];
                let sum: u32 = (0..side).flat_map(row).map(|&share| u32::from(share)).sum();
                let count = FINER * FINER;
                u8::try_from((sum + count / 2) / count).unwrap_or(u8::MAX)
            })
        })
        .collect()
}

#[expect(clippy::cast_possible_truncation, reason = "a texel's place is good to 1e-3 in single precision")]
fn path(grid: &Grid, polygons: &[Vec<Point>]) -> Option<Path> {
    let mut builder = PathBuilder::new();
    for polygon in polygons {
        for (index, &point) in polygon.iter().enumerate() {
            let Point { x, y } = grid.in_texels(point);
            if index == 0 {
                builder.move_to(x as f32, y as f32);
            } else {
                builder.line_to(x as f32, y as f32);
            }
        }
        builder.close();
    }
    builder.finish()
}

/// The share of a unit square around the origin that lies where x·n < `distance`, n a unit vector.
pub(super) fn half_plane(distance: f64, normal: Vec2) -> f64 {
    let (larger, smaller) = {
        let (x, y) = (normal.x.abs(), normal.y.abs());
        (x.max(y), x.min(y))
    };
    // The line passes the far corner, then two neighbouring ones, then the near corner.
    let (corner, edge) = (0.5 * (larger + smaller), 0.5 * (larger - smaller));
    let beyond = |d: f64| if d <= -corner { 0.0 } else { (d + corner).powi(2) / (2.0 * larger * smaller) };
    if distance.abs() < edge {
        0.5 + distance / larger
    } else if distance < 0.0 {
        // Where the line is parallel to a side, corner and edge are one, and only the first case of the two is met.
        beyond(distance)
    } else {
        1.0 - beyond(-distance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Counted on 400 × 400 places, whose error is below the perimeter's share, 1/200.
    #[test]
    fn the_share_beside_a_line_is_the_counted_one() {
        for degrees in [0.0, 10.0, 45.0, 77.0, 90.0, 135.0, 261.0] {
            let normal = Vec2::from_angle(f64::to_radians(degrees));
            for distance in [-0.8, -0.6, -0.5, -0.2, 0.0, 0.1, 0.45, 0.5, 0.7] {
                let places = (0..400).map(|i| (f64::from(i) + 0.5) / 400.0 - 0.5);
                let inside = places
                    .clone()
                    .flat_map(|x| places.clone().map(move |y| Vec2::new(x, y)))
                    .filter(|p| p.dot(normal) < distance);
                let counted = f64::from(u32::try_from(inside.count()).unwrap()) / 160_000.0;
                approx::assert_abs_diff_eq!(half_plane(distance, normal), counted, epsilon = 5e-3);
            }
        }
    }
}
