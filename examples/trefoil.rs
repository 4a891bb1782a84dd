//! Writes the mesh that stands in the scenes `fits/scene-table` and `fits/scene-room`: a tube about a trefoil knot, closed and
//! smooth, with hollows and overhangs as a figurine has. Units are mm, z is up, and it stands on z = 0.
//!
//! `cargo run --release --example trefoil fits/scene-table/trefoil.obj`

use std::f64::consts::TAU;
use std::fmt::Write;
use std::path::PathBuf;

use anyhow::{Context, Result};
use barbule::report::write_file;
use nalgebra::Vector3;

/// Cross-sections along the knot, and corners of each.
const ALONG: u32 = 96;
const AROUND: u32 = 18;
/// Radii of the knot's outermost line from its axis and of the tube, mm.
const REACH_MM: f64 = 8.4;
const TUBE_MM: f64 = 1.75;

fn main() -> Result<()> {
    let path = std::env::args().nth(1).context("give the file to write, as fits/scene-table/trefoil.obj")?;
    write_file(&PathBuf::from(path), mesh().as_bytes())?;
    Ok(())
}

/// The knot's line; its plane is that of x and z.
fn line(t: f64) -> Vector3<f64> {
    let from_axis = 2.0 + (3.0 * t).cos();
    REACH_MM / 3.0 * Vector3::new(from_axis * (2.0 * t).sin(), (3.0 * t).sin(), -from_axis * (2.0 * t).cos())
}

/// The tube's normal at an angle around its line, from the normal of the torus on which the knot winds. (The line's own
/// curvature nearly vanishes in places, and a frame that hangs on it twists the tube there until it pinches.)
fn normal(t: f64, angle: f64) -> Vector3<f64> {
    const STEP: f64 = 1e-4;
    let tangent = (line(t + STEP) - line(t - STEP)).normalize();
    let around = (3.0 * t).cos();
    let outwards = Vector3::new(around * (2.0 * t).sin(), (3.0 * t).sin(), -around * (2.0 * t).cos());
    outwards * angle.cos() + tangent.cross(&outwards) * angle.sin()
}

/// As Wavefront OBJ: positions, normals, texture coordinates (along the tube, around it), and quadrangles.
fn mesh() -> String {
    let share = |step: u32, of: u32| f64::from(step) / f64::from(of);
    // The seams have their texture coordinates twice.
    let grid = || (0..=ALONG).flat_map(|i| (0..=AROUND).map(move |j| (share(i, ALONG), share(j, AROUND))));
    let points: Vec<_> = grid()
        .map(|(u, v)| {
            let normal = normal(TAU * u, TAU * v);
            (line(TAU * u) + TUBE_MM * normal, normal, [u, v])
        })
        .collect();
    let lowest = points.iter().map(|(point, ..)| point.z).fold(f64::INFINITY, f64::min);
    let mut text = String::from("# a tube about a trefoil knot, by examples/trefoil.rs\n");
    for (point, normal, [u, v]) in &points {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "v {:.3} {:.3} {:.3}", point.x, point.y, point.z - lowest);
        let _ = writeln!(text, "vn {:.3} {:.3} {:.3}", normal.x, normal.y, normal.z);
        let _ = writeln!(text, "vt {u:.3} {v:.3}");
    }
    let corner = |i: u32, j: u32| i * (AROUND + 1) + j + 1;
    for (i, j) in (0..ALONG).flat_map(|i| (0..AROUND).map(move |j| (i, j))) {
        let corners = [corner(i, j), corner(i, j + 1), corner(i + 1, j + 1), corner(i + 1, j)];
        let [a, b, c, d] = corners.map(|n| format!("{n}/{n}/{n}"));
        let _ = writeln!(text, "f {a} {b} {c} {d}");
    }
    text
}
