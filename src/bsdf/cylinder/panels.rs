//! The panels of γ over which the far field is integrated.
//!
//! They are chosen for each pair of directions in two steps. [`kinks`] cuts the half-width where some lobe has
//! its kink, unless the kink is too weak to matter. [`PanelLengths`] then gives every panel its Gauss–Legendre rule, from
//! the two things that limit convergence: the poles of D, at height iπs in φ and therefore at least iπs/2 in γ (no ψₚ is
//! steeper than 2), and the branch point of cosγt, at sinγ = η', that is arcosh η' ≥ arcosh η above γ = π/2. All lobes share
//! the nodes. The error is below 1e-6 of the larger of the value and 1e-6 of the peak over azimuths, for βₙ from 0.05
//! to 1 and any angles; `tests/suite/cylinder.rs` measures it.

use std::f64::consts::{FRAC_PI_2, PI};

use super::azimuthal::{Density, distance_around};
use super::far_field::Refraction;
use super::quadrature::PanelLengths;

/// Most breaks that [`kinks`] can find, with the two ends.
const MOST_BREAKS: usize = 8;

/// A range of γ over which one rule integrates.
#[derive(Debug, Clone, Copy)]
pub(super) struct PanelPlan {
    pub(super) middle: f64,
    pub(super) half_length: f64,
    /// Number of the [rule](super::quadrature::Rule).
    pub(super) rule: usize,
    /// Which of R, TT and TRT add anything.
    pub(super) active: [bool; 3],
}

/// The panels between γ = 0 and π/2 in which some lobe adds anything; `phi` between 0 and π.
pub(super) fn panels<D: Density>(
    refraction: &Refraction,
    density: D,
    panel_lengths: &PanelLengths,
    phi: f64,
) -> impl Iterator<Item = PanelPlan> {
    let (breaks, break_count) = breaks(refraction, phi, density.is_smooth_at_pi());
    (1..break_count).flat_map(move |k| {
        let (start, end) = (breaks[k - 1], breaks[k]);
        let (parts, rule) = panel_lengths.plan(end - start);
        let length = (end - start) / parts as f64;
        (0..parts).filter_map(move |part| {
            let middle = start + part as f64 * length + 0.5 * length;
            let active = match parts {
                1 => [true; 3],
                _ => active_lobes(refraction, density, phi, middle, length),
            };
            (active != [false; 3]).then_some(PanelPlan { middle, half_length: 0.5 * length, rule, active })
        })
    })
}

/// Which of R, TT and TRT a panel around `middle` adds anything to. No ψₚ is steeper than 2.
fn active_lobes<D: Density>(refraction: &Refraction, density: D, phi: f64, middle: f64, length: f64) -> [bool; 3] {
    let reach = density.reach() + length;
    std::array::from_fn(|p| {
        let p = p as f64;
        let (turn, _) = refraction.turn(p, middle);
        let x = phi - (p % 2.0) * PI;
        distance_around(x - turn).min(distance_around(x + turn)) < reach
    })
}

/// The ends of the panels between γ = 0 and π/2, ascending, and how many they are; `phi` between 0 and π.
fn breaks(refraction: &Refraction, phi: f64, smooth_at_pi: bool) -> ([f64; MOST_BREAKS], usize) {
    let mut breaks = [0.0; MOST_BREAKS];
    let mut count = 1;
    if !smooth_at_pi {
        kinks(refraction, phi, |gamma| {
            breaks[count] = gamma;
            count += 1;
        });
        breaks[1..count].sort_unstable_by(f64::total_cmp);
    }
    breaks[count] = FRAC_PI_2;
    (breaks, count + 1)
}

/// Calls `found` with every γ at which some lobe's D is opposite its peak: |ψ₀| = π − φ, |ψ₁| = φ, |ψ₂| = π − φ.
fn kinks(refraction: &Refraction, phi: f64, mut found: impl FnMut(f64)) {
    let inside = |gamma: f64| gamma > 0.0 && gamma < FRAC_PI_2;

    // R: ψ₀ = −2γ.
    let reflected = 0.5 * (PI - phi);
    if inside(reflected) {
        found(reflected);
    }

    // TT: γt = γ − φ/2 in sinγ = η' sinγt.
    let (half_sine, half_cosine) = (0.5 * phi).sin_cos();
    let once = half_sine.atan2(half_cosine - refraction.inverse_eta_prime);
    if inside(once) {
        found(once);
    }

    // TRT: ψ₂ rises from 0 to the caustic, if there is one before γ = 0, and falls from there on.
    let target = PI - phi;
    let caustic = caustic(refraction);
    let (highest, last) = (refraction.turn(2.0, caustic).0, refraction.turn(2.0, FRAC_PI_2).0);
    if target > 0.0 && target < highest {
        found(crossing(refraction, target, 0.0, caustic));
    }
    if target < highest && target > last {
        found(crossing(refraction, target, caustic, FRAC_PI_2));
    }
    if -target < highest && -target > last {
        found(crossing(refraction, -target, caustic, FRAC_PI_2));
    }
}

/// Where ψ₂ turns round: sin²γ = (4 − η'²)/3, or 0 for η' ≥ 2 (Marschner et al. 2003, section 5.2.2).
fn caustic(refraction: &Refraction) -> f64 {
    let squared = refraction.inverse_eta_prime * refraction.inverse_eta_prime;
    let sine_squared = (4.0 * squared - 1.0) / (3.0 * squared);
    if sine_squared > 0.0 { sine_squared.min(1.0).sqrt().asin() } else { 0.0 }
}

/// The γ between two ends, ψ₂ monotone between them, where ψ₂ is `target`: Newton's method kept inside its bracket.
///
/// A break that is off by 1e-7 moves the integral by a hundredth of a millionth of the kink, so that is where it stops.
fn crossing(refraction: &Refraction, target: f64, mut low: f64, mut high: f64) -> f64 {
    let rising = refraction.turn(2.0, low).0 < target;
    let mut gamma = 0.5 * (low + high);
    for _ in 0..40 {
        let (turn, slope) = refraction.turn(2.0, gamma);
        if (turn < target) == rising {
            low = gamma;
        } else {
            high = gamma;
        }
        let newton = gamma - (turn - target) / slope;
        let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        if (next - gamma).abs() < 1e-7 {
            return next;
        }
        gamma = next;
    }
    gamma
}
