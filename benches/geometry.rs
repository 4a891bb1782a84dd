//! A flight feather with 1,500 barbs a side: its barbs made from the file, and its map of 2048 texels drawn.

use std::hint::black_box;

use barbule::geometry::{Feather, FeatherFile, FeatherMap};
use criterion::{Criterion, criterion_group, criterion_main};

fn file() -> FeatherFile {
    let mut file: FeatherFile = serde_json::from_str(include_str!("../fits/feather-primary/feather.json"))
        .expect("the shipped feather is valid");
    file.barbs.count_per_vane = 1500;
    file.barbs.width_um = 8.0;
    file
}

fn barbs(criterion: &mut Criterion) {
    let file = file();
    criterion.bench_function("2 × 1500 barbs", |bencher| {
        bencher.iter(|| Feather::new(black_box(&file)).expect("it is valid"));
    });
}

fn map(criterion: &mut Criterion) {
    let feather = Feather::new(&file()).expect("it is valid");
    let mut group = criterion.benchmark_group("map");
    group.sample_size(20);
    group.bench_function("406 × 2048 texels of 2 × 1500 barbs", |bencher| {
        bencher.iter(|| FeatherMap::of(black_box(&feather), None).expect("it has a size"));
    });
    group.finish();
}

criterion_group!(benches, barbs, map);
criterion_main!(benches);
