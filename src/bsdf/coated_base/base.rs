//! The diffuse base: a grey albedo, or one that bends at given wavelengths.

use crate::bsdf::ModelError;
use crate::parameter::{Parameter, Spread};

/// The base's albedo over the channels, as a mixture of its parameters.
#[derive(Debug, Clone)]
pub(super) struct Base {
    /// Number of parameters: one, or one a knot.
    count: usize,
    /// For each channel the parameter to its left and the share of the one to its right.
    places: Vec<(usize, f64)>,
}

impl Base {
    /// Declares `diffuse_albedo`, or one `diffuse_albedo.<nm>` a knot, between which the albedo runs straight and beyond
    /// which it stays level.
    pub(super) fn declare(
        knots_nm: &[f64],
        wavelengths_nm: &[f64],
        parameters: &mut Vec<Parameter>,
    ) -> Result<Self, ModelError> {
        if !knots_nm.is_sorted_by(|a, b| a < b) || knots_nm.iter().any(|knot| !knot.is_finite()) {
            return Err(ModelError::UnsortedKnots);
        }
        if knots_nm.is_empty() {
            let text = "share of the light that comes back diffusely, the same at every wavelength".to_owned();
            parameters.push(albedo("diffuse_albedo".to_owned(), "ρ".to_owned(), text));
            return Ok(Self { count: 1, places: vec![(0, 0.0); wavelengths_nm.len()] });
        }
        for knot in knots_nm {
            let text = format!("share of the light that comes back diffusely at {knot} nm");
            parameters.push(albedo(format!("diffuse_albedo.{knot}"), format!("ρ {knot}"), text));
        }
        let last = knots_nm.len() - 1;
        let place = |nm: &f64| match knots_nm.partition_point(|knot| knot <= nm) {
            0 => (0, 0.0),
            right if right > last => (last, 0.0),
            right => (right - 1, (nm - knots_nm[right - 1]) / (knots_nm[right] - knots_nm[right - 1])),
        };
        Ok(Self { count: knots_nm.len(), places: wavelengths_nm.iter().map(place).collect() })
    }

    /// Number of parameters.
    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// The albedo in each channel.
    pub(super) fn albedo(&self, values: &[f64]) -> Vec<f64> {
        let at = |&(left, share): &(usize, f64)| {
            if share > 0.0 { values[left] + share * (values[left + 1] - values[left]) } else { values[left] }
        };
        self.places.iter().map(at).collect()
    }
}

fn albedo(name: String, symbol: String, text: String) -> Parameter {
    Parameter {
        name,
        symbol,
        unit: "",
        default: 0.0,
        lower: 0.0,
        upper: 1.0,
        spread: Spread::Linear,
        scan_step: None,
        text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_straight_between_knots_and_level_beyond() {
        let mut parameters = Vec::new();
        let base = Base::declare(&[400.0, 500.0, 700.0], &[350.0, 400.0, 450.0, 650.0, 700.0, 800.0], &mut parameters);
        let names: Vec<&str> = parameters.iter().map(|parameter| parameter.name.as_str()).collect();
        assert_eq!(names, ["diffuse_albedo.400", "diffuse_albedo.500", "diffuse_albedo.700"]);
        let albedo = base.unwrap().albedo(&[0.1, 0.3, 0.7]);
        for (found, expected) in albedo.iter().zip([0.1, 0.1, 0.2, 0.6, 0.7, 0.7]) {
            approx::assert_abs_diff_eq!(*found, expected, epsilon = 1e-15);
        }
    }
}
