//! Light from far away on all sides, as a picture of the whole sphere.
//!
//! The picture is equirectangular: its rows run from the zenith (+z) to the nadir, its columns once around, from +x
//! towards +y. Directions are drawn in proportion to a texel's luminance and solid angle, by its row and then by its
//! column (Pharr, Jakob and Humphreys 2016, section 14.2.4).

use std::f64::consts::{PI, TAU};

use super::ray::{Colour, Vector, luminance};
use super::texture::Texture;

/// A picture of the light from all sides.
#[derive(Debug, Clone)]
pub struct EnvironmentMap {
    radiance: Texture,
    /// cos and sin of the azimuth of the picture's left edge.
    turn: (f64, f64),
    rows: Distribution,
    columns: Vec<Distribution>,
}

impl EnvironmentMap {
    /// From a picture of radiances, its left edge at this azimuth from +x towards +y, degrees.
    ///
    /// None where all of it is black.
    pub fn new(radiance: Texture, azimuth_deg: f64) -> Option<Self> {
        let (width, height) = (radiance.width(), radiance.height());
        let luminance_at = |x: usize, y: usize| luminance(radiance.texel(x, y));
        // Between centres of texels radiance is interpolated, so that light reaches half a texel into black ones: what
        // directions are drawn by is the mean over a texel and its neighbours, which is nowhere black where the light is not.
        let spread = |x: usize, y: usize| {
            let columns = [(x + width - 1) % width, x, (x + 1) % width];
            let rows = [y.saturating_sub(1), y, (y + 1).min(height - 1)];
            let weights = [0.125, 0.75, 0.125];
            let mut sum = 0.0;
            for (row, w_row) in rows.into_iter().zip(weights) {
                for (column, w_column) in columns.into_iter().zip(weights) {
                    sum += w_row * w_column * luminance_at(column, row);
                }
            }
            sum
        };
        let mut columns = Vec::with_capacity(height);
        let mut row_weights = Vec::with_capacity(height);
        for y in 0..height {
            let weights: Vec<f64> = (0..width).map(|x| spread(x, y)).collect();
            let solid_angle = cosine_of_row(y, height) - cosine_of_row(y + 1, height);
            row_weights.push(solid_angle * weights.iter().sum::<f64>());
            columns.push(Distribution::new(&weights));
        }
        let rows = Distribution::new(&row_weights);
        let (sin_turn, cos_turn) = azimuth_deg.to_radians().sin_cos();
        (rows.total > 0.0).then_some(Self { radiance, turn: (cos_turn, sin_turn), rows, columns })
    }

    /// Radiance from a direction.
    pub fn radiance(&self, direction: &Vector) -> Colour {
        let [u, v] = self.place(direction);
        self.radiance.around(u, v)
    }

    /// A direction towards its light, with the density of [`EnvironmentMap::density`].
    pub fn draw(&self, random: [f64; 2]) -> Vector {
        let (y, within_y) = self.rows.draw(random[1]);
        let (x, within_x) = self.columns[y].draw(random[0]);
        let height = self.columns.len();
        let (upper, lower) = (cosine_of_row(y, height), cosine_of_row(y + 1, height));
        let cosine = upper + (lower - upper) * within_y;
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
        #[expect(clippy::cast_precision_loss, reason = "a picture's columns are far below 2^53")]
        let azimuth = TAU * (x as f64 + within_x) / self.radiance.width() as f64;
        let (sin, cos) = azimuth.sin_cos();
        let (cos_turn, sin_turn) = self.turn;
        Vector::new(sine * (cos * cos_turn - sin * sin_turn), sine * (sin * cos_turn + cos * sin_turn), cosine)
    }

    /// Density of [`EnvironmentMap::draw`], 1/sr.
    pub fn density(&self, direction: &Vector) -> f64 {
        let [u, v] = self.place(direction);
        let (x, y) = (index(u, self.radiance.width()), index(v, self.columns.len()));
        let height = self.columns.len();
        let solid_angle = (cosine_of_row(y, height) - cosine_of_row(y + 1, height)) * TAU;
        #[expect(clippy::cast_precision_loss, reason = "a picture's columns are far below 2^53")]
        let width = self.radiance.width() as f64;
        self.rows.probability(y) * self.columns[y].probability(x) * width / solid_angle
    }

    /// Luminance integrated over all directions.
    pub fn flux(&self) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "a picture's columns are far below 2^53")]
        let width = self.radiance.width() as f64;
        self.rows.total * TAU / width
    }

    /// Share of the width from the left edge and of the height from the upper one.
    fn place(&self, direction: &Vector) -> [f64; 2] {
        let (cos_turn, sin_turn) = self.turn;
        let (x, y) = (direction.x * cos_turn + direction.y * sin_turn, direction.y * cos_turn - direction.x * sin_turn);
        let azimuth = y.atan2(x);
        let around = if azimuth < 0.0 { azimuth + TAU } else { azimuth };
        [around / TAU, direction.z.clamp(-1.0, 1.0).acos() / PI]
    }
}

/// Cosine from the zenith of the upper edge of a row.
fn cosine_of_row(row: usize, height: usize) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "a picture's rows are far below 2^53")]
    let share = row as f64 / height as f64;
    (PI * share).cos()
}

/// Which of `count` equal parts a share lies in.
fn index(share: f64, count: usize) -> usize {
    #[expect(clippy::cast_precision_loss, reason = "a picture's texels are far below 2^53")]
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "not negative, and cut to the range")]
    let index = (share * count as f64) as usize;
    index.min(count - 1)
}

/// A piecewise constant density over equal cells.
#[derive(Debug, Clone)]
struct Distribution {
    /// Sums of the weights up to and with each cell, over the total.
    cumulative: Vec<f64>,
    total: f64,
}

impl Distribution {
    fn new(weights: &[f64]) -> Self {
        let total: f64 = weights.iter().sum();
        let mut sum = 0.0;
        let cumulative = weights.iter().map(|weight| {
            sum += weight;
            if total > 0.0 { sum / total } else { 0.0 }
        });
        Self { cumulative: cumulative.collect(), total }
    }

    /// A cell in proportion to its weight, and a place in it.
    fn draw(&self, random: f64) -> (usize, f64) {
        let cell = self.cumulative.partition_point(|sum| *sum <= random).min(self.cumulative.len() - 1);
        let (before, share) = (self.before(cell), self.probability(cell));
        (cell, if share > 0.0 { ((random - before) / share).clamp(0.0, 1.0) } else { 0.5 })
    }

    fn probability(&self, cell: usize) -> f64 {
        self.cumulative[cell] - self.before(cell)
    }

    fn before(&self, cell: usize) -> f64 {
        if cell == 0 { 0.0 } else { self.cumulative[cell - 1] }
    }
}
