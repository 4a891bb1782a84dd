//! The dielectric cylinder against an independent program, conservation of energy, and brute force.

use std::f64::consts::PI;

use barbule::bsdf::cylinder::{
    AzimuthalLobe, Cylinder, CylinderDesign, CylinderModel, CylinderParameters, FibreAngles, LongitudinalMapping,
    NearFieldCylinderModel, mean_attenuation,
};
use barbule::bsdf::spongy_barb::{SpongeBand, SpongyBarb};
use barbule::bsdf::{Direction, Model, ModelError};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::directions::{RGB_NM, evaluate};

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

/// The same rows through the model that a job names: f = S/|n·ωi| at directions made of the table's angles.
#[test]
fn near_field_model_agrees_with_the_oracle() {
    let design = CylinderDesign { per_channel: vec!["sigma_a".to_owned()], ..CylinderDesign::default() };
    let model = NearFieldCylinderModel::new(&design, &RGB_NM).unwrap();
    let names: Vec<&str> = model.parameters().iter().map(|parameter| parameter.name.as_str()).collect();
    assert_eq!(names, ["eta", "beta_m", "beta_n", "sigma_a_r", "sigma_a_g", "sigma_a_b", "h"]);
    // Around the fibre azimuths turn from y to z; the viewer stands at 90°, in the plane of normal and fibre.
    let at = |theta: f64, azimuth: f64| {
        Direction::new(theta.sin(), theta.cos() * azimuth.cos(), theta.cos() * azimuth.sin())
    };
    let (mut worst, mut count) = (0.0, 0);
    for row in oracle("hair.csv") {
        let (outgoing, incoming) = (at(row[7], 0.5 * PI), at(row[8], 0.5 * PI + row[9]));
        let values = [row[3], row[1], row[2], row[4], row[5], row[6], row[10]];
        model.check(&values).unwrap();
        let found = evaluate(&model, &values, &incoming, &outgoing).into_iter().map(|f| f * incoming.z.abs());
        compare(&found.collect::<Vec<f64>>(), &row[11..14], &mut worst, &mut count, &row);
    }
    println!("{count} values, worst relative difference {worst:e}");
    assert!(count > 900 && worst < 1e-7);
}

/// Wherever a white fibre is met, all light goes on its way.
#[test]
fn near_field_white_furnace() {
    let cylinder = fibre(0.3, 0.3, 1.55, &[0.0]);
    for (h, theta_o) in [(0.0, 0.0), (0.7, 0.4), (-0.95, -1.0)] {
        // Not even in φ: both halves are summed.
        let found = sphere_integral(|theta, phi| {
            let (mut one, mut other) = ([0.0], [0.0]);
            cylinder.near_field(&FibreAngles::new(theta, theta_o, phi), h, &mut one);
            cylinder.near_field(&FibreAngles::new(theta, theta_o, -phi), h, &mut other);
            0.5 * (one[0] + other[0])
        });
        // Where the logistic is cut off it has a kink of 1e-3 of its height, which the midpoints feel.
        assert!((found - 1.0).abs() < 1e-5, "h {h}, viewer at {theta_o}: {found}");
    }
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
    let (inclinations, azimuths) = (800, 60);
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

/// The far field by brute force: the near field integrated over t, with h = sinγ and γ = π/2 sin t so that nodes crowd at the
/// grazing ends, in many short Gauss–Legendre panels between all the places where some path leaves exactly opposite the peak of its D. Those are found by looking for jumps of the
/// wrapped azimuth, with none of the algebra of the library.
fn far_field_by_brute_force(cylinder: &Cylinder, eta: f64, beta_n: f64, angles: &FibreAngles, values: &mut [f64]) {
    let eta_prime = (eta * eta - angles.sin_theta_o * angles.sin_theta_o).sqrt() / angles.cos_theta_o;
    let distance = |p: f64, t: f64| {
        let gamma = 0.5 * PI * t.sin();
        let exit = 2.0 * p * (gamma.sin() / eta_prime).asin() - 2.0 * gamma + p * PI;
        (angles.phi - exit + PI).rem_euclid(2.0 * PI)
    };
    let mut breaks = vec![-0.5 * PI, 0.5 * PI];
    let grid = 4000;
    let at = |k: i32| (f64::from(k) / f64::from(grid) - 0.5) * PI;
    for p in [0.0, 1.0, 2.0] {
        for k in 0..grid {
            let (mut low, mut high) = (at(k), at(k + 1));
            let start = distance(p, low);
            if (distance(p, high) - start).abs() > PI {
                for _ in 0..50 {
                    let middle = 0.5 * (low + high);
                    if (distance(p, middle) - start).abs() > PI { high = middle } else { low = middle }
                }
                breaks.push(0.5 * (low + high));
            }
        }
    }
    breaks.sort_by(f64::total_cmp);

    values.fill(0.0);
    let mut here = vec![0.0; values.len()];
    for pair in breaks.windows(2) {
        let length = pair[1] - pair[0];
        // The poles of the logistic are about 0.5 (βₙ + …) away in γ: panels of 0.2 βₙ see a smooth integrand.
        let parts = (length / (0.2 * beta_n)).ceil().max(4.0);
        let half = 0.5 * length / parts;
        let mut middle = pair[0] + half;
        while middle < pair[1] {
            for (node, weight) in TEN_NODES {
                for node in [node, -node] {
                    let t = middle + half * node;
                    let (h, cos_gamma) = (0.5 * PI * t.sin()).sin_cos();
                    let density = 0.5 * cos_gamma * 0.5 * PI * t.cos();
                    cylinder.near_field(angles, h, &mut here);
                    for (value, here) in values.iter_mut().zip(&here) {
                        *value += weight * half * density * here;
                    }
                }
            }
            middle += 2.0 * half;
        }
    }
}

/// Positive half of the Gauss–Legendre rule with ten nodes (Abramowitz and Stegun 1964, table 25.4).
const TEN_NODES: [(f64, f64); 5] = [
    (0.148_874_338_981_631, 0.295_524_224_714_753),
    (0.433_395_394_129_247, 0.269_266_719_309_996),
    (0.679_409_568_299_024, 0.219_086_362_515_982),
    (0.865_063_366_688_985, 0.149_451_349_150_581),
    (0.973_906_528_517_172, 0.066_671_344_308_688),
];

/// The error is stated as below 1e-6 of the larger of the value and 1e-6 of the peak over azimuths.
#[test]
fn far_field_agrees_with_brute_force() {
    let mut random = ChaCha8Rng::seed_from_u64(7);
    for lobe in [AzimuthalLobe::TrimmedLogistic, AzimuthalLobe::WrappedGaussian] {
        for beta_n in [0.05, 0.1, 0.2, 0.3, 0.31, 0.4, 0.6, 0.9] {
            let mut worst: f64 = 0.0;
            for _ in 0..60 {
                let eta = [1.1, 1.35, 1.55, 1.8, 2.4][random.random_range(0..5)];
                let sigma_a = [0.0, 0.01, random.random_range(0.0..2.0), 10.0];
                let cylinder = Cylinder::new(&CylinderParameters {
                    eta: vec![eta; 4],
                    sigma_a: sigma_a.to_vec(),
                    beta_m: 0.4,
                    beta_n,
                    mapping: LongitudinalMapping::Chiang,
                    lobe,
                })
                .unwrap();
                let theta_o = random.random_range(-1.57..1.57);
                let theta_i = -theta_o + random.random_range(-0.2..0.2);
                let mut peak = [0.0_f64; 4];
                let mut found = [0.0; 4];
                for k in 0..=180 {
                    cylinder.far_field(&FibreAngles::new(theta_i, theta_o, f64::from(k).to_radians()), &mut found);
                    for (peak, found) in peak.iter_mut().zip(found) {
                        *peak = peak.max(found);
                    }
                }
                let angles = FibreAngles::new(theta_i, theta_o, random.random_range(-PI..PI));
                cylinder.far_field(&angles, &mut found);
                let mut expected = [0.0; 4];
                far_field_by_brute_force(&cylinder, eta, beta_n, &angles, &mut expected);
                for ((found, expected), peak) in found.iter().zip(expected).zip(peak) {
                    let error = (found - expected).abs() / expected.max(1e-6 * peak);
                    worst = worst.max(error);
                }
            }
            println!("{lobe:?} β_n {beta_n}: worst error {worst:e}");
            assert!(worst < 1e-6, "{lobe:?} β_n {beta_n}: {worst:e}");
        }
    }
}

/// The model's known asymmetry: for a fixed light the same integral is not 1. Its range over lights, roughness and index is the
/// one that the model's page states.
#[test]
fn asymmetry_stays_in_its_documented_range() {
    let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
    for (beta_m, beta_n) in [(0.1, 0.6), (0.3, 0.6), (0.6, 0.6)] {
        let cylinder = fibre(beta_m, beta_n, 1.55, &[0.0]);
        for theta_i in [0.0, 0.9, 1.2, 1.35, 1.45, 1.52] {
            let found = sphere_integral(|theta, phi| {
                let mut value = [0.0];
                cylinder.far_field(&FibreAngles::new(theta_i, theta, phi), &mut value);
                value[0]
            });
            println!("β_m {beta_m}, light at {theta_i}: {found}");
            least = least.min(found);
            most = most.max(found);
        }
    }
    println!("∫ S dωo from {least} to {most}");
    assert!((least - 0.72).abs() < 0.01 && (most - 1.05).abs() < 0.01);
}

#[test]
fn tables_keep_their_error() {
    let mut random = ChaCha8Rng::seed_from_u64(3);
    for lobe in [AzimuthalLobe::TrimmedLogistic, AzimuthalLobe::WrappedGaussian] {
        let cylinder = Cylinder::new(&CylinderParameters {
            eta: vec![1.55, 1.55, 1.55, 1.5, 1.5, 1.5],
            sigma_a: vec![0.0, 0.2, 1.0, 0.05, 0.5, 3.0],
            beta_m: 0.3,
            beta_n: 0.4,
            mapping: LongitudinalMapping::Plain,
            lobe,
        })
        .unwrap();
        let table = cylinder.tabulate(1e-4);
        assert!(table.error() <= 1e-4, "{}", table.error());
        let mut worst: f64 = 0.0;
        for _ in 0..100 {
            let theta_o = random.random_range(-1.57..1.57);
            let theta_i = -theta_o + random.random_range(-0.3..0.3);
            let (mut peak, mut error) = ([0.0_f64; 6], [0.0_f64; 6]);
            for _ in 0..100 {
                let angles = FibreAngles::new(theta_i, theta_o, random.random_range(-10.0..10.0));
                let (mut exact, mut found) = ([0.0; 6], [0.0; 6]);
                cylinder.far_field(&angles, &mut exact);
                table.far_field(&angles, &mut found);
                for c in 0..6 {
                    peak[c] = peak[c].max(exact[c]);
                    error[c] = error[c].max((found[c] - exact[c]).abs());
                }
            }
            worst = peak.iter().zip(error).map(|(peak, error)| error / peak).fold(worst, f64::max);
        }
        println!("{lobe:?}: {} bytes, stated {:e}, found {worst:e}", table.bytes(), table.error());
        assert!(worst <= 1e-4, "{worst:e}");
    }
}

#[test]
fn impossible_fibres_are_refused_in_a_sentence() {
    let good = CylinderParameters {
        eta: vec![1.55; 3],
        sigma_a: vec![0.2; 3],
        beta_m: 0.3,
        beta_n: 0.3,
        mapping: LongitudinalMapping::Chiang,
        lobe: AzimuthalLobe::TrimmedLogistic,
    };
    assert!(Cylinder::new(&good).is_ok());
    let refused = |change: &dyn Fn(&mut CylinderParameters)| {
        let mut bad = good.clone();
        change(&mut bad);
        Cylinder::new(&bad).unwrap_err().to_string()
    };
    for eta in [1.0, 0.9, -1.5, 6.0, f64::NAN, f64::INFINITY] {
        assert!(refused(&|bad| bad.eta[1] = eta).starts_with("the refractive index of a fibre must be above 1"));
    }
    for beta in [0.0, -0.1, 1.01, f64::NAN] {
        assert!(
            refused(&|bad| bad.beta_m = beta).starts_with("the roughness beta_m of a fibre must be between 0.01 and 1")
        );
        assert!(
            refused(&|bad| bad.beta_n = beta).starts_with("the roughness beta_n of a fibre must be between 0.01 and 1")
        );
    }
    for sigma_a in [-0.1, f64::NAN, f64::INFINITY] {
        assert!(refused(&|bad| bad.sigma_a[2] = sigma_a).starts_with("the absorption sigma_a of channel 2 must be"));
    }
    assert!(refused(&|bad| bad.eta.truncate(1)).contains("1 indices and 3 absorptions"));
    assert!(rgb_model(&[], &[]).is_err());
    assert!(rgb_model(&[f64::NAN], &[]).is_err());
    assert!(rgb_model(&[645.0], &["beta_m"]).is_err());
}

fn rgb_model(wavelengths_nm: &[f64], per_channel: &[&str]) -> Result<CylinderModel, ModelError> {
    let per_channel = per_channel.iter().map(|name| (*name).to_owned()).collect();
    CylinderModel::new(&CylinderDesign { per_channel, ..CylinderDesign::default() }, wavelengths_nm)
}

/// One index a channel, all equal, is one index for all: to the last bit, whatever the number of channels.
#[test]
fn channels_are_independent() {
    let shared = rgb_model(&[645.0, 525.5, 445.0], &["sigma_a"]).unwrap();
    let separate = rgb_model(&[645.0, 525.5, 445.0], &["eta", "sigma_a"]).unwrap();
    let names: Vec<&str> = separate.parameters().iter().map(|parameter| parameter.name.as_str()).collect();
    assert_eq!(names, ["eta_r", "eta_g", "eta_b", "beta_m", "beta_n", "sigma_a_r", "sigma_a_g", "sigma_a_b"]);

    let (incoming, outgoing) = (Direction::new(0.1, 0.3, 0.9).normalize(), Direction::new(-0.2, 0.7, -0.4).normalize());
    let (mut one, mut three, mut alone) = ([0.0; 3], [0.0; 3], [0.0; 1]);
    shared.bind(&[1.5, 0.3, 0.25, 0.1, 0.2, 0.7]).evaluate(&incoming, &outgoing, &mut one);
    separate.bind(&[1.5, 1.5, 1.5, 0.3, 0.25, 0.1, 0.2, 0.7]).evaluate(&incoming, &outgoing, &mut three);
    let single = rgb_model(&[445.0], &[]).unwrap();
    single.bind(&[1.5, 0.3, 0.25, 0.7]).evaluate(&incoming, &outgoing, &mut alone);
    assert_eq!(one.map(f64::to_bits), three.map(f64::to_bits));
    assert_eq!(one[2].to_bits(), alone[0].to_bits());

    // f is S over the cosine of the light.
    let mut scattering = [0.0; 3];
    fibre(0.3, 0.25, 1.5, &[0.1, 0.2, 0.7]).far_field(&FibreAngles::between(&incoming, &outgoing), &mut scattering);
    for (f, s) in one.iter().zip(scattering) {
        assert!((f * incoming.z.abs() / s - 1.0).abs() < 1e-14);
    }
}

/// Values inside the declared bounds always give finite results, in every direction.
#[test]
fn bounds_are_safe() {
    let model = rgb_model(&[645.0], &[]).unwrap();
    let corners: Vec<Vec<f64>> = (0..16)
        .map(|corner| {
            let bound = |(k, parameter): (usize, &barbule::parameter::Parameter)| {
                if corner >> k & 1 == 0 { parameter.lower } else { parameter.upper }
            };
            model.parameters().iter().enumerate().map(bound).collect()
        })
        .collect();
    let directions = [
        Direction::x(),
        -Direction::x(),
        Direction::y(),
        Direction::z(),
        -Direction::z(),
        Direction::new(1.0, 1e-9, 0.0),
        Direction::new(0.6, 0.0, 0.8),
        Direction::new(-0.6, 0.8, 0.0),
    ];
    for corner in corners {
        let bound = model.bind(&corner);
        for incoming in &directions {
            for outgoing in &directions {
                let mut value = [f64::NAN];
                bound.evaluate(incoming, outgoing, &mut value);
                assert!(
                    value[0].is_finite() && value[0] >= 0.0,
                    "{corner:?}, {incoming:?}, {outgoing:?}: {}",
                    value[0]
                );
            }
        }
    }
}

/// A sponge moves light, it neither makes nor takes any; and it prefers the way back.
#[test]
fn spongy_barb_keeps_the_furnace() {
    let cylinder = fibre(0.3, 0.3, 1.55, &[0.0, 0.0, 0.8]);
    let band = SpongeBand { strength: 0.9, peak_nm: 450.0, width_nm: 40.0 };
    let barb = SpongyBarb::new(cylinder, &[450.0, 520.0, 450.0], band).unwrap();
    for theta_o in [0.0, 0.8] {
        for channel in 0..3 {
            let found = sphere_integral(|theta, phi| {
                let mut values = [0.0; 3];
                barb.far_field(&FibreAngles::new(theta, theta_o, phi), &mut values);
                values[channel]
            });
            let sigma_a = if channel == 2 { 0.8 } else { 0.0 };
            let expected = mean_attenuation(1.55, sigma_a, theta_o.sin()).total();
            assert!((found - expected).abs() < 1e-6, "channel {channel}, viewer at {theta_o}: {found}, not {expected}");
        }
    }
    let share = |strength: f64, width_nm: f64| {
        SpongyBarb::new(fibre(0.3, 0.3, 1.55, &[0.0]), &[450.0], SpongeBand { strength, peak_nm: 450.0, width_nm })
    };
    assert!(
        share(1.1, 40.0).unwrap_err().to_string().starts_with("the strength of a spongy barb must be between 0 and 1")
    );
    assert!(share(0.5, 0.0).unwrap_err().to_string().starts_with("the band of a spongy barb needs"));
    assert!(share(0.0, 40.0).is_ok());
}
