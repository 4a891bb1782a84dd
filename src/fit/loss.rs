//! Robust losses, as a change of each residual.
//!
//! A least-squares solver minimises Σt² with t = sign(r)·√ρ(r), so that Σt² = Σρ(r) and the solver needs no second form.
//! For soft-L1 and Cauchy see Triggs et al. 2000, section 4; Huber 1964 for his own. All behave as r² for small r.

use super::outcome::{Loss, Settings};

/// A loss with the residual beyond which it takes over.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct RobustLoss {
    loss: Loss,
    scale: f64,
}

impl RobustLoss {
    pub(super) fn new(settings: &Settings) -> Self {
        Self { loss: settings.loss, scale: settings.loss_scale }
    }

    /// Whether every residual stays as it is.
    pub(super) fn is_squares(self) -> bool {
        self.loss == Loss::Squares
    }

    /// ρ(r), in units of r².
    pub(super) fn rho(self, residual: f64) -> f64 {
        let u = residual / self.scale;
        let size = u.abs();
        let rho = match self.loss {
            Loss::Squares => return residual * residual,
            // 2(√(1 + u²) − 1) without cancellation at small u.
            Loss::SoftL1 => 2.0 * u * u / (1.0 + u.hypot(1.0)),
            Loss::Huber if size <= 1.0 => u * u,
            Loss::Huber => 2.0 * size - 1.0,
            Loss::Cauchy => (u * u).ln_1p(),
        };
        rho * self.scale * self.scale
    }

    /// ψ(r) = ρ′(r)/2, which is r for squares.
    pub(super) fn psi(self, residual: f64) -> f64 {
        let u = residual / self.scale;
        match self.loss {
            Loss::Squares => residual,
            Loss::SoftL1 => residual / u.hypot(1.0),
            Loss::Huber => residual.clamp(-self.scale, self.scale),
            Loss::Cauchy => residual / (1.0 + u * u),
        }
    }

    /// ψ′(r), which is 1 for squares and negative for Cauchy's outliers.
    pub(super) fn psi_slope(self, residual: f64) -> f64 {
        let u = residual / self.scale;
        match self.loss {
            Loss::Squares => 1.0,
            Loss::SoftL1 => u.hypot(1.0).powi(-3),
            Loss::Huber => f64::from(u8::from(u.abs() <= 1.0)),
            Loss::Cauchy => (1.0 - u * u) / ((1.0 + u * u) * (1.0 + u * u)),
        }
    }

    /// t = sign(r)·√ρ(r).
    pub(super) fn transformed(self, residual: f64) -> f64 {
        if self.is_squares() { residual } else { self.rho(residual).sqrt().copysign(residual) }
    }

    /// dt/dr = ψ(r)/t, which tends to 1 at r = 0.
    pub(super) fn slope(self, residual: f64) -> f64 {
        let t = self.transformed(residual);
        if self.is_squares() || t == 0.0 { 1.0 } else { self.psi(residual) / t }
    }
}
