//! Feathers on their maps: what is open is open, barbs scatter along their tangent, patterns lie where they are painted.

use barbule::bsdf::cylinder::CylinderModel;
use barbule::bsdf::{Direction, Feather};
use barbule::geometry::{FeatherFile, FeatherMap, TexelClass};
use barbule::render::{
    Camera, Light, Material, Picture, Projection, Rectangle, Resolution, Sampler, Scene, Settings, Sheet, Vanes, Vector,
};

use super::super::desk::shipped;
use super::super::directions::RGB_NM;
use super::{DIRECT, estimate, lambertian, material, picture, resolution};

/// The map of the symmetric tail feather.
fn tail(pixels_per_mm: f64) -> FeatherMap {
    let text = std::fs::read_to_string(format!("{}/feather.json", shipped("feather-tail"))).unwrap();
    let file: FeatherFile = serde_json::from_str(&text).unwrap();
    FeatherMap::of(&barbule::geometry::Feather::new(&file).unwrap(), Some(pixels_per_mm)).unwrap()
}

/// The feather flat on z = 0 in its own coordinates, x to the right, seen by a camera above that shows its map texel for
/// pixel, under lights.
fn sheet(materials: Vec<Material>, vanes: Vanes, pixels_per_mm: f64, lights: Vec<Light>) -> (Scene, Resolution) {
    let map = tail(pixels_per_mm);
    let [width_mm, height_mm] = map.size_mm();
    let centre = Vector::new(0.5 * width_mm, 0.5 * height_mm, 0.0);
    let camera = Camera::new(centre + Vector::z() * 300.0, centre, Vector::y(), Projection::Orthographic { height_mm });
    let rectangle = Rectangle::new(Vector::zeros(), Vector::x() * width_mm, Vector::y() * height_mm).unwrap();
    let size = resolution(map.width(), map.height(), 64);
    let scene = Scene::new(camera.unwrap(), materials).with_sheet(Sheet { rectangle, map, shaft: 0, vanes });
    (lights.into_iter().fold(scene, Scene::with_light), size)
}

fn clear_vane() -> Material {
    let model = Feather::new(&Default::default(), &RGB_NM).unwrap();
    material(model, &[("barb.sigma_a", 0.0), ("barbule.sigma_a", 0.0)])
}

/// A white shaft and clear vanes in a furnace: as bright as what is seen beside them, whatever is open.
#[test]
fn a_white_feather_vanishes_in_a_furnace() {
    let light = Light::Constant { radiance: [1.0; 3] };
    let (scene, size) = sheet(vec![lambertian(1.0), clear_vane()], Vanes::Plain(1), 1.0, vec![light]);
    let seen = picture(&scene, size, DIRECT);
    let (mean, error) = estimate(&seen)[0];
    assert!((mean - 1.0).abs() < 3.0 * error + 1e-6, "found {mean} ± {error}");
}

/// Black materials in front of a bright background: a pixel shows the share of its texel that is open.
#[test]
fn a_pixel_shows_what_the_map_leaves_open() {
    let light = Light::Constant { radiance: [1.0; 3] };
    let (scene, size) = sheet(vec![lambertian(0.0), lambertian(0.0)], Vanes::Plain(1), 2.0, vec![light]);
    let seen = picture(&scene, Resolution { samples: 256, ..size }, DIRECT);
    let map = tail(2.0);
    let (mut open, mut partly) = (0, 0);
    for (pixel, (_, _, texel)) in seen.pixels.iter().zip(map.texels()) {
        let expected = if texel.class == TexelClass::Nothing { 1.0 } else { 1.0 - texel.coverage };
        // The standard error of a share, of 256 samples, and one of them.
        let error = (expected * (1.0 - expected) / 256.0f64).sqrt();
        let found = f64::from(pixel[0]);
        assert!((found - expected).abs() <= 5.0 * error + 1.0 / 256.0, "found {found}, expected {expected}");
        open += u32::from(expected >= 1.0);
        partly += u32::from(expected > 0.0 && expected < 1.0);
    }
    assert!(open > 1000 && partly > 100, "{open} open texels, {partly} partly");
}

/// Fibres scatter into a cone about themselves: light along x, 45° up, is seen from above by fibres across it, not by those
/// along it. Each pixel must be the fibre's own value in the frame that its map says.
#[test]
fn barbs_scatter_along_their_tangents() {
    let fibre = || CylinderModel::new(&Default::default(), &RGB_NM).unwrap();
    let towards = Vector::new(1.0, 0.0, 1.0).normalize();
    let light = Light::Directional { direction: towards, irradiance: [1.0; 3] };
    let narrow = [("beta_m", 0.2), ("sigma_a", 0.5)];
    let (scene, size) = sheet(vec![lambertian(0.0), material(fibre(), &narrow)], Vanes::Plain(1), 1.0, vec![light]);
    let seen = picture(&scene, Resolution { samples: 1, ..size }, DIRECT);
    let model = fibre();
    let values = super::super::directions::values(&model, &narrow);
    let mut checked = 0;
    let (mut least, mut largest) = (f64::INFINITY, 0f64);
    for (pixel, (_, _, texel)) in seen.pixels.iter().zip(tail(1.0).texels()) {
        if texel.class != TexelClass::Barb || texel.coverage < 1.0 {
            continue;
        }
        let [x, y] = texel.tangent;
        // The frame of the fibre: x along it, z up.
        let local = Direction::new(towards.x * x + towards.y * y, towards.y * x - towards.x * y, towards.z);
        let function = super::super::directions::evaluate(&model, &values, &local, &Direction::z());
        let expected = function[0] * towards.z;
        let found = f64::from(pixel[0]);
        // 32-bit pixels, and lobes that a picture tabulates to 1e-4 of their peak.
        assert!((found - expected).abs() < 1e-3 * expected + 1e-4, "found {found}, expected {expected}");
        (least, largest) = (least.min(found), largest.max(found));
        checked += 1;
    }
    assert!(checked > 500 && largest > 2.0 * least, "{checked} texels from {least} to {largest}");
}

fn rms_difference(a: &Picture, b: &Picture) -> f64 {
    let squares = a.pixels.iter().flatten().zip(b.pixels.iter().flatten()).map(|(a, b)| f64::from(a - b).powi(2));
    (squares.sum::<f64>() / (3 * a.pixels.len()) as f64).sqrt()
}

/// The bar: on a feather, 64 of Sobol's samples have at most 1/1.5 of the error of 64 independent ones.
#[test]
fn sobols_samples_beat_independent_ones_on_a_feather() {
    let vane = Feather::new(&Default::default(), &RGB_NM).unwrap();
    let lamp = Rectangle::new(Vector::new(-40.0, 40.0, 80.0), Vector::y() * 60.0, Vector::x() * 60.0).unwrap();
    let lights = vec![Light::Rectangle { shape: lamp, radiance: [6.0; 3] }, Light::Constant { radiance: [0.4; 3] }];
    let (scene, size) = sheet(vec![lambertian(0.5), material(vane, &[])], Vanes::Plain(1), 0.3, lights);
    let truth = picture(&scene, Resolution { samples: 2048, ..size }, Settings { seed: 77, ..DIRECT });
    let error = |sampler| rms_difference(&picture(&scene, size, Settings { sampler, ..DIRECT }), &truth);
    let (sobol, independent) = (error(Sampler::Sobol), error(Sampler::Independent));
    assert!(sobol * 1.5 <= independent, "root mean square errors: Sobol {sobol}, independent {independent}");
}
