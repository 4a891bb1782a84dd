//! Fibres and what holds fibres, for many pairs of directions at a time against one at a time.

use barbule::bsdf::cylinder::{
    AzimuthalLobe, Cylinder, CylinderDesign, CylinderModel, CylinderParameters, LongitudinalMapping,
};
use barbule::bsdf::{Bsdf, Direction, Feather, FeatherDesign, Model, Oriented};
use proptest::prelude::*;

use super::directions::{RGB_NM, any_direction, values};

/// Largest |S found − S expected| over S expected, in directions where S, |n·ωi| f, is above `floor` of the largest value seen; 0
/// for pairs whose light lies in the surface, and for those along the fibre, whose azimuth is whatever it is taken to be. Below
/// 1e-280 exponentials are cut off.
fn worst_difference(bsdf: &dyn Bsdf, pairs: &[(Direction, Direction)], channels: usize, floor: f64) -> f64 {
    let (incoming, outgoing): (Vec<Direction>, Vec<Direction>) = pairs.iter().copied().unzip();
    let mut found = vec![f64::NAN; channels * pairs.len()];
    bsdf.evaluate_many(&incoming, &outgoing, &mut found);
    let mut expected = vec![f64::NAN; found.len()];
    for ((i, o), expected) in pairs.iter().zip(expected.chunks_exact_mut(channels)) {
        bsdf.evaluate(i, o, expected);
    }
    let cosine = |k: usize| pairs[k / channels].0.z.abs();
    let largest = expected.iter().enumerate().map(|(k, value)| value * cosine(k)).fold(0.0, f64::max);
    found
        .iter()
        .zip(&expected)
        .enumerate()
        .map(|(k, (found, expected))| {
            let (i, o) = &pairs[k / channels];
            assert!(found.is_finite() && *found >= 0.0, "{i:?} {o:?}: {found} instead of {expected}");
            if i.yz().norm() * o.yz().norm() == 0.0 {
                return 0.0;
            }
            (found - expected).abs() * cosine(k) / (expected * cosine(k)).max(floor * largest).max(1e-280)
        })
        .fold(0.0, f64::max)
}

/// Directions along the fibre, across it, in the surface and beside these: where a product of cosines is 0, or nearly.
fn edges() -> Vec<(Direction, Direction)> {
    let directions = [
        Direction::x(),
        -Direction::x(),
        Direction::y(),
        Direction::z(),
        -Direction::z(),
        Direction::new(1.0, 1e-9, 0.0),
        Direction::new(-1.0, 0.0, 1e-100),
        Direction::new(0.6, 0.0, 0.8),
        Direction::new(-0.6, 0.8, 0.0),
        Direction::new(0.0, 1e-12, 1.0),
    ];
    directions.iter().flat_map(|i| directions.iter().map(move |o| (*i, *o))).collect()
}

fn any_pairs() -> impl Strategy<Value = Vec<(Direction, Direction)>> {
    prop::collection::vec((any_direction(), any_direction()), 1..300)
}

fn any_lobe() -> impl Strategy<Value = AzimuthalLobe> {
    prop_oneof![Just(AzimuthalLobe::TrimmedLogistic), Just(AzimuthalLobe::WrappedGaussian)]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    /// The azimuth of a pair is good to 1e-11. A lobe's logarithm changes by at most 1/s times that, s > 0.003, and by
    /// twice as much twice over: 1e-8.
    #[test]
    fn cylinder(
        eta in prop_oneof![Just(1.05), 1.05..3.0],
        sigma_a in prop_oneof![Just(0.0), Just(20.0), 0.0..2.0],
        (beta_m, beta_n) in (0.02..1.0, prop_oneof![Just(0.05), Just(0.9), 0.02..1.0]),
        lobe in any_lobe(),
        pairs in any_pairs(),
    ) {
        // The first two channels share their index.
        let parameters = CylinderParameters {
            eta: vec![eta, eta, 1.55],
            sigma_a: vec![sigma_a, 0.5, 0.1],
            beta_m,
            beta_n,
            mapping: LongitudinalMapping::Chiang,
            lobe,
        };
        let cylinder = Cylinder::new(&parameters).unwrap();
        let worst = worst_difference(&cylinder, &pairs, 3, 0.0);
        prop_assert!(worst < 1e-8, "{worst:e}");
        let worst = worst_difference(&cylinder, &edges(), 3, 0.0);
        prop_assert!(worst < 1e-8, "at the edges: {worst:e}");
    }

    /// Turned by a tangent of its own, and as parts of a feather; the same bound.
    #[test]
    fn oriented_cylinder_and_feather(tangent_deg in -90.0..90.0, barbule_angle_deg in 0.0..90.0, pairs in any_pairs()) {
        let oriented = Oriented::new(Box::new(CylinderModel::new(&CylinderDesign::default(), &RGB_NM).unwrap()));
        let worst = worst_difference(&*oriented.bind(&values(&oriented, &[("tangent_deg", tangent_deg)])), &pairs, 3, 0.0);
        prop_assert!(worst < 1e-8, "oriented: {worst:e}");

        let feather = Feather::new(&FeatherDesign::default(), &RGB_NM).unwrap();
        let changes = [("barbule_angle_deg", barbule_angle_deg), ("through_share", 0.1), ("barb.sigma_a", 1.0)];
        let worst = worst_difference(&*feather.bind(&values(&feather, &changes)), &pairs, 3, 0.0);
        prop_assert!(worst < 1e-8, "feather: {worst:e}");
    }
}

/// The table's cells are found in single precision, which moves a place by 6e-8 of a step.
#[test]
fn tabulated_cylinder() {
    for (lobe, sigma_a) in
        [(AzimuthalLobe::TrimmedLogistic, vec![0.0, 0.2, 2.0]), (AzimuthalLobe::WrappedGaussian, vec![0.3; 6])]
    {
        let cylinder = Cylinder::new(&CylinderParameters {
            eta: vec![1.55; sigma_a.len()],
            sigma_a,
            beta_m: 0.3,
            beta_n: 0.5,
            mapping: LongitudinalMapping::Chiang,
            lobe,
        })
        .unwrap();
        let table = cylinder.tabulate(1e-2);
        proptest!(ProptestConfig::with_cases(8), |(mut pairs in any_pairs())| {
            pairs.extend(edges());
            let worst = worst_difference(&table, &pairs, cylinder.channel_count(), 1e-3);
            prop_assert!(worst < 1e-5, "{worst:e}");
        });
    }
}
