//! A fibre with layers on it: against the bare fibre, against its energy written out, and against the layers alone.

use std::f64::consts::FRAC_PI_2;

use barbule::bsdf::cylinder::{CylinderDesign, CylinderModel, FilmedCylinderDesign, FilmedCylinderModel};
use barbule::bsdf::{BarbuleDesign, Direction, Feather, FeatherDesign, Model, ModelError};
use barbule::optics::stack::{Layer, transfer};
use barbule::optics::{fresnel, known_material};
use num_complex::Complex64;

use super::directions::{RGB_NM, evaluate, furnace, spherical, values};

const FILM: &str = r#"layers = [{ name = "cortex", material = "keratin", thickness_nm = 400 }]"#;
const STACK: &str = r#"layers = [
    { name = "cortex", material = "keratin", thickness_nm = 330 },
    { name = "melanin", material = "bird_melanin", thickness_nm = 120 },
]"#;

fn model(design: &str, wavelengths_nm: &[f64]) -> FilmedCylinderModel {
    let design: FilmedCylinderDesign = toml::from_str(design).unwrap();
    FilmedCylinderModel::new(&design, wavelengths_nm).unwrap()
}

/// Layers that are not there, or cannot be told from the fibre: what is left is the table's interpolation, 2e-7 of 1.
#[test]
fn layers_that_change_nothing_leave_the_bare_fibre() {
    let bare = CylinderModel::new(&CylinderDesign::default(), &RGB_NM).unwrap();
    let same = r#"layers = [{ name = "skin", material = { name = "core", index = 1.55 }, thickness_nm = 700 }]"#;
    let mut worst: f64 = 0.0;
    for design in ["layers = []", same] {
        let filmed = model(design, &RGB_NM);
        for (theta_i, phi_i) in [(0.2, 0.0), (0.9, 1.0), (1.4, 2.5), (2.6, -2.0)] {
            for (theta_o, phi_o) in [(0.4, 3.0), (1.2, 0.3), (1.5, -1.0)] {
                let (incoming, outgoing) = (spherical(theta_i, phi_i), spherical(theta_o, phi_o));
                let expected = evaluate(&bare, &values(&bare, &[]), &incoming, &outgoing);
                for (found, expected) in
                    evaluate(&filmed, &values(&filmed, &[]), &incoming, &outgoing).iter().zip(expected)
                {
                    worst = worst.max((found / expected - 1.0).abs());
                }
            }
        }
    }
    println!("largest relative difference {worst:e}");
    assert!(worst < 1e-5);
}

/// ½ ∫ Σ Aₚ dh from the transfer products themselves, by midpoints in γ: R out and, of what enters, the geometric series of
/// the passes; 4000 midpoints leave 6e-9. An integral over the sphere cannot tell how the light is spread, but it sees every share.
fn albedo(layers: &[Layer], eta: f64, sigma_a: f64, sin_theta_o: f64, wavelength_nm: f64) -> f64 {
    let cos_theta_o = (1.0 - sin_theta_o * sin_theta_o).sqrt();
    let cos_theta_t = (1.0 - (sin_theta_o / eta).powi(2)).sqrt();
    let reversed: Vec<Layer> = layers.iter().rev().copied().collect();
    let count = 4000;
    let at = |k: i32| {
        let gamma = (f64::from(k) + 0.5) / f64::from(count) * FRAC_PI_2;
        let cosine = cos_theta_o * gamma.cos();
        let cosine_inside = (1.0 - (1.0 - cosine * cosine) / (eta * eta)).sqrt();
        let cos_gamma_t = cosine_inside / cos_theta_t;
        let pass = (-2.0 * sigma_a * cos_gamma_t / cos_theta_t).exp();
        let outside = transfer(1.0, layers, Complex64::new(eta, 0.0), cosine, wavelength_nm);
        let inside = transfer(eta, &reversed, Complex64::new(1.0, 0.0), cosine_inside, wavelength_nm);
        let (t, back) = (outside.transmittance.unpolarised(), inside.reflectance.unpolarised());
        (outside.reflectance.unpolarised() + t * t * pass / (1.0 - back * pass)) * gamma.cos()
    };
    (0..count).map(at).sum::<f64>() * FRAC_PI_2 / f64::from(count)
}

/// The midpoints over the sphere leave 4e-5 of a bare fibre too.
#[test]
fn the_energy_is_that_of_the_layers() {
    let wavelength_nm = 525.0;
    let layer = |name: &str, thickness_nm| Layer {
        index: known_material(name).unwrap().dispersion.at(wavelength_nm),
        thickness_nm,
    };
    let film = [layer("keratin", 400.0)];
    let stack = [layer("keratin", 330.0), layer("bird_melanin", 120.0)];
    for (design, layers, eta, sigma_a, white) in
        [(FILM, &film[..], 1.75, 0.0, true), (FILM, &film, 1.75, 0.4, false), (STACK, &stack, 1.56, 0.0, false)]
    {
        let model = model(design, &[wavelength_nm]);
        let values = values(&model, &[("eta", eta), ("sigma_a", sigma_a), ("beta_m", 0.35), ("beta_n", 0.4)]);
        for (theta_deg, phi_deg) in [(0.0_f64, 0.0_f64), (40.0, 30.0), (75.0, 10.0)] {
            let outgoing = spherical(theta_deg.to_radians(), phi_deg.to_radians());
            let found = furnace(&model, &values, &outgoing);
            let expected = albedo(layers, eta, sigma_a, outgoing.x, wavelength_nm);
            println!("{design} η {eta} σ {sigma_a}: {found}, expected {expected}");
            assert!((found - expected).abs() < 1e-4);
            assert!(!white || (expected - 1.0).abs() < 1e-8, "clear layers take nothing away");
        }
    }
}

/// With all light inside absorbed only R is left, and a narrow lobe shows the layers' own reflectance at the half angle. The
/// lobe is 0.004 wide: the curvature of a fringe over it is below 1e-3.
#[test]
fn the_first_reflection_is_that_of_the_layers() {
    let filmed = model(FILM, &RGB_NM);
    let bare = CylinderModel::new(&CylinderDesign::default(), &RGB_NM).unwrap();
    let settings = [("eta", 1.75), ("sigma_a", 20.0), ("beta_m", 0.2), ("beta_n", 0.02)];
    let across = |angle: f64| Direction::new(0.0, angle.sin(), angle.cos());
    for half_deg in [5.0_f64, 20.0, 35.0, 50.0, 65.0] {
        let half = half_deg.to_radians();
        let (incoming, outgoing) = (across(half - 0.1), across(-half - 0.1));
        let of = |model: &dyn Model| evaluate(model, &values(model, &settings), &incoming, &outgoing);
        for ((found, bare), wavelength_nm) in of(&filmed).iter().zip(of(&bare)).zip(RGB_NM) {
            let keratin = known_material("keratin").unwrap().dispersion.at(wavelength_nm);
            let layers = [Layer { index: keratin, thickness_nm: 400.0 }];
            let film = transfer(1.0, &layers, Complex64::new(1.75, 0.0), half.cos(), wavelength_nm).reflectance;
            let expected = film.unpolarised() / fresnel::dielectric(half.cos(), 1.75).unpolarised();
            let ratio = found / bare;
            assert!((ratio / expected - 1.0).abs() < 1e-3, "{half_deg}°, {wavelength_nm} nm: {ratio}, not {expected}");
        }
    }
}

#[test]
fn a_feather_takes_filmed_barbules() {
    let design: FilmedCylinderDesign = toml::from_str(STACK).unwrap();
    let filmed = FilmedCylinderModel::new(&design, &RGB_NM).unwrap();
    let feather = FeatherDesign { barbule: BarbuleDesign::FilmedCylinder(design), ..FeatherDesign::default() };
    let feather = Feather::new(&feather, &RGB_NM).unwrap();
    assert!(feather.parameters().iter().any(|parameter| parameter.name == "barbule.cortex.thickness_nm"));
    let (incoming, outgoing) = (spherical(0.5, 0.3), spherical(0.7, 2.5));
    let found =
        evaluate(&feather, &values(&feather, &[("barb_share", 0.0), ("barbule_angle_deg", 0.0)]), &incoming, &outgoing);
    let expected = evaluate(&filmed, &values(&filmed, &[]), &incoming, &outgoing);
    for (found, expected) in found.iter().zip(expected) {
        assert!((found / expected - 1.0).abs() < 1e-12);
    }
}

#[test]
fn layers_that_cannot_be_are_refused() {
    for (layers, part) in [
        (r#"{ name = "a", material = "keratin", thickness_nm = 1 }"#, "5 to 5000 nm"),
        (
            r#"{ name = "a", material = "keratin", thickness_nm = 100 }, { name = "a", material = "keratin", thickness_nm = 90 }"#,
            "two layers are named \"a\"",
        ),
    ] {
        let design: FilmedCylinderDesign = toml::from_str(&format!("layers = [{layers}]")).unwrap();
        let error: ModelError = FilmedCylinderModel::new(&design, &RGB_NM).unwrap_err();
        assert!(error.to_string().contains(part), "{error}");
    }
}
