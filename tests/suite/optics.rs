//! Interfaces, films, stacks and microfacets against tables from other programs, closed forms and conservation laws.

use std::f64::consts::PI;

use barbule::optics::microfacet::Beckmann;
use barbule::optics::stack::{Layer, transfer};
use barbule::optics::{Arrangement, LayeredMedium, Permittivity, double_wavenumbers, film, fresnel};
use num_complex::Complex64;
use proptest::prelude::*;

use super::oracle::Oracle;

fn real(index: f64) -> Complex64 {
    Complex64::new(index, 0.0)
}

fn layer(index: Complex64, thickness_nm: f64) -> Layer {
    Layer { index, thickness_nm }
}

/// The unpolarised reflectance by the fast path, for constant indices and one wavelength.
fn fast(front: f64, layers: &[Layer], substrate: Complex64, cos_theta: f64, wavelength_nm: f64) -> f64 {
    let indices: Vec<Complex64> = layers.iter().map(|layer| layer.index).chain([substrate]).collect();
    let count = layers.len();
    let arrangement = Arrangement::new(count + 1, (0..count).collect(), (0..count).collect(), count);
    let channels = double_wavenumbers(&[wavelength_nm]);
    let permittivities =
        indices.iter().map(|index| Permittivity::new(std::iter::once(index.re), std::iter::once(index.im))).collect();
    let thicknesses = layers.iter().map(|layer| layer.thickness_nm).collect();
    let mut reflectance = [0.0];
    LayeredMedium::new(&arrangement, &channels, permittivities, thicknesses).reflectance(
        front,
        cos_theta,
        &mut reflectance,
    );
    reflectance[0]
}

/// Every fifth row of values of the Python package tmm (`coh_tmm`, `unpolarized_RT`), which have 12 digits.
///
/// Against all 5670 rows the worst errors are 7e-13 in amplitude and 5e-13 in power: the rounding of the table.
#[test]
fn films_and_stacks_agree_with_tmm() {
    let oracle = Oracle::read("tests/oracles/film.csv");
    assert!(oracle.rows.len() > 1000);
    let (mut worst_amplitude, mut worst_power, mut worst_fast): (f64, f64, f64) = (0.0, 0.0, 0.0);
    for row in 0..oracle.rows.len() {
        let number = |name| oracle.number(row, name);
        let film_index = real(number("n_film"));
        let substrate = Complex64::new(number("n_sub"), number("k_sub"));
        let d = number("d_nm");
        let cos_theta = number("angle_deg").to_radians().cos();
        let wavelength = number("lambda_nm");
        let front = number("n_front");
        let outer = layer(film_index, d);
        let (layers, last) = match oracle.text(row, "config") {
            "film_air" => (vec![outer], real(1.0)),
            "film_melanin" => (vec![outer], substrate),
            "stack5" => {
                let melanin = layer(substrate, 100.0);
                (vec![outer, melanin, layer(real(1.0), 120.0), melanin, outer], real(1.0))
            }
            other => panic!("unknown configuration {other}"),
        };
        let mut responses = vec![transfer(front, &layers, last, cos_theta, wavelength)];
        if let [single] = layers[..] {
            responses.push(film::airy(front, single, last, cos_theta, wavelength));
        }
        for response in responses {
            let rs = Complex64::new(number("rs_re"), number("rs_im"));
            let rp = Complex64::new(number("rp_re"), number("rp_im"));
            worst_amplitude = worst_amplitude.max((response.s.r - rs).norm()).max((response.p.r - rp).norm());
            for (found, expected) in [
                (response.reflectance.s, number("Rs")),
                (response.reflectance.p, number("Rp")),
                (response.reflectance.unpolarised(), number("R")),
                (response.transmittance.s, number("Ts")),
                (response.transmittance.p, number("Tp")),
            ] {
                worst_power = worst_power.max((found - expected).abs());
            }
        }
        worst_fast = worst_fast.max((fast(front, &layers, last, cos_theta, wavelength) - number("R")).abs());
    }
    // The table is rounded to 12 digits, 5e-13; a tenth of a billionth is what was asked for.
    assert!(worst_amplitude <= 1e-10, "worst amplitude error {worst_amplitude:e}");
    assert!(worst_power <= 1e-10, "worst power error {worst_power:e}");
    assert!(worst_fast <= 1e-10, "worst error of the fast path {worst_fast:e}");
}

/// `eta` below over above; a negative cosine comes from below. The table has 14 digits.
#[test]
fn fresnel_agrees_with_its_table() {
    let oracle = Oracle::read("tests/oracles/fresnel.csv");
    for row in 0..oracle.rows.len() {
        let (eta, cosine, expected) =
            (oracle.number(row, "eta"), oracle.number(row, "cos_theta_i"), oracle.number(row, "F"));
        let found = fresnel::dielectric(cosine, eta).unpolarised();
        assert!((found - expected).abs() <= 1e-13, "eta {eta}, cos {cosine}: {found} instead of {expected}");
        if cosine > 0.0 {
            let absorbing = fresnel::absorbing(cosine, real(eta)).unpolarised();
            assert!((absorbing - expected).abs() <= 1e-13, "as a complex index: {absorbing} instead of {expected}");
        }
    }
}

/// Brewster's angle, normal incidence and grazing incidence in closed form, total reflection exactly 1.
#[test]
fn fresnel_closed_forms() {
    let eta: f64 = 1.56;
    let brewster = 1.0 / (1.0 + eta * eta).sqrt();
    assert!(fresnel::dielectric(brewster, eta).p < 1e-30);
    let normal = ((1.0 - eta) / (1.0 + eta)).powi(2);
    assert!((fresnel::dielectric(1.0, eta).unpolarised() - normal).abs() < 1e-16);
    assert!((fresnel::dielectric(0.0, eta).unpolarised() - 1.0).abs() < 1e-16);
    assert_eq!(fresnel::dielectric(-0.5, eta).s.to_bits(), 1.0_f64.to_bits());
    // Normal incidence on an absorber: ((n − 1)² + k²)/((n + 1)² + k²).
    let (n, k) = (1.74, 0.09);
    let absorber = ((n - 1.0_f64).powi(2) + k * k) / ((n + 1.0_f64).powi(2) + k * k);
    assert!((fresnel::absorbing(1.0, Complex64::new(n, k)).unpolarised() - absorber).abs() < 1e-15);
}

/// A quarter-wave layer at normal incidence: R = ((n₀n₂ − n₁²)/(n₀n₂ + n₁²))²; a half-wave layer is as if it were not
/// there; N pairs of quarter waves: the substrate seems to have the index (n₁/n₂)²ᴺ n₃.
#[test]
fn quarter_wave_layers_in_closed_form() {
    let wavelength = 520.0;
    for (front, n1, n2) in [(1.0, 1.38, 1.9044), (1.0, 1.55, 1.75), (1.0, 1.75, 1.55), (1.5, 1.2, 2.0), (1.3, 2.2, 1.0)]
    {
        let expected = f64::powi((front * n2 - n1 * n1) / (front * n2 + n1 * n1), 2);
        for found in [
            transfer(front, &[layer(real(n1), wavelength / (4.0 * n1))], real(n2), 1.0, wavelength)
                .reflectance
                .unpolarised(),
            fast(front, &[layer(real(n1), wavelength / (4.0 * n1))], real(n2), 1.0, wavelength),
        ] {
            assert!((found - expected).abs() < 1e-14, "{front}/{n1}/{n2}: {found} instead of {expected}");
        }
        let bare = fresnel::dielectric(1.0, n2 / front).unpolarised();
        let half = fast(front, &[layer(real(n1), wavelength / (2.0 * n1))], real(n2), 1.0, wavelength);
        assert!((half - bare).abs() < 1e-14, "half wave: {half} instead of {bare}");
    }
    let (high, low, substrate, pairs) = (2.3_f64, 1.38_f64, 1.52, 6);
    let quarter = |n: f64| layer(real(n), wavelength / (4.0 * n));
    let layers: Vec<Layer> = (0..pairs).flat_map(|_| [quarter(high), quarter(low)]).collect();
    let admittance = (high / low).powi(2 * pairs) * substrate;
    let expected = ((1.0 - admittance) / (1.0 + admittance)).powi(2);
    let found = fast(1.0, &layers, real(substrate), 1.0, wavelength);
    assert!((found - expected).abs() < 1e-13, "mirror: {found} instead of {expected}");
}

/// Where a 300 nm film reflects most between 400 and 750 nm, for each order of the indices. With two jumps of phase or
/// none the maxima lie at 2nd/m, with one at 2nd/(m − ½). A film formula in use for feathers counts the jump at a
/// rising index twice and puts the maximum of air/1.55/1.75 at 620 nm instead of 465.
#[test]
fn maxima_lie_where_the_order_of_indices_puts_them() {
    let d = 300.0;
    for (front, n1, n2) in [
        (1.0, 1.55, 1.75),
        (1.75, 1.55, 1.0),
        (1.0, 1.55, 1.0),
        (1.33, 1.75, 1.55),
        (1.75, 1.4, 1.55),
        (1.55, 1.3, 1.8),
    ] {
        let jumps = u32::from(n1 > front) + u32::from(n2 > n1);
        let shift = if jumps == 1 { 0.5 } else { 0.0 };
        let expected: Vec<f64> = (1..8)
            .map(|order| 2.0 * n1 * d / (f64::from(order) - shift))
            .filter(|wavelength| (401.0..749.0).contains(wavelength))
            .collect();
        let reflectance = |i: u32| fast(front, &[layer(real(n1), d)], real(n2), 1.0, 400.0 + 0.5 * f64::from(i));
        let found: Vec<f64> = (1..700)
            .filter(|&i| reflectance(i) > reflectance(i - 1) && reflectance(i) > reflectance(i + 1))
            .map(|i| 400.0 + 0.5 * f64::from(i))
            .collect();
        assert!(!expected.is_empty(), "the case {front}/{n1}/{n2} tests nothing");
        assert_eq!(found.len(), expected.len(), "{front}/{n1}/{n2}: maxima {found:?} instead of {expected:?}");
        for wavelength in expected {
            assert!(
                found.iter().any(|maximum| (maximum - wavelength).abs() <= 0.5),
                "{front}/{n1}/{n2}: maxima {found:?} without {wavelength}"
            );
        }
    }
}

/// A metre of absorber neither overflows nor lets light through, and looks like its own half-space.
#[test]
fn a_thick_absorber_is_a_half_space() {
    let melanin = Complex64::new(1.7, 0.3);
    let thick = transfer(1.0, &[layer(melanin, 1e9)], real(1.5), 0.7, 500.0);
    let bare = fresnel::absorbing(0.7, melanin);
    assert!((thick.reflectance.s - bare.s).abs() < 1e-15);
    assert!((thick.reflectance.p - bare.p).abs() < 1e-15);
    assert!(thick.transmittance.unpolarised() < 1e-300);
    let fast = fast(1.0, &[layer(melanin, 5e4)], real(1.5), 0.7, 500.0);
    assert!((fast - bare.unpolarised()).abs() < 1e-14);
}

/// Reflectance by the product of characteristic matrices (Born and Wolf 1999, section 1.6.2), which shares nothing
/// with the recursion.
fn by_matrices(front: f64, layers: &[Layer], substrate: Complex64, cos_theta: f64, wavelength: f64) -> f64 {
    let transverse = front * front * (1.0 - cos_theta * cos_theta);
    let i = Complex64::i();
    let power = |parallel: bool| {
        let admittance = |index: Complex64| {
            let q = (index * index - transverse).sqrt();
            if parallel { index * index / q } else { q }
        };
        let mut matrix = [[real(1.0), real(0.0)], [real(0.0), real(1.0)]];
        for layer in layers {
            let q = (layer.index * layer.index - transverse).sqrt();
            let delta = q * (2.0 * PI * layer.thickness_nm / wavelength);
            let y = admittance(layer.index);
            let (sine, cosine) = (delta.sin(), delta.cos());
            let next = [[cosine, -i * sine / y], [-i * y * sine, cosine]];
            let product =
                |row: usize, column: usize| matrix[row][0] * next[0][column] + matrix[row][1] * next[1][column];
            matrix = [[product(0, 0), product(0, 1)], [product(1, 0), product(1, 1)]];
        }
        let last = admittance(substrate);
        let e = matrix[0][0] + matrix[0][1] * last;
        let h = matrix[1][0] + matrix[1][1] * last;
        let first = admittance(real(front));
        ((first * e - h) / (first * e + h)).norm_sqr()
    };
    0.5 * (power(false) + power(true))
}

fn any_index() -> impl Strategy<Value = Complex64> {
    (1.0..2.5_f64, prop_oneof![Just(0.0), 0.0..0.5_f64]).prop_map(|(n, k)| Complex64::new(n, k))
}

fn any_layers(greatest: usize) -> impl Strategy<Value = Vec<Layer>> {
    prop::collection::vec((any_index(), 0.0..800.0_f64).prop_map(|(index, d)| layer(index, d)), 0..=greatest)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 512, failure_persistence: None, ..ProptestConfig::default() })]

    /// The recursion equals the product of characteristic matrices wherever that does not overflow.
    #[test]
    fn recursion_equals_matrices(
        front in 1.0..1.6_f64, layers in any_layers(6), substrate in any_index(), cosine in 0.02..1.0_f64,
        wavelength in 300.0..800.0_f64,
    ) {
        let expected = by_matrices(front, &layers, substrate, cosine, wavelength);
        let found = transfer(front, &layers, substrate, cosine, wavelength).reflectance.unpolarised();
        // The matrices' elements grow like e^{Im δ}, up to e^30 here, and lose as many digits near cancellation.
        prop_assert!((found - expected).abs() < 1e-9, "{found} instead of {expected}");
    }

    /// What is not reflected passes, where nothing absorbs.
    #[test]
    fn energy_is_conserved(
        front in 1.0..1.6_f64, indices in prop::collection::vec((1.0..2.5_f64, 0.0..800.0_f64), 0..6),
        substrate in 1.0..2.5_f64, cosine in 0.01..1.0_f64, wavelength in 300.0..800.0_f64,
    ) {
        let layers: Vec<Layer> = indices.iter().map(|&(n, d)| layer(real(n), d)).collect();
        let response = transfer(front, &layers, real(substrate), cosine, wavelength);
        // Rounding grows with the depth of a tunnelled layer's exponential; 1e-11 is a hundred times the worst seen.
        prop_assert!((response.reflectance.s + response.transmittance.s - 1.0).abs() < 1e-11);
        prop_assert!((response.reflectance.p + response.transmittance.p - 1.0).abs() < 1e-11);
    }

    /// The transmitted power is equal both ways, with absorption too; the reflected power is not, save without it.
    #[test]
    fn transmission_is_equal_both_ways(
        front in 1.0..2.0_f64, layers in any_layers(5), back in 1.0..2.0_f64, share in 0.0..0.998_f64,
        wavelength in 300.0..800.0_f64,
    ) {
        // n sinθ, the same on both sides.
        let transverse = share * front.min(back);
        let cosine = |index: f64| (1.0 - (transverse / index).powi(2)).sqrt();
        let forth = transfer(front, &layers, real(back), cosine(front), wavelength);
        let reversed: Vec<Layer> = layers.iter().rev().copied().collect();
        let backwards = transfer(back, &reversed, real(front), cosine(back), wavelength);
        prop_assert!((forth.transmittance.s - backwards.transmittance.s).abs() < 1e-11);
        prop_assert!((forth.transmittance.p - backwards.transmittance.p).abs() < 1e-11);
        if layers.iter().all(|layer| layer.index.im == 0.0) {
            prop_assert!((forth.reflectance.s - backwards.reflectance.s).abs() < 1e-11);
            prop_assert!((forth.reflectance.p - backwards.reflectance.p).abs() < 1e-11);
        }
    }

    /// The closed form of one film is the recursion with one layer.
    #[test]
    fn airy_equals_recursion(
        front in 1.0..1.6_f64, index in any_index(), d in 0.0..3000.0_f64, substrate in any_index(),
        cosine in 0.0..1.0_f64, wavelength in 300.0..800.0_f64,
    ) {
        let film = layer(index, d);
        let airy = film::airy(front, film, substrate, cosine, wavelength);
        let stack = transfer(front, &[film], substrate, cosine, wavelength);
        prop_assert!((airy.s.r - stack.s.r).norm() < 1e-12 && (airy.p.r - stack.p.r).norm() < 1e-12);
        prop_assert!((airy.s.t - stack.s.t).norm() < 1e-12 && (airy.p.t - stack.p.t).norm() < 1e-12);
    }

    /// The fast paths equal the reference for any layers, dispersive, periodic, any number of channels.
    #[test]
    fn fast_paths_equal_the_reference(
        front in 1.0..1.6_f64,
        materials in prop::collection::vec((any_index(), 0.0..40_000.0_f64), 2..5),
        layers in prop::collection::vec((0..4_usize, 0.0..1500.0_f64), 0..5),
        repeats in 1..4_usize,
        cosine in 0.0..=1.0_f64,
        channels in 1..150_usize,
    ) {
        let wavelengths: Vec<f64> = (0..channels).map(|c| 300.0 + 3.7 * c as f64).collect();
        let index = |material: usize, wavelength: f64| {
            let (base, b) = materials[material % materials.len()];
            base + b / (wavelength * wavelength)
        };
        let layer_materials: Vec<usize> = layers.iter().map(|&(material, _)| material % materials.len()).collect();
        let sequence: Vec<usize> = (0..repeats).flat_map(|_| 0..layers.len()).collect();
        let arrangement = Arrangement::new(materials.len(), layer_materials, sequence.clone(), 1);
        let permittivities = (0..materials.len())
            .map(|m| {
                let indices = wavelengths.iter().map(|&wavelength| index(m, wavelength));
                Permittivity::new(indices.clone().map(|index| index.re), indices.map(|index| index.im))
            })
            .collect();
        let wavenumbers = double_wavenumbers(&wavelengths);
        let thicknesses = layers.iter().map(|&(_, d)| d).collect();
        let mut found = vec![0.0; channels];
        let medium = LayeredMedium::new(&arrangement, &wavenumbers, permittivities, thicknesses);
        medium.reflectance(front, cosine, &mut found);
        let mut passed = vec![0.0; channels];
        medium.transmittance(front, cosine, &mut passed);
        for ((&wavelength, found), passed) in wavelengths.iter().zip(found).zip(passed) {
            let real_layers: Vec<Layer> =
                sequence.iter().map(|&l| layer(index(layers[l].0, wavelength), layers[l].1)).collect();
            let response = transfer(front, &real_layers, index(1, wavelength), cosine, wavelength);
            let expected = response.reflectance.unpolarised();
            // A phase of some hundreds carries an error of 1e-13, and a stack of a dozen layers adds them up.
            prop_assert!((found - expected).abs() < 2e-12, "{found} instead of {expected} at {wavelength} nm");
            // Power into the substrate is asked for where that is clear.
            if index(1, wavelength).im == 0.0 {
                let expected = response.transmittance.unpolarised();
                prop_assert!((passed - expected).abs() < 4e-12, "T {passed} instead of {expected} at {wavelength} nm");
            }
        }
    }
}

/// Diffuse light that meets the layers from the substrate, by midpoints over the reference's reversed stack: the root at
/// the critical angle costs them some 1e-6.
#[test]
fn diffuse_absorptance_from_inside() {
    let melanin = Complex64::new(1.7, 0.1);
    for (layers, substrate, wavelength) in [
        (vec![layer(melanin, 150.0)], 1.56, 500.0),
        (vec![layer(real(1.56), 330.0), layer(melanin, 120.0)], 1.56, 450.0),
        (vec![layer(Complex64::new(3.1, 3.3), 8.0), layer(real(1.38), 450.0)], 1.5, 600.0),
        (vec![layer(real(1.56), 330.0)], 1.5, 500.0),
    ] {
        let count = layers.len();
        let arrangement = Arrangement::new(count + 1, (0..count).collect(), (0..count).collect(), count);
        let permittivities = layers
            .iter()
            .map(|layer| layer.index)
            .chain([real(substrate)])
            .map(|index| Permittivity::new(std::iter::once(index.re), std::iter::once(index.im)))
            .collect();
        let thicknesses = layers.iter().map(|layer| layer.thickness_nm).collect();
        let wavenumbers = double_wavenumbers(&[wavelength]);
        let mut found = [f64::NAN];
        LayeredMedium::new(&arrangement, &wavenumbers, permittivities, thicknesses)
            .diffuse_absorptance_inside(1.0, &mut found);
        let reversed: Vec<Layer> = layers.iter().rev().copied().collect();
        let steps = 20_000;
        let at = |i: i32| {
            let cosine = (f64::from(i) + 0.5) / f64::from(steps);
            let response = transfer(substrate, &reversed, real(1.0), cosine, wavelength);
            2.0 * cosine * (1.0 - response.reflectance.unpolarised() - response.transmittance.unpolarised())
        };
        let expected = (0..steps).map(at).sum::<f64>() / f64::from(steps);
        println!("{} instead of {expected}", found[0]);
        assert!((found[0] - expected).abs() < 1e-5, "{} instead of {expected}", found[0]);
    }
}

/// Where the substrate disperses, the critical angle is another in each channel than the one that the rule follows.
#[test]
fn diffuse_absorptance_of_a_dispersive_substrate() {
    let (substrates, wavelengths) = ([1.60, 1.57, 1.55], [400.0, 500.0, 700.0]);
    let melanin = layer(Complex64::new(1.7, 0.1), 150.0);
    let of = |substrates: &[f64], wavelengths: &[f64]| {
        let arrangement = Arrangement::new(2, vec![0], vec![0], 1);
        let melanin_index = wavelengths.iter().map(|_| melanin.index);
        let permittivities = vec![
            Permittivity::new(melanin_index.clone().map(|index| index.re), melanin_index.map(|index| index.im)),
            Permittivity::new(substrates.iter().copied(), substrates.iter().map(|_| 0.0)),
        ];
        let mut found = vec![f64::NAN; substrates.len()];
        LayeredMedium::new(&arrangement, &double_wavenumbers(wavelengths), permittivities, vec![150.0])
            .diffuse_absorptance_inside(1.0, &mut found);
        found
    };
    let together = of(&substrates, &wavelengths);
    for ((substrate, wavelength), found) in substrates.iter().zip(wavelengths).zip(together) {
        let alone = of(&[*substrate], &[wavelength])[0];
        println!("{found} instead of {alone}");
        assert!((found - alone).abs() < 1e-4, "{found} instead of {alone}");
    }
}

/// G1 and D of tables with 14 digits.
#[test]
fn beckmann_agrees_with_its_tables() {
    let oracle = Oracle::read("tests/oracles/smith_g1.csv");
    for row in 0..oracle.rows.len() {
        let surface = Beckmann::new(oracle.number(row, "alpha"));
        let cosine = oracle.number(row, "theta_deg").to_radians().cos();
        close_relative(surface.visible_share(cosine), oracle.number(row, "G1_exact"), 1e-12);
        close_relative(surface.density(cosine), oracle.number(row, "D"), 1e-12);
    }
    // Here the directions have 12 digits, and the density's exponent multiplies what is missing.
    let oracle = Oracle::read("tests/oracles/microfacet.csv");
    for row in 0..oracle.rows.len() {
        let number = |name| oracle.number(row, name);
        let surface = Beckmann::new(number("alpha"));
        close_relative(surface.density(number("m_z")), number("D"), 1e-8);
        if number("exact_G1_i") > 0.0 && number("exact_G1_o") > 0.0 {
            close_relative(surface.visible_share(number("wi_z")), number("exact_G1_i"), 1e-8);
            close_relative(surface.visible_share(number("wo_z")), number("exact_G1_o"), 1e-8);
        }
    }
}

fn close_relative(found: f64, expected: f64, tolerance: f64) {
    let difference = (found - expected).abs();
    assert!(difference <= tolerance * expected.abs(), "found {found}, expected {expected}, difference {difference:e}");
}

/// ∫ D cosθ dω = 1, by Simpson's rule in tanθ/α, over which D cosθ dω is 2t e^{−t²} dt whatever α is.
#[test]
fn beckmann_is_normalised() {
    for alpha in [0.02, 0.1, 0.5, 1.0] {
        let surface = Beckmann::new(alpha);
        let integrand = |t: f64| {
            let cosine = 1.0 / (1.0 + (alpha * t).powi(2)).sqrt();
            // dω = 2π sinθ dθ, dθ = α cos²θ dt.
            let sine = alpha * t * cosine;
            surface.density(cosine) * cosine * 2.0 * PI * sine * alpha * cosine * cosine
        };
        let steps = 2000;
        let width = 7.0 / f64::from(steps);
        let sum: f64 = (0..=steps)
            .map(|i| {
                let weight = if i == 0 || i == steps {
                    1.0
                } else if i % 2 == 1 {
                    4.0
                } else {
                    2.0
                };
                weight * integrand(f64::from(i) * width)
            })
            .sum();
        let integral = sum * width / 3.0;
        // Simpson's error at this width is 1e-12.
        assert!((integral - 1.0).abs() < 1e-10, "alpha {alpha}: {integral}");
    }
}

/// At the ends of its range G1 is 1 and 0 and no NaN.
#[test]
fn visible_share_ends() {
    let surface = Beckmann::new(0.3);
    assert_eq!(surface.visible_share(1.0).to_bits(), 1.0_f64.to_bits());
    assert_eq!(surface.visible_share(0.0).to_bits(), 0.0_f64.to_bits());
    assert_eq!(surface.density(0.0).to_bits(), 0.0_f64.to_bits());
}
