//! Gauss–Legendre rules, and how many of their nodes a panel needs.

use std::sync::LazyLock;

/// Numbers in a block: what the widest vector registers hold. A loop over the lanes of one block becomes vector
/// instructions as a whole; rules have whole blocks of nodes, so that none is left over.
pub(super) const LANES: usize = 8;

/// A number for each of eight nodes.
pub(super) type Block = [f64; LANES];

/// Blocks of the largest rule.
pub(super) const MOST_BLOCKS: usize = 6;

/// Nodes in (−1, 1) and weights that sum to 2.
#[derive(Debug, Clone)]
pub(super) struct Rule {
    pub(super) nodes: Vec<Block>,
    pub(super) weights: Vec<Block>,
}

/// The rules with 1, 2, … [`MOST_BLOCKS`] blocks of nodes.
static RULES: LazyLock<Vec<Rule>> = LazyLock::new(|| (1..=MOST_BLOCKS).map(Rule::new).collect());

impl Rule {
    /// Roots of the Legendre polynomial by Newton's method from Tricomi's first guess; ascending.
    fn new(blocks: usize) -> Self {
        let count = blocks * LANES;
        let n = count as f64;
        let (nodes, weights): (Vec<f64>, Vec<f64>) = (0..count)
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
        Self { nodes: nodes.as_chunks().0.to_vec(), weights: weights.as_chunks().0.to_vec() }
    }
}

/// Blocks of [`WidthRule`].
pub(super) const WIDTH_BLOCKS: usize = 3;

/// Mean over the width of a fibre of something that does not depend on azimuths.
///
/// The sum over all late paths, (1 − f)² f² T³/(1 − f T), has a pole just beyond γ = π/2 where absorption is weak, since
/// f is 1 there. Nodes in u with γ = (1 − u²) π/2 crowd towards it: the error stays below 1e-13 however near it comes.
#[derive(Debug, Clone)]
pub(super) struct WidthRule {
    pub(super) sin_gamma: [Block; WIDTH_BLOCKS],
    pub(super) cos_gamma: [Block; WIDTH_BLOCKS],
    /// Sum to 1.
    pub(super) weights: [Block; WIDTH_BLOCKS],
}

/// The one rule of this kind.
pub(super) static WIDTH_RULE: LazyLock<WidthRule> = LazyLock::new(|| {
    let rule = &RULES[WIDTH_BLOCKS - 1];
    let mut width = WidthRule {
        sin_gamma: [[0.0; LANES]; WIDTH_BLOCKS],
        cos_gamma: [[0.0; LANES]; WIDTH_BLOCKS],
        weights: [[0.0; LANES]; WIDTH_BLOCKS],
    };
    for block in 0..WIDTH_BLOCKS {
        for lane in 0..LANES {
            let u = 0.5 * (1.0 + rule.nodes[block][lane]);
            let (cos_gamma, sin_gamma) = (u * u * std::f64::consts::FRAC_PI_2).sin_cos();
            width.sin_gamma[block][lane] = sin_gamma;
            width.cos_gamma[block][lane] = cos_gamma;
            // dh = cosγ dγ and dγ = π u du; u runs over half the range of the rule.
            width.weights[block][lane] = cos_gamma * std::f64::consts::PI * u * 0.5 * rule.weights[block][lane];
        }
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
pub(super) struct PanelLengths([f64; MOST_BLOCKS]);

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

    /// Equal parts into which a panel of this length is cut, and the rule for each part.
    pub(super) fn plan(&self, length: f64) -> (usize, &'static Rule) {
        let half = 0.5 * length;
        let longest = self.0[MOST_BLOCKS - 1];
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small positive whole number")]
        let parts = (half / longest).ceil().max(1.0) as usize;
        let half = half / parts as f64;
        let rule = self.0.iter().position(|&reach| half <= reach).unwrap_or(MOST_BLOCKS - 1);
        (parts, &RULES[rule])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A rule of n nodes is exact up to degree 2n − 1.
    #[test]
    fn rules_integrate_polynomials_exactly() {
        for rule in RULES.iter() {
            let nodes = rule.nodes.as_flattened();
            let weights = rule.weights.as_flattened();
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
