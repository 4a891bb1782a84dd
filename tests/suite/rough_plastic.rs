//! Rough dielectric interfaces over a diffuse base: power fractions, their shipped table, rough plastic plain and
//! iridescent.

use barbule::bsdf::{
    Direction, Interference, InternalReflection, IridescentPlastic, IridescentPlasticDesign, Model, RoughPlastic,
    RoughPlasticDesign,
};
use barbule::optics::{RoughInterface, RoughTransmittance};
use proptest::prelude::*;
use rand::Rng;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::directions::{
    RGB_NM, any_direction, any_direction_above, directional_albedo, evaluate, largest_albedo, spherical, values,
};
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

/// Light that goes in comes out by the same way: `T_int = T_ext/η²` for diffuse light, outside the oracle's grid too.
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
    let (worst, place) = errors.into_iter().max_by(|a, b| a.0.total_cmp(&b.0)).expect("there are points");
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

/// The same for the means over diffuse light, whose quadrature takes longer; the table's own test has 10⁵ points.
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
        let bound = model.bind(&values);
        bound.evaluate_many(&incoming, &outgoing, &mut found);
        for ((i, o), found) in incoming.iter().zip(&outgoing).zip(found.chunks_exact(3)) {
            for (found, expected) in found.iter().zip(evaluate(&model, &values, i, o)) {
                prop_assert!((found - expected).abs() <= 1e-5 * expected, "{i:?} {o:?}: {found} instead of {expected}");
            }
        }
        let mut densities = vec![f64::NAN; pairs.len()];
        bound.density_many(&incoming, &outgoing, &mut densities);
        for ((i, o), found) in incoming.iter().zip(&outgoing).zip(densities) {
            let expected = bound.density(i, o);
            prop_assert!((found - expected).abs() <= 1e-5 * expected, "{i:?} {o:?}: density {found}, not {expected}");
        }
    }
}

/// White base under a white light: what comes back is `R + T T_int/(1 − R_int)`, by quadrature that shares nothing with
/// the scattering function but the definitions, and never more than arrives.
#[test]
fn rough_plastic_never_creates_light() {
    let docs = include_str!("../../src/bsdf/rough_plastic.rs");
    let model = RoughPlastic::new(&RoughPlasticDesign::default(), &[550.0]).unwrap();
    for alpha in [0.1, 0.3, 0.5] {
        let (outside, inside) = (RoughInterface::new(1.5, alpha), RoughInterface::new(1.0 / 1.5, alpha));
        let returned = inside.diffuse_transmittance() / (1.0 - inside.diffuse_reflectance());
        let values = values(&model, &[("roughness", alpha), ("eta", 1.5), ("diffuse", 1.0)]);
        let bound = model.bind(&values);
        let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
        for degrees in 0..90 {
            let incoming = spherical(f64::from(degrees).to_radians(), 0.0);
            let expected = outside.reflectance(incoming.z) + outside.transmittance(incoming.z) * returned;
            (least, most) = (least.min(expected), most.max(expected));
            if degrees % 15 == 0 {
                let found = directional_albedo(bound.as_ref(), &incoming, true, (400, 100));
                // The table of T is good to 5e-4.
                assert!((found - expected).abs() < 1e-3, "α {alpha}, {degrees}°: {found} instead of {expected}");
            }
        }
        assert!(most <= 1.0);
        let row = format!("//! | {alpha} | {least:.3} | {most:.3} |");
        println!("{row}");
        assert!(docs.contains(&row), "the model's docs lack the row {row}");
    }
}

fn iridescent(interference: Interference, wavelengths_nm: &[f64]) -> IridescentPlastic {
    let design = IridescentPlasticDesign { interference, ..Default::default() };
    IridescentPlastic::new(&design, wavelengths_nm).expect("the design is valid")
}

/// Energy is not conserved, and the docs say by how much.
#[test]
fn iridescent_plastic_states_its_largest_albedo() {
    let docs = include_str!("../../src/bsdf/iridescent_plastic.rs");
    for alpha in [0.1, 0.3, 0.5] {
        let [constructive, destructive] = [Interference::Constructive, Interference::Destructive].map(|interference| {
            let model = iridescent(interference, &[550.0]);
            let changes = [("roughness", alpha), ("eta", 1.5), ("diffuse", 1.0)];
            largest_albedo(&model, &values(&model, &changes))
        });
        let row = format!("//! | {alpha} | {constructive:.2} | {destructive:.2} |");
        println!("{row}");
        assert!(docs.contains(&row), "the model's docs lack the row {row}");
    }
}

proptest! {
    /// With the phase term off and one index it is rough plastic, to rounding.
    #[test]
    fn iridescent_plastic_without_interference_is_rough_plastic(
        roughness in RoughTransmittance::ROUGHNESSES,
        eta in RoughTransmittance::INDICES,
        (specular, diffuse) in (0.0..=1.0, 0.0..=1.0),
        thickness_nm in 0.0..=5000.0,
        choice in 0..3_usize,
        (i, o) in (any_direction(), any_direction()),
    ) {
        let internal_reflection =
            [InternalReflection::Linear, InternalReflection::Nonlinear, InternalReflection::Thesis][choice];
        let plain = RoughPlasticDesign { internal_reflection, ..Default::default() };
        let plain = RoughPlastic::new(&plain, &RGB_NM).unwrap();
        let coloured =
            IridescentPlasticDesign { internal_reflection, interference: Interference::Off, ..Default::default() };
        let coloured = IridescentPlastic::new(&coloured, &RGB_NM).unwrap();
        let changes = [("roughness", roughness), ("eta", eta), ("specular", specular), ("diffuse", diffuse)];
        let expected = evaluate(&plain, &values(&plain, &changes), &i, &o);
        let changes = [&changes[..], &[("thickness_nm", thickness_nm)]].concat();
        for (found, expected) in evaluate(&coloured, &values(&coloured, &changes), &i, &o).iter().zip(&expected) {
            prop_assert!((found - expected).abs() <= 1e-14 * expected, "{found} instead of {expected}");
        }
    }

    /// Each channel is a model of its own, `f_r` and `f_t` of which are two rough plastics; their interference is
    /// written out here.
    #[test]
    fn iridescent_plastic_interferes_channel_by_channel(
        roughness in 0.05..=1.0,
        (eta_r, eta_g, eta_b) in (1.3..=1.8, 1.3..=1.8, 1.3..=1.8),
        thickness_nm in 0.0..=1000.0,
        (i, o) in (any_direction_above(), any_direction_above()),
    ) {
        let design = IridescentPlasticDesign { per_channel: vec!["eta".to_owned()], ..Default::default() };
        let model = IridescentPlastic::new(&design, &RGB_NM).unwrap();
        let of_channels = [("eta_r", eta_r), ("eta_g", eta_g), ("eta_b", eta_b)];
        let film = [("roughness", roughness), ("thickness_nm", thickness_nm)];
        let found = evaluate(&model, &values(&model, &[&film[..], &of_channels].concat()), &i, &o);
        let plain = RoughPlastic::new(&RoughPlasticDesign::default(), &[550.0]).unwrap();
        for ((found, (_, eta)), wavelength_nm) in found.iter().zip(of_channels).zip(RGB_NM) {
            let term = |specular, diffuse| {
                let changes = [("roughness", roughness), ("eta", eta), ("specular", specular), ("diffuse", diffuse)];
                evaluate(&plain, &values(&plain, &changes), &i, &o)[0]
            };
            let (reflected, transmitted) = (term(1.0, 0.0), term(0.0, 0.5));
            let inside = |cosine: f64| ((1.0 - cosine * cosine).sqrt() / eta).asin().cos();
            let phase = std::f64::consts::PI * eta * thickness_nm / wavelength_nm * (inside(i.z) + inside(o.z));
            let expected = reflected + transmitted + 2.0 * (2.0 * phase).cos() * (reflected * transmitted).sqrt();
            prop_assert!((found - expected).abs() <= 1e-11 * (reflected + transmitted), "{found} instead of {expected}");
        }
    }

    #[test]
    fn iridescent_plastic_is_reciprocal(
        roughness in RoughTransmittance::ROUGHNESSES,
        thickness_nm in 0.0..=5000.0,
        (i, o) in (any_direction_above(), any_direction_above()),
    ) {
        let model = iridescent(Interference::Film, &RGB_NM);
        let values = values(&model, &[("roughness", roughness), ("thickness_nm", thickness_nm)]);
        prop_assert_eq!(evaluate(&model, &values, &i, &o), evaluate(&model, &values, &o, &i));
    }
}

/// The three ways to sum the bounces, at one point of the oracle's grid: `f_t` goes as `1/(1 − R_int)`,
/// `1/(1 − w_d R_int)` and `1/T_int`.
#[test]
fn bounces_are_summed_as_asked() {
    let (r_int, t_int) = (0.5375340626, 0.408167204); // η 1.5, α 0.3 in rough_internal.csv
    let (i, o) = (spherical(0.4, 0.0), spherical(0.7, 2.0));
    let diffuse_part = |internal_reflection| {
        let design = RoughPlasticDesign { internal_reflection, ..Default::default() };
        let model = RoughPlastic::new(&design, &[550.0]).unwrap();
        let changes = [("roughness", 0.3), ("eta", 1.5), ("specular", 0.0), ("diffuse", 0.4)];
        evaluate(&model, &values(&model, &changes), &i, &o)[0]
    };
    let linear = diffuse_part(InternalReflection::Linear);
    for (option, expected) in [
        (InternalReflection::Nonlinear, (1.0 - r_int) / (1.0 - 0.4 * r_int)),
        (InternalReflection::Thesis, (1.0 - r_int) / t_int),
    ] {
        let found = diffuse_part(option) / linear;
        // Both means come from the table, good to 1e-4.
        assert!((found - expected).abs() < 3e-4, "{option:?}: {found} instead of {expected}");
    }
}

#[test]
fn bad_values_get_a_sentence() {
    let model = RoughPlastic::new(&RoughPlasticDesign::default(), &RGB_NM).unwrap();
    let check = |values: &[f64]| model.check(values).unwrap_err().to_string();
    assert_eq!(
        check(&[-0.1, 1.5, 1.0, 0.5]),
        "`roughness` is -0.1; expected a number from 0.005 to 1: roughness of the coat, √2 times the standard deviation of \
         its slopes (Beckmann)"
    );
    assert!(check(&[0.1, 0.9, 1.0, 0.5]).starts_with("`eta` is 0.9; expected a number from 1.05 to 2.5"));
    assert!(check(&[0.1, 1.5, 1.0, f64::NAN]).starts_with("`diffuse` is NaN; expected a number from 0 to 1"));
    assert!(check(&[0.1]).contains("4 parameters, found 1 values"));
    let misnamed = RoughPlasticDesign { per_channel: vec!["roughness".to_owned()], ..Default::default() };
    assert_eq!(
        RoughPlastic::new(&misnamed, &RGB_NM).unwrap_err().to_string(),
        "`per_channel` names \"roughness\"; expected some of: specular, diffuse"
    );
    assert!(RoughPlastic::new(&RoughPlasticDesign::default(), &[]).is_err());
    assert!(RoughPlastic::new(&RoughPlasticDesign::default(), &[f64::NAN]).is_err());
    let typed: Result<RoughPlasticDesign, _> = toml::from_str("internal_reflection = \"some\"");
    assert!(typed.unwrap_err().to_string().contains("expected one of `linear`, `nonlinear`, `thesis`"));
}

/// The shipped table is what the quadrature gives today; other processors may differ in the last bits of a logarithm.
#[test]
#[ignore = "long: run by .ci/long"]
fn shipped_table_is_current() {
    let shipped = include_bytes!("../../src/optics/rough_transmittance.f32");
    let computed = RoughTransmittance::tabulate();
    assert_eq!(shipped.len(), computed.len());
    for (shipped, computed) in shipped.as_chunks().0.iter().zip(computed.as_chunks().0) {
        let (shipped, computed) = (f32::from_le_bytes(*shipped), f32::from_le_bytes(*computed));
        assert!((shipped - computed).abs() <= 1e-6, "{shipped} in the table, {computed} now");
    }
}
