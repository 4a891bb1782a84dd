//! The scenes in which the renderer's speed and error are measured.

use barbule::bsdf::{Lambertian, Model, RoughPlastic, RoughPlasticDesign};
use barbule::render::{Camera, Light, Material, Projection, Rectangle, Scene, Texture, Vector};

const RGB_NM: [f64; 3] = [645.0, 525.0, 445.0];

fn rectangle(corner: [f64; 3], u: [f64; 3], v: [f64; 3]) -> Rectangle {
    Rectangle::new(corner.into(), u.into(), v.into()).expect("it has an area")
}

fn defaults(model: &dyn Model, changes: &[(&str, f64)]) -> Vec<f64> {
    let value = |name: &str, default| changes.iter().find(|(n, _)| *n == name).map_or(default, |(_, value)| *value);
    model.parameters().iter().map(|parameter| value(&parameter.name, parameter.default)).collect()
}

/// A 2 : 1 rectangle of textured rough plastic that fills the picture, under one lamp and a constant sky.
pub(super) fn textured_rectangle() -> Scene {
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

/// The box of rough plastic.
pub(super) fn plastic_room() -> Scene {
    let plastic = RoughPlastic::new(&RoughPlasticDesign::default(), &RGB_NM).expect("the design is valid");
    let values = defaults(&plastic, &[("roughness", 0.3)]);
    room(Material::plain(Box::new(plastic), values).expect("the values are valid"))
}

/// The box of a Lambertian material.
pub(super) fn lambertian_room() -> Scene {
    let lambertian = Lambertian::new(&Default::default(), &RGB_NM).expect("the design is valid");
    let values = defaults(&lambertian, &[]);
    room(Material::plain(Box::new(lambertian), values).expect("the values are valid"))
}
