//! One evaluation as a fit does it: bind the parameters, then 13 mirror geometries of 401 wavelengths.
//!
//! The plain scalar version of the same numbers stands beside it, so that one run gives the ratio.

use std::hint::black_box;

use barbule::bsdf::{CoatedBase, Design, Direction, Model};
use barbule::measure::Geometry;
use barbule::optics::film::airy;
use barbule::optics::known_material;
use barbule::optics::stack::Layer;
use criterion::{Criterion, criterion_group, criterion_main};

fn wavelengths() -> Vec<f64> {
    (300..=700).map(f64::from).collect()
}

fn angles() -> impl Iterator<Item = f64> {
    (0..13).map(|i| 15.0 + 5.0 * f64::from(i))
}

fn evaluate(criterion: &mut Criterion, name: &str, design: &str) {
    let design: Design = toml::from_str(design).expect("the design is valid");
    let model = CoatedBase::new(&design, &wavelengths()).expect("the design is valid");
    let values: Vec<f64> = model.parameters().iter().map(|parameter| parameter.default).collect();
    let directions: Vec<(Direction, Direction)> =
        angles().map(Geometry::mirror).map(|geometry| (geometry.incoming(), geometry.outgoing())).collect();
    let mut out = vec![0.0; directions.len() * 401];
    criterion.bench_function(name, |bencher| {
        bencher.iter(|| {
            let bound = model.bind(black_box(&values));
            for ((incoming, outgoing), out) in directions.iter().zip(out.chunks_exact_mut(401)) {
                bound.evaluate(incoming, outgoing, out);
            }
            out[0]
        });
    });
}

fn film(criterion: &mut Criterion) {
    let film = r#"
        substrate = "bird_melanin"
        layers = [{ name = "cortex", material = "keratin", thickness_nm = 330 }]
    "#;
    evaluate(criterion, "film 13 × 401", film);
}

fn stack(criterion: &mut Criterion) {
    let five_layers = r#"
        substrate = "air"
        layers = [
            { name = "cortex", material = "keratin", thickness_nm = 330 },
            { period = [
                { name = "rods", material = "bird_melanin", thickness_nm = 100 },
                { name = "gaps", material = "keratin", thickness_nm = 120 },
            ], count = 2 },
        ]
    "#;
    evaluate(criterion, "stack of five 13 × 401", five_layers);
}

fn film_scalar(criterion: &mut Criterion) {
    let indices: Vec<_> = ["keratin", "bird_melanin"]
        .map(|name| &known_material(name).expect("it is known").dispersion)
        .map(|dispersion| wavelengths().iter().map(|&wavelength| dispersion.at(wavelength)).collect::<Vec<_>>())
        .into();
    let mut out = vec![0.0; 13 * 401];
    criterion.bench_function("film 13 × 401, scalar", |bencher| {
        bencher.iter(|| {
            let thickness_nm = black_box(330.0);
            for (theta, out) in angles().zip(out.chunks_exact_mut(401)) {
                let cos_theta = theta.to_radians().cos();
                for (i, out) in out.iter_mut().enumerate() {
                    let film = Layer { index: indices[0][i], thickness_nm };
                    *out = airy(1.0, film, indices[1][i], cos_theta, 300.0 + i as f64).reflectance.unpolarised();
                }
            }
            out[0]
        });
    });
}

criterion_group!(benches, film, stack, film_scalar);
criterion_main!(benches);
