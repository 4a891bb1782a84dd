//! The dielectric cylinder against an independent program, conservation of energy, and brute force.

use std::f64::consts::PI;

use barbule::bsdf::cylinder::{
    AzimuthalLobe, Cylinder, CylinderParameters, FibreAngles, LongitudinalMapping, mean_attenuation,
};

/// Rows of a table in `tests/oracles`, as numbers; an empty cell is NaN.
fn oracle(name: &str) -> Vec<Vec<f64>> {
    let path = format!("{}/tests/oracles/{name}", env!("CARGO_MANIFEST_DIR"));
    let mut reader = csv::Reader::from_path(path).unwrap();
    let rows =
        reader.records().map(|record| record.unwrap().iter().map(|cell| cell.parse().unwrap_or(f64::NAN)).collect());
    rows.collect()
}

fn fibre(beta_m: f64, beta_n: f64, eta: f64, sigma_a: &[f64]) -> Cylinder {
    Cylinder::new(&CylinderParameters {
        eta: vec![eta; sigma_a.len()],
        sigma_a: sigma_a.to_vec(),
        beta_m,
        beta_n,
        mapping: LongitudinalMapping::Chiang,
        lobe: AzimuthalLobe::TrimmedLogistic,
    })
    .unwrap()
}

/// Largest relative difference over readings above 1e-6, and how many there were.
fn compare(found: &[f64], expected: &[f64], worst: &mut f64, count: &mut usize, row: &[f64]) {
    for (found, expected) in found.iter().zip(expected) {
        if *expected > 1e-6 {
            let difference = (found / expected - 1.0).abs();
            if difference > 1e-7 {
                println!("{row:?}: found {found}, expected {expected}, relative difference {difference:e}");
            }
            *worst = worst.max(difference);
            *count += 1;
        }
    }
}

/// The oracle's `i` is the direction in whose frame h is counted: the viewer here.
#[test]
fn far_field_agrees_with_the_oracle() {
    let (mut worst, mut count) = (0.0, 0);
    for row in oracle("hair_farfield.csv") {
        let cylinder = fibre(row[1], row[2], row[3], &row[4..7]);
        let mut found = [0.0; 3];
        cylinder.far_field(&FibreAngles::new(row[8], row[7], row[9]), &mut found);
        compare(&found, &row[10..13], &mut worst, &mut count, &row);
    }
    println!("{count} values, worst relative difference {worst:e}");
    assert!(count > 900 && worst < 1e-7);
}

#[test]
fn near_field_agrees_with_the_oracle() {
    let (mut worst, mut count) = (0.0, 0);
    for row in oracle("hair.csv") {
        let cylinder = fibre(row[1], row[2], row[3], &row[4..7]);
        let mut found = [0.0; 3];
        cylinder.near_field(&FibreAngles::new(row[8], row[7], row[9]), row[10], &mut found);
        compare(&found, &row[11..14], &mut worst, &mut count, &row);
    }
    println!("{count} values, worst relative difference {worst:e}");
    assert!(count > 900 && worst < 1e-7);
}

#[test]
fn albedo_agrees_with_the_oracle() {
    for row in oracle("hair_albedo.csv") {
        let found = mean_attenuation(row[0], row[1], row[2].to_radians().sin());
        let [a0, a1, a2] = found.direct;
        for (found, expected) in [a0, a1, a2, found.later, found.total()].iter().zip(&row[3..8]) {
            // The table has 14 digits, and its own quadrature 12.
            assert!((found - expected).abs() < 1e-11, "{row:?}: {found} instead of {expected}");
        }
    }
}

/// A white fibre sends on exactly what it receives: ∫ S dωi = 1 for a fixed viewer. The integral over inclinations is
/// taken in panels that follow the narrow lobes, the one over azimuths by the trapezoidal rule.
#[test]
fn white_furnace() {
    for (beta_m, beta_n) in [(0.3, 0.3), (0.15, 0.9), (0.7, 0.15), (0.9, 0.6)] {
        let cylinder = fibre(beta_m, beta_n, 1.55, &[0.0]);
        for theta_o in [0.0, 0.4, -1.0, 1.45] {
            let found = sphere_integral(|theta, phi| {
                let mut value = [0.0];
                cylinder.far_field(&FibreAngles::new(theta, theta_o, phi), &mut value);
                value[0]
            });
            assert!((found - 1.0).abs() < 1e-6, "β {beta_m}, {beta_n}, viewer at {theta_o}: {found}");
        }
    }
}

/// ∫ f(θ, φ) cosθ dθ dφ over the sphere around a fibre: Simpson's rule in θ, since the integrand does not end smoothly
/// at the poles, and midpoints in φ, in which f is even and periodic.
fn sphere_integral(f: impl Fn(f64, f64) -> f64) -> f64 {
    let (inclinations, azimuths) = (1200, 120);
    let ring = |i: i32| {
        let theta = (f64::from(i) / f64::from(inclinations) - 0.5) * PI;
        let sum: f64 = (0..azimuths).map(|k| f(theta, (f64::from(k) + 0.5) / f64::from(azimuths) * PI)).sum();
        let simpson = if i == 0 || i == inclinations {
            1.0
        } else if i % 2 == 1 {
            4.0
        } else {
            2.0
        };
        simpson / 3.0 * sum * theta.cos()
    };
    (0..=inclinations).map(ring).sum::<f64>() * (PI / f64::from(inclinations)) * (2.0 * PI / f64::from(azimuths))
}
