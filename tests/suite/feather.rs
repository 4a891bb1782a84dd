//! The vane of a feather against its parts, conservation of energy, its symmetries and the table of barbs.

use barbule::bsdf::cylinder::{CylinderDesign, CylinderModel};
use barbule::bsdf::spongy_barb::SpongyBarbModel;
use barbule::bsdf::{
    BarbDesign, BarbSpecies, BarbuleDesign, CoatedBase, Design, Direction, Feather, FeatherDesign, Model, ModelError,
};
use proptest::prelude::*;

use super::desk::{Desk, film_with};
use super::directions::{RGB_NM, any_direction, any_direction_above, evaluate, furnace, spherical, values};

fn feather(design: &FeatherDesign) -> Feather {
    Feather::new(design, &RGB_NM).unwrap()
}

fn lamella() -> Design {
    toml::from_str(
        "layers = [{ name = \"cortex\", material = \"keratin\", thickness_nm = 330 }]\nsubstrate = \"bird_melanin\"",
    )
    .unwrap()
}

fn iridescent() -> FeatherDesign {
    FeatherDesign { barbule: BarbuleDesign::Lamella(Box::new(lamella())), ..FeatherDesign::default() }
}

/// The direction turned about the normal by an angle in degrees, from x towards y.
fn turned(direction: &Direction, degrees: f64) -> Direction {
    let azimuth = direction.y.atan2(direction.x) + degrees.to_radians();
    spherical(direction.z.clamp(-1.0, 1.0).acos(), azimuth)
}

/// Relative difference that turning a direction and back leaves, through lobes a tenth of a radian wide.
const ROUNDING: f64 = 1e-9;

#[track_caller]
fn assert_near(found: &[f64], expected: &[f64]) {
    for (found, expected) in found.iter().zip(expected) {
        let difference = (found - expected).abs();
        assert!(difference <= ROUNDING * expected.abs() + 1e-15, "found {found}, expected {expected}: {difference:e}");
    }
}

/// What goes straight through is no part of the integral: it is the share that is missing.
#[test]
fn a_white_feather_sends_all_light_on() {
    let feather = Feather::new(&FeatherDesign::default(), &[550.0]).unwrap();
    for through in [0.0, 0.2, 0.5] {
        for (theta_deg, phi_deg) in [(0.0, 0.0), (35.0, 20.0), (70.0, 110.0), (130.0, 45.0)] {
            let white = [
                ("barb.sigma_a", 0.0),
                ("barbule.sigma_a", 0.0),
                ("barbule.eta", 1.4),
                ("through_share", through),
                ("barb_share", 0.3),
            ];
            let values = values(&feather, &white);
            let outgoing = spherical(f64::to_radians(theta_deg), f64::to_radians(phi_deg));
            let sum = furnace(&feather, &values, &outgoing);
            println!("viewer at {theta_deg}°, {phi_deg}°, w_t {through}: {sum}");
            assert!((sum - (1.0 - through)).abs() < 1e-3);
            let straight = feather.bind(&values).straight_through(&outgoing);
            assert!((sum + straight - 1.0).abs() < 1e-3, "what passes straight through is the rest");
        }
    }
}

/// Half barb and half open is half a barb; no barb is barbules alone.
#[test]
fn a_feather_is_the_sum_of_its_parts() {
    let cylinder = CylinderModel::new(&CylinderDesign::default(), &RGB_NM).unwrap();
    let sponge = SpongyBarbModel::new(&CylinderDesign::default(), &RGB_NM).unwrap();
    let coated = CoatedBase::new(&lamella(), &RGB_NM).unwrap();
    let plain = feather(&FeatherDesign::default());
    let spongy =
        feather(&FeatherDesign { barb: BarbDesign::SpongyBarb(CylinderDesign::default()), ..FeatherDesign::default() });
    let iridescent = feather(&iridescent());
    let directions: Vec<Direction> =
        [(0.3, 0.4), (1.2, 2.0), (2.5, -1.0), (0.8, -2.5)].map(|(theta, phi)| spherical(theta, phi)).to_vec();
    for incoming in &directions {
        for outgoing in &directions {
            let barb = [("barb_share", 0.5), ("through_share", 0.5)];
            for (feather, part) in [(&plain, &cylinder as &dyn Model), (&spongy, &sponge)] {
                let found = evaluate(feather, &values(feather, &barb), incoming, outgoing);
                let whole = evaluate(part, &values(part, &[]), incoming, outgoing);
                assert_near(&found, &whole.iter().map(|value| 0.5 * value).collect::<Vec<f64>>());
            }

            let barbules = [("barb_share", 0.0), ("barbule_angle_deg", 30.0), ("barbule.beta_n", 0.5)];
            let found = evaluate(&plain, &values(&plain, &barbules), incoming, outgoing);
            let fibre = values(&cylinder, &[("beta_n", 0.5)]);
            let side = |angle| evaluate(&cylinder, &fibre, &turned(incoming, angle), &turned(outgoing, angle));
            let expected: Vec<f64> =
                side(-30.0).iter().zip(side(30.0)).map(|(one, other)| 0.5 * (one + other)).collect();
            assert_near(&found, &expected);

            let found = evaluate(&iridescent, &values(&iridescent, &[("barb_share", 0.0)]), incoming, outgoing);
            assert_near(&found, &evaluate(&coated, &values(&coated, &[]), incoming, outgoing));
        }
    }
}

proptest! {
    /// Proximal and distal barbules are alike: the vane is its own mirror image on both sides of the barb.
    #[test]
    fn a_feather_is_symmetric_about_its_barb(
        incoming in any_direction(),
        outgoing in any_direction(),
        angle in 0.0..90.0f64,
        barb in 0.0..0.5f64,
    ) {
        let feather = feather(&FeatherDesign::default());
        let values = values(&feather, &[("barbule_angle_deg", angle), ("barb_share", barb)]);
        let mirrored = |direction: &Direction| Direction::new(direction.x, -direction.y, direction.z);
        assert_near(
            &evaluate(&feather, &values, &mirrored(&incoming), &mirrored(&outgoing)),
            &evaluate(&feather, &values, &incoming, &outgoing),
        );
    }

    /// At any values inside the bounds, corners too: finite, and nothing below zero.
    #[test]
    fn no_values_in_bounds_give_nonsense(
        incoming in any_direction_above(),
        outgoing in any_direction(),
        places in proptest::collection::vec(prop_oneof![Just(0.0), Just(1.0), 0.0..1.0f64], 40),
    ) {
        for design in [FeatherDesign::default(), iridescent()] {
            let feather = feather(&design);
            let inside = |(parameter, place): (&barbule::parameter::Parameter, &f64)| {
                (parameter.lower + place * (parameter.upper - parameter.lower)).clamp(parameter.lower, parameter.upper)
            };
            let values: Vec<f64> = feather.parameters().iter().zip(&places).map(inside).collect();
            prop_assert_eq!(values.len(), feather.parameters().len());
            for value in evaluate(&feather, &values, &incoming, &outgoing) {
                prop_assert!(value.is_finite() && value >= 0.0, "{} at {:?}", value, values);
            }
        }
    }
}

/// More channels than fit the small buffer, in the same numbers.
#[test]
fn thirty_channels_are_thirty_times_one() {
    let wavelengths: Vec<f64> = (0..30).map(|k| 400.0 + 10.0 * f64::from(k)).collect();
    let (many, one) =
        (Feather::new(&iridescent(), &wavelengths).unwrap(), Feather::new(&iridescent(), &[540.0]).unwrap());
    let (incoming, outgoing) = (spherical(0.5, 0.2), spherical(0.4, 3.0));
    let found = evaluate(&many, &values(&many, &[]), &incoming, &outgoing);
    assert_near(&found[14..15], &evaluate(&one, &values(&one, &[]), &incoming, &outgoing));
}

/// The printed share has one decimal at most: half of it is the rounding.
#[test]
fn area_shares_are_those_of_the_table() {
    let text = include_str!("../../src/bsdf/feather/barbs.csv");
    let rows: Vec<Vec<&str>> =
        text.lines().filter(|line| !line.starts_with('#')).skip(1).map(|line| line.split(',').collect()).collect();
    assert_eq!((rows.len(), BarbSpecies::all().len()), (46, 46));
    for (row, species) in rows.iter().zip(BarbSpecies::all()) {
        let printed: f64 = row[3].parse().unwrap();
        assert_eq!(row[0], species.name);
        let found = 100.0 * species.barb_share();
        assert!((found - printed).abs() <= 0.05 + 1e-9, "{}: found {found} %, printed {printed} %", species.name);

        let feather = feather(&FeatherDesign { species: Some(row[0].to_owned()), ..FeatherDesign::default() });
        let share = &feather.parameters()[0];
        assert!(share.name == "barb_share" && share.allows(share.default));
        assert_eq!(share.default.to_bits(), species.barb_share().to_bits());
    }
    assert_eq!(BarbSpecies::named("columba_livia").unwrap().name, "Columba livia");
}

#[test]
fn a_species_that_is_not_known_is_refused_with_the_nearest() {
    for (typed, parts) in [
        ("Anas creca", ["\"Anas creca\"", "Anas crecca"]),
        ("Columba", ["none of the 46 birds", "Columba livia"]),
        ("Archaeopteryx lithographica", ["from Accipiter gentilis to Cyanistes caeruleus", "set `barb_share`"]),
        ("", ["leave the key out", "none of the 46 birds"]),
    ] {
        let error =
            Feather::new(&FeatherDesign { species: Some(typed.to_owned()), ..FeatherDesign::default() }, &RGB_NM)
                .unwrap_err();
        assert!(matches!(error, ModelError::UnknownSpecies { .. }));
        for part in parts {
            assert!(error.to_string().contains(part), "{error} should say {part}");
        }
    }
}

#[test]
fn a_part_has_parameters_for_each_channel_where_it_says_so() {
    let design: FeatherDesign =
        toml::from_str("barb = { kind = \"cylinder\", per_channel = [\"sigma_a\"] }\nspecies = \"Bubo bubo\"").unwrap();
    let names: Vec<String> = feather(&design).parameters().iter().map(|parameter| parameter.name.clone()).collect();
    let expected = [
        "barb_share",
        "through_share",
        "barbule_angle_deg",
        "barb.eta",
        "barb.beta_m",
        "barb.beta_n",
        "barb.sigma_a_r",
        "barb.sigma_a_g",
        "barb.sigma_a_b",
        "barbule.eta",
        "barbule.beta_m",
        "barbule.beta_n",
        "barbule.sigma_a",
    ];
    assert_eq!(names, expected);
    assert!(toml::from_str::<FeatherDesign>("barb = { kind = \"cylinder\", per_chanel = [] }").is_err());
}

/// A slip inside a model is told by line and key, whatever its kind.
#[test]
fn a_slip_in_a_fibre_or_feather_is_told_in_words() {
    let plain = "kind = \"coated-base\"\n\
                 layers = [{ name = \"film\", material = \"keratin\", thickness_nm = 300 }]\n\
                 substrate = \"bird_melanin\"\n";
    for (model, parts) in [
        ("kind = \"cylinder\"\nlob = 1\n", ["line 16: model.lob", "there is no key `lob`", "did you mean `lobe`?"]),
        (
            "kind = \"spongy-barb\"\nlobe = \"logistic\"\n",
            ["line 16: model.lobe", "found `logistic`", "expected one of"],
        ),
        ("kind = \"feather\"\nspecie = 1\n", ["line 16: model.specie", "no key `specie`", "mean `species`"]),
        (
            "kind = \"feather\"\nbarb = { kind = \"cilinder\" }\n",
            ["line 16: model.barb", "`cilinder`", "mean `cylinder`"],
        ),
        (
            "kind = \"feather\"\nspecies = \"Corvus monedul\"\n",
            ["model: `species` is \"Corvus monedul\"", "the nearest", "Corvus monedula"],
        ),
    ] {
        Desk::with("slip.toml", film_with(plain, model)).barbule("check slip.toml").complains(&parts);
    }
}
