//! The far field for many pairs of directions at a time, everything computed afresh, as a fit wants it.
//!
//! Lanes are panels of the quadrature, not its nodes: panels of any pairs that take the same rule are worked on together. The nodes
//! and what is done at each are those of [`super::far_field`], so that the values differ little: the azimuth of a pair is good to 1e-11. Nothing is
//! added up across lanes, no register is left half empty, and what stands before and after the quadrature, angles and
//! longitudinal lobes, is done in lanes too.

use std::f64::consts::{FRAC_1_PI, PI};

use super::azimuthal::Density;
use super::far_field::{LaterPath, Node, Refraction};
use super::pairs::{Lanes, PAIRS, PairAngles};
use super::panels::{PanelPlan, panels};
use super::quadrature::{LANES, PanelLengths, RULE_COUNT, Rule, WIDTH_NODES, WIDTH_RULE, WidthRule};
use super::surface::{BareSurface, Surface};
use super::{Cylinder, Lobe};
use crate::bsdf::Direction;
use crate::optics::elementary::quick_exp_of_negative;

/// Blocks of pairs whose panels are pooled, so that few lanes are idle.
const BLOCKS: usize = 4;

const NOTHING: Lanes = [0.0; PAIRS];

/// So many lanes, the last register filled up: a block that is not full costs what it holds.
fn whole_registers(count: usize) -> usize {
    count.next_multiple_of(LANES)
}

/// [`crate::bsdf::Bsdf::evaluate_many`] of a cylinder.
pub(super) fn evaluate(cylinder: &Cylinder, incoming: &[Direction], outgoing: &[Direction], values: &mut [f64]) {
    let channels = cylinder.channel_count();
    assert_eq!(incoming.len(), outgoing.len(), "directions come in pairs");
    assert_eq!(values.len(), incoming.len() * channels, "one value a pair and channel");
    let arch = pulp::Arch::new();
    match cylinder.lobe {
        Lobe::Logistic(density) => arch.dispatch(Pairs { cylinder, density, incoming, outgoing, values }),
        Lobe::Narrow(density) => arch.dispatch(Pairs { cylinder, density, incoming, outgoing, values }),
        Lobe::Gaussian(density) => arch.dispatch(Pairs { cylinder, density, incoming, outgoing, values }),
    }
}

/// The loop over pools of pairs, in the form in which it is compiled once for each instruction set.
struct Pairs<'a, D> {
    cylinder: &'a Cylinder,
    density: D,
    incoming: &'a [Direction],
    outgoing: &'a [Direction],
    values: &'a mut [f64],
}

impl<D: Density> pulp::NullaryFnOnce for Pairs<'_, D> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { cylinder, density, incoming, outgoing, values } = self;
        let channels = cylinder.channel_count();
        values.fill(0.0);
        let pools = incoming.chunks(BLOCKS * PAIRS).zip(outgoing.chunks(BLOCKS * PAIRS));
        for ((incoming, outgoing), values) in pools.zip(values.chunks_mut(BLOCKS * PAIRS * channels)) {
            // Loops, since the body of a closure would not be compiled for the instruction set of this function.
            let (mut angles, mut longitudinal) = (Vec::with_capacity(BLOCKS), Vec::with_capacity(BLOCKS));
            for (incoming, outgoing) in incoming.chunks(PAIRS).zip(outgoing.chunks(PAIRS)) {
                let block = PairAngles::new(incoming, outgoing);
                longitudinal.push(cylinder.longitudinal.of_pairs(&block));
                angles.push(block);
            }
            let mut first_channel = 0;
            for group in &cylinder.groups {
                let mut fibre = Fibre {
                    density,
                    surface: BareSurface,
                    eta: group.eta,
                    sigma_a: &group.sigma_a,
                    panel_lengths: &group.panel_lengths,
                    channels,
                    first_channel,
                    sums: vec![NOTHING; group.sigma_a.len()],
                };
                fibre.add(&angles, &longitudinal, values);
                first_channel += group.sigma_a.len();
            }
            for (values, pair) in values.chunks_exact_mut(channels).zip(0..) {
                let inverse_cosine = angles[pair / PAIRS].inverse_cosine[pair % PAIRS];
                for value in values {
                    *value *= inverse_cosine;
                }
            }
        }
    }
}

/// Channels that share their angles and their surface.
struct Fibre<'a, D, S> {
    density: D,
    surface: S,
    eta: f64,
    /// Absorption in each channel, 1/radius.
    sigma_a: &'a [f64],
    panel_lengths: &'a PanelLengths,
    /// Channels of a pair's values, and the first of them that is this fibre's.
    channels: usize,
    first_channel: usize,
    /// What has been added up for each channel.
    sums: Vec<Lanes>,
}

/// What panels need to know of a block of pairs.
struct PairOptics {
    inverse_eta_prime: Lanes,
    cos_theta_o: Lanes,
    cos_theta_t: Lanes,
    longest_path: Lanes,
    /// [`Density::seen_from`] at φ.
    near: [Lanes; 2],
    /// [`Density::seen_from`] at π − φ.
    opposite: [Lanes; 2],
    /// Mₚ for R, TT and TRT.
    longitudinal: [Lanes; 3],
}

impl PairOptics {
    #[inline(always)]
    fn new(eta: f64, density: impl Density, angles: &PairAngles, longitudinal: &[Lanes; 3]) -> Self {
        let mut optics = Self::nothing();
        optics.longitudinal = *longitudinal;
        for pair in 0..PAIRS {
            let refraction = Refraction::new(eta, angles.sin_theta_o[pair], angles.cos_theta_o[pair]);
            optics.inverse_eta_prime[pair] = refraction.inverse_eta_prime;
            optics.cos_theta_o[pair] = refraction.cos_theta_o;
            optics.cos_theta_t[pair] = refraction.cos_theta_t;
            optics.longest_path[pair] = refraction.longest_path;
            [optics.near[0][pair], optics.near[1][pair]] = density.seen_from(angles.phi[pair]);
            [optics.opposite[0][pair], optics.opposite[1][pair]] = density.seen_from(PI - angles.phi[pair]);
        }
        optics
    }

    #[inline(always)]
    fn nothing() -> Self {
        Self {
            inverse_eta_prime: NOTHING,
            cos_theta_o: NOTHING,
            cos_theta_t: NOTHING,
            longest_path: NOTHING,
            near: [NOTHING; 2],
            opposite: [NOTHING; 2],
            longitudinal: [NOTHING; 3],
        }
    }

    #[inline(always)]
    fn refraction(&self, eta: f64, pair: usize) -> Refraction {
        Refraction {
            eta,
            cos_theta_o: self.cos_theta_o[pair],
            inverse_eta_prime: self.inverse_eta_prime[pair],
            cos_theta_t: self.cos_theta_t[pair],
            longest_path: self.longest_path[pair],
        }
    }

    /// Writes the numbers of one pair into one lane of `panels`.
    #[inline(always)]
    fn copy(&self, pair: usize, panels: &mut Self, lane: usize) {
        panels.inverse_eta_prime[lane] = self.inverse_eta_prime[pair];
        panels.cos_theta_o[lane] = self.cos_theta_o[pair];
        panels.cos_theta_t[lane] = self.cos_theta_t[pair];
        panels.longest_path[lane] = self.longest_path[pair];
        for (to, from) in panels.near.iter_mut().zip(&self.near) {
            to[lane] = from[pair];
        }
        for (to, from) in panels.opposite.iter_mut().zip(&self.opposite) {
            to[lane] = from[pair];
        }
        for (to, from) in panels.longitudinal.iter_mut().zip(&self.longitudinal) {
            to[lane] = from[pair];
        }
    }
}

impl<D: Density, S: Surface> Fibre<'_, D, S> {
    /// Adds Σₚ Mₚ Nₚ of this fibre's channels to the values of a pool of pairs.
    #[inline(always)]
    fn add(&mut self, angles: &[PairAngles], longitudinal: &[[Lanes; 3]], values: &mut [f64]) {
        let pairs = values.len() / self.channels;
        let mut optics = Vec::with_capacity(BLOCKS);
        for (angles, longitudinal) in angles.iter().zip(longitudinal) {
            optics.push(PairOptics::new(self.eta, self.density, angles, longitudinal));
        }

        for (optics, values) in optics.iter().zip(values.chunks_mut(PAIRS * self.channels)) {
            self.later_paths(optics, whole_registers(values.len() / self.channels));
            for (pair, values) in values.chunks_exact_mut(self.channels).enumerate() {
                for (value, sum) in values[self.first_channel..].iter_mut().zip(&self.sums) {
                    *value += sum[pair];
                }
            }
        }

        let mut by_rule: [Vec<(usize, PanelPlan)>; RULE_COUNT] = std::array::from_fn(|_| Vec::new());
        for pair in 0..pairs {
            let (block, lane) = (pair / PAIRS, pair % PAIRS);
            let refraction = optics[block].refraction(self.eta, lane);
            for panel in panels(&refraction, self.density, self.panel_lengths, angles[block].phi[lane]) {
                by_rule[panel.rule].push((pair, panel));
            }
        }
        for (rule, panels) in by_rule.iter().enumerate() {
            for panels in panels.chunks(PAIRS) {
                let (mut lanes, mut middle, mut half_length) = (PairOptics::nothing(), NOTHING, NOTHING);
                for lane in 0..PAIRS {
                    let (pair, panel) = panels[lane.min(panels.len() - 1)];
                    optics[pair / PAIRS].copy(pair % PAIRS, &mut lanes, lane);
                    middle[lane] = panel.middle;
                    half_length[lane] = panel.half_length;
                    for (lobe, active) in lanes.longitudinal.iter_mut().zip(panel.active) {
                        lobe[lane] = if active { lobe[lane] } else { 0.0 };
                    }
                }
                self.panels(&lanes, &middle, &half_length, whole_registers(panels.len()), Rule::numbered(rule));
                for (lane, (pair, _)) in panels.iter().enumerate() {
                    let values = &mut values[pair * self.channels + self.first_channel..];
                    for (value, sum) in values.iter_mut().zip(&self.sums) {
                        *value += sum[lane];
                    }
                }
            }
        }
    }

    /// Sets the first `lanes` sums to M N of all later paths.
    #[inline(always)]
    fn later_paths(&mut self, optics: &PairOptics, lanes: usize) {
        let lanes = lanes.min(PAIRS);
        self.sums.fill(NOTHING);
        let rule: &WidthRule = &WIDTH_RULE;
        for node in 0..WIDTH_NODES {
            let (mut entered, mut back, mut not_back, mut path) = (NOTHING, NOTHING, NOTHING, NOTHING);
            let (sin_gamma, cos_gamma, weight) = (rule.sin_gamma[node], rule.cos_gamma[node], rule.weights[node]);
            for pair in 0..lanes {
                let refraction = optics.refraction(self.eta, pair);
                let later = LaterPath::new(&refraction, &self.surface, sin_gamma, cos_gamma, weight);
                entered[pair] = later.entered;
                back[pair] = later.back;
                not_back[pair] = later.not_back;
                path[pair] = later.path;
            }
            for (sum, &sigma_a) in self.sums.iter_mut().zip(self.sigma_a) {
                for pair in 0..lanes {
                    let later = LaterPath {
                        entered: entered[pair],
                        back: back[pair],
                        not_back: not_back[pair],
                        path: path[pair],
                    };
                    sum[pair] += later.left(sigma_a);
                }
            }
        }
        let twice = &optics.longitudinal[2];
        for sum in &mut self.sums {
            for pair in 0..lanes {
                sum[pair] *= 0.5 * FRAC_1_PI * twice[pair];
            }
        }
    }

    /// Sets the first `lanes` sums to what R, TT and TRT add in these panels.
    #[inline(always)]
    fn panels(&mut self, optics: &PairOptics, middle: &Lanes, half_length: &Lanes, lanes: usize, rule: &Rule) {
        let lanes = lanes.min(PAIRS);
        self.sums.fill(NOTHING);
        let [m_reflected, m_once, m_twice] = &optics.longitudinal;
        let mut reflected = NOTHING;
        for (position, weight) in rule.nodes.iter().zip(&rule.weights) {
            let (mut once, mut twice, mut path) = (NOTHING, NOTHING, NOTHING);
            for lane in 0..lanes {
                let refraction = optics.refraction(self.eta, lane);
                let gamma = middle[lane] + half_length[lane] * position;
                let node = Node::new(&refraction, &self.surface, gamma, half_length[lane] * weight);
                let near = [optics.near[0][lane], optics.near[1][lane]];
                let opposite = [optics.opposite[0][lane], optics.opposite[1][lane]];
                reflected[lane] += node.reflected(self.density, near);
                once[lane] = m_once[lane] * node.once(self.density, opposite);
                twice[lane] = m_twice[lane] * node.twice(self.density, near);
                path[lane] = node.path;
            }
            for (sum, &sigma_a) in self.sums.iter_mut().zip(self.sigma_a) {
                for lane in 0..lanes {
                    let pass = quick_exp_of_negative(-sigma_a * path[lane]);
                    sum[lane] += pass * (once[lane] + pass * twice[lane]);
                }
            }
        }
        for sum in &mut self.sums {
            for lane in 0..lanes {
                sum[lane] += m_reflected[lane] * reflected[lane];
            }
        }
    }
}
