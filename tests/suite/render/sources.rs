//! Each kind of light against its closed form, and every kind of surface in a furnace against its albedo by quadrature.

use std::f64::consts::{PI, TAU};

use barbule::bsdf::cylinder::CylinderModel;
use barbule::bsdf::{
    BarbuleDesign, CoatedBase, Direction, Feather, FeatherDesign, MicrofacetInterface, Model, PICTURE_TOLERANCE,
    RoughPlastic,
};
use barbule::render::{EnvironmentMap, Light, Material, Rectangle, Scene, Settings, Sphere, Texture, Vector};

use rayon::prelude::*;

use super::super::directions::{RGB_NM, spherical, values};
use super::super::sampling::{QUADRATURE, QUICK, Subject, integrate_albedo, standard_errors, subjects};
use super::{
    DIRECT, LAMBERT, albedo_of_viewer, assert_estimates, at_origin, estimate, ground, lambertian, material, patch,
    picture, resolution,
};

const RADIANCE: [f64; 3] = [1.0, 2.0, 0.5];

/// A Lambertian patch under one light against the irradiance that it should receive: within 3 standard errors, and those
/// below the bar of 1e-3.
#[track_caller]
fn assert_irradiance(light: Light, expected: f64, what: &str) {
    let scene = patch(lambertian(0.7), 40.0, vec![light]);
    let picture = picture(&scene, resolution(32, 32, 1024), DIRECT);
    let expected = RADIANCE.map(|channel| 0.7 * LAMBERT * expected * channel);
    for (mean, error) in estimate(&picture) {
        assert!(3.0 * error < 1e-3 * mean, "{what}: an error of {error} of {mean} shows nothing");
    }
    assert_estimates(&picture, expected, what);
}

#[test]
fn a_point_light_falls_off_with_the_square_of_distance() {
    let position = Vector::new(1.0, -2.0, 3.0);
    let light = Light::Point { position, intensity: RADIANCE };
    assert_irradiance(light, 3.0 / 14f64.powf(1.5), "point");
}

#[test]
fn parallel_light_falls_with_its_cosine() {
    let direction = Vector::new(2.0, 3.0, 6.0) / 7.0;
    let light = Light::Directional { direction, irradiance: RADIANCE };
    assert_irradiance(light, 6.0 / 7.0, "directional");
}

/// Lambert 1760; Baum, Rushmeier and Winget 1989, equation 4: E = L/2 Σ γ (unit normal of each edge's plane · n), γ the angle
/// of the edge as seen from the point.
fn irradiance_of_polygon(corners: &[Vector]) -> f64 {
    let edges = corners.iter().zip(corners.iter().cycle().skip(1));
    let sum: f64 = edges.map(|(a, b)| a.angle(b) * a.cross(b).normalize().z).sum();
    0.5 * sum.abs()
}

#[test]
fn a_rectangle_lights_as_lambert_says() {
    // Tilted about x, and turned about z: off the axis, and so near that its fall-off shows.
    let (edge_u, edge_v) = (Vector::new(0.0, 2.0, 1.0), Vector::new(3.0, 0.0, 0.0));
    for corner in [Vector::new(-3.5, -0.5, 2.0), Vector::new(-4.0, 1.0, 1.5)] {
        let shape = Rectangle::new(corner, edge_u, edge_v).unwrap();
        assert!(shape.normal().dot(&corner) < 0.0, "it must shine on the origin");
        let light = Light::Rectangle { shape, radiance: RADIANCE };
        assert_irradiance(light, irradiance_of_polygon(&shape.corners()), "rectangle");
    }
}

/// A sphere wholly above the horizon: E = π L cosθ (r/d)², exactly (Lambert's sphere).
#[test]
fn a_sphere_lights_as_lambert_says() {
    let shape = Sphere { centre: Vector::new(0.0, 3.0, 4.0), radius: 2.0 };
    assert_irradiance(Light::Sphere { shape, radiance: RADIANCE }, PI * 0.8 * 0.16, "sphere");
}

#[test]
fn constant_surroundings_light_with_pi() {
    assert_irradiance(Light::Constant { radiance: RADIANCE }, PI, "constant environment");
}

/// A picture of the sky whose irradiance is summed texel by texel: each is constant over its solid angle, up to the
/// interpolation between neighbours, which vanishes with their number; here it is 1e-3 of the sum.
#[test]
fn a_picture_of_the_sky_lights_as_its_sum() {
    let (width, height) = (256, 128);
    let radiance = |azimuth: f64, zenith: f64| {
        let sun = if (azimuth - 2.0).abs() < 0.2 && (zenith - 0.7).abs() < 0.15 { 40.0 } else { 0.0 };
        0.3 + 0.2 * azimuth.sin() + sun
    };
    let place = |x: usize, y: usize| (TAU * (x as f64 + 0.5) / width as f64, PI * (y as f64 + 0.5) / height as f64);
    let texels: Vec<[f32; 3]> = (0..width * height)
        .map(|index| {
            let (azimuth, zenith) = place(index % width, index / width);
            #[expect(clippy::cast_possible_truncation, reason = "a texture holds 32-bit numbers")]
            let texel = RADIANCE.map(|channel| (channel * radiance(azimuth, zenith)) as f32);
            texel
        })
        .collect();
    let mut irradiance = 0.0;
    for index in 0..width * height / 2 {
        let (azimuth, zenith) = place(index % width, index / width);
        irradiance += radiance(azimuth, zenith) * zenith.cos() * zenith.sin() * TAU / width as f64 * PI / height as f64;
    }
    let map = EnvironmentMap::new(Texture::new(width, texels).unwrap(), 75.0).unwrap();
    let scene = patch(lambertian(0.7), 40.0, vec![Light::Map(Box::new(map))]);
    let picture = picture(&scene, resolution(32, 32, 1024), DIRECT);
    for ((mean, error), channel) in estimate(&picture).into_iter().zip(RADIANCE) {
        let expected = 0.7 * LAMBERT * irradiance * channel;
        assert!((mean - expected).abs() < 3.0 * error + 1e-3 * expected, "found {mean} ± {error}, expected {expected}");
        assert!(3.0 * error < 1e-3 * mean, "an error of {error} of {mean} shows nothing");
    }
}

/// Directions drawn from a picture of the sky, counted in cells, against the density integrated over them.
#[test]
fn the_sky_is_drawn_with_the_density_it_tells() {
    let texels: Vec<[f32; 3]> = (0..16 * 8).map(|index: u16| [f32::from(index * 37 % 11); 3]).collect();
    let map = EnvironmentMap::new(Texture::new(16, texels).unwrap(), 33.0).unwrap();
    // The density is constant over a texel: its integral is a sum over directions in the midst of small cells.
    let (rows, columns) = (400, 800);
    let mut total = 0.0;
    for row in 0..rows {
        let cosine = 1.0 - 2.0 * (f64::from(row) + 0.5) / f64::from(rows);
        for column in 0..columns {
            let (sin, cos) = (TAU * (f64::from(column) + 0.5) / f64::from(columns)).sin_cos();
            let sine = (1.0 - cosine * cosine).sqrt();
            total += map.density(&Vector::new(sine * cos, sine * sin, cosine)) * 4.0 * PI / f64::from(rows * columns);
        }
    }
    // Cells on an edge between texels go to one of them: some 2 in 400 rows.
    assert!((total - 1.0).abs() < 5e-3, "the density sums to {total}");
    // Of uniform numbers, ∫ 1/p · p dω is the solid angle of what can be drawn at all: everything.
    let count = 200;
    let mut mean = 0.0;
    for i in 0..count {
        for j in 0..count {
            let random = [i, j].map(|k| (f64::from(k) + 0.5) / f64::from(count));
            let direction = map.draw(random);
            assert!((direction.norm() - 1.0).abs() < 1e-12, "{direction} is no unit vector");
            mean += 1.0 / map.density(&direction) / f64::from(count * count);
        }
    }
    assert!((mean / (4.0 * PI) - 1.0).abs() < 2e-2, "drawn directions cover {mean} sr of 4π");
}

/// Constant light of radiance 1 from everywhere: what a viewer sees is the surface's albedo for that viewer.
#[track_caller]
fn assert_furnace(model: impl Model + 'static, changes: &[(&str, f64)], inclination_deg: f64, what: &str) {
    let values = values(&model, changes);
    let (sin, cos) = inclination_deg.to_radians().sin_cos();
    let expected = albedo_of_viewer(&model, &values, &Direction::new(sin, 0.0, cos));
    let material = Material::plain(Box::new(model), values).unwrap();
    let scene = patch(material, inclination_deg, vec![Light::Constant { radiance: [1.0; 3] }]);
    let picture = picture(&scene, resolution(32, 32, 256), DIRECT);
    for ((mean, error), (expected, quadrature_error)) in estimate(&picture).into_iter().zip(expected) {
        let slack = 3.0 * error + 1e-6 + quadrature_error;
        assert!((mean - expected).abs() < slack, "{what}: found {mean} ± {error}, expected {expected}");
    }
}

#[test]
fn a_furnace_shows_each_models_albedo() {
    let plastic = || RoughPlastic::new(&Default::default(), &RGB_NM).unwrap();
    assert_furnace(plastic(), &[("roughness", 0.2), ("diffuse", 0.6)], 50.0, "rough plastic");
    assert_furnace(plastic(), &[("roughness", 0.5), ("diffuse", 1.0)], 80.0, "rough plastic, grazing");
    let interface = MicrofacetInterface::new(&Default::default(), &RGB_NM).unwrap();
    assert_furnace(interface, &[("roughness", 0.3)], 30.0, "rough interface");
    let fibre = CylinderModel::new(&Default::default(), &RGB_NM).unwrap();
    assert_furnace(fibre, &[("sigma_a", 0.4), ("beta_m", 0.3), ("beta_n", 0.3)], 20.0, "absorbing fibre");
}

/// A diffuse base that absorbs nothing under a clear film, and a feather whose barbules are films over melanin.
#[test]
fn a_furnace_shows_the_albedo_of_films() {
    let film = "substrate = \"keratin\"\nlayers = [{ name = \"film\", material = \"chitin\", thickness_nm = 300 }]";
    let white = [("roughness", 0.3), ("diffuse_albedo", 1.0)];
    for inclination_deg in [20.0, 70.0] {
        let coated = CoatedBase::new(&toml::from_str(film).unwrap(), &RGB_NM).unwrap();
        let (sin, cos) = f64::to_radians(inclination_deg).sin_cos();
        let viewer = Direction::new(sin, 0.0, cos);
        for (albedo, error) in albedo_of_viewer(&coated, &values(&coated, &white), &viewer) {
            // The transmittance is what the tabulated lobe leaves, good to 1e-3.
            assert!((albedo - 1.0).abs() < 1e-3 + error, "the base sends back {albedo} of the light");
        }
        assert_furnace(coated, &white, inclination_deg, "white coated base");
    }
    let lamella =
        "layers = [{ name = \"cortex\", material = \"keratin\", thickness_nm = 330 }]\nsubstrate = \"bird_melanin\"";
    let barbule = BarbuleDesign::Lamella(Box::new(toml::from_str(lamella).unwrap()));
    for inclination_deg in [20.0, 60.0] {
        let feather = Feather::new(&FeatherDesign { barbule: barbule.clone(), ..Default::default() }, &RGB_NM).unwrap();
        assert_furnace(feather, &[("barbule.roughness", 0.3)], inclination_deg, "feather of lamellae");
    }
}

/// Every model, each viewer's picture of a furnace against Gauss's rule.
#[test]
fn a_furnace_shows_every_models_albedo() {
    let most_viewers = subjects().iter().map(|subject| subject.viewers.len()).max().unwrap();
    let count: usize = subjects().iter().map(|subject| subject.viewers.len()).sum();
    let errors = standard_errors(3 * count);
    let mut wrong = Vec::new();
    for number in 0..most_viewers {
        let wrong_now: Vec<String> = subjects()
            .into_par_iter()
            .filter_map(|Subject { name, model, values, viewers }| {
                let (theta_deg, phi_deg) = *viewers.get(number)?;
                let viewer = spherical(theta_deg.to_radians(), phi_deg.to_radians());
                let bound = model.bind(&values);
                let through = bound.straight_through(&viewer);
                let albedos = integrate_albedo(bound.as_ref(), 3, &viewer, QUICK);
                drop(bound);
                let scene = Scene::new(at_origin(viewer), vec![Material::plain(model, values).unwrap()])
                    .with_rectangle(ground(), 0)
                    .with_light(Light::Constant { radiance: [1.0; 3] });
                let seen = picture(&scene, resolution(32, 32, 64), DIRECT);
                estimate(&seen).into_iter().zip(albedos).find_map(|((mean, error), albedo)| {
                    let expected = albedo + through;
                    // Where a picture tabulates, it is good to PICTURE_TOLERANCE.
                    let slack = errors * error + 1e-6 + (QUADRATURE + PICTURE_TOLERANCE) * expected;
                    ((mean - expected).abs() > slack).then(|| {
                        format!("{name}, viewer at {theta_deg}°, {phi_deg}°: {mean} ± {error}, expected {expected}")
                    })
                })
            })
            .collect();
        wrong.extend(wrong_now);
    }
    assert!(wrong.is_empty(), "{} of {count} viewers:\n{}", wrong.len(), wrong.join("\n"));
}

/// What absorbs nothing is as bright as the furnace.
#[test]
fn white_surfaces_vanish_in_a_furnace() {
    let light = || vec![Light::Constant { radiance: [1.0; 3] }];
    let white = picture(&patch(lambertian(1.0), 60.0, light()), resolution(32, 32, 64), DIRECT);
    assert_estimates(&white, [1.0; 3], "white Lambertian surface");
    let fibre = CylinderModel::new(&Default::default(), &RGB_NM).unwrap();
    let fibre = material(fibre, &[("sigma_a", 0.0), ("beta_m", 0.3), ("beta_n", 0.3)]);
    let clear = picture(&patch(fibre, 35.0, light()), resolution(32, 32, 256), DIRECT);
    assert_estimates(&clear, [1.0; 3], "clear fibre");
}

/// The open share of a vane lets light through, to the eye and to what lies behind: white fibres with holes in front of a
/// light are no shadow in a furnace, and a hole shows what is behind it.
#[test]
fn light_passes_the_open_share_of_a_vane() {
    let vane = |share: f64| {
        let model = Feather::new(&Default::default(), &RGB_NM).unwrap();
        let clear = [("through_share", share), ("barb.sigma_a", 0.0), ("barbule.sigma_a", 0.0)];
        material(model, &clear)
    };
    let furnace = patch(vane(0.4), 30.0, vec![Light::Constant { radiance: [1.0; 3] }]);
    let seen = picture(&furnace, resolution(32, 32, 64), DIRECT);
    assert_estimates(&seen, [1.0; 3], "open vane in a furnace");

    // Ground under a vane under parallel light: direct light on it is the open share alone, seen through the vane.
    let light = Light::Directional { direction: Vector::new(0.6, 0.0, 0.8), irradiance: [PI; 3] };
    let above =
        Rectangle::new(Vector::new(-50.0, -50.0, 1.0), Vector::new(100.0, 0.0, 0.0), Vector::new(0.0, 100.0, 0.0));
    let scene = Scene::new(at_origin(Direction::z()), vec![lambertian(1.0), vane(0.25)])
        .with_rectangle(ground(), 0)
        .with_rectangle(above.unwrap(), 1)
        .with_light(light);
    let with_ground = picture(&scene, resolution(64, 64, 256), DIRECT);
    let black_ground = Scene::new(at_origin(Direction::z()), vec![lambertian(0.0), vane(0.25)])
        .with_rectangle(ground(), 0)
        .with_rectangle(above.unwrap(), 1)
        .with_light(Light::Directional { direction: Vector::new(0.6, 0.0, 0.8), irradiance: [PI; 3] });
    let without = picture(&black_ground, resolution(64, 64, 256), DIRECT);
    let ((with, e1), (without, e2)) = (estimate(&with_ground)[0], estimate(&without)[0]);
    let expected = 0.25 * 0.25 * 0.8;
    assert!(
        (with - without - expected).abs() < 3.0 * e1.hypot(e2) + 1e-6,
        "found {} ± {}, expected {expected}",
        with - without,
        e1.hypot(e2)
    );
}

/// Light and surface strategies meet the same light through an open vane: the mean does not hang on which is used.
#[test]
fn strategies_agree_through_an_open_vane() {
    let vane = || {
        let model = Feather::new(&Default::default(), &RGB_NM).unwrap();
        material(model, &[("through_share", 0.5), ("barb.sigma_a", 20.0), ("barbule.sigma_a", 20.0)])
    };
    let scene = |strategies| {
        let lamp = Rectangle::new(Vector::new(-2.0, -2.0, 4.0), Vector::new(0.0, 4.0, 0.0), Vector::new(4.0, 0.0, 0.0));
        let above =
            Rectangle::new(Vector::new(-50.0, -50.0, 2.0), Vector::new(100.0, 0.0, 0.0), Vector::new(0.0, 100.0, 0.0));
        let scene = Scene::new(at_origin(Direction::new(0.96, 0.0, 0.28)), vec![lambertian(0.8), vane()])
            .with_rectangle(ground(), 0)
            .with_rectangle(above.unwrap(), 1)
            .with_light(Light::Rectangle { shape: lamp.unwrap(), radiance: [1.0; 3] });
        estimate(&picture(&scene, resolution(64, 64, 64), Settings { strategies, ..DIRECT }))[0]
    };
    use barbule::render::Strategies::{Both, Light as Lights, Surface};
    let [both, lights, surface] = [Both, Lights, Surface].map(scene);
    for (other, what) in [(lights, "light"), (surface, "surface")] {
        let error = both.1.hypot(other.1);
        assert!((both.0 - other.0).abs() < 3.0 * error, "both {both:?}, {what} {other:?}");
    }
}
