//! Estimators against what theory says of them: mixtures of strategies, convergence, light of many scatterings.

use barbule::bsdf::{Direction, RoughPlastic};
use barbule::render::{
    Camera, Light, Material, Picture, Projection, Rectangle, Sampler, Scene, Settings, Sphere, Strategies, Vector,
};

use super::super::directions::RGB_NM;
use super::{DIRECT, assert_estimates, at_origin, lambertian, material, patch, picture, resolution};

fn plastic(roughness: f64, diffuse: f64) -> Material {
    let model = RoughPlastic::new(&Default::default(), &RGB_NM).unwrap();
    material(model, &[("roughness", roughness), ("diffuse", diffuse)])
}

/// A square lamp of this width above the origin, mirrored towards a viewer at 30°.
fn lamp(width: f64) -> Light {
    let centre = Vector::new(-0.5, 0.0, 0.75f64.sqrt()) * 10.0;
    let towards = -centre.normalize();
    let u = Vector::y() * width;
    let v = towards.cross(&Vector::y()) * width;
    Light::Rectangle { shape: Rectangle::new(centre - 0.5 * (u + v), u, v).unwrap(), radiance: [5.0; 3] }
}

/// Mean and variance of one independent sample of each strategy.
fn one_sample(scene: &Scene, strategies: Strategies) -> (f64, f64) {
    let settings = Settings { strategies, sampler: Sampler::Independent, ..DIRECT };
    let picture = picture(scene, resolution(512, 256, 1), settings);
    let count = picture.pixels.len() as f64;
    let values = || picture.pixels.iter().map(|pixel| f64::from(pixel[0]));
    let mean = values().sum::<f64>() / count;
    (mean, values().map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0))
}

/// Veach 1997, theorem 9.2: with one sample of each of two strategies, the balance heuristic's variance is at most the
/// better one's plus (1 − ½) I². Where one strategy suits the scene badly, what is left of it is a tenth at most.
#[test]
fn two_strategies_are_hardly_worse_than_the_better() {
    // So near and wide that it fills most of the sky: points on it are mostly seen from the side.
    let ceiling = Rectangle::new(Vector::new(-20.0, -20.0, 0.5), Vector::y() * 40.0, Vector::x() * 40.0).unwrap();
    let ceiling = Light::Rectangle { shape: ceiling, radiance: [1.0; 3] };
    for (scene, what) in [
        (patch(plastic(0.03, 0.0), 30.0, vec![lamp(12.0)]), "a large lamp in a glossy surface"),
        (patch(lambertian(0.5), 88.9, vec![ceiling]), "a wide lamp close to a dull surface"),
        (patch(lambertian(0.5), 30.0, vec![lamp(0.5)]), "a small lamp over a dull surface"),
    ] {
        let (mean, both) = one_sample(&scene, Strategies::Both);
        let (_, light) = one_sample(&scene, Strategies::Light);
        let (_, surface) = one_sample(&scene, Strategies::Surface);
        let (better, worse) = (light.min(surface), light.max(surface));
        let said = format!("{what}: mean {mean}, variances {both} of both, {light} of light, {surface} of surface");
        // The variances are themselves estimates, from 2¹⁷ pixels: 5 % is many times their error.
        assert!(both <= 1.05 * (better + 0.5 * mean * mean), "{said}");
        assert!(both <= 0.1 * worse, "{said}");
    }
}

/// A glossy and a dull sphere on a table under a lamp and a sky.
fn still_life() -> Scene {
    let camera = Camera::new(
        Vector::new(0.0, -60.0, 30.0),
        Vector::new(0.0, 0.0, 9.0),
        Vector::z(),
        Projection::Perspective { field_of_view: 0.6 },
    );
    let table =
        Rectangle::new(Vector::new(-80.0, -80.0, 0.0), Vector::new(160.0, 0.0, 0.0), Vector::new(0.0, 160.0, 0.0));
    let lamp =
        Rectangle::new(Vector::new(-40.0, -30.0, 50.0), Vector::new(0.0, 25.0, 0.0), Vector::new(25.0, 0.0, 0.0));
    Scene::new(camera.unwrap(), vec![lambertian(0.4), plastic(0.15, 0.4), plastic(0.4, 0.8)])
        .with_rectangle(table.unwrap(), 0)
        .with_sphere(Sphere { centre: Vector::new(-8.0, 0.0, 8.0), radius: 8.0 }, 1)
        .with_sphere(Sphere { centre: Vector::new(9.0, -4.0, 6.0), radius: 6.0 }, 2)
        .with_light(Light::Rectangle { shape: lamp.unwrap(), radiance: [12.0; 3] })
        .with_light(Light::Constant { radiance: [0.3; 3] })
}

fn rms_difference(a: &Picture, b: &Picture) -> f64 {
    let squares = a.pixels.iter().flatten().zip(b.pixels.iter().flatten()).map(|(a, b)| f64::from(a - b).powi(2));
    (squares.sum::<f64>() / (3 * a.pixels.len()) as f64).sqrt()
}

/// Independent samples: the error halves with four times as many. Sobol's samples: at least as fast, and never worse.
#[test]
fn the_error_falls_with_the_root_of_the_samples_or_faster() {
    let scene = still_life();
    let size = |samples| resolution(48, 36, samples);
    // Of 16 times the most samples that are judged: its own error is a quarter of theirs at most.
    let truth = picture(&scene, size(4096), Settings { seed: 99, ..DIRECT });
    let errors = |sampler| {
        [4, 16, 64, 256]
            .map(|samples| rms_difference(&picture(&scene, size(samples), Settings { sampler, ..DIRECT }), &truth))
    };
    let (independent, sobol) = (errors(Sampler::Independent), errors(Sampler::Sobol));
    let said = format!("independent {independent:?}, Sobol {sobol:?}");
    for errors in [independent, sobol] {
        for pair in errors.windows(2) {
            // 1.1 for the spread of an error over some 5000 numbers, of which edges of shadows weigh most.
            assert!(pair[1] <= 0.5 * 1.1 * pair[0], "{said}");
        }
    }
    for (sobol, independent) in sobol.iter().zip(independent) {
        assert!(*sobol <= independent, "{said}");
    }
}

/// A groove of a right angle along y that opens upwards, of one Lambertian material, with the origin on one of its walls at
/// √2 from the edge. Of an endless wall the part beyond R would fill ½ · √2/R of the view: with R = 3·10⁵ that is lost in the noise.
fn groove(albedo: f64) -> Scene {
    let (edge, along) = (Vector::new(-1.0, 0.0, -1.0), Vector::new(0.0, 6e5, 0.0));
    let corner = edge - 0.5 * along;
    let right = Rectangle::new(corner, Vector::new(3e5, 0.0, 3e5), along).unwrap();
    let left = Rectangle::new(corner, along, Vector::new(-3e5, 0.0, 3e5)).unwrap();
    assert!(right.normal().z > 0.0 && left.normal().z > 0.0, "both walls face the sky");
    Scene::new(at_origin(Direction::z()), vec![lambertian(albedo)])
        .with_rectangle(right, 0)
        .with_rectangle(left, 0)
        .with_light(Light::Constant { radiance: [1.0; 3] })
}

/// Half of what leaves a wall meets the other: 2⁻⁶⁰ is left after 60 scatterings.
const MANY: Settings = Settings { scatterings: 60, ..DIRECT };

/// Whatever the number of scatterings, white walls lose no light.
#[test]
fn a_white_groove_vanishes_in_a_furnace() {
    assert_estimates(&picture(&groove(1.0), resolution(32, 32, 256), MANY), [1.0; 3], "white groove");
}

/// In an endless groove all lengths look alike, so that its walls are equally bright everywhere; each point sees half sky and
/// half wall, L = ρ (½ + ½ L).
#[test]
fn a_grey_groove_is_as_bright_as_its_radiosity() {
    let expected = 0.3 / (1.0 - 0.3);
    assert_estimates(&picture(&groove(0.6), resolution(32, 32, 1024), MANY), [expected; 3], "grey groove");
}
