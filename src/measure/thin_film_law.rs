//! The closed law of a single film's peaks: what most papers fit, and a control on the full model.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Geometry, Peak, PeakModel, mirror_cosine};
use crate::parameter::{Parameter, Spread};

/// How many of a film's two reflections turn the phase by half a wave.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum PhaseJumps {
    /// Both or none, as in a film whose index lies between those of its neighbours: keratin over melanin. Peaks at
    /// 2 d √(n² − sin²θ) = m λ.
    #[default]
    Both,
    /// One of them, as in a film between equal neighbours. Peaks at 2 d √(n² − sin²θ) = (m − ½) λ.
    One,
}

/// The law's description in a job.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ThinFilmLawDesign {
    /// Which of the film's reflections turn the phase.
    pub phase_jumps: PhaseJumps,
}

/// λ = 2 d √(n² − sin²θ)/m: the path difference in a film of one index, without absorption, dispersion or the
/// wavelength dependence of a reflection's phase (Born & Wolf 1999, section 7.6).
#[derive(Debug, Clone)]
pub struct ThinFilmLaw {
    design: ThinFilmLawDesign,
    parameters: Vec<Parameter>,
}

impl ThinFilmLaw {
    /// The law for peaks no shorter than `shortest_nm`, which sets how finely thickness must be scanned.
    pub fn new(design: ThinFilmLawDesign, shortest_nm: f64) -> Self {
        let thickness = Parameter {
            name: "film.thickness_nm".into(),
            symbol: "d".into(),
            unit: "nm",
            default: 300.0,
            lower: 5.0,
            upper: 5000.0,
            spread: Spread::Logarithmic,
            // Orders of interference lie λ/2n apart; n is at most 3 here, and eight steps an order miss none.
            scan_step: Some(shortest_nm / 6.0 / 8.0),
            text: "Thickness of the film".into(),
        };
        let index = Parameter {
            name: "film.index".into(),
            symbol: "n".into(),
            unit: "",
            default: 1.56,
            lower: 1.0,
            upper: 3.0,
            spread: Spread::Linear,
            scan_step: None,
            text: "Effective refractive index of the film".into(),
        };
        Self { design, parameters: vec![thickness, index] }
    }
}

impl PeakModel for ThinFilmLaw {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn peaks(&self, values: &[f64], geometry: &Geometry, shortest_nm: f64, longest_nm: f64) -> Vec<Peak> {
        let (thickness_nm, index) = (values[0], values[1]);
        let cosine = mirror_cosine(geometry);
        let sine_squared = 1.0 - cosine * cosine;
        let path_nm = 2.0 * thickness_nm * (index * index - sine_squared).sqrt();
        (1..)
            .map(|order| Peak { order, wavelength_nm: path_nm / self.interference_order(order) })
            .skip_while(|peak| peak.wavelength_nm > longest_nm)
            .take_while(|peak| peak.wavelength_nm >= shortest_nm)
            .collect()
    }

    fn interference_order(&self, peak_order: u32) -> f64 {
        match self.design.phase_jumps {
            PhaseJumps::Both => f64::from(peak_order),
            PhaseJumps::One => f64::from(peak_order) - 0.5,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The law at normal incidence and at 90° has the closed values 2 n d/m and 2 d √(n² − 1)/m.
    #[test]
    fn ends_of_the_law() {
        let law = ThinFilmLaw::new(ThinFilmLawDesign::default(), 300.0);
        let normal = law.peaks(&[400.0, 1.5], &Geometry::mirror(0.0), 300.0, 1300.0);
        let wavelengths: Vec<f64> = normal.iter().map(|peak| peak.wavelength_nm).collect();
        for (found, expected) in wavelengths.iter().zip([1200.0, 600.0, 400.0, 300.0]) {
            approx::assert_relative_eq!(*found, expected, max_relative = 1e-14);
        }
        let grazing = law.peaks(&[400.0, 1.5], &Geometry::mirror(90.0), 500.0, 1000.0);
        assert_eq!(grazing.len(), 1);
        approx::assert_relative_eq!(grazing[0].wavelength_nm, 800.0 * 1.25f64.sqrt(), max_relative = 1e-14);
    }

    #[test]
    fn one_phase_jump_shifts_by_half_an_order() {
        let law = ThinFilmLaw::new(ThinFilmLawDesign { phase_jumps: PhaseJumps::One }, 300.0);
        let peaks = law.peaks(&[100.0, 1.5], &Geometry::mirror(0.0), 300.0, 1000.0);
        approx::assert_relative_eq!(peaks[0].wavelength_nm, 600.0, max_relative = 1e-14);
        assert_eq!(peaks.len(), 1);
    }
}
