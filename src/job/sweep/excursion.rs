//! One parameter at a time over its whole range.

use rayon::prelude::*;

use super::colour::ColourMaker;
use super::forward::Forward;
use super::outcome::{Excursion, Own};
use crate::job::JobError;
use crate::parameter::Spread;

/// Values over a range: fine enough to show the fringes of a film of some ten orders.
const POINTS: u32 = 257;

/// A value at a share of a range, 0 to 1.
pub(super) fn place([lower, upper]: [f64; 2], spread: Spread, share: f64) -> f64 {
    let value = match spread {
        Spread::Linear => lower + share * (upper - lower),
        Spread::Logarithmic => lower * (upper / lower).powf(share),
    };
    value.clamp(lower, upper)
}

/// The share of a range at which a value lies; beyond 0 to 1, or no number, where it lies outside.
fn share([lower, upper]: [f64; 2], spread: Spread, value: f64) -> f64 {
    match spread {
        Spread::Linear => (value - lower) / (upper - lower),
        Spread::Logarithmic => (value / lower).ln() / (upper / lower).ln(),
    }
}

/// Moves parameter `index` over its range.
pub(super) fn excursion(
    forward: &Forward,
    colours: &ColourMaker,
    exposure: f64,
    own: &Own,
    index: usize,
    (range, spread): ([f64; 2], Spread),
) -> Result<Excursion, JobError> {
    let point = |point: u32| f64::from(point) / f64::from(POINTS - 1);
    let mut points: Vec<(f64, f64)> =
        (0..POINTS).map(point).map(|share| (share, place(range, spread, share))).collect();
    // The job's own value too, where it lies inside: there the difference is 0.
    let own_share = share(range, spread, forward.own[index]);
    if (0.0..=1.0).contains(&own_share) {
        let after = points.partition_point(|(share, _)| *share < own_share);
        points.insert(after, (own_share, forward.own[index]));
    }
    let (shares, values): (Vec<f64>, Vec<f64>) = points.into_iter().unzip();
    let at_values: Vec<_> = values.par_iter().map(|value| forward.readings(&[(index, *value)])).collect();
    let mut differences = vec![Vec::new(); own.colours.len()];
    let mut changes = vec![Vec::new(); forward.views.len()];
    for readings in at_values {
        let readings = readings.map_err(|refusal| refusal.at("sweep"))?;
        for (number, (view, readings)) in forward.views.iter().zip(&readings).enumerate() {
            changes[number].push(root_mean_square(readings, &own.readings[number]));
            if let Some(colour) = colours.colour(view, forward.quantity, readings, exposure) {
                differences[number].push(colour.lab.delta_e_2000(own.colours[number].lab));
            }
        }
    }
    let parameter = forward.parameters()[index].clone();
    Ok(Excursion { parameter, own: forward.own[index], shares, values, spread, differences, changes })
}

#[expect(clippy::cast_precision_loss, reason = "a number of wavelengths")]
fn root_mean_square(readings: &[f64], own: &[f64]) -> f64 {
    let squares: f64 = readings.iter().zip(own).map(|(a, b)| (a - b).powi(2)).sum();
    (squares / readings.len() as f64).sqrt()
}
