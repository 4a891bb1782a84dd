//! Azimuthal lobes averaged over the fibre's width, and with them the far field.
//!
//! Nₚ(φ) = ½ ∫₋₁¹ Aₚ(h) D(φ − Φₚ(h)) dh, with h = sinγ. Aₚ is even in γ, and Φₚ − pπ = ψₚ = 2pγt − 2γ is odd, so that
//!
//! Nₚ = ½ ∫₀^{π/2} Aₚ [D(xₚ − ψₚ) + D(xₚ + ψₚ)] cosγ dγ, xₚ = φ − pπ,
//!
//! and the costly Aₚ are computed on half of the width. In γ the integrand is analytic, up to the ends and through
//! grazing exits, except where a D is opposite its peak: the trimmed logistic has a kink there, at xₚ ∓ ψₚ = ±π.
//!
//! The quadrature is chosen for each pair of directions in two steps. [`kinks`] cuts the half-width where some lobe has
//! its kink, unless the kink is too weak to matter. [`PanelLengths`] then gives every panel its Gauss–Legendre rule, from
//! the two things that limit convergence: the poles of D, at height iπs in φ and therefore at least iπs/2 in γ (no ψₚ is
//! steeper than 2), and the branch point of cosγt, at sinγ = η', that is arcosh η' ≥ arcosh η above γ = π/2. All lobes share
//! the nodes. The error is below 1e-6 of the larger of the value and 1e-6 of the peak over azimuths, for βₙ from 0.05
//! to 1 and any angles; `tests/suite/cylinder.rs` measures it.
//!
//! N₃₊ is uniform, hence one mean of A₃₊ over the width; it has a pole of its own to mind, see [`WidthRule`].
//!
//! The lanes of a vector register run over nodes. They could run over channels, but three of these fill no register.

use std::f64::consts::{FRAC_1_PI, FRAC_PI_2, PI};

use super::FibreAngles;
use super::azimuthal::{Density, Halves, distance_around};
use super::quadrature::{Block, LANES, MOST_BLOCKS, PanelLengths, Rule, WIDTH_BLOCKS, WIDTH_RULE, WidthRule};
use super::surface::{Surface, SurfaceShares};
use crate::optics::elementary::{arc_sine_of_positive, exp_of_negative, sin_cos};

/// Most breaks that [`kinks`] can find, with the two ends.
const MOST_BREAKS: usize = 8;

/// What does not depend on the position across the fibre.
#[derive(Debug, Clone, Copy)]
pub(super) struct Refraction {
    pub(super) eta: f64,
    pub(super) cos_theta_o: f64,
    /// 1/η', so that sinγt = h/η'. It is 0 where the viewer looks along the fibre.
    pub(super) inverse_eta_prime: f64,
    /// Cosine of the inclination inside.
    pub(super) cos_theta_t: f64,
}

impl Refraction {
    /// sinθt = sinθo/η and η' = √(η² − sin²θo)/cosθo (Marschner et al. 2003, appendix B).
    pub(super) fn new(eta: f64, angles: &FibreAngles) -> Self {
        let root = (eta * eta - angles.sin_theta_o * angles.sin_theta_o).sqrt();
        Self {
            eta,
            cos_theta_o: angles.cos_theta_o,
            inverse_eta_prime: angles.cos_theta_o / root,
            cos_theta_t: root / eta,
        }
    }

    /// Meets the surface at γ between 0 and π/2.
    #[inline(always)]
    fn enter(&self, surface: &impl Surface, sin_gamma: f64, cos_gamma: f64) -> Entry {
        let sin_gamma_t = sin_gamma * self.inverse_eta_prime;
        let cos_gamma_t = (1.0 - sin_gamma_t * sin_gamma_t).sqrt();
        let shares = surface.meet(self.eta, self.cos_theta_o * cos_gamma, self.cos_theta_t * cos_gamma_t);
        Entry { sin_gamma_t, path: 2.0 * cos_gamma_t / self.cos_theta_t, shares }
    }

    /// ψₚ at an angle γ and its derivative.
    fn turn(&self, p: f64, gamma: f64) -> (f64, f64) {
        let (sin_gamma, cos_gamma) = gamma.sin_cos();
        let sin_gamma_t = sin_gamma * self.inverse_eta_prime;
        let cos_gamma_t = (1.0 - sin_gamma_t * sin_gamma_t).sqrt();
        let turn = 2.0 * p * sin_gamma_t.asin() - 2.0 * gamma;
        (turn, 2.0 * p * self.inverse_eta_prime * cos_gamma / cos_gamma_t - 2.0)
    }
}

/// What happens where a ray meets the fibre.
struct Entry {
    sin_gamma_t: f64,
    /// Length of one pass, in radii.
    path: f64,
    shares: SurfaceShares,
}

/// The far field of one group of channels that share their index: writes Σₚ Mₚ Nₚ to `values`, one a channel.
pub(super) struct FarField<'a, D, S> {
    pub(super) density: D,
    pub(super) surface: S,
    pub(super) panel_lengths: &'a PanelLengths,
    pub(super) refraction: Refraction,
    /// φ of the light minus that of the viewer, any real number.
    pub(super) phi: f64,
    /// Mₚ for R, TT, TRT, and for all that follow.
    pub(super) longitudinal: [f64; 4],
    /// Absorption in each channel, 1/radius.
    pub(super) sigma_a: &'a [f64],
    pub(super) values: &'a mut [f64],
}

impl<D: Density, S: Surface> pulp::NullaryFnOnce for FarField<'_, D, S> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let [m_reflected, m_once, m_twice, m_later] = self.longitudinal;
        self.values.fill(0.0);
        if m_later > 0.0 {
            let later = LaterPaths::new(&self.refraction, &self.surface, &WIDTH_RULE);
            for (value, &sigma_a) in self.values.iter_mut().zip(self.sigma_a) {
                *value = 0.5 * FRAC_1_PI * m_later * later.sum(sigma_a);
            }
        }

        let phi = (self.phi - (self.phi / (2.0 * PI)).round() * (2.0 * PI)).abs();
        let (breaks, break_count) = breaks(&self.refraction, phi, self.density.is_smooth_at_pi());
        for pair in breaks[..break_count].windows(2) {
            let (parts, rule) = self.panel_lengths.plan(pair[1] - pair[0]);
            let length = (pair[1] - pair[0]) / parts as f64;
            for part in 0..parts {
                let start = pair[0] + part as f64 * length;
                let middle = start + 0.5 * length;
                let active = match parts {
                    1 => [true; 3],
                    _ => active_lobes(&self.refraction, self.density, phi, middle, length),
                };
                if active == [false; 3] {
                    continue;
                }
                let panel = Panel::new(&self.refraction, &self.surface, rule, middle, 0.5 * length);
                let lobes = Lobes::new(&panel, self.density, phi, [m_reflected, m_once, m_twice], active);
                for (value, &sigma_a) in self.values.iter_mut().zip(self.sigma_a) {
                    *value += lobes.reflected + lobes.transmitted(sigma_a, &panel.path[..panel.blocks]);
                }
            }
        }
    }
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

/// The nodes of one panel: what neither lobes nor absorption change.
struct Panel {
    blocks: usize,
    /// 2γ.
    turn: [Block; MOST_BLOCKS],
    /// 2γt.
    turn_inside: [Block; MOST_BLOCKS],
    /// A₀ times the share of the fibre's width.
    reflected: [Block; MOST_BLOCKS],
    /// (1 − f)² times the share of the width, A₁ without absorption.
    entered: [Block; MOST_BLOCKS],
    /// (1 − f)² f times the share of the width, A₂ without absorption.
    entered_and_back: [Block; MOST_BLOCKS],
    /// Length of one pass, in radii.
    path: [Block; MOST_BLOCKS],
}

const NOTHING: Block = [0.0; LANES];

impl Panel {
    #[inline(always)]
    fn new(refraction: &Refraction, surface: &impl Surface, rule: &Rule, middle: f64, half_length: f64) -> Self {
        let mut panel = Self {
            blocks: rule.nodes.len(),
            turn: [NOTHING; MOST_BLOCKS],
            turn_inside: [NOTHING; MOST_BLOCKS],
            reflected: [NOTHING; MOST_BLOCKS],
            entered: [NOTHING; MOST_BLOCKS],
            entered_and_back: [NOTHING; MOST_BLOCKS],
            path: [NOTHING; MOST_BLOCKS],
        };
        for (block, (nodes, weights)) in rule.nodes.iter().zip(&rule.weights).enumerate() {
            for lane in 0..LANES {
                let gamma = middle + half_length * nodes[lane];
                let (sin_gamma, cos_gamma) = sin_cos(gamma);
                let entry = refraction.enter(surface, sin_gamma, cos_gamma);
                let shares = entry.shares;
                let weight = 0.5 * half_length * weights[lane] * cos_gamma;
                panel.turn[block][lane] = 2.0 * gamma;
                panel.turn_inside[block][lane] = 2.0 * arc_sine_of_positive(entry.sin_gamma_t);
                let entered = weight * shares.transmittance * shares.transmittance;
                panel.reflected[block][lane] = weight * shares.reflectance;
                panel.entered[block][lane] = entered;
                panel.entered_and_back[block][lane] = entered * shares.back;
                panel.path[block][lane] = entry.path;
            }
        }
        panel
    }
}

/// What the nodes of one panel contribute, all done but absorption: with T the transmittance of one pass, a node adds
/// reflected + T (once + T twice).
struct Lobes {
    reflected: f64,
    once: [Block; MOST_BLOCKS],
    twice: [Block; MOST_BLOCKS],
}

impl Lobes {
    #[inline(always)]
    fn new<D: Density>(panel: &Panel, density: D, phi: f64, longitudinal: [f64; 3], active: [bool; 3]) -> Self {
        let [m_reflected, m_once, m_twice] = longitudinal;
        let mut lobes = Self { reflected: 0.0, once: [NOTHING; MOST_BLOCKS], twice: [NOTHING; MOST_BLOCKS] };
        let blocks = panel.blocks.min(MOST_BLOCKS);
        let (near, opposite) = (density.halves(phi), density.halves(PI - phi));
        if active[0] {
            let mut reflected = NOTHING;
            for block in 0..blocks {
                for (lane, reflected) in reflected.iter_mut().enumerate() {
                    *reflected += panel.reflected[block][lane] * near.at(panel.turn[block][lane]);
                }
            }
            lobes.reflected = m_reflected * sum(reflected);
        }
        if active[1] {
            for block in 0..blocks {
                for lane in 0..LANES {
                    let turn = panel.turn[block][lane] - panel.turn_inside[block][lane];
                    lobes.once[block][lane] = m_once * panel.entered[block][lane] * opposite.at(turn);
                }
            }
        }
        if active[2] {
            for block in 0..blocks {
                for lane in 0..LANES {
                    let turn = (2.0 * panel.turn_inside[block][lane] - panel.turn[block][lane]).abs();
                    lobes.twice[block][lane] = m_twice * panel.entered_and_back[block][lane] * near.at(turn);
                }
            }
        }
        lobes
    }

    /// What has gone through the fibre, at this absorption.
    #[inline(always)]
    fn transmitted(&self, sigma_a: f64, path: &[Block]) -> f64 {
        let mut transmitted = NOTHING;
        for ((once, twice), path) in self.once.iter().zip(&self.twice).zip(path) {
            for lane in 0..LANES {
                let pass = exp_of_negative(-sigma_a * path[lane]);
                transmitted[lane] += pass * (once[lane] + pass * twice[lane]);
            }
        }
        sum(transmitted)
    }
}

/// Paths that are reflected inside twice or more, node by node over the width: each adds T³ entered / (1 − f T).
struct LaterPaths {
    entered: [Block; WIDTH_BLOCKS],
    /// f inside, and 1 − f.
    back: [Block; WIDTH_BLOCKS],
    not_back: [Block; WIDTH_BLOCKS],
    path: [Block; WIDTH_BLOCKS],
}

impl LaterPaths {
    #[inline(always)]
    fn new(refraction: &Refraction, surface: &impl Surface, rule: &WidthRule) -> Self {
        let nothing = [NOTHING; WIDTH_BLOCKS];
        let mut later = Self { entered: nothing, back: nothing, not_back: nothing, path: nothing };
        for block in 0..WIDTH_BLOCKS {
            for lane in 0..LANES {
                let entry = refraction.enter(surface, rule.sin_gamma[block][lane], rule.cos_gamma[block][lane]);
                let shares = entry.shares;
                let entered_and_back = shares.transmittance * shares.back;
                later.entered[block][lane] = rule.weights[block][lane] * entered_and_back * entered_and_back;
                later.back[block][lane] = shares.back;
                later.not_back[block][lane] = shares.not_back;
                later.path[block][lane] = entry.path;
            }
        }
        later
    }

    /// Mean of A₃₊ at this absorption.
    #[inline(always)]
    fn sum(&self, sigma_a: f64) -> f64 {
        let mut left = NOTHING;
        for block in 0..WIDTH_BLOCKS {
            for (lane, left) in left.iter_mut().enumerate() {
                let pass = exp_of_negative(-sigma_a * self.path[block][lane]);
                // 1 − f T without cancellation. It is 0 for a viewer along the fibre, where nothing enters: the smallest
                // number, far below the rounding of any other case, makes 0/0 a 0.
                let lost = self.not_back[block][lane] + self.back[block][lane] * (1.0 - pass);
                *left += self.entered[block][lane] * pass * pass * pass / (lost + f64::MIN_POSITIVE);
            }
        }
        sum(left)
    }
}

/// Sum of the eight lanes, always in the same order.
#[inline(always)]
fn sum([a, b, c, d, e, f, g, h]: Block) -> f64 {
    ((a + e) + (c + g)) + ((b + f) + (d + h))
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
