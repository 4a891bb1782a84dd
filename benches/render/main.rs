//! Samples a second of the renderer: direct light on a textured rectangle, and paths of eight scatterings in a box.
//!
//! Of the first, an element is one sample of one pixel: a camera ray, a texel, one direction towards the lamp and one of
//! the surface's own with their shadow rays, in the whole pipeline from seed to picture. Of the second it is one path.
//! Then the cheap rows of the second thesis's Table 4.5, its model beside that of Granier and Heidrich.

mod scenes;
#[path = "../../examples/thesis2_table_4_5/scenes.rs"]
mod table_scenes;

use std::sync::atomic::AtomicBool;

use barbule::render::{Control, Resolution, Sampler, Scene, Settings, Strategies, render};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};

use self::scenes::{lambertian_room, plastic_room, textured_rectangle};
use self::table_scenes::{Lighting, Model};

fn picture(scene: &Scene, resolution: Resolution, scatterings: u32) {
    let control = Control { interrupt: &AtomicBool::new(false), progress: &|_, _| (), checkpoint: None };
    let settings = Settings { scatterings, strategies: Strategies::Both, sampler: Sampler::Sobol, seed: 1 };
    let picture = render(scene, resolution, settings, &control).expect("nothing stops it");
    assert!(std::hint::black_box(picture).pixels[0][0] >= 0.0);
}

fn samples(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("render");
    group.sample_size(10);

    let scene = textured_rectangle();
    let resolution = Resolution { width: 1024, height: 512, samples: 4 };
    group.throughput(Throughput::Elements(4 * 1024 * 512));
    group.bench_function("direct samples, textured rough plastic", |bencher| {
        bencher.iter(|| picture(&scene, resolution, 1));
    });

    let resolution = Resolution { width: 256, height: 256, samples: 16 };
    group.throughput(Throughput::Elements(16 * 256 * 256));
    let scene = plastic_room();
    group.bench_function("paths of 8 scatterings, rough plastic", |bencher| {
        bencher.iter(|| picture(&scene, resolution, 8));
    });
    let scene = lambertian_room();
    group.bench_function("paths of 8 scatterings, Lambertian", |bencher| {
        bencher.iter(|| picture(&scene, resolution, 8));
    });
    group.finish();
}

/// Rows of 16 and 64 samples; the dearer ones are those of `examples/thesis2_table_4_5`.
fn table(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("thesis2-table-4.5");
    group.sample_size(10);
    for (light, lighting) in [("direct", Lighting::Direct), ("global", Lighting::Global)] {
        for samples in [16, 64] {
            for (name, model) in [("Granier", Model::Granier), ("iridescent plastic", Model::IridescentPlastic)] {
                let scene = table_scenes::scene(model, lighting, samples).expect("the scene is part of the project");
                group.bench_function(format!("{light}, {samples} samples, {name}"), |bencher| {
                    bencher.iter(|| table_scenes::picture(&scene).expect("nothing stops it"));
                });
            }
        }
    }
    group.finish();
}

criterion_group!(benches, samples, table);
criterion_main!(benches);
