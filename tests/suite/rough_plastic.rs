//! Rough dielectric interfaces over a diffuse base: power fractions, their shipped table, rough plastic plain and
//! iridescent.

use barbule::bsdf::{Direction, Model, RoughPlastic, RoughPlasticDesign};
use barbule::optics::{RoughInterface, RoughTransmittance};
use proptest::prelude::*;
use rand::Rng;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::oracle::Oracle;

/// A power fraction and the printed one differ by less than one part in a million; the table has ten digits behind the
/// point, so that values below 1e-4 are known to 1e-10.
fn close(found: f64, expected: f64, what: &str) {
    assert!((found - expected).abs() <= 1e-6 * expected.abs().max(1e-4), "{what}: {found} instead of {expected}");
}

/// Single-scattering power fractions integrated by another program, from both sides.
#[test]
fn power_fractions_agree_with_their_tables() {
    let oracle = Oracle::read("tests/oracles/rough_transmittance.csv");
    assert!(oracle.rows.len() > 500);
    (0..oracle.rows.len()).into_par_iter().for_each(|row| {
        let number = |name| oracle.number(row, name);
        let (eta, alpha, cosine) = (number("eta"), number("alpha"), number("mu"));
        let outside = RoughInterface::new(eta, alpha);
        let inside = RoughInterface::new(1.0 / eta, alpha);
        let what = |name| format!("{name} at η {eta}, α {alpha}, μ {cosine}");
        close(outside.transmittance(cosine), number("exact_T_ext"), &what("T from outside"));
        close(outside.reflectance(cosine), number("exact_R_ext"), &what("R from outside"));
        close(inside.transmittance(cosine), number("exact_T_int"), &what("T from inside"));
        close(inside.reflectance(cosine), number("exact_R_int"), &what("R from inside"));
    });
}

#[test]
fn diffuse_fractions_agree_with_their_tables() {
    let oracle = Oracle::read("tests/oracles/rough_internal.csv");
    (0..oracle.rows.len()).into_par_iter().for_each(|row| {
        let number = |name| oracle.number(row, name);
        let (eta, alpha) = (number("eta"), number("alpha"));
        let inside = RoughInterface::new(1.0 / eta, alpha);
        close(inside.diffuse_reflectance(), number("exact_Rint"), &format!("R_int at η {eta}, α {alpha}"));
        close(inside.diffuse_transmittance(), number("exact_Tint"), &format!("T_int at η {eta}, α {alpha}"));
    });
}

/// Light that goes in comes out by the same way: T_int = T_ext/η² for diffuse light, outside the oracle's grid too.
#[test]
fn diffuse_transmittance_is_reciprocal() {
    for (eta, alpha) in [(1.05, 0.005), (1.05, 1.0), (1.4, 0.03), (2.5, 0.005), (2.5, 0.6), (2.5, 1.0)] {
        let from_outside = RoughInterface::new(eta, alpha).diffuse_transmittance();
        let from_inside = RoughInterface::new(1.0 / eta, alpha).diffuse_transmittance();
        let difference = from_inside * eta * eta / from_outside - 1.0;
        // Two quadratures with nothing in common; each is good to 1e-7.
        assert!(difference.abs() < 1e-6, "η {eta}, α {alpha}: relative difference {difference:e}");
    }
}

/// Largest absolute error of the table against direct quadrature, at random points of its whole domain.
fn worst_table_error(count: u64) -> f64 {
    let error_at = |point: u64| {
        let mut random = ChaCha8Rng::seed_from_u64(35);
        random.set_stream(point);
        let n = random.random_range(RoughTransmittance::INDICES);
        let eta = if random.random() { n } else { 1.0 / n };
        // Evenly in the roughness, and evenly in its logarithm, where the small ones are seen.
        let (least, most) = (*RoughTransmittance::ROUGHNESSES.start(), *RoughTransmittance::ROUGHNESSES.end());
        let alpha: f64 = if random.random() {
            random.random_range(least..=most)
        } else {
            random.random_range(least.ln()..=most.ln()).exp().clamp(least, most)
        };
        // Evenly over all cosines, or within some roughnesses of the horizon or the critical angle.
        let critical = (1.0 - eta * eta).max(0.0).sqrt();
        let cosine: f64 = match random.random_range(0..3) {
            0 => random.random(),
            1 => 4.0 * alpha * random.random::<f64>(),
            _ => critical + 8.0 * alpha * (random.random::<f64>() - 0.5),
        };
        let cosine = cosine.clamp(1e-9, 1.0);
        let found = RoughTransmittance::curve(eta, alpha).at(cosine);
        let expected = RoughInterface::new(eta, alpha).transmittance(cosine);
        ((found - expected).abs(), format!("η {eta}, α {alpha}, μ {cosine}: {found} instead of {expected}"))
    };
    let errors: Vec<_> = (0..count).into_par_iter().map(error_at).collect();
    let (worst, place) = errors.into_iter().max_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
    println!("worst of {count}: {worst:.2e} at {place}");
    worst
}

#[test]
fn tabulated_transmittance_is_right() {
    assert!(worst_table_error(3000) <= 1e-3);
}

#[test]
#[ignore = "long: run by .ci/long"]
fn tabulated_transmittance_is_right_everywhere() {
    assert!(worst_table_error(100_000) <= 1e-3);
}

/// The same for the means over diffuse light, whose quadrature takes longer.
fn worst_diffuse_error(count: u64) -> f64 {
    let error_at = |point: u64| {
        let mut random = ChaCha8Rng::seed_from_u64(36);
        random.set_stream(point);
        let n = random.random_range(RoughTransmittance::INDICES);
        let eta = if random.random() { n } else { 1.0 / n };
        let (least, most) = (*RoughTransmittance::ROUGHNESSES.start(), *RoughTransmittance::ROUGHNESSES.end());
        let alpha = random.random_range(least.ln()..=most.ln()).exp().clamp(least, most);
        let interface = RoughInterface::new(eta, alpha);
        let reflected = RoughTransmittance::diffuse_reflectance(eta, alpha) - interface.diffuse_reflectance();
        let transmitted = RoughTransmittance::diffuse_transmittance(eta, alpha) - interface.diffuse_transmittance();
        reflected.abs().max(transmitted.abs())
    };
    let worst = (0..count).into_par_iter().map(error_at).collect::<Vec<_>>().into_iter().fold(0.0, f64::max);
    println!("worst of {count}: {worst:.2e}");
    worst
}

#[test]
fn tabulated_diffuse_fractions_are_right() {
    assert!(worst_diffuse_error(60) <= 1e-3);
}

#[test]
#[ignore = "long: run by .ci/long"]
fn tabulated_diffuse_fractions_are_right_everywhere() {
    assert!(worst_diffuse_error(3000) <= 1e-3);
}

const RGB_NM: [f64; 3] = [645.0, 525.0, 445.0];

/// Values of a model's parameters by name; the others at their defaults.
fn values(model: &dyn Model, changes: &[(&str, f64)]) -> Vec<f64> {
    let mut values: Vec<f64> = model.parameters().iter().map(|parameter| parameter.default).collect();
    for (name, value) in changes {
        let position = model.parameters().iter().position(|parameter| parameter.name == *name);
        values[position.unwrap_or_else(|| panic!("no parameter {name}"))] = *value;
    }
    model.check(&values).unwrap();
    values
}

fn evaluate(model: &dyn Model, values: &[f64], incoming: &Direction, outgoing: &Direction) -> Vec<f64> {
    let mut found = vec![f64::NAN; model.channel_count()];
    model.bind(values).evaluate(incoming, outgoing, &mut found);
    found
}

fn direction(oracle: &Oracle, row: usize, name: &str) -> Direction {
    let [x, y, z] = ["x", "y", "z"].map(|axis| oracle.number(row, &format!("{name}_{axis}")));
    Direction::new(x, y, z)
}

/// Every third row of the printed values, whose eval includes the viewer's cosine.
#[test]
fn rough_plastic_agrees_with_its_table() {
    let oracle = Oracle::read("tests/oracles/roughplastic.csv");
    let model = RoughPlastic::new(&RoughPlasticDesign::default(), &[550.0]).unwrap();
    let peak_of = |alpha, eta| {
        (0..oracle.rows.len())
            .filter(|&row| oracle.text(row, "alpha") == alpha && oracle.text(row, "eta") == eta)
            .map(|row| oracle.number(row, "exact_spec"))
            .fold(0.0, f64::max)
    };
    let (mut worst_gloss, mut worst_diffuse): (f64, f64) = (0.0, 0.0);
    for row in 0..oracle.rows.len() {
        let number = |name| oracle.number(row, name);
        let (incoming, outgoing) = (direction(&oracle, row, "wi"), direction(&oracle, row, "wo"));
        let of_weights = |specular, diffuse| {
            let changes =
                [("roughness", number("alpha")), ("eta", number("eta")), ("specular", specular), ("diffuse", diffuse)];
            evaluate(&model, &values(&model, &changes), &incoming, &outgoing)[0] * outgoing.z
        };
        let gloss = of_weights(1.0, 0.0);
        // The directions are printed with twelve digits, which is 1e-9 of a steep lobe's value.
        if number("exact_spec") > 1e-6 * peak_of(oracle.text(row, "alpha"), oracle.text(row, "eta")) {
            worst_gloss = worst_gloss.max((gloss / number("exact_spec") - 1.0).abs());
        }
        if number("diffuse") > 0.0 {
            let diffuse = of_weights(0.0, number("diffuse"));
            worst_diffuse = worst_diffuse.max((diffuse / number("exact_diff") - 1.0).abs());
        }
    }
    println!("gloss {worst_gloss:.2e}, diffuse {worst_diffuse:.2e}");
    assert!(worst_gloss <= 1e-6, "worst relative error of the gloss {worst_gloss:e}");
    assert!(worst_diffuse <= 5e-3, "worst relative error of the diffuse part {worst_diffuse:e}");
}

fn any_direction_above() -> impl Strategy<Value = Direction> {
    (0.0..1.0f64, 0.0..std::f64::consts::TAU).prop_map(|(cosine, azimuth)| {
        let sine = (1.0 - cosine * cosine).sqrt();
        Direction::new(sine * azimuth.cos(), sine * azimuth.sin(), cosine)
    })
}

proptest! {
    #[test]
    fn rough_plastic_is_reciprocal(
        roughness in RoughTransmittance::ROUGHNESSES,
        eta in RoughTransmittance::INDICES,
        (i, o) in (any_direction_above(), any_direction_above()),
    ) {
        let model = RoughPlastic::new(&RoughPlasticDesign::default(), &RGB_NM).unwrap();
        let values = values(&model, &[("roughness", roughness), ("eta", eta)]);
        prop_assert_eq!(evaluate(&model, &values, &i, &o), evaluate(&model, &values, &o, &i));
    }

    /// The fast path against the readable one: a cubic between curve nodes costs 1e-5 of the value at most.
    #[test]
    fn many_pairs_are_as_good_as_one(
        roughness in RoughTransmittance::ROUGHNESSES,
        eta in RoughTransmittance::INDICES,
        pairs in prop::collection::vec((any_direction_above(), any_direction_above(), any::<bool>()), 1..150),
    ) {
        let design = RoughPlasticDesign { per_channel: vec!["diffuse".to_owned()], ..Default::default() };
        let model = RoughPlastic::new(&design, &RGB_NM).unwrap();
        let values = values(&model, &[("roughness", roughness), ("eta", eta), ("diffuse_r", 0.9), ("diffuse_b", 0.1)]);
        let incoming: Vec<Direction> = pairs.iter().map(|(i, _, below)| if *below { -i } else { *i }).collect();
        // Near the mirror direction, so that the gloss is not always nothing.
        let outgoing: Vec<Direction> = pairs
            .iter()
            .map(|(i, o, _)| (Direction::new(-i.x, -i.y, i.z) + o * roughness).normalize())
            .collect();
        let mut found = vec![f64::NAN; 3 * pairs.len()];
        model.bind(&values).evaluate_many(&incoming, &outgoing, &mut found);
        for ((i, o), found) in incoming.iter().zip(&outgoing).zip(found.chunks_exact(3)) {
            for (found, expected) in found.iter().zip(evaluate(&model, &values, i, o)) {
                prop_assert!((found - expected).abs() <= 1e-5 * expected, "{i:?} {o:?}: {found} instead of {expected}");
            }
        }
    }
}
