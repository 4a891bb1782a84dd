//! The fibre as a job types it and as a fit moves it: a design, and the parameters that it declares.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{AzimuthalLobe, Cylinder, CylinderParameters, LongitudinalMapping, PictureFibre, for_picture};
use crate::bsdf::absorbers::{Absorbers, AmountScale};
use crate::bsdf::channel_parameters::{ChannelParameter, Declarations};
use crate::bsdf::{Bsdf, ChannelMix, Model, ModelError};
use crate::parameter::{Parameter, Spread};
use crate::pigment::PigmentDesign;

/// A fibre as typed in a job.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct CylinderDesign {
    /// How `beta_m` becomes the width of the lobes.
    pub mapping: LongitudinalMapping,
    /// Shape of the lobes around the fibre, and how `beta_n` becomes their width.
    pub lobe: AzimuthalLobe,
    /// Parameters that have one value in each channel: `eta`, `sigma_a`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub per_channel: Vec<String>,
    /// What absorbs inside the fibre; their amounts then stand in the place of `sigma_a`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub pigments: Vec<PigmentDesign>,
}

/// Where σₐ comes from.
#[derive(Debug, Clone)]
enum Absorption {
    /// A parameter of its own.
    Free(ChannelParameter),
    /// The amounts of absorbers.
    Pigments(Absorbers),
}

impl Absorption {
    fn declare(
        design: &CylinderDesign,
        wavelengths_nm: &[f64],
        declarations: &mut Declarations,
    ) -> Result<Self, ModelError> {
        const UNIT: &str = "1/radius";
        // Beyond 20 per radius a fibre is black but for its surface.
        let (default, upper) = (0.2, 20.0);
        if design.pigments.is_empty() {
            return Ok(Self::Free(declarations.spectral(parameter(
                "sigma_a",
                "σ_a",
                UNIT,
                [default, 0.0, upper],
                "absorption inside the fibre, per radius of it",
            ))));
        }
        if design.per_channel.iter().any(|name| name == "sigma_a") {
            return Err(ModelError::PigmentsAndAbsorption);
        }
        let scale = AmountScale { unit: UNIT, default, upper, fibre: true };
        Absorbers::declare(&design.pigments, wavelengths_nm, scale, declarations).map(Self::Pigments)
    }
}

fn parameter(name: &str, symbol: &str, unit: &'static str, [default, lower, upper]: [f64; 3], text: &str) -> Parameter {
    Parameter {
        name: name.to_owned(),
        symbol: symbol.to_owned(),
        unit,
        default,
        lower,
        upper,
        spread: Spread::Linear,
        scan_step: None,
        text: text.to_owned(),
    }
}

/// The cylinder as a model to be fitted: which parameters it has is fixed, their values are not.
#[derive(Debug, Clone)]
pub struct CylinderModel {
    channel_count: usize,
    mapping: LongitudinalMapping,
    lobe: AzimuthalLobe,
    eta: ChannelParameter,
    beta_m: usize,
    beta_n: usize,
    sigma_a: Absorption,
    parameters: Vec<Parameter>,
}

impl CylinderModel {
    /// The model at these wavelengths (nm, one a channel).
    ///
    /// # Errors
    /// No wavelengths, senseless ones, or a wrong name in `per_channel`.
    pub fn new(design: &CylinderDesign, wavelengths_nm: &[f64]) -> Result<Self, ModelError> {
        let mut declarations = Declarations::new(wavelengths_nm, &design.per_channel)?;
        let eta = declarations.spectral(parameter(
            "eta",
            "η",
            "",
            [1.55, 1.05, 3.0],
            "refractive index of the fibre relative to what surrounds it",
        ));
        let beta_m = declarations.number(parameter(
            "beta_m",
            "β_m",
            "",
            [0.3, 0.02, 1.0],
            "roughness along the fibre: how far lobes spread along it",
        ));
        let beta_n = declarations.number(parameter(
            "beta_n",
            "β_n",
            "",
            [0.3, 0.02, 1.0],
            "roughness around the fibre: how far lobes spread around it",
        ));
        let sigma_a = Absorption::declare(design, wavelengths_nm, &mut declarations)?;
        Ok(Self {
            channel_count: wavelengths_nm.len(),
            mapping: design.mapping,
            lobe: design.lobe,
            eta,
            beta_m,
            beta_n,
            sigma_a,
            parameters: declarations.finish()?,
        })
    }

    /// The fibre with these parameter values.
    pub(in crate::bsdf) fn cylinder(&self, values: &[f64]) -> Cylinder {
        let channels = 0..self.channel_count;
        Cylinder::from_checked(&CylinderParameters {
            eta: channels.clone().map(|channel| self.eta.value(values, channel)).collect(),
            sigma_a: match &self.sigma_a {
                Absorption::Free(sigma_a) => channels.map(|channel| sigma_a.value(values, channel)).collect(),
                Absorption::Pigments(absorbers) => absorbers.absorption(values),
            },
            beta_m: values[self.beta_m],
            beta_n: values[self.beta_n],
            mapping: self.mapping,
            lobe: self.lobe,
        })
    }
}

impl Model for CylinderModel {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn channel_count(&self) -> usize {
        self.channel_count
    }

    fn bind(&self, values: &[f64]) -> Box<dyn Bsdf + '_> {
        Box::new(self.cylinder(values))
    }

    fn bind_for_picture(&self, shades: &[Vec<f64>], mix: Option<&ChannelMix>) -> Vec<Box<dyn Bsdf + '_>> {
        let without_sponge = vec![0.0; self.channel_count];
        let fibre =
            |values: &Vec<f64>| PictureFibre { cylinder: self.cylinder(values), sponge: without_sponge.clone() };
        let fibres: Vec<PictureFibre> = shades.iter().map(fibre).collect();
        for_picture(&fibres, mix, |number| Box::new(fibres[number].cylinder.clone()))
    }
}
