//! What the tests of several scattering models share: parameter values by name, random directions, integrals over them.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use barbule::bsdf::{Bsdf, Direction, Model};
use proptest::prelude::*;
use rayon::prelude::*;

/// Default channels of a picture.
pub(super) const RGB_NM: [f64; 3] = [645.0, 525.0, 445.0];

/// Values of a model's parameters by name; the others at their defaults.
pub(super) fn values(model: &dyn Model, changes: &[(&str, f64)]) -> Vec<f64> {
    let mut values: Vec<f64> = model.parameters().iter().map(|parameter| parameter.default).collect();
    for (name, value) in changes {
        let position = model.parameters().iter().position(|parameter| parameter.name == *name);
        values[position.unwrap_or_else(|| panic!("no parameter {name}"))] = *value;
    }
    model.check(&values).expect("the values are inside their bounds");
    values
}

/// One evaluation, bound for it alone.
pub(super) fn evaluate(model: &dyn Model, values: &[f64], incoming: &Direction, outgoing: &Direction) -> Vec<f64> {
    let mut found = vec![f64::NAN; model.channel_count()];
    model.bind(values).evaluate(incoming, outgoing, &mut found);
    found
}

pub(super) fn spherical(theta: f64, phi: f64) -> Direction {
    Direction::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos())
}

pub(super) fn any_direction_above() -> impl Strategy<Value = Direction> {
    (0.001..1.0f64, 0.0..TAU).prop_map(|(cosine, azimuth)| spherical(cosine.acos(), azimuth))
}

pub(super) fn any_direction() -> impl Strategy<Value = Direction> {
    (any_direction_above(), any::<bool>()).prop_map(|(direction, below)| if below { -direction } else { direction })
}

/// ∫ f |cosθo| dωo over the upper (or lower) half of the sphere, for light in the plane φ = 0 and a model of one
/// channel that is even in φ: midpoints in both angles. In φ that is exact for smooth periodic functions, in θ of
/// second order.
pub(super) fn directional_albedo(
    bound: &dyn Bsdf,
    incoming: &Direction,
    above: bool,
    (polar, azimuthal): (u32, u32),
) -> f64 {
    let (d_theta, d_phi) = (FRAC_PI_2 / f64::from(polar), PI / f64::from(azimuthal));
    let mut sum = 0.0;
    let mut value = [f64::NAN];
    for i in 0..polar {
        let theta = (f64::from(i) + 0.5) * d_theta;
        for j in 0..azimuthal {
            let mut outgoing = spherical(theta, (f64::from(j) + 0.5) * d_phi);
            if !above {
                outgoing.z = -outgoing.z;
            }
            bound.evaluate(incoming, &outgoing, &mut value);
            sum += value[0] * theta.cos() * theta.sin();
        }
    }
    2.0 * sum * d_theta * d_phi
}

/// ∫ f |n·ωi| dωi over the whole sphere at a fixed viewer for a model of one channel, midpoints in inclination and azimuth: second order in
/// the first, where f |n·ωi| = S has no kink, and exact for smooth functions in the second.
pub(super) fn furnace(model: &dyn Model, values: &[f64], outgoing: &Direction) -> f64 {
    let (polar, azimuthal) = (300, 300);
    let bound = model.bind(values);
    let ring = |i: i32| {
        let theta = (f64::from(i) + 0.5) * PI / f64::from(polar);
        let mut value = [f64::NAN];
        let at = |j: i32| {
            let incoming = spherical(theta, (f64::from(j) + 0.5) * TAU / f64::from(azimuthal));
            bound.evaluate(&incoming, outgoing, &mut value);
            value[0] * theta.cos().abs() * theta.sin()
        };
        (0..azimuthal).map(at).sum::<f64>()
    };
    let rings: Vec<f64> = (0..polar).into_par_iter().map(ring).collect();
    rings.iter().sum::<f64>() * (PI / f64::from(polar)) * (TAU / f64::from(azimuthal))
}

/// The largest directional albedo of a model of one channel over inclinations of the light from 0 to 89°, every degree.
/// With lobes no narrower than α 0.1 or exponent 130 it is right to 1e-3.
pub(super) fn largest_albedo(model: &dyn Model, values: &[f64]) -> f64 {
    let bound = model.bind(values);
    let albedos: Vec<f64> = (0..90)
        .into_par_iter()
        .map(|degrees| {
            directional_albedo(bound.as_ref(), &spherical(f64::from(degrees).to_radians(), 0.0), true, (300, 150))
        })
        .collect();
    albedos.into_iter().fold(0.0, f64::max)
}
