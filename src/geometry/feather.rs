//! A feather's geometry after every check: it can be drawn.

use std::path::Path;

use kurbo::{ParamCurveArclen, Point, Rect};
use rayon::prelude::*;

use super::arc_length::ArcLength;
use super::barb::{Astray, Barb, Bed, Side};
use super::bezier::{Bezier, as_f64};
use super::check;
use super::crossing::{Target, self_crossing};
use super::file::{BarbsFile, BetweenBarbs, FeatherFile, VaneFile, VariationFile};
use super::variation::{Deviation, deviations};
use super::{FeatherMistake, GeometryError};
use crate::json_file;
use crate::number;

/// Lengths of barbs are good to this, mm.
const LENGTH_ACCURACY_MM: f64 = 1e-6;

/// A feather that can be drawn.
#[derive(Debug, Clone)]
pub struct Feather {
    /// One line for people.
    pub title: String,
    /// The axis.
    pub shaft: Shaft,
    /// The left vane and the right one.
    pub vanes: [Vane; 2],
    /// Width of every barb, mm.
    pub barb_width_mm: f64,
    /// What lies between two neighbouring barbs.
    pub between_barbs: BetweenBarbs,
}

/// The axis of a feather: calamus, then rachis.
#[derive(Debug, Clone)]
pub struct Shaft {
    /// The curve from base to tip, mm.
    pub curve: Bezier,
    /// Its length, mm.
    pub length_mm: f64,
    /// Length of the calamus, mm.
    pub calamus_length_mm: f64,
    /// The curve's parameter where the calamus ends and the rachis begins.
    pub rachis_start: f64,
    base_width_mm: f64,
    tip_width_mm: f64,
    along: ArcLength,
}

impl Shaft {
    /// Width at the parameter t, mm: it changes evenly along the length.
    pub fn width_mm(&self, t: f64) -> f64 {
        self.base_width_mm + (self.tip_width_mm - self.base_width_mm) * self.along.at(t) / self.length_mm
    }

    /// Length of the rachis, mm.
    pub fn rachis_length_mm(&self) -> f64 {
        self.length_mm - self.calamus_length_mm
    }

    /// The parameter at a distance from the beginning of the rachis along it, mm.
    pub fn at_rachis_mm(&self, distance: f64) -> f64 {
        self.along.parameter(self.calamus_length_mm + distance)
    }
}

/// One vane.
#[derive(Debug, Clone)]
pub struct Vane {
    /// Which.
    pub side: Side,
    /// Its outline, from the beginning of the rachis to its tip, mm.
    pub outline: Bezier,
    /// Angle between the rachis and the barbs as planned, degrees.
    pub barb_angle_deg: f64,
    /// Its barbs, from the first to the one nearest to the tip.
    pub barbs: Vec<Barb>,
}

impl Vane {
    /// Mean length of a barb from the rachis's axis to the outline, mm.
    pub fn mean_barb_length_mm(&self) -> f64 {
        let sum: f64 = self.barbs.iter().map(|barb| barb.curve.arclen(LENGTH_ACCURACY_MM)).sum();
        sum / as_f64(self.barbs.len())
    }
}

impl Feather {
    /// Reads a feather from its JSON file, or from the `feather.json` in a folder, and makes its barbs.
    ///
    /// # Errors
    /// A sentence that names the file and the line or key, and says how to mend it.
    pub fn read(path: &Path) -> Result<Self, GeometryError> {
        let file: FeatherFile = json_file::read(path, "feather.json")?;
        let path = json_file::in_folder(path, "feather.json");
        Self::new(&file).map_err(|mistake| GeometryError::Mistake { path, mistake })
    }

    /// Checks a feather and makes its barbs.
    ///
    /// # Errors
    /// The first key whose value makes no sense.
    pub fn new(file: &FeatherFile) -> Result<Self, FeatherMistake> {
        check::numbers(file)?;
        let shaft = shaft(file)?;
        let rachis = shaft.curve.after(shaft.rachis_start);
        let rachis_target = Target::new(&rachis);
        let mut vanes = Vec::with_capacity(2);
        for (side, vane) in [(Side::Left, &file.left_vane), (Side::Right, &file.right_vane)] {
            let outline = outline(vane, side, &rachis, &rachis_target)?;
            let hull = shaft.curve.hull().union(outline.hull());
            let bed = Bed {
                side,
                rachis: &rachis_target,
                outline: &Target::new(&outline),
                reach_mm: hull.width() + hull.height(),
            };
            let barbs = barbs(&shaft, vane, &file.barbs, file.variation.as_ref(), &bed)?;
            vanes.push(Vane { side, outline, barb_angle_deg: vane.barb_angle_deg, barbs });
        }
        let feather = |vanes| Self {
            title: file.title.clone(),
            shaft,
            vanes,
            barb_width_mm: file.barbs.width_um / 1000.0,
            between_barbs: file.barbs.between,
        };
        match <[Vane; 2]>::try_from(vanes) {
            Ok(vanes) => Ok(feather(vanes)),
            Err(_) => unreachable!("two sides were built"),
        }
    }

    /// Distance between the axes of two neighbouring barbs of a vane as planned, square to them, mm.
    pub fn barb_pitch_mm(&self, vane: &Vane) -> f64 {
        self.shaft.rachis_length_mm() / as_f64(vane.barbs.len()) * vane.barb_angle_deg.to_radians().sin()
    }

    /// Share of a vane's area that its barbs cover, width/(width + spacing), the spacing from edge to edge: the scattering
    /// model's weight `w_b` (the first thesis, section 5.2 and Table B.1).
    pub fn barb_share(&self, vane: &Vane) -> f64 {
        self.barb_width_mm / self.barb_pitch_mm(vane)
    }

    /// A rectangle around the feather, mm.
    pub fn bounds_mm(&self) -> Rect {
        /// The polyline that stands for a curve here is this near to it, far less than a texel.
        const NEAR_MM: f64 = 1e-3;
        let shaft = self.shaft.curve.polyline(NEAR_MM).into_iter().map(|(t, point)| {
            let half = 0.5 * self.shaft.width_mm(t);
            Rect::from_center_size(point, (2.0 * half, 2.0 * half))
        });
        let half = 0.5 * self.barb_width_mm;
        let outlines = self.vanes.iter().flat_map(|vane| vane.outline.polyline(NEAR_MM));
        let vanes = outlines.map(|(_, point)| Rect::from_center_size(point, (2.0 * half, 2.0 * half)));
        let around = |one: Rect, other: Rect| one.union(other);
        shaft.chain(vanes).reduce(around).unwrap_or(Rect::ZERO)
    }
}

fn points(file: &[[f64; 2]]) -> impl Iterator<Item = Point> {
    file.iter().map(|&[x, y]| Point::new(x, y))
}

/// The axis, checked.
fn shaft(file: &FeatherFile) -> Result<Shaft, FeatherMistake> {
    const KEY: &str = "shaft.control_points_mm";
    let plan = &file.shaft;
    let curve = Bezier::new(points(&plan.control_points_mm).collect());
    let along = ArcLength::new(&curve);
    let length_mm = along.total();
    if length_mm < check::SHORTEST_SHAFT_MM {
        return Err(FeatherMistake::new(
            KEY,
            format!(
                "found a shaft of {} mm; expected one of at least {} mm: are its points in mm?",
                number::plain(length_mm),
                number::plain(check::SHORTEST_SHAFT_MM)
            ),
        ));
    }
    if let Some(crossing) = self_crossing(&curve) {
        return Err(crosses_itself(KEY, "the shaft", &curve, crossing));
    }
    if plan.calamus_length_mm >= length_mm {
        return Err(FeatherMistake::new(
            "shaft.calamus_length_mm",
            format!(
                "found {}, but the whole shaft is {} mm long and the rachis needs a part of it; make it shorter",
                number::plain(plan.calamus_length_mm),
                number::plain(length_mm)
            ),
        ));
    }
    Ok(Shaft {
        rachis_start: along.parameter(plan.calamus_length_mm),
        curve,
        length_mm,
        calamus_length_mm: plan.calamus_length_mm,
        base_width_mm: plan.base_width_mm,
        tip_width_mm: plan.tip_width_mm,
        along,
    })
}

fn crosses_itself(key: &str, what: &str, curve: &Bezier, (one, other): (f64, f64)) -> FeatherMistake {
    let at = place(curve.point(one));
    #[expect(clippy::float_cmp, reason = "equal parameters are how a cusp is told")]
    let problem = if one == other {
        format!("{what} turns back on the spot at {at} mm; move its control points apart")
    } else {
        format!("{what} crosses itself at {at} mm; expected a curve without a loop: move its control points")
    };
    FeatherMistake::new(key, problem)
}

/// A point as messages write it.
fn place(point: Point) -> String {
    format!("({}, {})", number::plain(point.x), number::plain(point.y))
}

/// A vane's outline, checked against the rachis.
fn outline(vane: &VaneFile, side: Side, rachis: &Bezier, target: &Target) -> Result<Bezier, FeatherMistake> {
    let key = format!("{}_vane.control_points_mm", side.name());
    let ends = (rachis.start(), rachis.end());
    let inner = points(&vane.control_points_mm);
    let outline = Bezier::new(std::iter::once(ends.0).chain(inner).chain(std::iter::once(ends.1)).collect());
    if let Some(crossing) = self_crossing(&outline) {
        return Err(crosses_itself(&key, "this outline", &outline, crossing));
    }
    let crossings = target.crossings(&outline).map_err(|_| {
        FeatherMistake::new(&key, "this outline lies on the rachis, so that the vane has no width; move its points out")
    })?;
    let inner = |t: f64| (1e-6..1.0 - 1e-6).contains(&t);
    if let Some(hit) = crossings.iter().find(|hit| inner(hit.first)) {
        return Err(FeatherMistake::new(
            key,
            format!("this outline crosses the rachis at {} mm; keep it on one side", place(hit.point)),
        ));
    }
    // Up the outline and down the rachis is clockwise for the left vane.
    let around: Vec<Point> = [outline.polyline(0.1), rachis.polyline(0.1).into_iter().rev().collect()]
        .concat()
        .into_iter()
        .map(|(_, point)| point)
        .collect();
    if super::polygon::signed_area(&around) * side.sign() >= 0.0 {
        return Err(FeatherMistake::new(
            key,
            format!(
                "this outline does not lie on the {} of the shaft, seen from its base to its tip with y up; exchange the \
                 vanes or move its points",
                side.name()
            ),
        ));
    }
    Ok(outline)
}

/// The barbs of a vane.
fn barbs(
    shaft: &Shaft,
    vane: &VaneFile,
    shape: &BarbsFile,
    variation: Option<&VariationFile>,
    bed: &Bed,
) -> Result<Vec<Barb>, FeatherMistake> {
    let count = shape.count_per_vane as usize;
    let spacing_mm = shaft.rachis_length_mm() / as_f64(count);
    let pitch_um = 1000.0 * spacing_mm * vane.barb_angle_deg.to_radians().sin();
    if shape.width_um >= pitch_um {
        return Err(FeatherMistake::new(
            "barbs.width_um",
            format!(
                "found {}, but {count} barbs at {}° stand only {} µm apart in the {} vane, from axis to axis; make them \
                 fewer or narrower",
                number::plain(shape.width_um),
                number::plain(vane.barb_angle_deg),
                number::plain(pitch_um),
                bed.side.name()
            ),
        ));
    }
    let deviations = match variation {
        Some(plan) => deviations(plan, bed.side, count, spacing_mm),
        None => vec![Deviation::default(); count],
    };
    let made: Vec<Result<Barb, FeatherMistake>> = deviations
        .into_par_iter()
        .enumerate()
        .map(|(index, deviation)| {
            // Each barb stands in the middle of its own share of the rachis.
            let root_mm = (as_f64(index) + 0.5 + deviation.root) * spacing_mm;
            let angle_deg = vane.barb_angle_deg + deviation.angle_deg;
            let name = format!(
                "barb {} of {count}, which leaves the rachis {} mm from its beginning at {}°,",
                index + 1,
                number::plain(root_mm),
                number::plain(angle_deg)
            );
            if !(angle_deg > 0.0 && angle_deg < 90.0) {
                return Err(FeatherMistake::new(
                    "variation.angle_deg",
                    format!("{name} has an angle that is not between 0 and 90°; make the variation smaller"),
                ));
            }
            let t = shaft.at_rachis_mm(root_mm);
            let (root, up) = (shaft.curve.point(t), shaft.curve.tangent(t));
            let barb = bed.barb(root, up, angle_deg.to_radians(), shape).map_err(|astray| {
                let (key, problem) = match astray {
                    Astray::Misses => ("control_points_mm", "never meets the outline; move the outline's points out"),
                    Astray::MeetsShaft => (
                        "barb_angle_deg",
                        "meets the rachis before the outline; make the angle larger, or |v2| and |v4| smaller",
                    ),
                    Astray::Grazes => (
                        "barb_angle_deg",
                        "runs along the outline instead of across it; change the angle or the outline's points",
                    ),
                };
                FeatherMistake::new(format!("{}_vane.{key}", bed.side.name()), format!("{name} {problem}"))
            })?;
            Ok(Barb { root_mm, ..barb })
        })
        .collect();
    // In order, so that the mistake that is told is always the same.
    made.into_iter().collect()
}
