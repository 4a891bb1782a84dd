//! The rough dielectric interface: printed values, closed forms of GGX, reciprocity, energy; and the Lambertian
//! surface.

use std::f64::consts::PI;

use barbule::bsdf::{
    Direction, Distribution, Lambertian, LambertianDesign, MicrofacetDesign, MicrofacetInterface, Model,
};
use barbule::optics::RoughInterface;
use barbule::optics::microfacet::Ggx;
use proptest::prelude::*;

use super::directions::{RGB_NM, any_direction, any_direction_above, directional_albedo, evaluate, spherical, values};
use super::oracle::Oracle;

fn interface(distribution: Distribution) -> MicrofacetInterface {
    MicrofacetInterface::new(&MicrofacetDesign { distribution, ..Default::default() }, &[550.0])
        .expect("the design is valid")
}

fn direction(oracle: &Oracle, row: usize, name: &str) -> Direction {
    let [x, y, z] = ["x", "y", "z"].map(|axis| oracle.number(row, &format!("{name}_{axis}")));
    Direction::new(x, y, z)
}

/// A quarter of the printed values, BSDF · |cosθo| with light from wi, from either side of the interface.
#[test]
fn beckmann_interface_agrees_with_its_table() {
    let oracle = Oracle::read("tests/oracles/microfacet.csv");
    let model = interface(Distribution::Beckmann);
    let mut worst: f64 = 0.0;
    for row in 0..oracle.rows.len() {
        let number = |name| oracle.number(row, name);
        let (incoming, outgoing) = (direction(&oracle, row, "wi"), direction(&oracle, row, "wo"));
        let expected = number("exact_value");
        let values = values(&model, &[("roughness", number("alpha")), ("eta", number("eta"))]);
        let found = evaluate(&model, &values, &incoming, &outgoing)[0] * outgoing.z.abs();
        worst = worst.max(if expected == 0.0 { found } else { (found / expected - 1.0).abs() });
    }
    println!("worst of {}: {worst:.2e}", oracle.rows.len());
    assert!(worst <= 1e-6, "worst relative error {worst:e}");
}

/// Walter et al. 2007, section 5.2: D at the normal, half of the projected area within tanθ = α, and G1 from the same
/// distribution's projected area, which a quadrature over visible normals gives independently.
#[test]
fn ggx_closed_forms() {
    for alpha in [0.05, 0.3, 1.0] {
        let ggx = Ggx::new(alpha);
        assert!((ggx.density(1.0) * PI * alpha * alpha - 1.0).abs() < 1e-12);
        assert_eq!(ggx.density(-0.5).to_bits(), 0.0_f64.to_bits());
        assert_eq!(ggx.visible_share(0.0).to_bits(), 0.0_f64.to_bits());
        assert!((ggx.visible_share(1.0) - 1.0).abs() < 1e-15);
        // Equation 34 as printed, in the tangent.
        let cosine: f64 = 0.3;
        let tangent = (1.0 - cosine * cosine).sqrt() / cosine;
        let printed = 2.0 / (1.0 + (1.0 + alpha * alpha * tangent * tangent).sqrt());
        assert!((ggx.visible_share(cosine) - printed).abs() < 1e-14);
        // ∫ D cosθ dω = 1; the share within tanθ is tan²θ/(α² + tan²θ) (equation 35 turned round).
        let projected_area = |tangent: f64| {
            let (steps, end) = (200_000, tangent.atan());
            let step = end / f64::from(steps);
            let at = |i: u32| {
                let theta = (f64::from(i) + 0.5) * step;
                ggx.density(theta.cos()) * theta.cos() * theta.sin()
            };
            2.0 * PI * step * (0..steps).map(at).sum::<f64>()
        };
        assert!((projected_area(alpha) - 0.5).abs() < 1e-6);
        assert!((projected_area(f64::INFINITY) - 1.0).abs() < 1e-6);
    }
}

/// Smith's G1 is what makes the visible microfacets fill the projected surface: ∫ G1 D max(ω·m, 0) dm = cosθ (Heitz
/// 2014, equation 16). By midpoints in both angles; GGX and slope tails ask for many.
#[test]
fn ggx_masking_fills_the_projected_area() {
    for (alpha, theta) in [(0.3, 0.4), (0.3, 1.4), (0.8, 1.0)] {
        let ggx = Ggx::new(alpha);
        let view = spherical(theta, 0.0);
        let (polar, azimuthal) = (4000, 400);
        let (d_theta, d_phi) = (0.5 * PI / f64::from(polar), 2.0 * PI / f64::from(azimuthal));
        let mut sum = 0.0;
        for i in 0..polar {
            let inclination = (f64::from(i) + 0.5) * d_theta;
            let ring = ggx.density(inclination.cos()) * inclination.sin();
            for j in 0..azimuthal {
                let normal = spherical(inclination, (f64::from(j) + 0.5) * d_phi);
                sum += ring * view.dot(&normal).max(0.0);
            }
        }
        let found = ggx.visible_share(view.z) * sum * d_theta * d_phi;
        // The kink where ω·m = 0 costs the midpoints some 1e-5.
        assert!((found / view.z - 1.0).abs() < 1e-4, "α {alpha}, θ {theta}: {found} instead of {}", view.z);
    }
}

/// Of three channels the longest wavelength is r and the shortest b, whatever their order. Names once went by position, so
/// that the red of a table, whose wavelengths rise, was its shortest wavelength.
#[test]
fn channels_are_named_by_wavelength() {
    let design = LambertianDesign { per_channel: vec!["albedo".to_owned()] };
    let z = Direction::new(0.0, 0.0, 1.0);
    let albedos = [("albedo_r", 0.9), ("albedo_g", 0.5), ("albedo_b", 0.2)];
    for (wavelengths_nm, expected) in [
        ([645.0, 525.0, 445.0], [0.9, 0.5, 0.2]),
        ([445.0, 525.0, 645.0], [0.2, 0.5, 0.9]),
        ([525.0, 645.0, 445.0], [0.5, 0.9, 0.2]),
        ([525.0, 445.0, 645.0], [0.5, 0.2, 0.9]),
    ] {
        let model = Lambertian::new(&design, &wavelengths_nm).unwrap();
        let found = evaluate(&model, &values(&model, &albedos), &z, &z);
        for (found, albedo) in found.iter().zip(expected) {
            assert!((found * PI - albedo).abs() <= 1e-15, "{wavelengths_nm:?}: {found} for an albedo of {albedo}");
        }
        let others = Lambertian::new(&design, &wavelengths_nm[..2]).unwrap();
        assert_eq!(others.parameters().iter().map(|p| &*p.name).collect::<Vec<_>>(), ["albedo_1", "albedo_2"]);
    }
}

proptest! {
    /// `f_r(i, o) = f_r(o, i)`; `f_t(i → o)/η_o² = f_t(o → i)/η_i²`.
    #[test]
    fn interface_is_reciprocal(
        roughness in 0.005..=1.0,
        eta in 1.01..=3.0,
        ggx in any::<bool>(),
        (i, o) in (any_direction(), any_direction()),
    ) {
        let model = interface(if ggx { Distribution::Ggx } else { Distribution::Beckmann });
        let values = values(&model, &[("roughness", roughness), ("eta", eta)]);
        let index = |direction: &Direction| if direction.z > 0.0 { 1.0 } else { eta };
        let forth = evaluate(&model, &values, &i, &o)[0] / (index(&o) * index(&o));
        let back = evaluate(&model, &values, &o, &i)[0] / (index(&i) * index(&i));
        // Rounding of the half vector is magnified by the steepness of a narrow lobe: 1/α² times the cosine's last
        // bits.
        prop_assert!((forth - back).abs() <= 1e-9 * forth.abs().max(1e-30), "{forth} and {back}");
    }

    /// Every channel has its own index, and none knows of the others.
    #[test]
    fn channels_are_independent(
        (eta_r, eta_g, eta_b) in (1.01..=3.0, 1.01..=3.0, 1.01..=3.0),
        (i, o) in (any_direction(), any_direction()),
    ) {
        let design = MicrofacetDesign { per_channel: vec!["eta".to_owned()], ..Default::default() };
        let three = MicrofacetInterface::new(&design, &RGB_NM).unwrap();
        let of_channels = [("eta_r", eta_r), ("eta_g", eta_g), ("eta_b", eta_b)];
        let found = evaluate(&three, &values(&three, &of_channels), &i, &o);
        let one = interface(Distribution::Beckmann);
        for (found, (_, eta)) in found.iter().zip(of_channels) {
            prop_assert_eq!(vec![*found], evaluate(&one, &values(&one, &[("eta", eta)]), &i, &o));
        }
    }

    #[test]
    fn lambertian_is_its_albedo(albedo in 0.0..=1.0, (i, o) in (any_direction_above(), any_direction_above())) {
        let model = Lambertian::new(&LambertianDesign::default(), &RGB_NM).unwrap();
        let values = values(&model, &[("albedo", albedo)]);
        for found in evaluate(&model, &values, &i, &o) {
            prop_assert!((found * PI - albedo).abs() <= 1e-15);
        }
        prop_assert_eq!(evaluate(&model, &values, &i, &-o), vec![0.0; 3]);
        prop_assert_eq!(evaluate(&model, &values, &-i, &o), vec![0.0; 3]);
    }
}

/// What the scattering function reflects and transmits in all is what the direct quadrature of T and R says, from
/// either side of the interface: two integrals over different variables.
#[test]
fn interface_scatters_its_power_fractions() {
    let (alpha, eta) = (0.4, 1.5);
    let model = interface(Distribution::Beckmann);
    let values = values(&model, &[("roughness", alpha), ("eta", eta)]);
    let bound = model.bind(&values);
    for theta in [0.0, 0.5, 1.0, 1.4] {
        for (side, relative) in [(1.0, eta), (-1.0, 1.0 / eta)] {
            let mut incoming = spherical(theta, 0.0);
            let quadrature = RoughInterface::new(relative, alpha);
            let (reflected, transmitted) = (quadrature.reflectance(incoming.z), quadrature.transmittance(incoming.z));
            incoming.z *= side;
            let nodes = (2000, 200);
            let found_reflected = directional_albedo(bound.as_ref(), &incoming, side > 0.0, nodes);
            let found_transmitted = directional_albedo(bound.as_ref(), &incoming, side < 0.0, nodes);
            // Midpoints meet the edge of the lobes at the horizon and the critical angle.
            assert!((found_reflected - reflected).abs() < 1e-4, "R at {theta}: {found_reflected}, {reflected}");
            assert!((found_transmitted - transmitted).abs() < 1e-4, "T at {theta}: {found_transmitted}, {transmitted}");
        }
    }
}
