//! From starts to distinct minima.
//!
//! Starts are cheap and minima are few. Every start is run on the coarse problem, where there is one; what ends together is
//! one candidate; each candidate is then run on the full problem, and only those that can matter are settled to the last
//! digit. Where a parameter asks for a scan, the cost is first profiled along it, the others following in a few steps, and
//! every valley of that profile is one more start: linear parameters (a gain) are solved at each node, so that their
//! start values cannot hide a valley.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use super::curvature::Curvature;
use super::differences::{Accuracy, Bounds, Differences, Pattern};
use super::least_squares::Finish;
use super::local::{LocalFit, least_squares};
use super::minima::{Found, same};
use super::objective::{Objective, Point};
use super::outcome::{Settings, Solver, StopReason};
use super::smooth::{Method, bound_free, swarm};
use super::starts::spread;

/// Most nodes of one scan.
const MOST_NODES: usize = 2000;
/// Nodes of one scan that hand their values on from one to the next; the same for any number of threads.
const CHUNK: usize = 8;

/// Most iterations at one node of a scan.
const NODE: u64 = 8;
/// Most iterations of a start on the coarse problem.
const SCREENING: u64 = 30;
/// Most iterations on the full problem of a minimum that weighs nothing.
const LISTING: u64 = 1;

/// What the search found.
#[derive(Debug)]
pub(super) struct Survey {
    /// Distinct minima on the full problem, lowest cost first.
    pub(super) minima: Vec<Found>,
    /// Scanned parameters (position among the free ones) with the lowest cost at each node.
    pub(super) profiles: Vec<(usize, Vec<Point>)>,
    /// Number of starts tried.
    pub(super) starts: usize,
}

/// Bounds of a run of all free parameters.
pub(super) fn all_bounds(objective: &Objective<'_>) -> Bounds {
    let free = &objective.mapping.free;
    Bounds { lower: free.iter().map(|p| p.lower).collect(), upper: free.iter().map(|p| p.upper).collect() }
}

/// Finds the distinct minima.
pub(super) fn search(objective: &Objective<'_>, pattern: &Pattern, settings: &Settings) -> Survey {
    match settings.solver {
        Solver::LeastSquares => by_least_squares(objective, pattern, settings),
        Solver::LBfgs => by_bound_free(objective, pattern, settings, Method::LBfgs),
        Solver::NelderMead => by_bound_free(objective, pattern, settings, Method::NelderMead),
        Solver::ParticleSwarm => by_swarm(objective, pattern, settings),
    }
}

/// Every start by one of argmin's bound-free solvers, on the full problem.
fn by_bound_free(objective: &Objective<'_>, pattern: &Pattern, settings: &Settings, method: Method) -> Survey {
    let bounds = all_bounds(objective);
    let starts = spread(objective.mapping, settings.starts, settings.seed);
    let run = |start: &Vec<f64>| bound_free(objective, pattern, &bounds, start, method, settings.max_iterations);
    let ends = each(objective, &starts, run).into_iter().map(|end| (end, 1)).collect();
    Survey { minima: distinct(objective, pattern, &bounds, ends), profiles: Vec::new(), starts: starts.len() }
}

/// One swarm of as many particles as there are starts; its best point and the job's own start, polished.
fn by_swarm(objective: &Objective<'_>, pattern: &Pattern, settings: &Settings) -> Survey {
    let bounds = all_bounds(objective);
    let best = swarm(objective, pattern, &bounds, settings.starts, settings.seed, settings.max_iterations);
    let starts: Vec<Vec<f64>> = best.map(|point| point.free).into_iter().chain([objective.mapping.start()]).collect();
    let finish = Finish::Travelled(1e-6);
    let run = |start: &Vec<f64>| {
        least_squares(objective, Differences::new(pattern), &bounds, start, finish, settings.max_iterations)
    };
    let ends = each(objective, &starts, run).into_iter().map(|end| (end, 1)).collect();
    Survey { minima: distinct(objective, pattern, &bounds, ends), profiles: Vec::new(), starts: starts.len() }
}

/// Runs every start in parallel, with progress; in the order of the starts, without those that failed. Once interrupted
/// it begins no more of them, except the first, so that there is a best so far even then.
fn each<F>(objective: &Objective<'_>, starts: &[Vec<f64>], run: F) -> Vec<LocalFit>
where
    F: Fn(&Vec<f64>) -> Option<LocalFit> + Sync,
{
    let done = AtomicUsize::new(0);
    let watched = |(index, start): (usize, &Vec<f64>)| {
        if index > 0 && objective.control.interrupted() {
            return None;
        }
        let end = run(start);
        (objective.control.progress)(1 + done.fetch_add(1, Ordering::Relaxed), starts.len());
        end
    };
    starts.par_iter().enumerate().map(watched).collect::<Vec<_>>().into_iter().flatten().collect()
}

/// Profile, screening on the coarse problem, and the full problem for what is left.
fn by_least_squares(objective: &Objective<'_>, pattern: &Pattern, settings: &Settings) -> Survey {
    let bounds = all_bounds(objective);
    let coarse = if settings.starts > 1 { objective.residuals.coarse() } else { None };
    let screen = coarse.map(|residuals| objective.on(residuals));
    // Too few rows would make minima where there are none.
    let screen = screen.filter(|screen| screen.rows() >= 3 * objective.mapping.free.len());
    let screen_pattern = screen.as_ref().map(|screen| Pattern::new(screen, false));
    let (screening, screening_pattern) = match (&screen, &screen_pattern) {
        (Some(screen), Some(pattern)) => (screen, pattern),
        _ => (objective, pattern),
    };

    let mut starts = spread(objective.mapping, settings.starts, settings.seed);
    let mut profiles = Vec::new();
    if settings.starts > 1 {
        for (position, points) in profiles_of(screening, screening_pattern, &bounds) {
            starts.extend(valleys(&points));
            profiles.push((position, scaled(points, objective, screening)));
        }
    }

    let iterations = settings.max_iterations.min(if screen.is_some() { SCREENING } else { u64::MAX });
    let run = |start: &Vec<f64>| {
        let finish = Finish::Travelled(1e-3);
        least_squares(screening, Differences::new(screening_pattern), &bounds, start, finish, iterations)
    };
    let ends = each(objective, &starts, run);
    let ends = joined(screening, ends.into_iter().map(|end| (end, 1)).collect());
    let candidates = distinct(screening, screening_pattern, &bounds, ends);

    let lowest = candidates.first().map_or(f64::INFINITY, |candidate| candidate.cost);
    let finish = |candidate: &Found| {
        // What weighs nothing on the coarse problem is listed, but need not be known to the last digit.
        let (promise, iterations) = if screen.is_none() || matters(screening, lowest, candidate) {
            (1e-6, settings.max_iterations)
        } else {
            (1e-2, settings.max_iterations.min(LISTING))
        };
        let (start, finish) = (&candidate.free, Finish::Travelled(promise));
        let mut end = least_squares(objective, Differences::new(pattern), &bounds, start, finish, iterations)?;
        let mut path = candidate.path.clone();
        path.append(&mut end.path);
        Some((LocalFit { path, ..end }, candidate.hits))
    };
    let ends: Vec<(LocalFit, usize)> =
        candidates.par_iter().map(finish).collect::<Vec<_>>().into_iter().flatten().collect();
    let minima = distinct(objective, pattern, &bounds, ends);
    Survey { minima, profiles, starts: starts.len() }
}

/// σ of the readings, as far as the cost tells it.
pub(super) fn sigma(objective: &Objective<'_>, cost: f64) -> f64 {
    if objective.residuals.sigma_known() {
        return 1.0;
    }
    #[expect(clippy::cast_precision_loss, reason = "a number of rows is far below 2^53")]
    let freedom = objective.rows().saturating_sub(objective.mapping.free.len()).max(1) as f64;
    (cost / freedom).sqrt()
}

/// Whether a minimum can have any weight beside the lowest cost: exp(−50) is none.
pub(super) fn matters(objective: &Objective<'_>, lowest: f64, found: &Found) -> bool {
    #[expect(clippy::cast_precision_loss, reason = "a number of rows is far below 2^53")]
    let rows = objective.rows() as f64;
    let behind = if objective.residuals.sigma_known() {
        0.5 * (found.cost - lowest)
    } else {
        0.5 * rows * (found.cost / lowest.max(f64::MIN_POSITIVE)).ln()
    };
    behind < 50.0
}

/// Merges ends that had no time to converge with ends that they would have reached: those with no rise in between.
fn joined(objective: &Objective<'_>, mut ends: Vec<(LocalFit, usize)>) -> Vec<(LocalFit, usize)> {
    let mut values = vec![0.0; objective.residuals.parameters().len()];
    let mut rows = vec![0.0; objective.rows()];
    ends.sort_by(|a, b| a.0.cost.total_cmp(&b.0.cost));
    let mut kept: Vec<(LocalFit, usize)> = Vec::new();
    for (end, hits) in ends {
        let mut falls_to = |other: &LocalFit| {
            [0.25, 0.5, 0.75].iter().all(|share| {
                let between: Vec<f64> = end.free.iter().zip(&other.free).map(|(a, b)| a + share * (b - a)).collect();
                objective.evaluate(&between, &mut values, &mut rows) && objective.cost(&rows) <= end.cost
            })
        };
        let limited = end.stop == StopReason::Limit;
        match kept.iter_mut().find(|other| limited && falls_to(&other.0)) {
            Some(other) => other.1 += hits,
            None => kept.push((end, hits)),
        }
    }
    kept
}

/// Merges ends that are one minimum, lowest cost first.
fn distinct(
    objective: &Objective<'_>,
    pattern: &Pattern,
    bounds: &Bounds,
    mut ends: Vec<(LocalFit, usize)>,
) -> Vec<Found> {
    ends.sort_by(|a, b| a.0.cost.total_cmp(&b.0.cost));
    let mut minima: Vec<Found> = Vec::new();
    for (end, hits) in ends {
        let twin =
            |found: &&mut Found| same(&found.free, found.curvature.as_ref(), sigma(objective, found.cost), &end.free);
        if let Some(found) = minima.iter_mut().find(twin) {
            found.hits += hits;
            continue;
        }
        let mut differences = Differences::new(pattern);
        let curvature = Curvature::new(objective, &mut differences, bounds, &end.free, Accuracy::Travel);
        let LocalFit { free, cost, stop, path } = end;
        minima.push(Found { free, cost, stop, hits, path, curvature });
    }
    minima
}

/// The profile along each scanned parameter.
fn profiles_of(objective: &Objective<'_>, pattern: &Pattern, bounds: &Bounds) -> Vec<(usize, Vec<Point>)> {
    let free = &objective.mapping.free;
    let scanned = (0..free.len()).filter_map(|position| Some((position, free[position].scan_step?)));
    scanned.map(|(position, step)| (position, profile(objective, pattern, bounds, position, step))).collect()
}

/// The lowest cost at nodes `step` apart along one parameter.
fn profile(objective: &Objective<'_>, pattern: &Pattern, bounds: &Bounds, position: usize, step: f64) -> Vec<Point> {
    let (lower, upper) = super::starts::range(&objective.mapping.free[position]);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to a small positive count")]
    let nodes = (((upper - lower) / step).ceil().clamp(2.0, MOST_NODES as f64)) as usize + 1;
    #[expect(clippy::cast_precision_loss, reason = "a number of nodes is small")]
    let node = |k: usize| lower + (upper - lower) * (k as f64 / (nodes - 1) as f64);
    let chunks: Vec<usize> = (0..nodes).step_by(CHUNK).collect();
    // Each node begins where the last one ended, and anew: a chain alone would carry one wrong turn on to its end.
    let run = |&first: &usize| {
        let fresh = objective.mapping.start();
        let mut points: Vec<Point> = Vec::with_capacity(CHUNK);
        for k in first..(first + CHUNK).min(nodes) {
            let mut held = bounds.clone();
            (held.lower[position], held.upper[position]) = (node(k), node(k));
            let last = points.last().map(|point| point.free.clone());
            let ends = last.into_iter().chain([fresh.clone()]).filter_map(|mut start| {
                start[position] = node(k);
                least_squares(objective, Differences::new(pattern), &held, &start, Finish::Travelled(1e-2), NODE)
            });
            let lowest = ends.min_by(|a, b| a.cost.total_cmp(&b.cost));
            points.extend(lowest.map(|end| Point { free: end.free, cost: end.cost }));
        }
        points
    };
    chunks.par_iter().map(run).collect::<Vec<_>>().into_iter().flatten().collect()
}

/// Nodes of a profile that are lower than their neighbours.
fn valleys(points: &[Point]) -> Vec<Vec<f64>> {
    let cost = |k: Option<usize>| k.and_then(|k| points.get(k)).map_or(f64::INFINITY, |point| point.cost);
    let low = |&k: &usize| cost(Some(k)) <= cost(k.checked_sub(1)) && cost(Some(k)) < cost(Some(k + 1));
    (0..points.len()).filter(low).map(|k| points[k].free.clone()).collect()
}

/// Costs of the coarse problem as they would be of the full one.
fn scaled(mut points: Vec<Point>, full: &Objective<'_>, coarse: &Objective<'_>) -> Vec<Point> {
    #[expect(clippy::cast_precision_loss, reason = "a number of readings is far below 2^53")]
    let factor = full.readings as f64 / coarse.readings.max(1) as f64;
    for point in &mut points {
        point.cost *= factor;
    }
    points
}
