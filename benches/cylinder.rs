//! Speed of the cylinder: far field of 2²⁰ random pairs of directions, β 0.3, η 1.55, three channels, all cores.
//!
//! One element of the throughput is one pair of directions with all three channels. The pairs are shared by rayon over all
//! cores, in fixed chunks. `fresh` computes everything anew, and binds the model's parameters in the time it takes; `table`
//! reads tabulated azimuthal lobes, and what it takes to build them stands last.

use std::hint::black_box;

use barbule::bsdf::cylinder::{
    AzimuthalLobe, Cylinder, CylinderDesign, CylinderModel, CylinderParameters, LongitudinalMapping,
};
use barbule::bsdf::{Bsdf, Direction, Model};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

const PAIRS: usize = 1 << 20;

/// Pairs that a core takes at a time.
const CHUNK: usize = 1 << 12;

const RGB_NM: [f64; 3] = [645.0, 525.0, 445.0];

fn directions(seed: u64) -> Vec<Direction> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut direction = || {
        let z: f64 = random.random_range(-1.0..1.0);
        let (sin_phi, cos_phi) = random.random_range(0.0..std::f64::consts::TAU).sin_cos();
        let radius = (1.0 - z * z).sqrt();
        Direction::new(radius * cos_phi, radius * sin_phi, z)
    };
    (0..PAIRS).map(|_| direction()).collect()
}

fn fibre(beta_n: f64) -> Cylinder {
    let parameters = CylinderParameters {
        eta: vec![1.55; 3],
        sigma_a: vec![0.2, 0.5, 1.1],
        beta_m: 0.3,
        beta_n,
        mapping: LongitudinalMapping::Chiang,
        lobe: AzimuthalLobe::TrimmedLogistic,
    };
    Cylinder::new(&parameters).expect("these parameters are in range")
}

/// In fixed chunks on all cores.
fn in_parallel(
    incoming: &[Direction],
    outgoing: &[Direction],
    values: &mut [f64],
    scatter: impl Fn(&[Direction], &[Direction], &mut [f64]) + Sync,
) {
    let chunks = incoming.par_chunks(CHUNK).zip(outgoing.par_chunks(CHUNK)).zip(values.par_chunks_mut(3 * CHUNK));
    chunks.for_each(|((incoming, outgoing), values)| scatter(incoming, outgoing, values));
}

fn one_at_a_time(bsdf: &dyn Bsdf, incoming: &[Direction], outgoing: &[Direction], values: &mut [f64]) {
    for ((incoming, outgoing), values) in incoming.iter().zip(outgoing).zip(values.chunks_exact_mut(3)) {
        bsdf.evaluate(incoming, outgoing, values);
    }
}

fn far_field(criterion: &mut Criterion) {
    let (incoming, outgoing) = (directions(1), directions(2));
    let mut values = vec![0.0; 3 * PAIRS];
    let design = CylinderDesign { per_channel: vec!["sigma_a".to_owned()], ..CylinderDesign::default() };
    let model = CylinderModel::new(&design, &RGB_NM).expect("the design is valid");

    let mut group = criterion.benchmark_group("cylinder, 2^20 pairs of RGB");
    group.throughput(Throughput::Elements(PAIRS as u64)).sample_size(10);
    for beta_n in [0.05, 0.1, 0.3, 0.6, 0.9] {
        let parameters = [1.55, 0.3, beta_n, 0.2, 0.5, 1.1];
        group.bench_function(format!("fresh, beta_n {beta_n}"), |bencher| {
            bencher.iter(|| {
                let bound = model.bind(black_box(&parameters));
                in_parallel(&incoming, &outgoing, &mut values, |i, o, values| bound.evaluate_many(i, o, values));
            });
        });
        group.bench_function(format!("fresh, beta_n {beta_n}, one pair at a time"), |bencher| {
            bencher.iter(|| {
                let bound = model.bind(black_box(&parameters));
                in_parallel(&incoming, &outgoing, &mut values, |i, o, values| one_at_a_time(&*bound, i, o, values));
            });
        });
    }
    let table = fibre(0.3).tabulate(1e-4);
    println!("table: {} bytes, error {:.1e}", table.bytes(), table.error());
    group.bench_function("table, beta_n 0.3", |bencher| {
        bencher.iter(|| {
            let table = black_box(&table);
            in_parallel(&incoming, &outgoing, &mut values, |i, o, values| table.evaluate_many(i, o, values));
        });
    });
    group.bench_function("table, beta_n 0.3, one pair at a time", |bencher| {
        bencher.iter(|| {
            let table = black_box(&table);
            in_parallel(&incoming, &outgoing, &mut values, |i, o, values| one_at_a_time(table, i, o, values));
        });
    });
    group.finish();
}

/// Time to build the table of the benchmark above, all cores.
fn tabulation(criterion: &mut Criterion) {
    let cylinder = fibre(0.3);
    let mut group = criterion.benchmark_group("cylinder");
    group.sample_size(10);
    group.bench_function("build the table, beta_n 0.3", |bencher| {
        bencher.iter(|| black_box(&cylinder).tabulate(1e-4).error());
    });
    group.finish();
}

criterion_group!(benches, far_field, tabulation);
criterion_main!(benches);
