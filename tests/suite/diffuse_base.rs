//! The diffuse base below the layers of a coated base: what enters, what comes back, and that nothing is made or lost.

use std::f64::consts::PI;

use barbule::bsdf::{CoatedBase, Design, Direction, Model};
use barbule::optics::stack::{Layer, transfer};
use barbule::optics::{Arrangement, FacetKernel, LayeredMedium, Permittivity, double_wavenumbers, fresnel};
use num_complex::Complex64;
use proptest::prelude::*;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::coated_base::albedo as lobe_albedo;
use super::directions::{evaluate, spherical, values};
use super::oracle::Oracle;

/// A stack at one wavelength: layers from the outside in, and the substrate.
fn with_medium<T>(layers: &[Layer], substrate: Complex64, wavelength_nm: f64, then: impl Fn(&LayeredMedium) -> T) -> T {
    let count = layers.len();
    let arrangement = Arrangement::new(count + 1, (0..count).collect(), (0..count).collect(), count);
    let indices = layers.iter().map(|layer| layer.index).chain([substrate]);
    let permittivities =
        indices.map(|index| Permittivity::new(std::iter::once(index.re), std::iter::once(index.im))).collect();
    let thicknesses_nm = layers.iter().map(|layer| layer.thickness_nm).collect();
    then(&LayeredMedium::new(&arrangement, &double_wavenumbers(&[wavelength_nm]), permittivities, thicknesses_nm))
}

/// Without layers what the lobe throws back is the rough interface's R of another program's table.
#[test]
fn what_enters_agrees_with_the_table_of_rough_interfaces() {
    let oracle = Oracle::read("tests/oracles/rough_transmittance.csv");
    let worst = (0..oracle.rows.len()).into_par_iter().map(|row| {
        let number = |name| oracle.number(row, name);
        let (eta, alpha, cosine) = (number("eta"), number("alpha"), number("mu"));
        with_medium(&[], Complex64::from(eta), 550.0, |medium| {
            let entering = FacetKernel::new(alpha, medium, 1.0).entering(medium, 1.0);
            let mut product = [0.0];
            entering.add_products([cosine, cosine], &[1.0], &mut product);
            (product[0].sqrt() - (1.0 - number("exact_R_ext"))).abs()
        })
    });
    let worst = worst.collect::<Vec<f64>>().into_iter().fold(0.0, f64::max);
    println!("worst {worst:e}");
    // What the docs of the kernel state for a plain interface, a fiftieth of the furnace's bar.
    assert!(worst < 2e-5, "worst difference {worst:e}");
}

/// ∫ f cosθo dωo of what a base adds, which is the same in all azimuths: midpoints in the inclination.
fn base_albedo(model: &dyn Model, (black, with): (&[f64], &[f64]), incoming: &Direction) -> Vec<f64> {
    let (black, with) = (model.bind(black), model.bind(with));
    let count = 3000_u32;
    let step = 0.5 * PI / f64::from(count);
    let mut sum = vec![0.0; model.channel_count()];
    let (mut a, mut b) = (sum.clone(), sum.clone());
    for i in 0..count {
        let theta = (f64::from(i) + 0.5) * step;
        let outgoing = spherical(theta, 0.7);
        black.evaluate(incoming, &outgoing, &mut a);
        with.evaluate(incoming, &outgoing, &mut b);
        for ((sum, black), with) in sum.iter_mut().zip(&a).zip(&b) {
            *sum += (with - black) * 2.0 * PI * theta.sin() * theta.cos() * step;
        }
    }
    sum
}

/// Directional albedo of the whole with the base's albedo at `albedo`.
fn whole_albedo(model: &CoatedBase, alpha: f64, albedo: f64, theta: f64) -> Vec<f64> {
    let black = values(model, &[("roughness", alpha), ("diffuse_albedo", 0.0)]);
    let with = values(model, &[("roughness", alpha), ("diffuse_albedo", albedo)]);
    let lobe = lobe_albedo(model, &black, alpha, theta);
    base_albedo(model, (&black, &with), &spherical(theta, 0.0))
        .iter()
        .zip(lobe)
        .map(|(base, lobe)| base + lobe)
        .collect()
}

fn design(text: &str) -> Design {
    toml::from_str(text).expect("the design is valid")
}

/// So many layers of random indices and thicknesses on a clear substrate.
fn random_design(random: &mut ChaCha8Rng, count: usize, greatest_nm: f64, greatest_extinction: f64) -> Design {
    let layers: Vec<String> = (0..count)
        .map(|number| {
            let index: f64 = random.random_range(1.0..2.4);
            let extinction: f64 = greatest_extinction * random.random::<f64>();
            let thickness_nm: f64 = random.random_range(10.0..greatest_nm);
            let material = format!(r#"{{ name = "m{number}", index = {index}, extinction = {extinction} }}"#);
            format!(r#"{{ name = "l{number}", material = {material}, thickness_nm = {thickness_nm} }}"#)
        })
        .collect();
    let substrate: f64 = random.random_range(1.0..2.0);
    design(&format!("substrate = {{ name = \"base\", index = {substrate} }}\nlayers = [{}]", layers.join(", ")))
}

const WAVELENGTHS_NM: [f64; 3] = [400.0, 550.0, 700.0];
const INCLINATIONS: [f64; 5] = [0.0, 0.5, 1.0, 1.4, 1.55];

/// Largest amount by which a white base over random layers, with this albedo, gives more (first) or less than it receives.
fn worst_of_random(cases: u64, (layers, greatest_nm, extinction): (usize, f64, f64)) -> (f64, f64) {
    let error_at = |case: u64| {
        let mut random = ChaCha8Rng::seed_from_u64(39);
        random.set_stream(case);
        let model = CoatedBase::new(&random_design(&mut random, layers, greatest_nm, extinction), &WAVELENGTHS_NM);
        let alpha = (random.random_range(0.01_f64.ln()..0.0)).exp();
        let theta = INCLINATIONS[random.random_range(0..INCLINATIONS.len())];
        let differences = whole_albedo(&model.unwrap(), alpha, 1.0, theta).into_iter().map(|albedo| albedo - 1.0);
        differences.fold((0.0_f64, 0.0_f64), |(more, less), it| (more.max(it), less.max(-it)))
    };
    let worst = (0..cases).into_par_iter().map(error_at).collect::<Vec<_>>();
    let worst = worst.into_iter().fold((0.0_f64, 0.0_f64), |(a, b), (c, d)| (a.max(c), b.max(d)));
    println!("{layers} layers to {greatest_nm} nm, k to {extinction}: {:.1e} more, {:.1e} less", worst.0, worst.1);
    worst
}

/// A white lossless base gives back all that it receives, whatever clear layers lie on it and however rough they are.
/// Both integrals share nothing but f: the lobe's runs over half vectors, the base's over directions.
#[test]
fn white_furnace_of_clear_layers() {
    for (cases, layers, greatest_nm) in [(12, 0, 100.0), (12, 1, 600.0), (12, 1, 3000.0), (12, 3, 500.0), (8, 8, 400.0)]
    {
        let (more, less) = worst_of_random(cases, (layers, greatest_nm, 0.0));
        assert!(more <= 1e-3 && less <= 1e-3, "{layers} layers: {more:e} more, {less:e} less");
    }
}

#[test]
#[ignore = "long: run by .ci/long"]
fn white_furnace_of_many_clear_layers() {
    for (cases, layers, greatest_nm) in [(300, 1, 5000.0), (300, 5, 500.0), (100, 12, 400.0), (40, 40, 200.0)] {
        let (more, less) = worst_of_random(cases, (layers, greatest_nm, 0.0));
        assert!(more <= 1e-3 && less <= 1e-3, "{layers} layers: {more:e} more, {less:e} less");
    }
}

/// Layers that absorb only take light away.
#[test]
fn furnace_of_absorbing_layers_stays_below_one() {
    for (cases, layers, extinction) in [(12, 1, 0.01), (12, 2, 0.3), (12, 3, 3.0)] {
        let (more, less) = worst_of_random(cases, (layers, 400.0, extinction));
        assert!(more <= 1e-3, "{layers} layers give {more:e} more than they receive");
        assert!(less > 0.01, "the layers take nothing away: {less:e}");
    }
}

/// A share beside the layers takes its light from them, so that even a white one keeps the furnace at 1.
#[test]
fn a_share_beside_the_layers_conserves_energy() {
    let film = "substrate = \"bird_melanin\"\nlayers = [{ name = \"f\", material = \"keratin\", thickness_nm = 330 }]";
    let model = CoatedBase::new(&design(film), &WAVELENGTHS_NM).unwrap();
    let (incoming, outgoing) = (spherical(0.5, 0.0), spherical(0.6, 2.0));
    let black = evaluate(&model, &values(&model, &[]), &incoming, &outgoing);
    for share in [0.3, 1.0] {
        let found = evaluate(&model, &values(&model, &[("diffuse_share", share)]), &incoming, &outgoing);
        for (found, black) in found.iter().zip(&black) {
            let expected = (1.0 - share) * black + share / PI;
            assert!((found - expected).abs() <= 1e-15, "{found} instead of {expected}");
        }
    }
}

/// Without layers, on a smooth surface, the base is seen through Fresnel's interface: 1 − `R_int` of index 1.5 is 1/1.5² of
/// the external transmittance, whose diffuse reflectance is 0.09178 (Walsh 1926, in Duntley 1942: 0.092 and 0.596).
#[test]
fn smooth_surface_over_a_base_in_closed_form() {
    let model = CoatedBase::new(&design(r#"substrate = { name = "base", index = 1.5 }"#), &[550.0]).unwrap();
    let n: f64 = 1.5;
    // Walsh's formula for the external diffuse reflectance of an interface of index n.
    let (n2, n4) = (n * n, n.powi(4));
    let external = 0.5
        + (n - 1.0) * (3.0 * n + 1.0) / (6.0 * (n + 1.0).powi(2))
        + n2 * (n2 - 1.0).powi(2) / (n2 + 1.0).powi(3) * ((n - 1.0) / (n + 1.0)).ln()
        - 2.0 * n.powi(3) * (n2 + 2.0 * n - 1.0) / ((n2 + 1.0) * (n4 - 1.0))
        + 8.0 * n4 * (n4 + 1.0) / ((n2 + 1.0) * (n4 - 1.0).powi(2)) * n.ln();
    assert!((external - 0.09178).abs() < 1e-5, "{external}");
    let (albedo, theta_i, theta_o) = (0.6, 0.4_f64, 1.0_f64);
    let (incoming, outgoing) = (spherical(theta_i, 0.0), spherical(theta_o, 1.5));
    let at = |albedo| {
        let values = values(&model, &[("roughness", 0.01), ("diffuse_albedo", albedo)]);
        evaluate(&model, &values, &incoming, &outgoing)[0]
    };
    let transmittance = |theta: f64| 1.0 - fresnel::dielectric(theta.cos(), n).unpolarised();
    let internal = 1.0 - (1.0 - external) / n2;
    let expected = albedo * transmittance(theta_i) * transmittance(theta_o) / (PI * n2 * (1.0 - albedo * internal));
    let found = at(albedo) - at(0.0);
    // Slopes of 0.01 blur T by 1e-4 of itself.
    assert!((found / expected - 1.0).abs() < 2e-4, "{found} instead of {expected}");
}

/// Layers that absorb, smooth, against the formula with every factor from the reference: t at both directions, both
/// means by midpoints.
#[test]
fn smooth_absorbing_layers_over_a_base() {
    let text = r#"
        substrate = { name = "tissue", index = 1.5 }
        layers = [
            { name = "cortex", material = { name = "clear", index = 1.56 }, thickness_nm = 300 },
            { name = "pigment", material = { name = "dark", index = 1.7, extinction = 0.1 }, thickness_nm = 150 },
        ]"#;
    let (n, wavelength_nm) = (1.5_f64, 500.0);
    let model = CoatedBase::new(&design(text), &[wavelength_nm]).unwrap();
    let layers = [
        Layer { index: Complex64::new(1.56, 0.0), thickness_nm: 300.0 },
        Layer { index: Complex64::new(1.7, 0.1), thickness_nm: 150.0 },
    ];
    let reversed = [layers[1], layers[0]];
    let entering = |cosine: f64| transfer(1.0, &layers, n.into(), cosine, wavelength_nm).transmittance.unpolarised();
    let absorbed = |cosine: f64| {
        let response = transfer(n, &reversed, 1.0.into(), cosine, wavelength_nm);
        1.0 - response.reflectance.unpolarised() - response.transmittance.unpolarised()
    };
    let mean = |f: &dyn Fn(f64) -> f64| {
        let steps = 20_000;
        let at = |i: i32| (f64::from(i) + 0.5) / f64::from(steps);
        (0..steps).map(|i| 2.0 * at(i) * f(at(i))).sum::<f64>() / f64::from(steps)
    };
    let not_back = mean(&entering) / (n * n) + mean(&absorbed);
    let (theta_i, theta_o, albedo) = (0.7_f64, 1.1_f64, 0.8);
    let expected =
        albedo * entering(theta_i.cos()) * entering(theta_o.cos()) / (PI * n * n * (1.0 - albedo * (1.0 - not_back)));
    let (incoming, outgoing) = (spherical(theta_i, 0.0), spherical(theta_o, 2.0));
    let at = |albedo| {
        let values = values(&model, &[("roughness", 0.01), ("diffuse_albedo", albedo)]);
        evaluate(&model, &values, &incoming, &outgoing)[0]
    };
    let found = at(albedo) - at(0.0);
    // Slopes of 0.01 blur T by some 1e-4 of itself, the rule for the mean of A is good to 1e-4.
    assert!((found / expected - 1.0).abs() < 1e-3, "{found} instead of {expected}");
}

/// A kernel from the list of those last used is the one that would be made anew.
#[test]
fn kernels_that_are_kept_change_no_byte() {
    let mut random = ChaCha8Rng::seed_from_u64(40);
    let design = random_design(&mut random, 2, 500.0, 0.1);
    let used = CoatedBase::new(&design, &WAVELENGTHS_NM).unwrap();
    let (incoming, outgoing) = (spherical(0.5, 0.0), spherical(0.9, 2.0));
    for round in 0..40 {
        let alpha = [0.01, 0.1, 0.3][round % 3] * (1.0 + 0.1 * random.random_range(0..20) as f64);
        let changes =
            [("roughness", alpha), ("diffuse_albedo", 0.7), ("l0.thickness_nm", random.random_range(5.0..2000.0))];
        let fresh = CoatedBase::new(&design, &WAVELENGTHS_NM).unwrap();
        let expected = evaluate(&fresh, &values(&fresh, &changes), &incoming, &outgoing);
        assert_eq!(evaluate(&used, &values(&used, &changes), &incoming, &outgoing), expected);
    }
}

/// The substrate says which diffuse light there is, and its parameter's name says it again.
#[test]
fn the_substrate_decides_what_is_diffuse() {
    for (substrate, knots, expected) in [
        (r#""keratin""#, "[]", &["diffuse_albedo"][..]),
        (r#""bird_melanin""#, "[]", &["diffuse_share"]),
        (
            r#"{ name = "ink", index = 1.5, extinction = 0.2 }"#,
            "[500, 600]",
            &["diffuse_share.500", "diffuse_share.600"],
        ),
        (r#"{ name = "wax", index = 1.5 }"#, "[500, 600]", &["diffuse_albedo.500", "diffuse_albedo.600"]),
    ] {
        let design = design(&format!("substrate = {substrate}\nbase_knots_nm = {knots}"));
        let model = CoatedBase::new(&design, &WAVELENGTHS_NM).unwrap();
        let names = model.parameters().iter().map(|parameter| parameter.name.as_str());
        let diffuse: Vec<&str> = names.filter(|name| name.starts_with("diffuse")).collect();
        assert_eq!(diffuse, expected);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    /// f(ωi, ωo) = f(ωo, ωi) to the last bit, finite and not negative, for any clear or absorbing layers over a base, under a
    /// clear coat or none.
    #[test]
    fn reciprocity_is_exact(
        seed in any::<u64>(),
        (layers, extinction) in (0..5_usize, prop_oneof![Just(0.0), 0.0..2.0_f64]),
        (alpha, albedo) in (0.01..=1.0_f64, 0.0..=1.0_f64),
        coat in prop::option::of(1.0..2.0_f64),
        angles in [0.0..1.57_f64, 0.0..6.3, 0.0..1.57, 0.0..6.3],
    ) {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let design = Design { clear_coat: coat, ..random_design(&mut random, layers, 400.0, extinction) };
        let model = CoatedBase::new(&design, &WAVELENGTHS_NM).unwrap();
        let values = values(&model, &[("roughness", alpha), ("diffuse_albedo", albedo)]);
        let (i, o) = (spherical(angles[0], angles[1]), spherical(angles[2], angles[3]));
        let (forth, back) = (evaluate(&model, &values, &i, &o), evaluate(&model, &values, &o, &i));
        for (forth, back) in forth.into_iter().zip(back) {
            prop_assert!(forth.is_finite() && forth >= 0.0, "{forth}");
            prop_assert_eq!(forth.to_bits(), back.to_bits());
        }
    }
}
