//! Rough plastic, three channels, for a million random pairs of directions: on one core, and on all of them in chunks.

use std::hint::black_box;

use barbule::bsdf::{Bsdf, Direction, Model, RoughPlastic, RoughPlasticDesign};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

const PAIRS: usize = 1 << 20;

/// Pairs that a core takes at a time.
const CHUNK: usize = 1 << 12;

fn directions(seed: u64) -> Vec<Direction> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut direction = || {
        let cosine: f64 = random.random();
        let (sin_phi, cos_phi) = random.random_range(0.0..std::f64::consts::TAU).sin_cos();
        let sine = (1.0 - cosine * cosine).sqrt();
        Direction::new(sine * cos_phi, sine * sin_phi, cosine)
    };
    (0..PAIRS).map(|_| direction()).collect()
}

fn rough_plastic(criterion: &mut Criterion) {
    let model = RoughPlastic::new(&RoughPlasticDesign::default(), &[645.0, 525.0, 445.0]).expect("the design is valid");
    let mut values: Vec<f64> = model.parameters().iter().map(|parameter| parameter.default).collect();
    // Roughness and index of the measure: 0.3 and 1.55.
    values[..2].copy_from_slice(&[0.3, 1.55]);
    let (incoming, outgoing) = (directions(1), directions(2));
    let mut out = vec![0.0; 3 * PAIRS];

    let mut group = criterion.benchmark_group("rough plastic, 2^20 pairs of RGB");
    group.throughput(Throughput::Elements(PAIRS as u64));
    group.sample_size(20);
    let bound = model.bind(&values);
    group.bench_function("one core", |bencher| {
        bencher.iter(|| bound.evaluate_many(black_box(&incoming), black_box(&outgoing), &mut out));
    });
    group.bench_function("all cores", |bencher| {
        bencher.iter(|| evaluate_in_parallel(bound.as_ref(), black_box(&incoming), black_box(&outgoing), &mut out));
    });
    group.bench_function("one pair at a time", |bencher| {
        bencher.iter(|| {
            for ((incoming, outgoing), out) in incoming.iter().zip(&outgoing).zip(out.chunks_exact_mut(3)) {
                bound.evaluate(black_box(incoming), outgoing, out);
            }
        });
    });
    group.finish();

    criterion
        .bench_function("rough plastic, bind", |bencher| bencher.iter(|| black_box(model.bind(black_box(&values)))));
}

fn evaluate_in_parallel(bound: &dyn Bsdf, incoming: &[Direction], outgoing: &[Direction], out: &mut [f64]) {
    let chunks = incoming.par_chunks(CHUNK).zip(outgoing.par_chunks(CHUNK)).zip(out.par_chunks_mut(3 * CHUNK));
    chunks.for_each(|((incoming, outgoing), out)| bound.evaluate_many(incoming, outgoing, out));
}

criterion_group!(benches, rough_plastic);
criterion_main!(benches);
