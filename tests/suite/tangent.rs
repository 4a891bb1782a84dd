//! Models with a tangent, turned: against the same model seen from turned directions, and found again by a fit.

use std::f64::consts::TAU;
use std::fmt::Write as _;

use barbule::bsdf::cylinder::{CylinderDesign, CylinderModel};
use barbule::bsdf::spongy_barb::SpongyBarbModel;
use barbule::bsdf::{Feather, FeatherDesign, Model, Oriented};
use proptest::prelude::*;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::Value;

use super::desk::Desk;
use super::directions::{RGB_NM, evaluate, spherical, values};

fn cylinder() -> Box<dyn Model> {
    Box::new(CylinderModel::new(&CylinderDesign::default(), &RGB_NM).unwrap())
}

fn spongy_barb() -> Box<dyn Model> {
    Box::new(SpongyBarbModel::new(&CylinderDesign::default(), &RGB_NM).unwrap())
}

fn feather() -> Box<dyn Model> {
    Box::new(Feather::new(&FeatherDesign::default(), &RGB_NM).unwrap())
}

proptest! {
    /// Turning the tangent is turning light and viewer the other way; half a turn changes nothing. 1e-9 is rounding in
    /// the azimuths, seen through the lobes.
    #[test]
    fn a_turned_tangent_is_turned_directions_the_other_way(
        tangent_deg in -90.0..90.0f64,
        (theta_i, phi_i) in (0.0..1.5f64, 0.0..TAU),
        (theta_o, phi_o) in (0.0..3.1f64, 0.0..TAU),
    ) {
        let plain = feather();
        let turned = Oriented::new(feather());
        let (incoming, outgoing) = (spherical(theta_i, phi_i), spherical(theta_o, phi_o));
        let azimuth = tangent_deg.to_radians();
        let expected = evaluate(
            plain.as_ref(),
            &values(plain.as_ref(), &[]),
            &spherical(theta_i, phi_i - azimuth),
            &spherical(theta_o, phi_o - azimuth),
        );
        for whole in [0.0, 180.0, -180.0] {
            let tangent_deg = tangent_deg + whole;
            if tangent_deg.abs() <= 180.0 {
                let values = values(&turned, &[("tangent_deg", tangent_deg)]);
                for (found, expected) in evaluate(&turned, &values, &incoming, &outgoing).iter().zip(&expected) {
                    prop_assert!((found / expected - 1.0).abs() < 1e-9, "found {}, expected {}", found, expected);
                }
            }
        }
    }
}

/// At 0, where every job starts that says nothing, not a bit is changed.
#[test]
fn a_tangent_along_x_changes_nothing() {
    for (plain, turned) in [(cylinder(), Oriented::new(cylinder())), (feather(), Oriented::new(feather()))] {
        let (incoming, outgoing) = (spherical(0.7, 1.0), spherical(0.4, -2.0));
        let expected = evaluate(plain.as_ref(), &values(plain.as_ref(), &[]), &incoming, &outgoing);
        assert_eq!(evaluate(&turned, &values(&turned, &[]), &incoming, &outgoing), expected);
        assert_eq!(turned.parameters().last().unwrap().name, "tangent_deg");
    }
}

/// Readings of a model whose tangent lies at `tangent_deg`, at four angles in and out of the plane of incidence, with 1 % noise.
/// The model is seen from turned directions, so that nothing of [`Oriented`] is used.
fn table(model: &dyn Model, tangent_deg: f64) -> String {
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let truth = values(model, &[]);
    let bound = model.bind(&truth);
    let mut text = "theta_i,phi_i,theta_o,phi_o,nm,brdf\n".to_owned();
    let mut readings = [0.0; 3];
    for theta_i in [15.0, 40.0, 65.0] {
        for phi_i in [0.0, 70.0] {
            for theta_o in [10.0, 45.0, 70.0] {
                for phi_o in [20.0, 110.0, 200.0, 290.0] {
                    let towards = |theta_deg: f64, phi_deg: f64| {
                        spherical(theta_deg.to_radians(), (phi_deg - tangent_deg).to_radians())
                    };
                    bound.evaluate(&towards(theta_i, phi_i), &towards(theta_o, phi_o), &mut readings);
                    for (nm, reading) in RGB_NM.iter().zip(readings) {
                        // Twelve uniform numbers are as good as a normal one here.
                        let noise = (0..12).map(|_| random.random_range(-0.5..0.5)).sum::<f64>();
                        let value = reading * (1.0 + 0.01 * noise);
                        writeln!(text, "{theta_i},{phi_i},{theta_o},{phi_o},{nm},{value:e}").unwrap();
                    }
                }
            }
        }
    }
    text
}

/// The tangent comes back within four standard errors, which a right answer misses once in 16,000, and to a degree.
#[test]
fn the_tangent_of_a_table_is_found() {
    for (kind, model, roughness) in [
        ("cylinder", cylinder(), "beta_m"),
        ("spongy-barb", spongy_barb(), "beta_m"),
        ("feather", feather(), "barbule.beta_m"),
    ] {
        let job = format!(
            r#"title = "A turned {kind}"

[data]
file = "table.csv"

[data.layout.spectra]
quantity = "brdf"
sigma = {{ relative = 0.01, absolute = 1e-9 }}

[data.layout.spectra.columns.long]
angles = {{ four = {{ theta_i = "theta_i", phi_i = "phi_i", theta_o = "theta_o", phi_o = "phi_o" }} }}
wavelength = "nm"
value = "brdf"

[model]
kind = "{kind}"

[parameters]
tangent_deg = {{ lower = -90, upper = 90 }}
"{roughness}" = {{ lower = 0.1, upper = 0.8 }}

[fit]
starts = 8
"#
        );
        let desk = Desk::with("turned.toml", job).and("table.csv", table(model.as_ref(), 27.0));
        desk.barbule("fit turned.toml --out found").succeeds();
        let result = desk.result("found");
        let estimates = result["cases"][0]["fit"]["estimates"].as_array().unwrap();
        let of = |name: &str, key: &str| {
            let found = estimates.iter().find(|estimate| estimate["name"] == name).map(|estimate| &estimate[key]);
            found.and_then(Value::as_f64).unwrap_or_else(|| panic!("{kind}: {name} has no {key}"))
        };
        for (name, truth) in [("tangent_deg", 27.0), (roughness, 0.3)] {
            let (value, error) = (of(name, "value"), of(name, "standard_error"));
            println!("{kind}: {name} {value} ± {error}, made from {truth}");
            assert!((value - truth).abs() < 4.0 * error, "{kind}: {name} {value} ± {error}, made from {truth}");
        }
        assert!((of("tangent_deg", "value") - 27.0).abs() < 1.0);
    }
}
