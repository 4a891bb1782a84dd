//! The coated base against its own optics, conservation laws and what a user may type.

use std::f64::consts::PI;

use barbule::bsdf::{
    CoatedBase, Design, DesignEntry, DesignLayer, Direction, MaterialChoice, Model, ModelError, OwnMaterial,
};
use barbule::optics::microfacet::Beckmann;
use barbule::optics::stack::{Layer, transfer};
use barbule::optics::{film, fresnel, known_material};
use num_complex::Complex64;
use proptest::prelude::*;

use super::oracle::Oracle;

const WAVELENGTHS_NM: [f64; 11] = [400.0, 430.0, 460.0, 490.0, 520.0, 550.0, 580.0, 610.0, 640.0, 670.0, 700.0];

fn known(name: &str) -> MaterialChoice {
    MaterialChoice::Known(name.to_owned())
}

fn own(name: &str, index: f64) -> MaterialChoice {
    MaterialChoice::Own(OwnMaterial { name: name.to_owned(), index: Some(index), ..OwnMaterial::default() })
}

fn layer(name: &str, material: MaterialChoice, thickness_nm: f64) -> DesignEntry {
    DesignEntry::Layer(DesignLayer { name: name.to_owned(), material, thickness_nm })
}

/// Layers in air, on a substrate.
fn in_air(layers: Vec<DesignEntry>, substrate: MaterialChoice) -> Design {
    Design { layers, substrate, clear_coat: None, base_knots_nm: Vec::new() }
}

/// Keratin over bird melanin, as in a starling's barbule.
fn cortex(thickness_nm: f64) -> Design {
    in_air(vec![layer("cortex", known("keratin"), thickness_nm)], known("bird_melanin"))
}

/// Default values of a model, with some of them replaced by name.
fn values(model: &CoatedBase, changes: &[(&str, f64)]) -> Vec<f64> {
    let mut values: Vec<f64> = model.parameters().iter().map(|parameter| parameter.default).collect();
    for (name, value) in changes {
        let position = model.parameters().iter().position(|parameter| parameter.name == *name);
        values[position.unwrap_or_else(|| panic!("no parameter {name}"))] = *value;
    }
    values
}

fn direction(theta: f64, phi: f64) -> Direction {
    Direction::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos())
}

fn evaluate(model: &CoatedBase, values: &[f64], incoming: Direction, outgoing: Direction) -> Vec<f64> {
    let mut out = vec![0.0; model.channel_count()];
    model.bind(values).evaluate(&incoming, &outgoing, &mut out);
    out
}

fn index(name: &str, wavelength_nm: f64) -> Complex64 {
    known_material(name).expect("the material is known").dispersion.at(wavelength_nm)
}

/// In the mirror direction the half vector is the normal, and what is left of f is the film's reflectance.
#[test]
fn mirror_direction_shows_the_bare_film() {
    let model = CoatedBase::new(&cortex(330.0), &WAVELENGTHS_NM).unwrap();
    for alpha in [0.01, 0.1, 0.37, 1.0] {
        for theta_deg in [0.0_f64, 15.0, 45.0, 80.0, 89.0] {
            let theta = theta_deg.to_radians();
            let f = evaluate(
                &model,
                &values(&model, &[("roughness", alpha)]),
                direction(theta, 0.3),
                direction(theta, 0.3 + PI),
            );
            let surface = Beckmann::new(alpha);
            let scale = surface.density(1.0) * surface.visible_share(theta.cos()).powi(2) / (4.0 * theta.cos().powi(2));
            for (&wavelength, f) in WAVELENGTHS_NM.iter().zip(f) {
                let keratin = Layer { index: index("keratin", wavelength), thickness_nm: 330.0 };
                let melanin = index("bird_melanin", wavelength);
                let expected = film::airy(1.0, keratin, melanin, theta.cos(), wavelength).reflectance.unpolarised();
                let found = f / scale;
                // The half vector is the normal to 1e-16 only; at 89° and α = 0.01 D makes 1e-12 of it.
                assert!((found - expected).abs() < 1e-10, "α {alpha}, {theta_deg}°: {found} instead of {expected}");
            }
        }
    }
}

/// The same against another program's films and stacks (tmm, 12 digits), whatever the roughness.
#[test]
fn mirror_direction_agrees_with_the_table_of_films() {
    let oracle = Oracle::read("tests/oracles/film.csv");
    let mut count = 0;
    for row in 0..oracle.rows.len() {
        let number = |name| oracle.number(row, name);
        let (n_sub, k_sub, d_nm) = (number("n_sub"), number("k_sub"), number("d_nm"));
        if !(5.0..=5000.0).contains(&d_nm) {
            continue;
        }
        count += 1;
        let melanin = MaterialChoice::Own(OwnMaterial {
            name: "melanin".to_owned(),
            index: Some(n_sub),
            extinction: Some(k_sub),
            ..OwnMaterial::default()
        });
        let film = own("film", number("n_film"));
        let design = match oracle.text(row, "config") {
            "film_air" => in_air(vec![layer("film", film, d_nm)], known("air")),
            "film_melanin" => in_air(vec![layer("film", film, d_nm)], melanin),
            _ => in_air(
                vec![
                    layer("outer", film.clone(), d_nm),
                    layer("upper", melanin.clone(), 100.0),
                    layer("gap", known("air"), 120.0),
                    layer("lower", melanin, 100.0),
                    layer("inner", film, d_nm),
                ],
                known("air"),
            ),
        };
        let model = CoatedBase::new(&design, &[number("lambda_nm")]).unwrap();
        let theta = number("angle_deg").to_radians();
        for alpha in [0.01, 0.2, 1.0] {
            let values = values(&model, &[("roughness", alpha)]);
            let f = evaluate(&model, &values, direction(theta, 0.0), direction(theta, PI))[0];
            let surface = Beckmann::new(alpha);
            let masking = surface.visible_share(theta.cos()).powi(2);
            let found = f * 4.0 * theta.cos().powi(2) / (surface.density(1.0) * masking);
            let expected = number("R");
            assert!((found - expected).abs() < 1e-10, "α {alpha}, row {row}: {found} instead of {expected}");
        }
    }
    assert!(count > 800, "only {count} rows have a thickness that a layer may have");
}

/// The control without layers reflects as Fresnel says, clear or absorbing.
#[test]
fn plain_interface_is_fresnel() {
    for (substrate, index) in [
        (own("wax", 1.44), Complex64::new(1.44, 0.0)),
        (
            MaterialChoice::Own(OwnMaterial {
                name: "ink".to_owned(),
                index: Some(1.7),
                extinction: Some(0.2),
                ..OwnMaterial::default()
            }),
            Complex64::new(1.7, 0.2),
        ),
    ] {
        let design = in_air(Vec::new(), substrate);
        let model = CoatedBase::new(&design, &WAVELENGTHS_NM).unwrap();
        for cosine in [1.0, 0.7, 0.2, 0.01] {
            let mut found = [0.0; 11];
            model.reflectance_at(&values(&model, &[]), cosine, &WAVELENGTHS_NM, &mut found);
            let expected = fresnel::absorbing(cosine, index).unpolarised();
            for found in found {
                assert!((found - expected).abs() < 1e-14, "{found} instead of {expected}");
            }
        }
    }
}

/// A parameter of a material changes all layers of it; index and extinction do what their text says.
#[test]
fn parameters_of_a_material_reach_every_layer_of_it() {
    let text = r#"
        substrate = "keratin"
        layers = [
            { name = "cortex", material = "keratin", thickness_nm = 80 },
            { period = [
                { name = "rods", material = "melanin", thickness_nm = 90 },
                { name = "gaps", material = "air", thickness_nm = 60 },
            ], count = 3 },
        ]
    "#;
    let design: Design = toml::from_str(text).unwrap();
    let model = CoatedBase::new(&design, &WAVELENGTHS_NM).unwrap();
    let names: Vec<&str> = model.parameters().iter().map(|parameter| parameter.name.as_str()).collect();
    assert_eq!(
        names,
        [
            "cortex.thickness_nm",
            "rods.thickness_nm",
            "gaps.thickness_nm",
            "keratin.index_offset",
            "keratin.index_scale",
            "bird_melanin.index_offset",
            "bird_melanin.index_scale",
            "bird_melanin.extinction_scale",
            "roughness",
            "diffuse_albedo",
        ]
    );
    let changed = values(
        &model,
        &[
            ("cortex.thickness_nm", 75.0),
            ("rods.thickness_nm", 101.0),
            ("keratin.index_offset", 0.02),
            ("bird_melanin.index_scale", 1.03),
            ("bird_melanin.index_offset", -0.04),
            ("bird_melanin.extinction_scale", 0.6),
        ],
    );
    let mut found = [0.0; 11];
    model.reflectance_at(&changed, 0.8, &WAVELENGTHS_NM, &mut found);
    for (&wavelength, found) in WAVELENGTHS_NM.iter().zip(found) {
        let keratin = index("keratin", wavelength) + 0.02;
        let melanin = index("bird_melanin", wavelength);
        let melanin = Complex64::new(1.03 * melanin.re - 0.04, 0.6 * melanin.im);
        let layer = |index, thickness_nm| Layer { index, thickness_nm };
        let pair = [layer(melanin, 101.0), layer(Complex64::new(1.0, 0.0), 60.0)];
        let layers = [vec![layer(keratin, 75.0)], pair.repeat(3)].concat();
        let expected = transfer(1.0, &layers, keratin, 0.8, wavelength).reflectance.unpolarised();
        assert!((found - expected).abs() < 1e-12, "{found} instead of {expected} at {wavelength} nm");
    }
}

/// A coat of index 1 is no coat; one of index n refracts the directions and weakens the light on both passes.
#[test]
fn clear_coat_refracts_first() {
    let bare = CoatedBase::new(&cortex(330.0), &WAVELENGTHS_NM).unwrap();
    let coated =
        |index| CoatedBase::new(&Design { clear_coat: Some(index), ..cortex(330.0) }, &WAVELENGTHS_NM).unwrap();
    let defaults = values(&bare, &[("diffuse_share", 0.2), ("roughness", 0.3)]);
    let (incoming, outgoing) = (direction(0.6, 0.2), direction(0.9, 2.0));
    let none = evaluate(&bare, &defaults, incoming, outgoing);
    for (found, expected) in evaluate(&coated(1.0), &defaults, incoming, outgoing).into_iter().zip(none) {
        assert!((found / expected - 1.0).abs() < 1e-12, "{found} instead of {expected}");
    }

    // In the mirror direction at 50°, by the reference, with the refraction written out.
    let n = 1.5_f64;
    let theta = 50.0_f64.to_radians();
    let inside = (theta.sin() / n).asin();
    let f = evaluate(&coated(n), &values(&bare, &[("roughness", 0.2)]), direction(theta, 0.0), direction(theta, PI));
    let surface = Beckmann::new(0.2);
    let transmittance = 1.0 - fresnel::dielectric(theta.cos(), n).unpolarised();
    let scale = (transmittance / n * surface.visible_share(inside.cos())).powi(2) * surface.density(1.0)
        / (4.0 * inside.cos().powi(2));
    let mut bare_reflectance = [0.0; 11];
    coated(n).reflectance_at(&values(&bare, &[]), theta.cos(), &WAVELENGTHS_NM, &mut bare_reflectance);
    for ((&wavelength, f), bare_reflectance) in WAVELENGTHS_NM.iter().zip(f).zip(bare_reflectance) {
        let keratin = Layer { index: index("keratin", wavelength), thickness_nm: 330.0 };
        let melanin = index("bird_melanin", wavelength);
        let expected = film::airy(n, keratin, melanin, inside.cos(), wavelength).reflectance.unpolarised();
        assert!((f / scale - expected).abs() < 1e-10, "{} instead of {expected}", f / scale);
        assert!((bare_reflectance - expected).abs() < 1e-12, "{bare_reflectance} instead of {expected}");
    }
}

/// ∫ f cosθo dωo by the midpoint rule over the half vector's slope, in which a Beckmann lobe is smooth for any α:
/// dωo = 4 (ωi·h) dωh and dωh = α² cos³θh t dt dφ with t = tanθh/α = 6 w², so that no end has a slope in w.
pub(super) fn albedo(model: &CoatedBase, values: &[f64], alpha: f64, theta: f64) -> Vec<f64> {
    let incoming = direction(theta, 0.0);
    let bound = model.bind(values);
    let (radii, azimuths) = (160_u32, 128_u32);
    let (w_step, azimuth_step) = (1.0 / f64::from(radii), 2.0 * PI / f64::from(azimuths));
    let mut sum = vec![0.0; model.channel_count()];
    let mut f = sum.clone();
    for i in 0..radii {
        let w = (f64::from(i) + 0.5) * w_step;
        let t = 6.0 * w * w;
        let cos_half = 1.0 / (1.0 + (alpha * t).powi(2)).sqrt();
        for j in 0..azimuths {
            let phi = (f64::from(j) + 0.5) * azimuth_step;
            let half = direction(cos_half.acos(), phi);
            let cos_facet = incoming.dot(&half);
            let outgoing = 2.0 * cos_facet * half - incoming;
            if cos_facet <= 0.0 || outgoing.z <= 0.0 {
                continue;
            }
            bound.evaluate(&incoming, &outgoing, &mut f);
            let ring = t * 12.0 * w * w_step * azimuth_step;
            let solid_angle = 4.0 * cos_facet * alpha * alpha * cos_half.powi(3) * ring;
            for (sum, f) in sum.iter_mut().zip(&f) {
                *sum += f * outgoing.z * solid_angle;
            }
        }
    }
    sum
}

/// Never more comes back than arrives, even from a stack that reflects nearly all; the weakest case is a mirror.
#[test]
fn furnace_stays_below_one() {
    let mirror: Design = toml::from_str(
        r#"
        substrate = { name = "glass", index = 1.52 }
        layers = [{ period = [
            { name = "high", material = { name = "high", index = 2.6 }, thickness_nm = 50 },
            { name = "low", material = { name = "low", index = 1.3 }, thickness_nm = 100 },
        ], count = 8 }]
    "#,
    )
    .unwrap();
    let model = CoatedBase::new(&mirror, &WAVELENGTHS_NM).unwrap();
    let mut highest: f64 = 0.0;
    for alpha in [0.05, 0.3, 1.0] {
        for theta_deg in [0.0_f64, 30.0, 60.0, 80.0] {
            let values = values(&model, &[("roughness", alpha)]);
            highest = albedo(&model, &values, alpha, theta_deg.to_radians()).into_iter().fold(highest, f64::max);
        }
    }
    // The quadrature is good to 1e-4; a nearly perfect mirror of little roughness comes near to 1.
    assert!(highest <= 1.0 + 1e-4, "albedo {highest}");
    assert!(highest > 0.95, "the stack is no mirror: {highest}");
}

/// With vanishing roughness all light goes into the mirror direction, and the albedo becomes the film's reflectance:
/// slopes of α change R by α² times its curvature in θ, so that half the roughness leaves a quarter of the difference.
#[test]
fn smooth_limit_is_the_film() {
    let model = CoatedBase::new(&cortex(330.0), &WAVELENGTHS_NM).unwrap();
    for theta_deg in [0.0_f64, 30.0, 60.0] {
        let theta = theta_deg.to_radians();
        let difference = |alpha: f64| {
            let values = values(&model, &[("roughness", alpha)]);
            let mut expected = vec![0.0; 11];
            model.reflectance_at(&values, theta.cos(), &WAVELENGTHS_NM, &mut expected);
            let found = albedo(&model, &values, alpha, theta);
            let differences = found.iter().zip(&expected).map(|(found, expected)| (found - expected).powi(2));
            (differences.sum::<f64>() / 11.0).sqrt()
        };
        let (coarse, fine) = (difference(0.04), difference(0.02));
        assert!((coarse / fine - 4.0).abs() < 0.4, "{theta_deg}°: {coarse} at α 0.04, {fine} at α 0.02");
        assert!(difference(0.01) < 1e-4, "{theta_deg}°: {}", difference(0.01));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, failure_persistence: None, ..ProptestConfig::default() })]

    /// f(ωi, ωo) = f(ωo, ωi) to the last bit, and finite, anywhere above the horizon and inside the bounds.
    #[test]
    fn reciprocity_is_exact(
        angles in [0.0..1.57_f64, 0.0..6.3, 0.0..1.57, 0.0..6.3],
        shares in prop::collection::vec(0.0..=1.0_f64, 8),
        coat in prop::option::of(1.0..2.0_f64),
    ) {
        let design = Design { clear_coat: coat, ..cortex(300.0) };
        let model = CoatedBase::new(&design, &WAVELENGTHS_NM).unwrap();
        prop_assert_eq!(model.parameters().len(), shares.len());
        let values: Vec<f64> = model
            .parameters()
            .iter()
            .zip(&shares)
            .map(|(parameter, share)| parameter.lower + share * (parameter.upper - parameter.lower))
            .collect();
        let (incoming, outgoing) = (direction(angles[0], angles[1]), direction(angles[2], angles[3]));
        let forth = evaluate(&model, &values, incoming, outgoing);
        let back = evaluate(&model, &values, outgoing, incoming);
        for (forth, back) in forth.into_iter().zip(back) {
            prop_assert!(forth.is_finite() && forth >= 0.0, "{forth}");
            prop_assert_eq!(forth.to_bits(), back.to_bits());
        }
    }
}

#[test]
fn nothing_comes_from_below_the_horizon() {
    let model = CoatedBase::new(&cortex(330.0), &WAVELENGTHS_NM).unwrap();
    let values = values(&model, &[("diffuse_share", 0.5)]);
    let (above, below) = (Direction::new(0.0, 0.6, 0.8), Direction::new(0.0, 0.6, -0.8));
    let horizon = Direction::new(1.0, 0.0, 0.0);
    for (incoming, outgoing) in [(above, below), (below, above), (below, below), (above, horizon), (horizon, above)] {
        assert!(evaluate(&model, &values, incoming, outgoing).iter().all(|f| f.to_bits() == 0));
    }
}

/// A scan at the declared step meets each local minimum of a misfit that a ten times finer scan meets.
#[test]
fn scan_step_misses_no_minimum() {
    let wavelengths: Vec<f64> = (0..81).map(|i| 300.0 + 5.0 * f64::from(i)).collect();
    let model = CoatedBase::new(&cortex(330.0), &wavelengths).unwrap();
    let step = model.parameters()[0].scan_step.unwrap();
    let mut measured = vec![0.0; wavelengths.len()];
    model.reflectance_at(&values(&model, &[]), 0.9, &wavelengths, &mut measured);
    let mut predicted = measured.clone();
    let mut minima = |step: f64| {
        let mut misfit = |i: u32| {
            let d = 50.0 + step * f64::from(i);
            let values = values(&model, &[("cortex.thickness_nm", d)]);
            model.reflectance_at(&values, 0.9, &wavelengths, &mut predicted);
            predicted.iter().zip(&measured).map(|(a, b)| (a - b).powi(2)).sum::<f64>()
        };
        let mut count = 0;
        let mut i = 1;
        while 50.0 + step * f64::from(i) < 1500.0 {
            let (before, here, after) = (misfit(i - 1), misfit(i), misfit(i + 1));
            count += u32::from(here < before && here < after);
            i += 1;
        }
        count
    };
    let (fine, declared) = (minima(0.1 * step), minima(step));
    assert!(fine >= 5, "the misfit has only {fine} minima and tests little");
    assert_eq!(declared, fine);
}

/// What a user mistypes ends in a sentence that names it, what was expected, and the line.
#[test]
fn mistyped_designs_are_explained() {
    for (text, parts) in [
        (
            r#"substrate = "keratine""#,
            &["line 1", "keratine", "keratin, bird_melanin, chitin", "did you mean \"keratin\""][..],
        ),
        (r#"substrate = "unobtainium""#, &["unobtainium", "keratin, bird_melanin", "describe your own"]),
        ("substrate = 1.5", &["line 1", "name of a known material"]),
        (r#"substrate = { name = "wax", indx = 1.44 }"#, &["indx", "`index`"]),
        (r#"substrate = { name = "wax" }"#, &["\"wax\"", "its name alone", "`table`"]),
        (r#"substrate = { name = "wax", index = 1.4, cauchy_a = 1.5 }"#, &["`index`, `cauchy_a`", "expected one of"]),
        (r#"substrate = { name = "wax", cauchy_a = 1.5, cauchy_b_nm2 = 1, extinction_c = 1 }"#, &["`extinction_c`"]),
        (r#"substrate = { name = "wax", index = -1.4 }"#, &["`index` of material \"wax\"", "-1.4", "0.05 to 10"]),
        (r#"substrate = { name = "wax", index = nan }"#, &["NaN", "0.05 to 10"]),
        (r#"substrate = { name = "bees wax", index = 1.4 }"#, &["\"bees wax\"", "letters, digits or underscores"]),
        (r#"substrate = { name = "wax", table = [[400, 1.4, 0]] }"#, &["wax", "at least two rows"]),
        (r#"substrate = { name = "wax", table = [[400, 1.4, 0], [400, 1.5, 0]] }"#, &["row 2", "sort"]),
        (r#"substrate = { name = "wax", table = [[400, 1.4, 0], [500, 1.5, -1]] }"#, &["row 2", "-1", "k from 0"]),
        (
            "substrate = \"air\"\nlayers = [{ name = \"a\", material = \"air\" }]",
            &["line 2", "`name`, `material`", "`thickness_nm`"],
        ),
        ("substrate = \"air\"\nlayers = [{ period = [] }]", &["line 2", "`period`", "`count`"]),
        ("substrate = \"air\"\nlayers = [{ name = \"a\", thickness = 3 }]", &["line 2", "thickness", "`thickness_nm`"]),
        ("layers = []", &["substrate"]),
    ] {
        let message = toml::from_str::<Design>(text).unwrap_err().to_string();
        for part in parts {
            assert!(message.contains(part), "{text}\ngave\n{message}\nwithout {part:?}");
        }
    }
}

/// What is right on its own but not together, or out of range, is refused when the model is made.
#[test]
fn senseless_designs_are_refused() {
    let refused = |design: &Design, wavelengths: &[f64]| CoatedBase::new(design, wavelengths).unwrap_err();
    assert_eq!(refused(&cortex(300.0), &[]), ModelError::NoWavelengths);
    for wavelength in [f64::NAN, f64::INFINITY, 0.0, -500.0, 0.5] {
        assert!(matches!(refused(&cortex(300.0), &[wavelength]), ModelError::OutOfRange { .. }));
    }
    for thickness in [f64::NAN, 0.3, -300.0, 5001.0] {
        let message = refused(&cortex(thickness), &[500.0]).to_string();
        assert!(message.contains("\"cortex\"") && message.contains("5 to 5000 nm"), "{message}");
    }
    let coat = Design { clear_coat: Some(0.9), ..cortex(300.0) };
    assert!(refused(&coat, &[500.0]).to_string().contains("clear_coat"));
    let twice =
        Design { layers: vec![layer("a", known("keratin"), 50.0), layer("a", known("air"), 50.0)], ..cortex(300.0) };
    assert_eq!(refused(&twice, &[500.0]), ModelError::TwoLayers { name: "a".to_owned() });
    let conflict = in_air(vec![layer("a", own("wax", 1.4), 50.0)], own("wax", 1.5));
    assert_eq!(refused(&conflict, &[500.0]), ModelError::TwoMaterials { name: "wax".to_owned() });
    let wax = OwnMaterial {
        name: "wax".to_owned(),
        table: Some(vec![[400.0, 1.5, 0.0], [600.0, 1.45, 0.0]]),
        ..OwnMaterial::default()
    };
    let table = in_air(Vec::new(), MaterialChoice::Own(wax));
    let message = refused(&table, &[500.0, 650.0]).to_string();
    for part in ["wax", "400 to 600 nm", "650"] {
        assert!(message.contains(part), "{message}");
    }
    assert!(CoatedBase::new(&table, &[400.0, 500.0, 600.0]).is_ok());
}

/// A design survives being written and read.
#[test]
fn designs_round_trip() {
    let text = r#"
        clear_coat = 1.5
        substrate = { name = "ink", cauchy_a = 1.6, cauchy_b_nm2 = 9000.0, extinction_c = 0.5, extinction_length_nm = 270.0 }
        layers = [
            { name = "top", material = "Melanin", thickness_nm = 100.0 },
            { period = [{ name = "gap", material = "air", thickness_nm = 90.0 }], count = 2 },
        ]
    "#;
    let design: Design = toml::from_str(text).unwrap();
    let json = serde_json::to_string(&design).unwrap();
    assert!(json.contains("bird_melanin"), "the canonical name is written: {json}");
    assert_eq!(serde_json::from_str::<Design>(&json).unwrap(), design);
    assert_eq!(toml::from_str::<Design>(&toml::to_string(&design).unwrap()).unwrap(), design);
}

/// The methods paragraph names the layers in order and says how well each material is known.
#[test]
fn description_is_fit_for_a_methods_section() {
    let model = CoatedBase::new(&cortex(330.0), &[300.0, 500.0, 700.0]).unwrap();
    let description = model.describe();
    assert!(
        description.text.contains("From the outside in: cortex of keratin (nominally 330 nm), on bird_melanin."),
        "{}",
        description.text
    );
    let text = r#"
        layers = [{ name = "film", material = { name = "film", index = 1.7 }, thickness_nm = 330 }]
        substrate = { name = "binder", index = 1.5 }
    "#;
    let film = CoatedBase::new(&toml::from_str::<Design>(text).unwrap(), &[500.0]).unwrap().describe();
    assert!(film.text.contains("From the outside in: film (nominally 330 nm), on binder."), "{}", film.text);
    let melanin = &description.materials[1];
    assert_eq!(melanin.name, "bird_melanin");
    for part in ["1.648", "400 to 700 nm", "extrapolation", "Secondary"] {
        assert!(melanin.text.contains(part), "{}", melanin.text);
    }
    let keys: Vec<&str> = description.references.iter().map(|reference| reference.key.as_str()).collect();
    assert_eq!(keys, ["Yeh 1988", "Walter 2007", "Leertouwer 2011", "Stavenga 2015"]);
}
