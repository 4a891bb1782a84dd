//! A whole multi-start fit of a film's thickness, and one evaluation of its residuals: 13 angles × 401 wavelengths,
//! unpolarised keratin film on melanin (dispersive, absorbing), free thickness, index offset and gain, 1 % noise, 32 starts.

use std::hint::black_box;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use barbule::fit::Control;
use barbule::job::{CheckedCase, Job};
use criterion::{Criterion, criterion_group, criterion_main};

const JOB: &str = r#"
title = "benchmark"
[data.synthetic]
quantity = "reflectance"
mirror_deg = [10, 15, 20, 25, 30, 35, 40, 45, 50, 55, 60, 65, 70]
window_nm = [300, 700]
step_nm = 1
noise = 0.01
seed = 7
[data.synthetic.truth]
"film.thickness_nm" = 612.5
"keratin.index_offset" = 0.012
gain = 0.04
[instrument]
gain = "shared"
[model]
kind = "coated-base"
layers = [{ name = "film", material = "keratin", thickness_nm = 300 }]
substrate = "bird_melanin"
[parameters]
"film.thickness_nm" = { lower = 100, upper = 1500 }
"keratin.index_offset" = { lower = -0.1, upper = 0.1 }
[fit]
starts = 32
"#;

fn case() -> CheckedCase {
    let job = Job::from_text("benchmark", JOB, Path::new(".")).expect("the job is right");
    job.cases().expect("its data are synthetic").0.swap_remove(0)
}

fn benchmark(criterion: &mut Criterion) {
    let case = case();
    let interrupt = AtomicBool::new(false);
    let control = Control { interrupt: &interrupt, progress: &|_, _| (), checkpoint: None };
    let residuals = case.residuals();
    let values: Vec<f64> = residuals.parameters().iter().map(|parameter| parameter.default).collect();
    let mut rows = vec![0.0; residuals.count()];

    let mut group = criterion.benchmark_group("fit");
    group.bench_function("one evaluation", |bencher| {
        bencher.iter(|| residuals.evaluate(black_box(&values), &mut rows));
    });
    group.sample_size(20);
    group.bench_function("32 starts", |bencher| bencher.iter(|| case.fit(&control).expect("it fits")));
    group.finish();
}

criterion_group!(benches, benchmark);
criterion_main!(benches);
