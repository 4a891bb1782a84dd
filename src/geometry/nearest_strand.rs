//! Which barb, or which place of the shaft, is nearest to each texel's centre.
//!
//! Every strand becomes a polyline; each of its segments offers itself to the texels within reach, and the nearest wins, by
//! distance first and by order where two are equally near. A texel that nobody reached is asked again with twice the reach.
//! So the winner is the nearest of all, at the cost of a few segments a texel. Bands of rows are independent of each other.

use kurbo::Point;

use super::bezier::as_f64;

/// Rows of a band: its buffers fit into a processor's cache.
pub(super) const BAND_ROWS: usize = 32;

/// Strands in one group may be asked for apart from others: the shaft, one vane, the other.
pub(super) type Groups = u8;

/// The place of a strand that is nearest to a texel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Place {
    /// Index of the strand.
    pub(super) strand: u32,
    /// Parameter on it, as good as its polyline.
    pub(super) t: f64,
}

/// A piece of a strand's polyline, in texels.
#[derive(Debug, Clone, Copy)]
pub(super) struct Segment {
    pub(super) ends: [Point; 2],
    pub(super) parameters: [f64; 2],
    pub(super) strand: u32,
    pub(super) group: Groups,
}

/// Strands over a grid, ready to be asked band by band.
#[derive(Debug)]
pub(super) struct Strands {
    width: usize,
    segments: Vec<Segment>,
    /// A first guess of the largest distance that a texel has to look, in texels.
    reach: f64,
    /// For each band the segments within reach of it, in order.
    offered: Vec<Vec<u32>>,
}

impl Strands {
    pub(super) fn new(width: usize, height: usize, segments: Vec<Segment>, reach: f64) -> Self {
        let bands = height.div_ceil(BAND_ROWS);
        let mut offered = vec![Vec::new(); bands];
        for (index, segment) in (0..).zip(&segments) {
            let [from, to] = span(segment.ends[0].y, segment.ends[1].y, reach, bands * BAND_ROWS);
            for band in offered.iter_mut().take(to.div_ceil(BAND_ROWS)).skip(from / BAND_ROWS) {
                band.push(index);
            }
        }
        Self { width, segments, reach, offered }
    }

    /// The nearest strand of each texel of a band, among the groups that it wants, in rows; none where it wants none.
    pub(super) fn nearest(&self, band: usize, wanted: &[Groups]) -> Vec<Option<Place>> {
        let mut search = Band::new(band * BAND_ROWS, self.width, wanted, self.reach);
        for &index in &self.offered[band] {
            search.offer(&self.segments[index as usize]);
        }
        // Texels far from every strand are rare; for those of this band, every segment is asked.
        while search.lacks_any() {
            search.reach *= 2.0;
            for segment in &self.segments {
                search.offer(segment);
            }
        }
        search.found
    }
}

/// The first texel and the one after the last whose centres may be within reach of two coordinates, of `count` texels.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to the texels there are")]
fn span(one: f64, other: f64, reach: f64, count: usize) -> [usize; 2] {
    let last = as_f64(count);
    let from = (one.min(other) - reach - 0.5).ceil().clamp(0.0, last);
    let to = ((one.max(other) + reach - 0.5).floor() + 1.0).clamp(from, last);
    [from as usize, to as usize]
}

struct Band<'a> {
    first_row: usize,
    width: usize,
    wanted: &'a [Groups],
    reach: f64,
    /// Squared distance to the nearest strand so far.
    distances: Vec<f64>,
    found: Vec<Option<Place>>,
}

impl<'a> Band<'a> {
    fn new(first_row: usize, width: usize, wanted: &'a [Groups], reach: f64) -> Self {
        let distances = vec![f64::INFINITY; wanted.len()];
        Self { first_row, width, wanted, reach, distances, found: vec![None; wanted.len()] }
    }

    fn lacks_any(&self) -> bool {
        self.wanted.iter().zip(&self.found).any(|(groups, found)| *groups != 0 && found.is_none())
    }

    fn offer(&mut self, segment: &Segment) {
        let [start, end] = segment.ends;
        let chord = end - start;
        let length2 = chord.hypot2();
        let rows = self.wanted.len() / self.width;
        let offset = as_f64(self.first_row);
        let [top, bottom] = span(start.y - offset, end.y - offset, self.reach, rows);
        let [left, right] = span(start.x, end.x, self.reach, self.width);
        for row in top..bottom {
            for column in left..right {
                let index = row * self.width + column;
                if self.wanted[index] & segment.group == 0 {
                    continue;
                }
                let centre = Point::new(as_f64(column) + 0.5, as_f64(row) + 0.5 + offset);
                let share = if length2 > 0.0 { ((centre - start).dot(chord) / length2).clamp(0.0, 1.0) } else { 0.0 };
                let distance = (start + share * chord - centre).hypot2();
                if distance < self.distances[index] && distance <= self.reach * self.reach {
                    self.distances[index] = distance;
                    let t = segment.parameters[0] + share * (segment.parameters[1] - segment.parameters[0]);
                    self.found[index] = Some(Place { strand: segment.strand, t });
                }
            }
        }
    }
}
