//! Pictures laid over surfaces, and around the scene.

use super::ray::Colour;

/// A picture of linear values, in rows from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Texture {
    width: usize,
    texels: Vec<[f32; 3]>,
}

impl Texture {
    /// A picture of this width; None where the texels fill no whole rows.
    pub fn new(width: usize, texels: Vec<[f32; 3]>) -> Option<Self> {
        let whole = width > 0 && !texels.is_empty() && texels.len().is_multiple_of(width);
        whole.then_some(Self { width, texels })
    }

    /// Texels a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.texels.len() / self.width
    }

    /// The texel in this column and row.
    #[inline]
    pub fn texel(&self, x: usize, y: usize) -> Colour {
        let [r, g, b] = self.texels[y * self.width + x];
        [r.into(), g.into(), b.into()]
    }

    /// All texels.
    pub fn texels(&self) -> &[[f32; 3]] {
        &self.texels
    }

    /// The value at a place, u to the right and v upwards, 0 to 1: interpolated between centres of texels, constant beyond
    /// the outermost ones.
    #[inline]
    pub fn at(&self, uv: [f64; 2]) -> Colour {
        let (x, right) = between(uv[0], self.width);
        let (y, down) = between(1.0 - uv[1], self.height());
        let (next_x, next_y) = ((x + 1).min(self.width - 1), (y + 1).min(self.height() - 1));
        self.mix([x, next_x], right, [y, next_y], down)
    }

    /// The same for a picture that closes to a ring: u from the left edge, v from the upper one.
    pub(super) fn around(&self, u: f64, v: f64) -> Colour {
        #[expect(clippy::cast_precision_loss, reason = "a picture's columns are far below 2^53")]
        let shifted = (u - 0.5 / self.width as f64).rem_euclid(1.0) + 0.5 / self.width as f64;
        let (x, right) = between(shifted, self.width);
        let (y, down) = between(v, self.height());
        self.mix([x, (x + 1) % self.width], right, [y, (y + 1).min(self.height() - 1)], down)
    }

    #[inline]
    fn mix(&self, [x0, x1]: [usize; 2], right: f64, [y0, y1]: [usize; 2], down: f64) -> Colour {
        let (a, b, c, d) = (self.texel(x0, y0), self.texel(x1, y0), self.texel(x0, y1), self.texel(x1, y1));
        std::array::from_fn(|k| {
            let (upper, lower) = (a[k] + (b[k] - a[k]) * right, c[k] + (d[k] - c[k]) * right);
            upper + (lower - upper) * down
        })
    }
}

/// The texel whose centre lies before a share of the whole, and the place between it and the next.
#[inline]
fn between(share: f64, count: usize) -> (usize, f64) {
    #[expect(clippy::cast_precision_loss, reason = "a picture's texels are far below 2^53")]
    let place = (share * count as f64 - 0.5).clamp(0.0, (count - 1) as f64);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "cut to the range")]
    let texel = place as usize;
    #[expect(clippy::cast_precision_loss, reason = "a picture's texels are far below 2^53")]
    let rest = place - texel as f64;
    (texel, rest)
}
