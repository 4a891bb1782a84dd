//! From a feather to its map.

use kurbo::{Point, Vec2};
use rayon::prelude::*;

use super::barb::{Barb, Side};
use super::bezier::Bezier;
use super::coverage::{half_plane, inside, union};
use super::feather::Feather;
use super::file::BetweenBarbs;
use super::grid::Grid;
use super::map::{NOTHING, TexelClass, coded};
use super::nearest_strand::{BAND_ROWS, Groups, Place, Segment, Strands};
use super::place::{Ground, VanePlace};
use super::polygon;
use super::{FeatherMap, GeometryError};

const SHAFT: Groups = 1;

fn group(side: Side) -> Groups {
    match side {
        Side::Left => 2,
        Side::Right => 4,
    }
}

/// Largest distance of a polyline from its curve, texels: it decides which barb is the nearest, and where Newton's method
/// begins; the tangent is the curve's own.
const POLYLINE_TEXELS: f64 = 0.02;

/// Largest distance of a polygon from the curves around an area, texels; tiny-skia's own steps are coarser.
const POLYGON_TEXELS: f64 = 0.01;

impl FeatherMap {
    /// Draws a feather at a resolution in texels a millimetre, which is rounded to thousandths. Without one the map has
    /// 2048 texels along its longer side.
    ///
    /// # Errors
    /// A resolution that makes no map, or one that is too large.
    pub fn of(feather: &Feather, pixels_per_mm: Option<f64>) -> Result<Self, GeometryError> {
        let grid = Grid::new(feather.bounds_mm(), pixels_per_mm)?;
        Ok(draw(feather, &grid, Vec::new()).0)
    }

    /// The same map, and where each texel of a barb or its barbules lies on its vane, in rows from the top.
    ///
    /// # Errors
    /// As [`FeatherMap::of`].
    pub fn with_places(
        feather: &Feather,
        pixels_per_mm: Option<f64>,
    ) -> Result<(Self, Vec<Option<VanePlace>>), GeometryError> {
        let grid = Grid::new(feather.bounds_mm(), pixels_per_mm)?;
        Ok(draw(feather, &grid, Ground::of_all(feather)))
    }
}

/// Draws a feather on a grid, in bands of rows that are independent of each other. Places are told where the grounds of
/// barbs are given.
fn draw(feather: &Feather, grid: &Grid, grounds: Vec<Ground>) -> (FeatherMap, Vec<Option<VanePlace>>) {
    let picture = Picture::new(feather, grid, grounds);
    let (width, height) = (grid.width as usize, grid.height as usize);
    let shaft_reach = 1.0 + 0.55 * picture.widest_shaft_mm() * grid.pixels_per_mm;
    let shaft = Strands::new(width, height, picture.shaft_segments(shaft_reach), shaft_reach);
    // Half the way between two barbs is farthest, unless they spread.
    let barb_reach = 1.0 + 0.75 * picture.widest_pitch_mm() * grid.pixels_per_mm;
    let barbs = Strands::new(width, height, picture.barb_segments(barb_reach), barb_reach);
    let bands: Vec<Vec<([u16; 4], Option<VanePlace>)>> = (0..height.div_ceil(BAND_ROWS))
        .into_par_iter()
        .map(|band| {
            let first = band * BAND_ROWS * width;
            let texels = first..(first + BAND_ROWS * width).min(width * height);
            let shaft_wanted: Vec<Groups> = texels.clone().map(|index| picture.shaft_wanted(index)).collect();
            let barbs_wanted: Vec<Groups> = texels.clone().map(|index| picture.barbs_wanted(index)).collect();
            let places = shaft.nearest(band, &shaft_wanted).into_iter().zip(barbs.nearest(band, &barbs_wanted));
            texels.zip(places).map(|(index, (shaft, barb))| picture.texel(index, shaft, barb)).collect()
        })
        .collect();
    let (texels, places) = bands.into_iter().flatten().unzip();
    (FeatherMap::from_texels(grid.width, grid.pixels_per_mm, texels), places)
}

/// A feather over a grid, with what is known before any tangent is looked up.
struct Picture<'a> {
    feather: &'a Feather,
    grid: &'a Grid,
    /// Barbs of both vanes, the left one's first.
    barbs: Vec<&'a Barb>,
    /// Where they stand on the rachis; empty where nobody asks.
    grounds: Vec<Ground>,
    /// Share of each texel that the shaft covers, 0 to 255.
    shaft: Vec<u8>,
    /// Share that shaft or closed vane covers.
    whole: Vec<u8>,
    /// Whether the texel's centre lies in the left vane, and in the right one.
    in_vane: [Vec<bool>; 2],
}

impl<'a> Picture<'a> {
    fn new(feather: &'a Feather, grid: &'a Grid, grounds: Vec<Ground>) -> Self {
        let tolerance_mm = POLYGON_TEXELS / grid.pixels_per_mm;
        let shaft = polygon::shaft(&feather.shaft, tolerance_mm);
        let vanes = feather.vanes.each_ref().map(|vane| polygon::vane(vane, &feather.shaft, tolerance_mm));
        // The first barb and the last are half outside the polygon through their axes.
        let border = feather.vanes.iter().flat_map(|vane| [&vane.barbs[0], &vane.barbs[vane.barbs.len() - 1]]);
        let border = border.map(|barb| polygon::barb(barb, feather.barb_width_mm, tolerance_mm));
        let areas: Vec<Vec<Point>> = vanes.iter().cloned().chain(border).chain([shaft.clone()]).collect();
        Self {
            feather,
            grid,
            barbs: feather.vanes.iter().flat_map(|vane| &vane.barbs).collect(),
            grounds,
            shaft: union(grid, &[shaft]),
            whole: union(grid, &areas),
            in_vane: vanes.map(|vane| inside(grid, vane)),
        }
    }

    fn widest_shaft_mm(&self) -> f64 {
        self.feather.shaft.width_mm(0.0).max(self.feather.shaft.width_mm(1.0))
    }

    fn widest_pitch_mm(&self) -> f64 {
        self.feather.vanes.iter().map(|vane| self.feather.barb_pitch_mm(vane)).fold(0.0, f64::max)
    }

    /// Whether a texel may need the shaft's tangent.
    fn shaft_wanted(&self, index: usize) -> Groups {
        if self.shaft[index] > 0 { SHAFT } else { 0 }
    }

    /// Which vane's barbs a texel may take its tangent from: its own vane's, or either's at an edge.
    fn barbs_wanted(&self, index: usize) -> Groups {
        match self.in_vane.each_ref().map(|vane| vane[index]) {
            _ if self.whole[index] == 0 || self.shaft[index] == u8::MAX => 0,
            [true, false] => group(Side::Left),
            [false, true] => group(Side::Right),
            _ => group(Side::Left) | group(Side::Right),
        }
    }

    fn shaft_segments(&self, reach: f64) -> Vec<Segment> {
        self.segments(&self.feather.shaft.curve, 0, SHAFT, reach)
    }

    fn barb_segments(&self, reach: f64) -> Vec<Segment> {
        let sides = self.feather.vanes.iter().flat_map(|vane| vane.barbs.iter().map(|_| vane.side));
        (0..)
            .zip(self.barbs.iter().zip(sides))
            .flat_map(|(strand, (barb, side))| self.segments(&barb.curve.into(), strand, group(side), reach))
            .collect()
    }

    /// A curve's polyline in texels. Its pieces are about as long as they reach: longer ones would offer themselves to many
    /// texels in vain.
    fn segments(&self, curve: &Bezier, strand: u32, group: Groups, reach: f64) -> Vec<Segment> {
        let in_mm = 1.0 / self.grid.pixels_per_mm;
        curve
            .polyline_in_pieces(POLYLINE_TEXELS * in_mm, reach * in_mm)
            .windows(2)
            .map(|pair| Segment {
                ends: [self.grid.in_texels(pair[0].1), self.grid.in_texels(pair[1].1)],
                parameters: [pair[0].0, pair[1].0],
                strand,
                group,
            })
            .collect()
    }

    /// The texel whose nearest places on shaft and barbs are known, where it may need them; and where it lies on its vane.
    fn texel(&self, index: usize, shaft: Option<Place>, barb: Option<Place>) -> ([u16; 4], Option<VanePlace>) {
        let width = self.grid.width as usize;
        let centre = self.grid.centre_mm(index % width, index / width);
        let barb = barb.map(|place| {
            let barb = place.strand as usize;
            (barb, self.barbs[barb].nearest(centre, place.t))
        });

        // What of the texel each class covers, the shaft lying on the barbs.
        let whole = f64::from(self.whole[index]) / 255.0;
        let of_shaft = f64::from(self.shaft[index]) / 255.0;
        let of_barbs = match (barb, self.feather.between_barbs) {
            (None, _) => 0.0,
            (Some(_), BetweenBarbs::Barbules) => whole - of_shaft,
            (Some((barb, t)), BetweenBarbs::Nothing) => (1.0 - of_shaft) * self.loose_barbs_coverage(barb, t, centre),
        };

        match (shaft, barb) {
            (Some(place), _) if of_shaft >= of_barbs => {
                let curve = &self.feather.shaft.curve;
                (coded(TexelClass::Shaft, curve.tangent(curve.nearest(centre, place.t)), of_shaft + of_barbs), None)
            }
            (_, Some((barb, t))) if of_barbs > 0.0 => {
                let place = self.grounds.get(barb).map(|ground| {
                    ground.place(self.barbs[barb], t, centre, self.loose_barbs_coverage(barb, t, centre))
                });
                (coded(TexelClass::Barb, self.barbs[barb].tangent(t), of_shaft + of_barbs), place)
            }
            _ => (NOTHING, None),
        }
    }

    /// The share of a texel that loose barbs cover: the nearest one and its neighbours on both sides.
    fn loose_barbs_coverage(&self, nearest: usize, t: f64, centre: Point) -> f64 {
        let neighbours = [nearest.checked_sub(1), Some(nearest + 1)].into_iter().flatten();
        let others = neighbours.filter_map(|other| self.barbs.get(other));
        let others: f64 = others.map(|other| self.strip(other, other.nearest(centre, t), centre)).sum();
        (self.strip(self.barbs[nearest], t, centre) + others).min(1.0)
    }

    /// The share of a texel that one barb covers: a straight strip that ends where the barb does.
    fn strip(&self, barb: &Barb, t: f64, centre: Point) -> f64 {
        let off = |point: Point| self.grid.pixels_per_mm * (point - centre);
        let tangent = barb.tangent(t);
        let normal = Vec2::new(-tangent.y, tangent.x);
        let axis = off(barb.jet(t).point).dot(normal);
        let half = 0.5 * self.grid.pixels_per_mm * self.feather.barb_width_mm;
        let across = half_plane(axis + half, normal) - half_plane(axis - half, normal);
        let (first, last) = (barb.tangent(0.0), barb.tangent(1.0));
        let before_end = half_plane(off(barb.curve.p3).dot(last), last);
        let after_root = half_plane(-off(barb.curve.p0).dot(first), -first);
        across * before_end * after_root
    }
}
