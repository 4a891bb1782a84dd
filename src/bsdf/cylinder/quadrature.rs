//! Gauss–Legendre rules, and how many of their nodes a panel needs.

use std::sync::LazyLock;

/// Numbers in the widest vector registers. Rules have a multiple of so many nodes, so that none is left over.
pub(super) const LANES: usize = 8;

/// The number of rules.
pub(super) const RULE_COUNT: usize = 6;

/// Nodes of the largest rule.
pub(super) const MOST_NODES: usize = RULE_COUNT * LANES;

/// Nodes in (−1, 1) and weights that sum to 2.
#[derive(Debug, Clone)]
pub(super) struct Rule {
    pub(super) nodes: Vec<f64>,
    pub(super) weights: Vec<f64>,
}

/// The rules with 8, 16, … [`MOST_NODES`] nodes.
static RULES: LazyLock<Vec<Rule>> = LazyLock::new(|| (1..=RULE_COUNT).map(|k| Rule::new(k * LANES)).collect());

impl Rule {
    /// The rule that [`PanelLengths::plan`] names, 0 to [`RULE_COUNT`] − 1.
    pub(super) fn numbered(number: usize) -> &'static Self {
        &RULES[number]
    }

    /// Roots of the Legendre polynomial by Newton's method from Tricomi's first guess; ascending.
    fn new(count: usize) -> Self {
        let n = count as f64;
        let (nodes, weights) = (0..count)
            .map(|k| {
                let mut x = -(std::f64::consts::PI * (k as f64 + 0.75) / (n + 0.5)).cos();
                let mut slope = 0.0;
                // Six steps reach the last digit from anywhere on that guess; more change nothing.
                for _ in 0..6 {
                    let (mut previous, mut value) = (1.0, x);
                    for degree in 2..=count {
                        let degree = degree as f64;
                        (previous, value) =
                            (value, ((2.0 * degree - 1.0) * x * value - (degree - 1.0) * previous) / degree);
                    }
                    slope = n * (x * value - previous) / (x * x - 1.0);
                    x -= value / slope;
                }
                (x, 2.0 / ((1.0 - x * x) * slope * slope))
            })
            .unzip();
        Self { nodes, weights }
    }
}

/// Nodes of [`WidthRule`].
pub(super) const WIDTH_NODES: usize = 3 * LANES;

/// Mean over the width of a fibre of something that does not depend on azimuths.
///
/// The sum over all late paths, (1 − f)² f² T³/(1 − f T), has a pole just beyond γ = π/2 where absorption is weak, since
/// f is 1 there. Nodes in u with γ = (1 − u²) π/2 crowd towards it: the error stays below 1e-13 however near it comes.
#[derive(Debug, Clone)]
pub(super) struct WidthRule {
    pub(super) sin_gamma: [f64; WIDTH_NODES],
    pub(super) cos_gamma: [f64; WIDTH_NODES],
    /// Sum to 1.
    pub(super) weights: [f64; WIDTH_NODES],
}

/// The one rule of this kind.
pub(super) static WIDTH_RULE: LazyLock<WidthRule> = LazyLock::new(|| {
    let rule = &RULES[WIDTH_NODES / LANES - 1];
    let mut width =
        WidthRule { sin_gamma: [0.0; WIDTH_NODES], cos_gamma: [0.0; WIDTH_NODES], weights: [0.0; WIDTH_NODES] };
    for node in 0..WIDTH_NODES {
        let u = 0.5 * (1.0 + rule.nodes[node]);
        let (cos_gamma, sin_gamma) = (u * u * std::f64::consts::FRAC_PI_2).sin_cos();
        width.sin_gamma[node] = sin_gamma;
        width.cos_gamma[node] = cos_gamma;
        // dh = cosγ dγ and dγ = π u du; u runs over half the range of the rule.
        width.weights[node] = cos_gamma * std::f64::consts::PI * u * 0.5 * rule.weights[node];
    }
    width
});

/// How far an integrand stays analytic, which decides how fast a Gauss rule converges.
///
/// On a panel of half-length a, the error of n nodes falls as ρ^{−2n}, ρ being the sum of the half-axes (over a) of the
/// largest ellipse around the panel's ends in which the integrand is analytic (Trefethen 2008, theorem 4.5).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Analyticity {
    /// Distance from the real axis to singularities that may stand beside any point of a panel.
    pub(super) beside: f64,
    /// Distance from the real axis to singularities that stand above a panel's end.
    pub(super) at_end: f64,
}

/// ln of the factor by which a panel's error is pushed below its integrand, where singularities stand beside it. Paths that
/// are reflected at once reach every azimuth, so that no value is below some 1e-4 of the peak; e^−22 is 3e-10.
const CONVERGENCE_BESIDE: f64 = 22.0;

/// The same for singularities above an end. Rules of few nodes need the larger factor, since the integrand grows on its way
/// to a distant singularity.
const CONVERGENCE_AT_END: f64 = 34.0;

/// For each rule, the half-length of the longest panel on which it converges.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PanelLengths([f64; RULE_COUNT]);

impl PanelLengths {
    /// A singularity at height y beside the middle gives ρ = e^τ with sinh τ = y/a; one at height y above the end gives
    /// sinh²τ / cosh τ = y/a. A rule of n nodes wants 2nτ to be a given number; both are solved for a.
    pub(super) fn new(analyticity: Analyticity) -> Self {
        Self(std::array::from_fn(|k| {
            let double_nodes = (2 * LANES * (k + 1)) as f64;
            let beside = analyticity.beside / (CONVERGENCE_BESIDE / double_nodes).sinh();
            let tau = CONVERGENCE_AT_END / double_nodes;
            let at_end = analyticity.at_end * tau.cosh() / (tau.sinh() * tau.sinh());
            beside.min(at_end)
        }))
    }

    /// Equal parts into which a panel of this length is cut, and the number of the [rule](Rule::numbered) for each part.
    pub(super) fn plan(&self, length: f64) -> (usize, usize) {
        let half = 0.5 * length;
        let longest = self.0[RULE_COUNT - 1];
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small positive whole number")]
        let parts = (half / longest).ceil().max(1.0) as usize;
        let half = half / parts as f64;
        (parts, self.0.iter().position(|&reach| half <= reach).unwrap_or(RULE_COUNT - 1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A rule of n nodes is exact up to degree 2n − 1.
    #[test]
    fn rules_integrate_polynomials_exactly() {
        for rule in RULES.iter() {
            let Rule { nodes, weights } = rule;
            let count = nodes.len();
            for degree in [0, 2, count, 2 * count - 2] {
                let power = i32::try_from(degree).unwrap();
                let found: f64 = nodes.iter().zip(weights).map(|(x, w)| w * x.powi(power)).sum();
                let expected = if degree % 2 == 0 { 2.0 / (degree as f64 + 1.0) } else { 0.0 };
                assert!((found - expected).abs() < 1e-14, "{count} nodes, degree {degree}: {found} not {expected}");
            }
        }
    }
}
