//! Azimuthal lobes averaged over the fibre's width, and with them the far field.
//!
//! Nₚ(φ) = ½ ∫₋₁¹ Aₚ(h) D(φ − Φₚ(h)) dh, with h = sinγ. Aₚ is even in γ, and Φₚ − pπ = ψₚ = 2pγt − 2γ is odd, so that
//!
//! Nₚ = ½ ∫₀^{π/2} Aₚ [D(xₚ − ψₚ) + D(xₚ + ψₚ)] cosγ dγ, xₚ = φ − pπ,
//!
//! and the costly Aₚ are computed on half of the width. In γ the integrand is analytic, up to the ends and through
//! grazing exits, except where a D is opposite its peak: the trimmed logistic has a kink there, at xₚ ∓ ψₚ = ±π. The
//! [panels](super::panels) of the quadrature mind both.
//!
//! N₃₊ is uniform, hence one mean of A₃₊ over the width; it has a pole of its own to mind, see [`WidthRule`].
//!
//! The lanes of a vector register run over nodes. They could run over channels, but three of these fill no register.

use std::f64::consts::{FRAC_1_PI, PI};

use super::azimuthal::Density;
use super::panels::panels;
use super::quadrature::{LANES, MOST_NODES, PanelLengths, Rule, WIDTH_NODES, WIDTH_RULE, WidthRule};
use super::surface::{Surface, SurfaceShares};
use crate::optics::elementary::{acute_angle, quick_exp_of_negative, sin_cos};

/// What does not depend on the position across the fibre.
#[derive(Debug, Clone, Copy)]
pub(super) struct Refraction {
    pub(super) eta: f64,
    pub(super) cos_theta_o: f64,
    /// 1/η', so that sinγt = h/η'. It is 0 where the viewer looks along the fibre.
    pub(super) inverse_eta_prime: f64,
    /// Cosine of the inclination inside.
    pub(super) cos_theta_t: f64,
    /// Length of a diameter that is passed at that inclination, in radii.
    pub(super) longest_path: f64,
}

impl Refraction {
    /// sinθt = sinθo/η and η' = √(η² − sin²θo)/cosθo (Marschner et al. 2003, appendix B).
    #[inline(always)]
    pub(super) fn new(eta: f64, sin_theta_o: f64, cos_theta_o: f64) -> Self {
        let root = (eta * eta - sin_theta_o * sin_theta_o).sqrt();
        let inverse = 1.0 / root;
        Self {
            eta,
            cos_theta_o,
            inverse_eta_prime: cos_theta_o * inverse,
            cos_theta_t: root / eta,
            longest_path: 2.0 * eta * inverse,
        }
    }

    /// Meets the surface at γ between 0 and π/2.
    #[inline(always)]
    pub(super) fn enter(&self, surface: &impl Surface, sin_gamma: f64, cos_gamma: f64) -> Entry {
        let sin_gamma_t = sin_gamma * self.inverse_eta_prime;
        let cos_gamma_t = (1.0 - sin_gamma_t * sin_gamma_t).sqrt();
        let shares = surface.meet(self.eta, self.cos_theta_o * cos_gamma, self.cos_theta_t * cos_gamma_t);
        Entry { sin_gamma_t, cos_gamma_t, path: self.longest_path * cos_gamma_t, shares }
    }

    /// ψₚ at an angle γ and its derivative.
    pub(super) fn turn(&self, p: f64, gamma: f64) -> (f64, f64) {
        let (sin_gamma, cos_gamma) = gamma.sin_cos();
        let sin_gamma_t = sin_gamma * self.inverse_eta_prime;
        let cos_gamma_t = (1.0 - sin_gamma_t * sin_gamma_t).sqrt();
        let turn = 2.0 * p * sin_gamma_t.asin() - 2.0 * gamma;
        (turn, 2.0 * p * self.inverse_eta_prime * cos_gamma / cos_gamma_t - 2.0)
    }
}

/// What happens where a ray meets the fibre.
pub(super) struct Entry {
    sin_gamma_t: f64,
    cos_gamma_t: f64,
    /// Length of one pass, in radii.
    pub(super) path: f64,
    pub(super) shares: SurfaceShares,
}

/// A node of the quadrature over the width: what neither lobes nor absorption change.
pub(super) struct Node {
    /// 2γ.
    turn: f64,
    /// 2γt.
    turn_inside: f64,
    /// A₀ times the share of the fibre's width.
    reflected: f64,
    /// (1 − f)² times the share of the width, A₁ without absorption.
    entered: f64,
    /// (1 − f)² f times the share of the width, A₂ without absorption.
    entered_and_back: f64,
    /// Length of one pass, in radii.
    pub(super) path: f64,
}

impl Node {
    /// At γ between 0 and π/2, standing for a range of `d_gamma`.
    #[inline(always)]
    pub(super) fn new(refraction: &Refraction, surface: &impl Surface, gamma: f64, d_gamma: f64) -> Self {
        let (sin_gamma, cos_gamma) = sin_cos(gamma);
        let entry = refraction.enter(surface, sin_gamma, cos_gamma);
        let shares = entry.shares;
        let weight = 0.5 * d_gamma * cos_gamma;
        let entered = weight * shares.transmittance * shares.transmittance;
        Self {
            turn: 2.0 * gamma,
            turn_inside: 2.0 * acute_angle(entry.sin_gamma_t, entry.cos_gamma_t),
            reflected: weight * shares.reflectance,
            entered,
            entered_and_back: entered * shares.back,
            path: entry.path,
        }
    }

    /// A₀ D of both halves of the fibre; `near` is [`Density::seen_from`] at φ.
    #[inline(always)]
    pub(super) fn reflected(&self, density: impl Density, near: [f64; 2]) -> f64 {
        self.reflected * density.both(near, self.turn)
    }

    /// A₁ D without absorption; `opposite` is [`Density::seen_from`] at π − φ.
    #[inline(always)]
    pub(super) fn once(&self, density: impl Density, opposite: [f64; 2]) -> f64 {
        self.entered * density.both(opposite, self.turn - self.turn_inside)
    }

    /// A₂ D without absorption.
    #[inline(always)]
    pub(super) fn twice(&self, density: impl Density, near: [f64; 2]) -> f64 {
        self.entered_and_back * density.both(near, (2.0 * self.turn_inside - self.turn).abs())
    }
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
        for panel in panels(&self.refraction, self.density, self.panel_lengths, phi) {
            let nodes = Panel::new(
                &self.refraction,
                &self.surface,
                Rule::numbered(panel.rule),
                panel.middle,
                panel.half_length,
            );
            let lobes = Lobes::new(&nodes, self.density, phi, [m_reflected, m_once, m_twice], panel.active);
            for (value, &sigma_a) in self.values.iter_mut().zip(self.sigma_a) {
                *value += lobes.reflected + lobes.transmitted(sigma_a, &nodes.path[..nodes.count]);
            }
        }
    }
}

/// The [nodes](Node) of one panel in lists of their own.
struct Panel {
    /// How many nodes there are; the rest of each list is not used.
    count: usize,
    turn: [f64; MOST_NODES],
    turn_inside: [f64; MOST_NODES],
    reflected: [f64; MOST_NODES],
    entered: [f64; MOST_NODES],
    entered_and_back: [f64; MOST_NODES],
    path: [f64; MOST_NODES],
}

const NOTHING: [f64; MOST_NODES] = [0.0; MOST_NODES];

impl Panel {
    #[inline(always)]
    fn new(refraction: &Refraction, surface: &impl Surface, rule: &Rule, middle: f64, half_length: f64) -> Self {
        let (nodes, weights) = (rule.nodes.as_slice(), rule.weights.as_slice());
        let count = nodes.len().min(weights.len()).min(MOST_NODES);
        let mut panel = Self {
            count,
            turn: NOTHING,
            turn_inside: NOTHING,
            reflected: NOTHING,
            entered: NOTHING,
            entered_and_back: NOTHING,
            path: NOTHING,
        };
        for k in 0..count {
            let node = Node::new(refraction, surface, middle + half_length * nodes[k], half_length * weights[k]);
            panel.turn[k] = node.turn;
            panel.turn_inside[k] = node.turn_inside;
            panel.reflected[k] = node.reflected;
            panel.entered[k] = node.entered;
            panel.entered_and_back[k] = node.entered_and_back;
            panel.path[k] = node.path;
        }
        panel
    }

    #[inline(always)]
    fn node(&self, k: usize) -> Node {
        Node {
            turn: self.turn[k],
            turn_inside: self.turn_inside[k],
            reflected: self.reflected[k],
            entered: self.entered[k],
            entered_and_back: self.entered_and_back[k],
            path: self.path[k],
        }
    }
}

/// What the nodes of one panel contribute, all done but absorption: with T the transmittance of one pass, a node adds
/// reflected + T (once + T twice).
struct Lobes {
    reflected: f64,
    once: [f64; MOST_NODES],
    twice: [f64; MOST_NODES],
}

impl Lobes {
    #[inline(always)]
    fn new<D: Density>(panel: &Panel, density: D, phi: f64, longitudinal: [f64; 3], active: [bool; 3]) -> Self {
        let [m_reflected, m_once, m_twice] = longitudinal;
        let mut lobes = Self { reflected: 0.0, once: NOTHING, twice: NOTHING };
        let count = panel.count.min(MOST_NODES);
        let (near, opposite) = (density.seen_from(phi), density.seen_from(PI - phi));
        if active[0] {
            let mut reflected = NOTHING;
            for (k, reflected) in reflected[..count].iter_mut().enumerate() {
                *reflected = panel.node(k).reflected(density, near);
            }
            lobes.reflected = m_reflected * sum(&reflected[..count]);
        }
        if active[1] {
            for k in 0..count {
                lobes.once[k] = m_once * panel.node(k).once(density, opposite);
            }
        }
        if active[2] {
            for k in 0..count {
                lobes.twice[k] = m_twice * panel.node(k).twice(density, near);
            }
        }
        lobes
    }

    /// What has gone through the fibre, at this absorption.
    #[inline(always)]
    fn transmitted(&self, sigma_a: f64, path: &[f64]) -> f64 {
        let mut transmitted = NOTHING;
        let count = path.len().min(MOST_NODES);
        for node in 0..count {
            let pass = quick_exp_of_negative(-sigma_a * path[node]);
            transmitted[node] = pass * (self.once[node] + pass * self.twice[node]);
        }
        sum(&transmitted[..count])
    }
}

/// Paths that are reflected inside twice or more, from one node over the width: they add T³ entered / (1 − f T).
#[derive(Clone, Copy)]
pub(super) struct LaterPath {
    pub(super) entered: f64,
    /// f inside, and 1 − f.
    pub(super) back: f64,
    pub(super) not_back: f64,
    pub(super) path: f64,
}

impl LaterPath {
    #[inline(always)]
    pub(super) fn new(
        refraction: &Refraction,
        surface: &impl Surface,
        sin_gamma: f64,
        cos_gamma: f64,
        weight: f64,
    ) -> Self {
        let entry = refraction.enter(surface, sin_gamma, cos_gamma);
        let shares = entry.shares;
        let entered_and_back = shares.transmittance * shares.back;
        Self {
            entered: weight * entered_and_back * entered_and_back,
            back: shares.back,
            not_back: shares.not_back,
            path: entry.path,
        }
    }

    /// A₃₊ at this absorption, times the share of the width.
    #[inline(always)]
    pub(super) fn left(self, sigma_a: f64) -> f64 {
        let pass = quick_exp_of_negative(-sigma_a * self.path);
        // 1 − f T without cancellation. It is 0 for a viewer along the fibre, where nothing enters: the smallest
        // number, far below the rounding of any other case, makes 0/0 a 0.
        let lost = self.not_back + self.back * (1.0 - pass);
        self.entered * pass * pass * pass / (lost + f64::MIN_POSITIVE)
    }
}

/// [`LaterPath`] of every node in lists of their own.
struct LaterPaths {
    entered: [f64; WIDTH_NODES],
    back: [f64; WIDTH_NODES],
    not_back: [f64; WIDTH_NODES],
    path: [f64; WIDTH_NODES],
}

impl LaterPaths {
    #[inline(always)]
    fn new(refraction: &Refraction, surface: &impl Surface, rule: &WidthRule) -> Self {
        let nothing = [0.0; WIDTH_NODES];
        let mut later = Self { entered: nothing, back: nothing, not_back: nothing, path: nothing };
        for k in 0..WIDTH_NODES {
            let node = LaterPath::new(refraction, surface, rule.sin_gamma[k], rule.cos_gamma[k], rule.weights[k]);
            later.entered[k] = node.entered;
            later.back[k] = node.back;
            later.not_back[k] = node.not_back;
            later.path[k] = node.path;
        }
        later
    }

    /// Mean of A₃₊ at this absorption.
    #[inline(always)]
    fn sum(&self, sigma_a: f64) -> f64 {
        let mut left = [0.0; WIDTH_NODES];
        for k in 0..WIDTH_NODES {
            let Self { entered, back, not_back, path } = self;
            let node = LaterPath { entered: entered[k], back: back[k], not_back: not_back[k], path: path[k] };
            left[k] = node.left(sigma_a);
        }
        sum(&left)
    }
}

/// Sum of whole blocks of eight, always in the same order.
#[inline(always)]
fn sum(values: &[f64]) -> f64 {
    let mut lanes = [0.0; LANES];
    for block in values.as_chunks::<LANES>().0 {
        for (lane, value) in lanes.iter_mut().zip(block) {
            *lane += value;
        }
    }
    let [a, b, c, d, e, f, g, h] = lanes;
    ((a + e) + (c + g)) + ((b + f) + (d + h))
}
