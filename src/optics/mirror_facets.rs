//! Which microfacets throw light back, and how steeply it meets them: what the albedo of any mirror lobe is made of.
//!
//! A rough surface whose microfacets reflect the share R(c) of light that meets them at the cosine c throws back
//!
//! ```text
//! ∫ K(μ, c; α) R(c) dc = 1/μ ∫ D(m) (i·m) R(i·m) G1(i) G1(o) dm
//! ```
//!
//! of light from the cosine μ (Walter, Marschner, Li and Torrance 2007). K is geometry alone: it knows neither film nor
//! wavelength, and stands here as a list of cosines with their weights.
//!
//! The integral is taken in spherical coordinates about the light, m = (β, ψ) with c = cosβ, so that R hangs on β
//! alone, and where the mirrored direction dips under the horizon there is a bound on ψ in closed form. Between the
//! break points in β everything is smooth but for square roots at the ends, which the substitution β(t) ∝ t²(3 − 2t)
//! takes away.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use super::microfacet::Beckmann;

/// Slopes beyond this many α hold e⁻³⁶ = 2e-16 of the surface.
pub(super) const STEEPEST_SLOPE: f64 = 6.0;

/// The microfacets of a rough surface as mirrors.
#[derive(Debug, Clone, Copy)]
pub(super) struct MirrorFacets<'a> {
    pub(super) alpha: f64,
    /// Steepest slope that counts, in α: beyond s lies the share e^(−s²) of the surface.
    pub(super) steepest: f64,
    /// Widest panel in β, see [`panel_width`].
    pub(super) panel_width: f64,
    /// Nodes and weights on [0, 1] of one panel, in either variable.
    pub(super) rule: &'a [(f64, f64)],
}

impl MirrorFacets<'_> {
    /// Calls `meet` with cosines c and their weights in ∫ K(μ, c; α) … dc for light from 0 < `cos_theta` ≤ 1, where the
    /// rest of the integrand is smooth but for a kink at the angle of incidence `kink`, π/2 if there is none.
    pub(super) fn visit(self, cos_theta: f64, kink: f64, mut meet: impl FnMut(f64, f64)) {
        debug_assert!(cos_theta > 0.0 && cos_theta <= 1.0, "the light must be above the surface, found {cos_theta}");
        let microfacets = Beckmann::new(self.alpha);
        let theta = cos_theta.acos();
        let (low, high) = facing(self.steepest * self.alpha, theta);
        // A mirror that leans towards the light by ψ = 0 or away from it (ψ = π) sends the light to the horizon.
        let high = high.min(FRAC_PI_4 + theta / 2.0);
        let outer = microfacets.visible_share(cos_theta) / cos_theta;
        over_panels(self.panel_width, self.rule, [low, FRAC_PI_4 - theta / 2.0, kink, high], |beta, weight| {
            let ring = self.ring(microfacets, theta, cos_theta, beta);
            if ring > 0.0 {
                meet(beta.cos(), weight * ring * outer);
            }
        });
    }

    /// The integral over ψ at one β: cosβ sinβ · 2 ∫ D G1(o) dψ, by symmetry over half a turn.
    fn ring(self, microfacets: Beckmann, theta: f64, cos_theta: f64, beta: f64) -> f64 {
        let (sin_beta, cos_beta) = beta.sin_cos();
        // The mirrored direction is above the horizon where m_z > μ/(2 cosβ).
        let lowest = least_height(self.steepest * self.alpha).max(cos_theta / (2.0 * cos_beta));
        // m_z = base + amplitude · cosψ.
        let (base, amplitude) = (cos_beta * cos_theta, sin_beta * theta.sin());
        let end = if amplitude > 0.0 { ((lowest - base) / amplitude).clamp(-1.0, 1.0).acos() } else { PI };
        let mut sum = 0.0;
        for &(node, weight) in self.rule {
            let m_z = base + amplitude * (end * node).cos();
            let o_z = 2.0 * cos_beta * m_z - cos_theta;
            sum += weight * microfacets.density(m_z) * microfacets.visible_share(o_z);
        }
        2.0 * end * sum * cos_beta * sin_beta
    }
}

/// Range of the angle between light at inclination `theta` and the normals of microfacets that are neither steeper than a
/// slope nor turned away from it.
pub(super) fn facing(steepest_slope: f64, theta: f64) -> (f64, f64) {
    let steepest = steepest_slope.atan();
    ((theta - steepest).max(0.0), (theta + steepest).min(FRAC_PI_2))
}

/// Cosine of the inclination of a slope.
pub(super) fn least_height(steepest_slope: f64) -> f64 {
    1.0 / (1.0 + steepest_slope * steepest_slope).sqrt()
}

/// Widest panel in β for a surface on its own: three roughnesses where these are small, and never more than three quarters
/// of a radian.
pub(super) fn panel_width(alpha: f64) -> f64 {
    3.0 * alpha / (1.0 + 4.0 * alpha)
}

/// Calls `visit` with nodes β and weights of an integral from the first to the last of `edges`, which breaks at those
/// between them, in panels no wider than `panel_width`.
pub(super) fn over_panels<const N: usize>(
    panel_width: f64,
    rule: &[(f64, f64)],
    mut edges: [f64; N],
    mut visit: impl FnMut(f64, f64),
) {
    let (start, end) = (edges[0], edges[N - 1]);
    for edge in &mut edges {
        *edge = edge.clamp(start, end.max(start));
    }
    edges.sort_by(f64::total_cmp);
    for segment in edges.windows(2) {
        let (start, length) = (segment[0], segment[1] - segment[0]);
        if length <= 0.0 {
            continue;
        }
        let panels = (length / panel_width).ceil().max(1.0);
        let mut panel = 0.0;
        while panel < panels {
            for &(node, weight) in rule {
                let t = (panel + node) / panels;
                visit(start + length * t * t * (3.0 - 2.0 * t), weight * length * 6.0 * t * (1.0 - t) / panels);
            }
            panel += 1.0;
        }
    }
}
