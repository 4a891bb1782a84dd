//! Speed of the cylinder: far field of random pairs of directions, β 0.3, η 1.55, three channels.
//!
//! One element of the throughput is one pair of directions with all three channels. The pairs are shared by rayon over all
//! cores, in fixed chunks.

use std::hint::black_box;

use barbule::bsdf::Direction;
use barbule::bsdf::cylinder::{AzimuthalLobe, Cylinder, CylinderParameters, FibreAngles, LongitudinalMapping};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

const PAIRS: usize = 1 << 20;

fn direction(random: &mut ChaCha8Rng) -> Direction {
    let z: f64 = random.random_range(-1.0..1.0);
    let azimuth: f64 = random.random_range(0.0..std::f64::consts::TAU);
    let radius = (1.0 - z * z).sqrt();
    Direction::new(radius * azimuth.cos(), radius * azimuth.sin(), z)
}

fn pairs() -> Vec<(Direction, Direction)> {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    (0..PAIRS).map(|_| (direction(&mut random), direction(&mut random))).collect()
}

fn parameters(beta_n: f64) -> CylinderParameters {
    CylinderParameters {
        eta: vec![1.55; 3],
        sigma_a: vec![0.2, 0.5, 1.1],
        beta_m: 0.3,
        beta_n,
        mapping: LongitudinalMapping::Chiang,
        lobe: AzimuthalLobe::TrimmedLogistic,
    }
}

/// Sum of everything, so that nothing is optimised away.
fn total(pairs: &[(Direction, Direction)], scatter: impl Fn(&FibreAngles, &mut [f64]) + Sync) -> f64 {
    let sums: Vec<f64> = pairs
        .par_chunks(4096)
        .map(|chunk| {
            let mut values = [0.0; 3];
            chunk
                .iter()
                .map(|(incoming, outgoing)| {
                    scatter(&FibreAngles::between(incoming, outgoing), &mut values);
                    values.iter().sum::<f64>()
                })
                .sum()
        })
        .collect();
    sums.iter().sum()
}

fn far_field(criterion: &mut Criterion) {
    let pairs = pairs();
    let mut group = criterion.benchmark_group("cylinder far field");
    group.throughput(Throughput::Elements(PAIRS as u64)).sample_size(10);
    for beta_n in [0.05, 0.1, 0.3, 0.6, 0.9] {
        let cylinder = Cylinder::new(&parameters(beta_n)).expect("these parameters are in range");
        group.bench_function(format!("fresh, beta_n {beta_n}"), |bencher| {
            bencher.iter(|| total(black_box(&pairs), |angles, values| cylinder.far_field(angles, values)));
        });
    }
    let table = Cylinder::new(&parameters(0.3)).expect("these parameters are in range").tabulate(1e-4);
    println!("table: {} bytes, error {:.1e}", table.bytes(), table.error());
    group.bench_function("tabulated, beta_n 0.3", |bencher| {
        bencher.iter(|| total(black_box(&pairs), |angles, values| table.far_field(angles, values)));
    });
    group.finish();
}

/// Time to build the table of the benchmark above, all cores.
fn tabulation(criterion: &mut Criterion) {
    let cylinder = Cylinder::new(&parameters(0.3)).expect("these parameters are in range");
    criterion.bench_function("cylinder, build table, beta_n 0.3", |bencher| {
        bencher.iter(|| black_box(&cylinder).tabulate(1e-4).error());
    });
}

criterion_group!(benches, far_field, tabulation);
criterion_main!(benches);
