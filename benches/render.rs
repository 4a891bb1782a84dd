//! Samples a second of the renderer: direct light on a textured rectangle, and paths of eight scatterings in a box.
//!
//! Of the first, an element is one sample of one pixel: a camera ray, a texel, one direction towards the lamp and one of
//! the surface's own with their shadow rays, in the whole pipeline from seed to picture. Of the second it is one path.
//! Then the cheap rows of the second thesis's Table 4.5, its model beside that of Granier and Heidrich.

#[path = "../examples/thesis2_table_4_5/scenes.rs"]
mod scenes;

use std::sync::atomic::AtomicBool;

use barbule::bsdf::{Lambertian, Model as BsdfModel, RoughPlastic, RoughPlasticDesign};
use barbule::render::{
    Camera, Control, Light, Material, Projection, Rectangle, Resolution, Sampler, Scene, Settings, Strategies, Texture,
    Vector, render,
};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use scenes::{Lighting, Model};

const RGB_NM: [f64; 3] = [645.0, 525.0, 445.0];

fn rectangle(corner: [f64; 3], u: [f64; 3], v: [f64; 3]) -> Rectangle {
    Rectangle::new(corner.into(), u.into(), v.into()).expect("it has an area")
}

fn defaults(model: &dyn BsdfModel, changes: &[(&str, f64)]) -> Vec<f64> {
    let value = |name: &str, default| changes.iter().find(|(n, _)| *n == name).map_or(default, |(_, value)| *value);
    model.parameters().iter().map(|parameter| value(&parameter.name, parameter.default)).collect()
}

/// A 2 : 1 rectangle of textured rough plastic that fills the picture, under one lamp and a constant sky.
fn textured_rectangle() -> Scene {
    let design = RoughPlasticDesign { per_channel: vec!["diffuse".to_owned()], ..RoughPlasticDesign::default() };
    let twice: Vec<f64> = RGB_NM.iter().chain(&RGB_NM).copied().collect();
    let plastic = RoughPlastic::new(&design, &twice).expect("the design is valid");
    let ends = ["diffuse_1", "diffuse_2", "diffuse_3", "diffuse_4", "diffuse_5", "diffuse_6"];
    let ends: Vec<(&str, f64)> = ends.into_iter().zip([0.0, 0.0, 0.0, 1.0, 1.0, 1.0]).collect();
    let values = defaults(&plastic, &[&ends[..], &[("roughness", 0.3)]].concat());
    let texels =
        (0..1024 * 512u32).map(|k| [0.2 + 0.6 * ((k % 97) as f32 / 97.0), 0.5, 0.1 + 0.8 * ((k % 31) as f32 / 31.0)]);
    let texture = Texture::new(1024, texels.collect()).expect("whole rows");
    let material = Material::textured(Box::new(plastic), values, texture).expect("the values are valid");
    let camera = Camera::new(
        Vector::new(0.0, 0.0, 100.0),
        Vector::zeros(),
        Vector::y(),
        Projection::Perspective { field_of_view: 0.5 },
    );
    Scene::new(camera.expect("it looks down"), vec![material])
        .with_rectangle(rectangle([-60.0, -30.0, 0.0], [120.0, 0.0, 0.0], [0.0, 60.0, 0.0]), 0)
        .with_light(Light::Rectangle {
            shape: rectangle([-40.0, -20.0, 60.0], [0.0, 30.0, 0.0], [30.0, 0.0, 0.0]),
            radiance: [10.0; 3],
        })
        .with_light(Light::Constant { radiance: [0.3; 3] })
}

/// The inside of a box, 2 wide, that the camera looks into through its open side; a lamp hangs under the ceiling.
fn room(wall: Material) -> Scene {
    let camera = Camera::new(
        Vector::new(0.0, -3.8, 1.0),
        Vector::new(0.0, 0.0, 1.0),
        Vector::z(),
        Projection::Perspective { field_of_view: 0.7 },
    );
    Scene::new(camera.expect("it looks in"), vec![wall])
        .with_rectangle(rectangle([-1.0, -1.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]), 0)
        .with_rectangle(rectangle([-1.0, -1.0, 2.0], [0.0, 2.0, 0.0], [2.0, 0.0, 0.0]), 0)
        .with_rectangle(rectangle([-1.0, 1.0, 0.0], [2.0, 0.0, 0.0], [0.0, 0.0, 2.0]), 0)
        .with_rectangle(rectangle([-1.0, -1.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]), 0)
        .with_rectangle(rectangle([1.0, -1.0, 0.0], [0.0, 0.0, 2.0], [0.0, 2.0, 0.0]), 0)
        .with_light(Light::Rectangle {
            shape: rectangle([-0.3, -0.3, 1.99], [0.0, 0.6, 0.0], [0.6, 0.0, 0.0]),
            radiance: [10.0; 3],
        })
}

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
    let plastic = RoughPlastic::new(&RoughPlasticDesign::default(), &RGB_NM).expect("the design is valid");
    let values = defaults(&plastic, &[("roughness", 0.3)]);
    let scene = room(Material::plain(Box::new(plastic), values).expect("the values are valid"));
    group.bench_function("paths of 8 scatterings, rough plastic", |bencher| {
        bencher.iter(|| picture(&scene, resolution, 8));
    });
    let lambertian = Lambertian::new(&Default::default(), &RGB_NM).expect("the design is valid");
    let values = defaults(&lambertian, &[]);
    let scene = room(Material::plain(Box::new(lambertian), values).expect("the values are valid"));
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
                let scene = scenes::scene(model, lighting, samples).expect("the scene is part of the project");
                group.bench_function(format!("{light}, {samples} samples, {name}"), |bencher| {
                    bencher.iter(|| scenes::picture(&scene).expect("nothing stops it"));
                });
            }
        }
    }
    group.finish();
}

criterion_group!(benches, samples, table);
criterion_main!(benches);
