//! Feathers: shaft, outlines and barbs against closed forms and kurbo's curves, maps against the barbs they show.

use std::path::Path;

use barbule::bsdf::BarbSpecies;
use barbule::geometry::{
    Barb, Feather, FeatherFile, FeatherMap, GeometrySummary, Preview, Side, Texel, TexelClass, Vane,
};
use kurbo::{CubicBez, ParamCurve, ParamCurveDeriv, Point, Vec2};
use proptest::prelude::*;
use serde_json::{Value, json};

/// A feather from its JSON.
fn feather(value: &Value) -> Feather {
    let file: FeatherFile = serde_json::from_value(value.clone()).unwrap();
    Feather::new(&file).unwrap_or_else(|mistake| panic!("{mistake}\n{value:#}"))
}

/// A straight shaft up the y axis, 10 mm of calamus and 100 mm of rachis, its vanes mirrored.
fn symmetric(barbs: &Value) -> Value {
    json!({
        "title": "Symmetric",
        "shaft": {
            "control_points_mm": [[0, 0], [0, 110]],
            "base_width_mm": 2.0, "tip_width_mm": 0.4, "calamus_length_mm": 10
        },
        "left_vane": { "control_points_mm": [[-18, 14], [-20, 100]], "barb_angle_deg": 35 },
        "right_vane": { "control_points_mm": [[18, 14], [20, 100]], "barb_angle_deg": 35 },
        "barbs": barbs
    })
}

/// The same with its shaft bent into a parabola: x = y²/400 from (0, 0) to (25, 100).
fn bent(barbs: &Value) -> Value {
    json!({
        "title": "Bent",
        "shaft": {
            "control_points_mm": [[0, 0], [0, 50], [25, 100]],
            "base_width_mm": 2.0, "tip_width_mm": 0.3, "calamus_length_mm": 12
        },
        "left_vane": { "control_points_mm": [[-14, 16], [-12, 90]], "barb_angle_deg": 28 },
        "right_vane": { "control_points_mm": [[26, 10], [46, 80]], "barb_angle_deg": 41 },
        "barbs": barbs
    })
}

/// Length of x = y²/400 from y = 0: with u = y/200, 100 (u √(1 + u²) + asinh u).
fn parabola_length(y: f64) -> f64 {
    let u = y / 200.0;
    100.0 * (u * u.hypot(1.0) + u.asinh())
}

fn straight_barbs(count: u32) -> Value {
    json!({ "count_per_vane": count, "width_um": 30 })
}

fn bowed_barbs(count: u32) -> Value {
    json!({ "count_per_vane": count, "width_um": 30, "v1": 0.3, "v2": -0.05, "v3": 0.4, "v4": 0.1 })
}

/// The nearest point of a cubic: 400 places, then the interval around the best halved until it is a rounding error wide.
fn nearest_on(cubic: CubicBez, target: Point) -> (f64, f64) {
    let distance = |t: f64| (cubic.eval(t) - target).hypot();
    let best = (0..=400).map(|i| f64::from(i) / 400.0).min_by(|a, b| distance(*a).total_cmp(&distance(*b))).unwrap();
    let slope = |t: f64| (cubic.eval(t) - target).dot(cubic.deriv().eval(t).to_vec2());
    let (mut lower, mut upper) = ((best - 0.0025).max(0.0), (best + 0.0025).min(1.0));
    for _ in 0..60 {
        let middle = 0.5 * (lower + upper);
        if slope(middle) > 0.0 { upper = middle } else { lower = middle }
    }
    (0.5 * (lower + upper), distance(0.5 * (lower + upper)))
}

/// A vane's outline as kurbo's cubic: these feathers have two inner control points.
fn outline(vane: &Vane) -> CubicBez {
    let [a, b, c, d] = vane.outline.control_points() else { panic!("four control points") };
    CubicBez::new(*a, *b, *c, *d)
}

fn angle_between(one: Vec2, other: Vec2) -> f64 {
    one.cross(other).atan2(one.dot(other))
}

fn all_barbs(feather: &Feather) -> impl Iterator<Item = (Side, &Barb)> {
    feather.vanes.iter().flat_map(|vane| vane.barbs.iter().map(|barb| (vane.side, barb)))
}

#[test]
fn roots_are_evenly_spaced_along_a_parabola() {
    let feather = feather(&bent(&straight_barbs(57)));
    let rachis_mm = parabola_length(100.0) - 12.0;
    for vane in &feather.vanes {
        for (index, barb) in (0..).zip(&vane.barbs) {
            let Point { x, y } = barb.curve.p0;
            let expected = 12.0 + (f64::from(index) + 0.5) / 57.0 * rachis_mm;
            approx::assert_abs_diff_eq!(x, y * y / 400.0, epsilon = 1e-12);
            approx::assert_abs_diff_eq!(parabola_length(y), expected, epsilon = 1e-10);
            approx::assert_abs_diff_eq!(barb.root_mm, expected - 12.0, epsilon = 1e-10);
        }
    }
}

#[test]
fn barbs_leave_the_rachis_at_their_angle_and_end_on_the_outline() {
    for barbs in [straight_barbs(120), bowed_barbs(120)] {
        let feather = feather(&bent(&barbs));
        for (side, barb) in all_barbs(&feather) {
            // The parabola's tangent is (y/200, 1).
            let tangent = Vec2::new(barb.planned.p0.y / 200.0, 1.0);
            let turned = angle_between(tangent, barb.planned.p3 - barb.planned.p0).to_degrees();
            let expected = if side == Side::Left { 28.0 } else { -41.0 };
            approx::assert_abs_diff_eq!(turned, expected, epsilon = 1e-9);
            let vane = &feather.vanes[usize::from(side == Side::Right)];
            let (_, distance) = nearest_on(outline(vane), barb.curve.p3);
            assert!(distance < 1e-9, "a barb ends {distance} mm off the outline");
        }
    }
}

/// Equation 4.1 by hand, with w' towards the tip on either side.
#[test]
fn inner_control_points_are_those_of_the_thesis() {
    let feather = feather(&symmetric(&bowed_barbs(40)));
    for (side, barb) in all_barbs(&feather) {
        let CubicBez { p0, p1, p2, p3 } = barb.planned;
        let d = (p3 - p0).hypot();
        let w = (p3 - p0) / d;
        let up = if side == Side::Left { Vec2::new(w.y, -w.x) } else { Vec2::new(-w.y, w.x) };
        assert!(up.y > 0.0);
        assert!((p1 - (p0 + 0.3 * d * w - 0.05 * d * up)).hypot() < 1e-12);
        assert!((p2 - (p3 - 0.4 * d * w + 0.1 * d * up)).hypot() < 1e-12);
    }
}

#[test]
fn a_barb_that_bulges_out_is_cut_where_it_leaves_the_vane() {
    let mut bulging = bowed_barbs(80);
    bulging["v4"] = json!(-0.6);
    let feather = feather(&symmetric(&bulging));
    let cut = all_barbs(&feather).filter(|(_, barb)| barb.curve != barb.planned).count();
    assert!(cut > 20, "{cut} are cut");
    for vane in &feather.vanes {
        let outline = outline(vane);
        for barb in &vane.barbs {
            let (t, distance) = nearest_on(outline, barb.curve.p3);
            assert!(distance < 1e-9, "a barb ends {distance} mm off the outline, at {t}");
            for i in 1..20 {
                let point = barb.curve.eval(f64::from(i) / 20.0);
                let (t, distance) = nearest_on(outline, point);
                // Seen along the outline upwards, the vane lies on the right of the left outline.
                let inwards = outline.deriv().eval(t).to_vec2().cross(point - outline.eval(t));
                let sign = if vane.side == Side::Left { -1.0 } else { 1.0 };
                assert!(sign * inwards > 0.0 || distance < 1e-9, "a barb leaves the vane by {distance} mm");
            }
        }
    }
}

#[test]
fn the_two_vanes_of_a_symmetric_feather_mirror() {
    let feather = feather(&symmetric(&bowed_barbs(90)));
    let mirrored = |point: Point| Point::new(-point.x, point.y);
    for (left, right) in feather.vanes[0].barbs.iter().zip(&feather.vanes[1].barbs) {
        for t in [0.0, 0.3, 0.7, 1.0] {
            assert!((mirrored(left.curve.eval(t)) - right.curve.eval(t)).hypot() < 1e-12);
        }
    }
    let map = FeatherMap::of(&feather, Some(12.0)).unwrap();
    let mut compared = 0;
    for (column, row, left) in map.texels() {
        let right = map.texel(map.width() - 1 - column, row);
        // Both are good to 1/32.
        assert!((left.coverage - right.coverage).abs() <= 0.0625, "({column}, {row}) {left:?} {right:?}");
        if left.class != right.class {
            let edge = |texel: Texel| texel.coverage < 1.0 || texel.class == TexelClass::Shaft;
            assert!(edge(left) || edge(right), "({column}, {row}) {left:?} {right:?}");
            continue;
        }
        // Two half steps of the 16 bits, 3e-5 each. A shaft's tangent keeps its x = 0.
        assert!((left.tangent[0] + right.tangent[0]).abs() < 7e-5, "({column}, {row}) {left:?} {right:?}");
        assert!((left.tangent[1] - right.tangent[1]).abs() < 7e-5, "({column}, {row}) {left:?} {right:?}");
        compared += usize::from(left.class == TexelClass::Barb && left.coverage >= 1.0);
    }
    assert!(compared > 100_000, "{compared}");
}

/// Every 97th texel of class barb: its tangent is the derivative, at the nearest point, of the barb that is nearest.
fn tangents_are_those_of_the_nearest_barb(value: &Value, pixels_per_mm: f64) {
    let feather = feather(value);
    let map = FeatherMap::of(&feather, Some(pixels_per_mm)).unwrap();
    let summary = GeometrySummary::new(&feather, &map).map;
    let half_width = 0.5 * feather.barb_width_mm;
    let (mut compared, mut on_a_barb) = (0, 0);
    let barbs = map.texels().filter(|(_, _, texel)| texel.class == TexelClass::Barb && texel.coverage > 0.5);
    for (column, row, texel) in barbs.step_by(97) {
        let centre = Point::new(
            summary.left_mm + (f64::from(column) + 0.5) / pixels_per_mm,
            summary.top_mm - (f64::from(row) + 0.5) / pixels_per_mm,
        );
        let mut near: Vec<(f64, Vec2)> = all_barbs(&feather)
            .filter(|(side, barb)| {
                // A texel of one vane does not take its tangent from the other's roots.
                let own = texel.tangent[0] < 0.0;
                own == (*side == Side::Left) && {
                    let [low, high] = [barb.curve.p0.y, barb.curve.p3.y];
                    centre.y > low - 5.0 && centre.y < high + 5.0
                }
            })
            .map(|(_, barb)| {
                let (t, distance) = nearest_on(barb.curve, centre);
                (distance, barb.curve.deriv().eval(t).to_vec2())
            })
            .collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0));
        // Half way between two barbs either is right.
        if near[1].0 - near[0].0 < 0.03 / pixels_per_mm {
            continue;
        }
        let angle = angle_between(near[0].1, Vec2::new(texel.tangent[0], texel.tangent[1])).abs();
        // The bar is 1e-3; 16 bits hold a direction to 2.2e-5.
        assert!(angle < 3e-5, "({column}, {row}) is off by {angle}");
        compared += 1;
        on_a_barb += usize::from(near[0].0 < half_width);
    }
    assert!(compared > 300 && on_a_barb > 30, "{on_a_barb} of {compared} lie on a barb");
}

#[test]
fn tangents_of_a_closed_vane() {
    tangents_are_those_of_the_nearest_barb(&symmetric(&bowed_barbs(100)), 8.0);
}

#[test]
fn tangents_of_loose_barbs() {
    let mut loose = bowed_barbs(60);
    loose["width_um"] = json!(300);
    loose["between"] = json!("nothing");
    tangents_are_those_of_the_nearest_barb(&symmetric(&loose), 8.0);
}

/// From the JSON's angle to the texture and back: a straight barb through a texel is followed to the parabola that the
/// shaft is, and its angle there is measured.
#[test]
fn the_angle_in_the_file_is_the_mean_angle_in_the_texture() {
    let feather = feather(&bent(&straight_barbs(300)));
    let map = FeatherMap::of(&feather, Some(10.0)).unwrap();
    let summary = GeometrySummary::new(&feather, &map).map;
    let mut angles = [Vec::new(), Vec::new()];
    for (column, row, texel) in map.texels().filter(|(_, _, texel)| texel.class == TexelClass::Barb) {
        let (x, y) =
            (summary.left_mm + (f64::from(column) + 0.5) / 10.0, summary.top_mm - (f64::from(row) + 0.5) / 10.0);
        let [tx, ty] = texel.tangent;
        // (x − s tx) = (y − s ty)²/400, the smaller s > 0.
        let (a, b, c) = (ty * ty / 400.0, tx - y * ty / 200.0, y * y / 400.0 - x);
        let root = (b * b - 4.0 * a * c).sqrt();
        let along =
            [(-b - root) / (2.0 * a), (-b + root) / (2.0 * a)].into_iter().filter(|s| *s > 0.0).reduce(f64::min);
        let Some(along) = along else { continue };
        let foot = y - along * ty;
        let turned = angle_between(Vec2::new(foot / 200.0, 1.0), Vec2::new(tx, ty)).to_degrees();
        angles[usize::from(turned < 0.0)].push(turned.abs());
    }
    for (angles, expected) in angles.iter().zip([28.0, 41.0]) {
        assert!(angles.len() > 50_000, "{}", angles.len());
        let mean = angles.iter().sum::<f64>() / angles.len() as f64;
        approx::assert_abs_diff_eq!(mean, expected, epsilon = 0.2);
    }
}

#[test]
fn polylines_tangents_are_their_differences() {
    let feather = feather(&bent(&bowed_barbs(30)));
    let csv = feather.barbs_csv();
    let rows: Vec<(String, [f64; 4])> = csv::Reader::from_reader(csv.as_bytes())
        .records()
        .map(|record| {
            let record = record.unwrap();
            let number = |at: usize| record[at].parse::<f64>().unwrap();
            (format!("{} {}", &record[0], &record[1]), [number(2), number(3), number(4), number(5)])
        })
        .collect();
    let mut compared = 0;
    for pair in rows.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
        let ([x0, y0, tx0, ty0], [x1, y1, tx1, ty1]) = (pair[0].1, pair[1].1);
        // A chord's direction is that of the mean tangent but for the third power of the piece's bend.
        let angle = angle_between(Vec2::new(x1 - x0, y1 - y0), Vec2::new(tx0 + tx1, ty0 + ty1)).abs();
        assert!(angle < 1e-3, "barb {} at ({x0}, {y0}) is off by {angle}", pair[0].0);
        compared += 1;
    }
    let barbs: std::collections::BTreeSet<&String> = rows.iter().map(|(barb, _)| barb).collect();
    assert_eq!(barbs.len(), 60);
    assert!(compared > 60);
}

/// The shaft is a trapezium, and the vane the polygon through its barbs' ends.
#[test]
fn the_covered_area_is_that_of_shaft_and_vanes() {
    let feather = feather(&symmetric(&straight_barbs(400)));
    let map = FeatherMap::of(&feather, Some(16.0)).unwrap();
    let texel_mm2 = 1.0 / (16.0 * 16.0);
    let area = |class| {
        let covered = map.texels().filter(|(_, _, texel)| texel.class == class).map(|(_, _, texel)| texel.coverage);
        covered.sum::<f64>() * texel_mm2
    };
    let (shaft, barbs) = (area(TexelClass::Shaft), area(TexelClass::Barb));
    let trapezium = 0.5 * (2.0 + 0.4) * 110.0;
    // An edge texel belongs to one class whole: on average the two errors cancel.
    approx::assert_relative_eq!(shaft, trapezium, max_relative = 5e-3);
    let polygon: Vec<Point> = {
        let vane = &feather.vanes[1].barbs;
        std::iter::once(vane[0].curve.p0)
            .chain(vane.iter().map(|barb| barb.curve.p3))
            .chain([vane[vane.len() - 1].curve.p0])
            .collect()
    };
    let next = polygon.iter().cycle().skip(1);
    let vane = 0.5 * polygon.iter().zip(next).map(|(a, b)| a.to_vec2().cross(b.to_vec2())).sum::<f64>().abs();
    // Of the two vanes the shaft hides what it covers between the first roots and the last.
    let hidden = {
        let [low, high] = [feather.vanes[0].barbs[0].curve.p0.y, feather.vanes[0].barbs[399].curve.p0.y];
        let width = |y: f64| 2.0 - 1.6 * y / 110.0;
        0.5 * (width(low) + width(high)) * (high - low)
    };
    approx::assert_relative_eq!(barbs, 2.0 * vane - hidden, max_relative = 2e-3);
    approx::assert_relative_eq!(
        GeometrySummary::new(&feather, &map).map.covered_mm2,
        shaft + barbs,
        max_relative = 1e-9
    );
}

/// Barbs as wide and as far apart as those of a species cover the share of the vane that Table B.1 prints for it.
#[test]
fn loose_barbs_cover_a_species_share() {
    for species in BarbSpecies::all().iter().step_by(4) {
        let pitch_mm = (species.width_um + species.spacing_um) / 1000.0;
        let angle: f64 = 50.0;
        let rachis_mm = 60.0 * pitch_mm / angle.to_radians().sin();
        let feather = feather(&json!({
            "title": species.name,
            "shaft": {
                "control_points_mm": [[0, 0], [0, rachis_mm]],
                "base_width_mm": 0.2, "tip_width_mm": 0.1, "calamus_length_mm": 0
            },
            "left_vane": { "control_points_mm": [[-8, 0], [-8, rachis_mm + 8.0]], "barb_angle_deg": angle },
            "right_vane": { "control_points_mm": [[8, 0], [8, rachis_mm + 8.0]], "barb_angle_deg": angle },
            "barbs": { "count_per_vane": 60, "width_um": species.width_um, "between": "nothing" }
        }));
        let share = feather.barb_share(&feather.vanes[0]);
        approx::assert_relative_eq!(share, species.barb_share(), max_relative = 1e-9);

        // Forty whole periods along the rachis, in a strip that lies well inside the vane.
        let map = FeatherMap::of(&feather, Some(30.0)).unwrap();
        let summary = GeometrySummary::new(&feather, &map).map;
        let period_mm = rachis_mm / 60.0;
        let (low, high) = (0.3 * rachis_mm, 0.3 * rachis_mm + 40.0 * period_mm);
        let (mut sum, mut count) = (0.0, 0.0);
        for (column, row, texel) in map.texels() {
            let x = summary.left_mm + (f64::from(column) + 0.5) / 30.0;
            let y = summary.top_mm - (f64::from(row) + 0.5) / 30.0;
            if (0.3..1.5).contains(&x) && (low..high).contains(&y) {
                sum += texel.coverage;
                count += 1.0;
            }
        }
        // The strip's ends cut texels: one of some hundred rows.
        approx::assert_relative_eq!(sum / count, share, max_relative = 0.02);
    }
}

#[test]
fn a_map_is_read_back_as_it_was_written() {
    let feather = feather(&symmetric(&bowed_barbs(20)));
    let map = FeatherMap::of(&feather, Some(3.3333)).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("map.png");
    std::fs::write(&path, map.png().unwrap()).unwrap();
    assert_eq!(FeatherMap::read(&path).unwrap(), map);
    // Rounded to whole texels a metre.
    approx::assert_relative_eq!(map.pixels_per_mm(), 3.333, max_relative = 1e-15);

    // Another decoder sees what the documentation says.
    let picture = image::open(&path).unwrap();
    let picture = picture.as_rgba16().unwrap();
    for (column, row, texel) in map.texels() {
        let [red, green, blue, alpha] = picture.get_pixel(column, row).0;
        let class = match texel.class {
            TexelClass::Nothing => 0,
            TexelClass::Shaft => 32768,
            TexelClass::Barb => 65535,
        };
        assert_eq!(blue, class);
        approx::assert_relative_eq!(f64::from(alpha) / 65535.0, texel.coverage, max_relative = 1e-15);
        assert_eq!(texel.class == TexelClass::Nothing, alpha == 0);
        if alpha > 0 {
            let [x, y] = [red, green].map(|value| 2.0 * f64::from(value) / 65535.0 - 1.0);
            // The stored vector is a unit vector but for the steps of 16 bits.
            assert!((x.hypot(y) - 1.0).abs() < 5e-5);
            assert!((x - texel.tangent[0]).hypot(y - texel.tangent[1]) < 5e-5);
        }
    }
}

#[test]
fn a_place_finds_its_texel() {
    let feather = feather(&symmetric(&straight_barbs(50)));
    let map = FeatherMap::of(&feather, Some(5.0)).unwrap();
    let [width_mm, height_mm] = map.size_mm();
    let at = |x_mm: f64, y_mm: f64| map.lookup(0.5 + x_mm / width_mm, y_mm / height_mm);
    // The calamus is at the bottom, the vanes beside the middle; the map's lower edge lies below the base.
    let calamus = at(0.0, 3.0);
    assert_eq!((calamus.class, calamus.coverage), (TexelClass::Shaft, 1.0));
    assert!(calamus.tangent[1] > 0.999_999);
    let [left, right] = [at(-4.0, 60.0), at(4.0, 60.0)];
    assert_eq!((left.class, right.class), (TexelClass::Barb, TexelClass::Barb));
    for (texel, degrees) in [(left, 125.0), (right, 55.0)] {
        approx::assert_abs_diff_eq!(texel.tangent[1].atan2(texel.tangent[0]).to_degrees(), degrees, epsilon = 0.01);
    }
    for (u, v) in [(0.0, 0.0), (1.0, 1.0), (-0.1, 0.5), (0.5, 1.1), (f64::NAN, 0.5)] {
        let nothing = map.lookup(u, v);
        assert_eq!((nothing.class, nothing.tangent, nothing.coverage), (TexelClass::Nothing, [0.0, 0.0], 0.0));
    }
}

#[test]
fn the_same_feather_gives_the_same_bytes_on_one_thread_and_on_many() {
    let mut value = bent(&bowed_barbs(150));
    value["variation"] = json!({ "seed": 3, "root": 0.1, "angle_deg": 1 });
    let made = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let feather = feather(&value);
            let map = FeatherMap::of(&feather, Some(6.0)).unwrap();
            (map.png().unwrap(), feather.barbs_csv(), feather.svg(Preview::Construction))
        })
    };
    let one = made(1);
    assert_eq!(one, made(4));
    value["variation"]["seed"] = json!(4);
    assert_ne!(one.1, feather(&value).barbs_csv(), "another seed is another feather");
}

#[test]
fn shipped_feathers_are_what_they_are_called() {
    let shipped = |name: &str| {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("fits").join(name);
        Feather::read(&path).unwrap_or_else(|error| panic!("{error}"))
    };
    let lengths = |name: &str| shipped(name).vanes.map(|vane| vane.mean_barb_length_mm());
    let [leading, trailing] = lengths("feather-primary");
    assert!(trailing > 1.5 * leading, "a primary is asymmetric: {leading} and {trailing}");
    let [left, right] = lengths("feather-tail");
    approx::assert_relative_eq!(left, right, max_relative = 0.1);
    let contour = shipped("feather-contour");
    assert!(contour.shaft.length_mm < 40.0);
}

/// A feather within what birds have.
fn usual() -> impl Strategy<Value = Value> {
    let shape = (20.0..55.0, 20.0..55.0, 0.2..0.45, -0.08..0.08, 0.2..0.45, -0.08..0.12);
    let form = (-0.06..0.06, 40.0..160.0, 0.08..0.25, 0.08..0.25, 40_u32..200);
    (shape, form, 0_u64..1000, proptest::bool::ANY).prop_map(|(shape, form, seed, varied)| {
        let (left_angle, right_angle, v1, v2, v3, v4) = shape;
        let (bend, length, left, right, count): (f64, f64, f64, f64, u32) = form;
        let mut value = json!({
            "title": "Usual",
            "shaft": {
                "control_points_mm": [[0, 0], [bend * length, 0.5 * length], [0, length]],
                "base_width_mm": 0.02 * length, "tip_width_mm": 0.1, "calamus_length_mm": 0.15 * length
            },
            "left_vane": {
                "control_points_mm": [[-left * length, 0.2 * length], [-left * length, 0.95 * length]],
                "barb_angle_deg": left_angle
            },
            "right_vane": {
                "control_points_mm": [[right * length, 0.2 * length], [right * length, 0.95 * length]],
                "barb_angle_deg": right_angle
            },
            "barbs": { "count_per_vane": count, "width_um": 20, "v1": v1, "v2": v2, "v3": v3, "v4": v4 }
        });
        if varied {
            value["variation"] = json!({ "seed": seed, "root": 0.1, "angle_deg": 0.5, "angle_reach_mm": 0.1 * length });
        }
        value
    })
}

/// Whether two polylines cross, each segment against each.
fn cross(one: &[Point], other: &[Point]) -> bool {
    let beside = |a: Point, b: Point, c: Point| (b - a).cross(c - a);
    one.windows(2).any(|p| {
        other.windows(2).any(|q| {
            beside(p[0], p[1], q[0]) * beside(p[0], p[1], q[1]) < 0.0
                && beside(q[0], q[1], p[0]) * beside(q[0], q[1], p[1]) < 0.0
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn barbs_of_a_usual_feather_do_not_cross(value in usual()) {
        let feather = feather(&value);
        for vane in &feather.vanes {
            let lines: Vec<Vec<Point>> = vane
                .barbs
                .iter()
                .map(|barb| (0..=12).map(|i| barb.curve.eval(f64::from(i) / 12.0)).collect())
                .collect();
            for (index, pair) in lines.windows(2).enumerate() {
                prop_assert!(!cross(&pair[0], &pair[1]), "{} barbs {index} and the next cross", vane.side.name());
            }
        }
    }

    /// Whatever the numbers, a feather is made or refused in a sentence; what is made has its barbs' ends on the outline.
    #[test]
    fn any_feather_is_drawn_or_refused(
        points in proptest::collection::vec((-60.0..60.0, -60.0..60.0), 2..6),
        left in proptest::collection::vec((-60.0..60.0, -60.0..60.0), 1..4),
        right in proptest::collection::vec((-60.0..60.0, -60.0..60.0), 1..4),
        angles in (1.0..89.0, 1.0..89.0),
        bends in (-0.9..0.9, -0.9..0.9),
    ) {
        let list = |points: &[(f64, f64)]| points.iter().map(|&(x, y)| json!([x, y])).collect::<Value>();
        let value = json!({
            "title": "Any",
            "shaft": {
                "control_points_mm": list(&points), "base_width_mm": 1, "tip_width_mm": 0.2, "calamus_length_mm": 1
            },
            "left_vane": { "control_points_mm": list(&left), "barb_angle_deg": angles.0 },
            "right_vane": { "control_points_mm": list(&right), "barb_angle_deg": angles.1 },
            "barbs": { "count_per_vane": 12, "width_um": 10, "v2": bends.0, "v4": bends.1 }
        });
        let file: FeatherFile = serde_json::from_value(value).unwrap();
        match Feather::new(&file) {
            Err(mistake) => prop_assert!(mistake.problem.len() > 20, "{mistake}"),
            Ok(feather) => {
                let map = FeatherMap::of(&feather, Some(2.0)).unwrap();
                prop_assert!(map.texels().any(|(_, _, texel)| texel.class == TexelClass::Barb));
                for vane in &feather.vanes {
                    for barb in &vane.barbs {
                        let near = (0..=20_000).map(|i| (vane.outline.point(f64::from(i) / 20_000.0) - barb.curve.p3).hypot());
                        // Steps of a curve of at most 400 mm.
                        prop_assert!(near.fold(f64::INFINITY, f64::min) < 0.02);
                    }
                }
            }
        }
    }
}
