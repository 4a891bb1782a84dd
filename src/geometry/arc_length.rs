//! Places on a curve by their distance along it.

use super::bezier::{Bezier, as_f64};
use crate::optics::gauss_legendre;

/// Panels into which a curve is cut: each is so short that the rule below is exact to rounding on any smooth feather.
const PANELS: usize = 256;

/// Nodes of the rule on each panel.
const NODES: usize = 12;

/// The length of a curve from its start to any parameter, and back.
#[derive(Debug, Clone)]
pub(super) struct ArcLength {
    curve: Bezier,
    rule: Vec<(f64, f64)>,
    /// Length up to the start of each panel, and the whole.
    up_to: Vec<f64>,
}

impl ArcLength {
    pub(super) fn new(curve: &Bezier) -> Self {
        let rule = gauss_legendre(NODES);
        let mut length = Self { curve: curve.clone(), rule, up_to: vec![0.0] };
        let mut sum = 0.0;
        for panel in 0..PANELS {
            sum += length.between(edge(panel), edge(panel + 1));
            length.up_to.push(sum);
        }
        length
    }

    /// The whole length.
    pub(super) fn total(&self) -> f64 {
        self.up_to[PANELS]
    }

    /// The length from the start to `t`.
    pub(super) fn at(&self, t: f64) -> f64 {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and the panels")]
        let panel = ((t.clamp(0.0, 1.0) * as_f64(PANELS)) as usize).min(PANELS - 1);
        self.up_to[panel] + self.between(edge(panel), t)
    }

    /// The parameter at a length, by Newton's method inside its panel.
    pub(super) fn parameter(&self, length: f64) -> f64 {
        let panel = self.up_to.partition_point(|&start| start <= length).clamp(1, PANELS) - 1;
        let (from, to) = (edge(panel), edge(panel + 1));
        let (start, end) = (self.up_to[panel], self.up_to[panel + 1]);
        let mut t = from + (to - from) * (length - start) / (end - start);
        for _ in 0..6 {
            let error = start + self.between(from, t) - length;
            let step = error / self.curve.jet(t).derivative.hypot();
            t = (t - step).clamp(from, to);
            if step.abs() < 1e-15 {
                break;
            }
        }
        t
    }

    fn between(&self, from: f64, to: f64) -> f64 {
        let width = to - from;
        width
            * self
                .rule
                .iter()
                .map(|(node, weight)| weight * self.curve.jet(from + node * width).derivative.hypot())
                .sum::<f64>()
    }
}

fn edge(panel: usize) -> f64 {
    as_f64(panel) / as_f64(PANELS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use kurbo::{CubicBez, ParamCurveArclen};

    /// The parabola y = x² from 0 to 1: √5/2 + asinh(2)/4.
    #[test]
    fn a_parabolas_length_is_the_closed_form() {
        let parabola = Bezier::new(vec![(0.0, 0.0).into(), (0.5, 0.0).into(), (1.0, 1.0).into()]);
        let expected = 0.5 * 5f64.sqrt() + 0.25 * 2f64.asinh();
        approx::assert_relative_eq!(ArcLength::new(&parabola).total(), expected, max_relative = 1e-14);
    }

    #[test]
    fn lengths_and_parameters_are_inverse_and_agree_with_kurbo() {
        let cubic = CubicBez::new((0.0, 0.0), (-20.0, 60.0), (30.0, 90.0), (0.0, 150.0));
        let length = ArcLength::new(&cubic.into());
        approx::assert_relative_eq!(length.total(), cubic.arclen(1e-9), max_relative = 1e-10);
        for share in [0.0, 1e-6, 0.1, 0.37, 0.5, 0.999, 1.0] {
            let t = length.parameter(share * length.total());
            approx::assert_relative_eq!(length.at(t), share * length.total(), max_relative = 1e-13, epsilon = 1e-12);
        }
    }
}
