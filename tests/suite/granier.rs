//! The Granier–Heidrich film against its equations written out with vectors, and against what its docs say.

use std::f64::consts::PI;

use barbule::bsdf::{
    Bsdf, Direction, GranierHeidrich, GranierHeidrichDesign, Interference, NormalSource, Site, normal_from_rgb,
};
use proptest::prelude::*;

use super::directions::{RGB_NM, any_direction_above, evaluate, largest_albedo, spherical, values};

/// All that the equations take.
struct Film {
    n0: Direction,
    n1: Direction,
    eta: f64,
    thickness_nm: f64,
    wavelength_nm: f64,
    exponents: (f64, f64),
}

impl Film {
    /// Equations 2.23 to 2.30 with the directions of 3.1 to 3.4, mended, one line each: the refracted directions by
    /// Snell's law in the plane of ω and n0, the mirrored ones by a Householder reflection.
    fn dielectric(&self, i: &Direction, o: &Direction) -> f64 {
        let schlick = |cosine: f64| {
            let f = ((1.0 - self.eta) / (1.0 + self.eta)).powi(2);
            f + (1.0 - f) * (1.0 - cosine).powi(5)
        };
        let refract = |w: &Direction| {
            let along = w - self.n0 * w.dot(&self.n0);
            let inside = along / self.eta;
            -inside - self.n0 * (1.0 - inside.norm_squared()).sqrt()
        };
        let mirror = |w: &Direction, n: &Direction| w - n * (2.0 * w.dot(n));
        let lobe = |cosine: f64, exponent: f64| if cosine > 0.0 { cosine.powf(exponent) } else { 0.0 };
        let (ti, to) = (refract(i), refract(o));
        let fr = schlick(i.dot(&self.n0)) * lobe(mirror(&-i, &self.n0).dot(o), self.exponents.0);
        let ft = (1.0 - schlick(i.dot(&self.n0)))
            * lobe(mirror(&ti, &self.n1).dot(&-to), self.exponents.1)
            * (1.0 - schlick(to.dot(&self.n0).abs()));
        let phase = PI * self.eta * self.thickness_nm / self.wavelength_nm * (ti + to).dot(&-self.n0);
        fr + ft + 2.0 * (2.0 * phase).cos() * (fr * ft).sqrt()
    }

    /// Equations 2.32 to 2.34.
    fn diffuse(&self) -> f64 {
        let td = 80.0 / 21.0 * self.eta / (1.0 + self.eta).powi(2);
        let phase = 2.0 * PI * self.eta * self.thickness_nm / self.wavelength_nm;
        1.0 + 2.0 * (2.0 * phase).cos() * (td * (1.0 - td)).sqrt()
    }
}

fn any_tilted_normal() -> impl Strategy<Value = (f64, f64)> {
    (0.0..30.0f64, -180.0..180.0f64)
}

fn tilted((tilt_deg, azimuth_deg): (f64, f64)) -> Direction {
    spherical(tilt_deg.to_radians(), azimuth_deg.to_radians())
}

proptest! {
    /// In every channel its own index and wavelength, with tilted normals given as parameters.
    #[test]
    fn film_follows_its_equations(
        (outer, inner) in (any_tilted_normal(), any_tilted_normal()),
        etas in (1.3..=1.9, 1.3..=1.9, 1.3..=1.9),
        thickness_nm in 0.0..=800.0,
        exponents in (0.0..=200.0, 0.0..=200.0),
        (i, o) in (any_direction_above(), any_direction_above()),
    ) {
        let design = GranierHeidrichDesign {
            outer_normal: NormalSource::Spherical,
            inner_normal: NormalSource::Spherical,
            per_channel: vec!["eta".to_owned()],
            ..Default::default()
        };
        let model = GranierHeidrich::new(&design, &RGB_NM).unwrap();
        let changes = [
            ("thickness_nm", thickness_nm),
            ("outer_exponent", exponents.0),
            ("inner_exponent", exponents.1),
            ("eta_r", etas.0),
            ("eta_g", etas.1),
            ("eta_b", etas.2),
            ("specular", 0.7),
            ("diffuse", 0.2),
            ("outer_tilt_deg", outer.0),
            ("outer_azimuth_deg", outer.1),
            ("inner_tilt_deg", inner.0),
            ("inner_azimuth_deg", inner.1),
        ];
        let found = evaluate(&model, &values(&model, &changes), &i, &o);
        for ((found, eta), wavelength_nm) in found.iter().zip([etas.0, etas.1, etas.2]).zip(RGB_NM) {
            let film = Film { n0: tilted(outer), n1: tilted(inner), eta, thickness_nm, wavelength_nm, exponents };
            let lit = i.dot(&film.n0) > 0.0 && o.dot(&film.n0) > 0.0;
            let expected = if lit { 0.7 * film.dielectric(&i, &o) } else { 0.0 } + 0.2 * film.diffuse();
            // Both sides are sums of terms up to 4; a steep lobe magnifies a cosine's rounding by its exponent, 200.
            prop_assert!((found - expected).abs() <= 1e-12, "{found} instead of {expected}");
        }
    }

    /// A fixed normal, the same as parameters, and the same from a map are one model.
    #[test]
    fn normals_may_come_from_anywhere(
        (outer, inner) in (any_tilted_normal(), any_tilted_normal()),
        grey in 0.0..=1.0,
        (i, o) in (any_direction_above(), any_direction_above()),
    ) {
        let (n0, n1) = (tilted(outer), tilted(inner));
        let of = |outer_normal, inner_normal| {
            let design = GranierHeidrichDesign { outer_normal, inner_normal, ..Default::default() };
            GranierHeidrich::new(&design, &RGB_NM).unwrap()
        };
        // The length of a fixed vector does not matter.
        let fixed = of(NormalSource::Fixed((n0 * 3.0).into()), NormalSource::Fixed(n1.into()));
        let thickness_nm = 330.0 * grey;
        let expected = evaluate(&fixed, &values(&fixed, &[("thickness_nm", thickness_nm)]), &i, &o);

        let spherical = of(NormalSource::Spherical, NormalSource::Spherical);
        let angles = [
            ("thickness_nm", thickness_nm),
            ("outer_tilt_deg", outer.0),
            ("outer_azimuth_deg", outer.1),
            ("inner_tilt_deg", inner.0),
            ("inner_azimuth_deg", inner.1),
        ];
        let by_angles = evaluate(&spherical, &values(&spherical, &angles), &i, &o);

        let mapped = of(NormalSource::Mapped, NormalSource::Mapped);
        let colour = |normal: Direction| [normal.x, normal.y, normal.z].map(|component| 0.5 * (component + 1.0));
        let site = Site {
            outer_normal: normal_from_rgb(colour(n0)).unwrap(),
            inner_normal: normal_from_rgb(colour(n1)).unwrap(),
            thickness_scale: grey,
        };
        let mut by_map = [f64::NAN; 3];
        mapped.at(&values(&mapped, &[("thickness_nm", 330.0)]), &site).evaluate(&i, &o, &mut by_map);
        for ((a, b), expected) in by_angles.iter().zip(by_map).zip(expected) {
            prop_assert!((a - expected).abs() < 1e-12 && (b - expected).abs() < 1e-12, "{a}, {b}, {expected}");
        }
    }
}

/// The example of the second thesis (table 3.1), outer normal tilted by 14°, light along z. The outer surface mirrors
/// it to 28°. Light that enters is at asin(sin 14°/1.5) = 9.28° to n0, so at 4.72° to z; the inner surface mirrors it
/// to 9.28° + 2 · 4.72° = 18.72° from n0, and it leaves at asin(1.5 sin 18.72°) = 28.77° from n0: at −14.77°.
#[test]
fn tilted_surfaces_part_the_two_reflections() {
    let design = GranierHeidrichDesign {
        outer_normal: NormalSource::Fixed([0.24192, 0.0, 0.97030]),
        interference: Interference::Off,
        ..Default::default()
    };
    let model = GranierHeidrich::new(&design, &[645.0]).unwrap();
    let values = values(&model, &[("thickness_nm", 76.0), ("eta", 1.5), ("diffuse", 0.0)]);
    let at = |degrees: f64| evaluate(&model, &values, &Direction::z(), &spherical(degrees.to_radians(), 0.0))[0];
    let peak_between = |start: i32, end: i32| {
        let tenths = (10 * start..10 * end).map(|tenth| 0.1 * f64::from(tenth));
        tenths.max_by(|a, b| at(*a).total_cmp(&at(*b))).unwrap()
    };
    // The Fresnel factors pull the peaks by less than a step.
    assert!((peak_between(15, 45) - 28.0).abs() < 0.15, "outer reflection at {}°", peak_between(15, 45));
    assert!((peak_between(-45, 10) + 14.77).abs() < 0.15, "inner reflection at {}°", peak_between(-45, 10));
}

/// The phase term is off by a switch; no thickness is "off", and 0 is the opposite of it.
#[test]
fn interference_is_switched_not_thinned_away() {
    let at = |interference, thickness_nm| {
        let model =
            GranierHeidrich::new(&GranierHeidrichDesign { interference, ..Default::default() }, &[550.0]).unwrap();
        let values = values(&model, &[("thickness_nm", thickness_nm), ("eta", 1.5), ("diffuse", 0.5)]);
        evaluate(&model, &values, &Direction::z(), &Direction::z())[0]
    };
    // Along the normal f_r = f = 0.04 and f_t = 0.96².
    let (reflected, transmitted) = (0.04, 0.96 * 0.96);
    assert!((at(Interference::Off, 123.0) - (reflected + transmitted + 0.5)).abs() < 1e-14);
    assert_eq!(at(Interference::Constructive, 77.0).to_bits(), at(Interference::Film, 0.0).to_bits());
    let td: f64 = 80.0 / 21.0 * 1.5 / 6.25;
    let bound = |sign: f64| {
        (reflected + transmitted + sign * 2.0 * f64::sqrt(reflected * transmitted))
            + 0.5 * (1.0 + sign * 2.0 * (td * (1.0 - td)).sqrt())
    };
    assert!((at(Interference::Constructive, 0.0) - bound(1.0)).abs() < 1e-14);
    assert!((at(Interference::Destructive, 0.0) - bound(-1.0)).abs() < 1e-14);
}

/// Energy is not conserved, and the docs say by how much.
#[test]
fn film_states_its_largest_albedo() {
    let docs = include_str!("../../src/bsdf/granier.rs");
    for exponent in [0.0, 10.0, 130.0] {
        let albedo = |normalised, interference| {
            let design = GranierHeidrichDesign { normalised, interference, ..Default::default() };
            let model = GranierHeidrich::new(&design, &[550.0]).unwrap();
            let changes = [("outer_exponent", exponent), ("inner_exponent", exponent), ("eta", 1.5), ("diffuse", 1.0)];
            format!("{:.2}", largest_albedo(&model, &values(&model, &changes)))
        };
        let row = format!(
            "//! | {exponent} | {} | {} | {} | {} |",
            albedo(false, Interference::Constructive),
            albedo(false, Interference::Destructive),
            albedo(true, Interference::Constructive),
            albedo(true, Interference::Destructive),
        );
        println!("{row}");
        assert!(docs.contains(&row), "the model's docs lack the row {row}");
    }
}

#[test]
fn bad_normals_get_a_sentence() {
    for found in [[0.0, 0.0, 0.0], [1.0, 0.0, -0.1], [f64::NAN, 0.0, 1.0], [f64::INFINITY, 0.0, 1.0]] {
        let design = GranierHeidrichDesign { outer_normal: NormalSource::Fixed(found), ..Default::default() };
        let message = GranierHeidrich::new(&design, &RGB_NM).unwrap_err().to_string();
        assert!(
            message.starts_with("`outer_normal` is [") && message.contains("points out of the surface"),
            "{message}"
        );
        assert!(normal_from_rgb(found.map(|component| 0.5 * (component + 1.0))).is_none());
    }
    let typed: GranierHeidrichDesign =
        toml::from_str("outer_normal = { fixed = [0.24192, 0, 0.97030] }\ninner_normal = \"mapped\"").unwrap();
    assert_eq!(typed.outer_normal, NormalSource::Fixed([0.24192, 0.0, 0.97030]));
    assert_eq!(typed.inner_normal, NormalSource::Mapped);
}
