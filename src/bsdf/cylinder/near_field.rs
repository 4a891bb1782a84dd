//! The fibre seen so closely that the position across it is known: S(h) = Σₚ Mₚ Aₚ(h) D(φ − Φₚ(h)).
//!
//! The same fibre as the [cylinder](super), with the same parameters and one more, and the same f = S/|n·ωi|; the cylinder
//! is its mean over h.
//!
//! | parameter | symbol | unit | default | range |
//! | --- | --- | --- | --- | --- |
//! | those of the cylinder | | | | |
//! | `h`: position across the fibre, in the viewer's frame, 0 at its middle | h | radius | 0 | −1 to 1 |

use std::f64::consts::{FRAC_1_PI, PI, TAU};
use std::sync::OnceLock;

use super::attenuation::Attenuation;
use super::azimuth_table::AzimuthTable;
use super::azimuthal::Density;
use super::far_field::Refraction;
use super::sampling::direction_around;
use super::{Cylinder, CylinderDesign, CylinderModel, FibreAngles, Lobe, over_cosine};
use crate::bsdf::sampling::Choice;
use crate::bsdf::{Bsdf, Direction, Model, ModelError, Sample};
use crate::parameter::{Parameter, Spread};

/// The fibre at one position across it as a model to be fitted.
#[derive(Debug, Clone)]
pub struct NearFieldCylinderModel {
    cylinder: CylinderModel,
    parameters: Vec<Parameter>,
}

impl NearFieldCylinderModel {
    /// The model at these wavelengths (nm, one a channel).
    ///
    /// # Errors
    /// As [`CylinderModel::new`].
    pub fn new(design: &CylinderDesign, wavelengths_nm: &[f64]) -> Result<Self, ModelError> {
        let cylinder = CylinderModel::new(design, wavelengths_nm)?;
        let mut parameters = cylinder.parameters().to_vec();
        parameters.push(Parameter {
            name: "h".to_owned(),
            symbol: "h".to_owned(),
            unit: "radius",
            default: 0.0,
            lower: -1.0,
            upper: 1.0,
            spread: Spread::Linear,
            scan_step: None,
            text: "position across the fibre as the viewer sees it, 0 at its middle".to_owned(),
        });
        Ok(Self { cylinder, parameters })
    }
}

impl Model for NearFieldCylinderModel {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn channel_count(&self) -> usize {
        self.cylinder.channel_count()
    }

    fn bind(&self, values: &[f64]) -> Box<dyn Bsdf + '_> {
        let (cylinder, position) = values.split_at(values.len() - 1);
        Box::new(NearFieldCylinder {
            cylinder: self.cylinder.cylinder(cylinder),
            h: position[0],
            around: OnceLock::new(),
        })
    }
}

/// A fibre with its parameters given, at one position across it.
#[derive(Debug)]
struct NearFieldCylinder {
    cylinder: Cylinder,
    h: f64,
    /// Made at the first draw.
    around: OnceLock<AzimuthTable>,
}

impl Bsdf for NearFieldCylinder {
    /// f = S/|n·ωi|, as for the cylinder.
    fn evaluate(&self, incoming: &Direction, outgoing: &Direction, values: &mut [f64]) {
        self.cylinder.near_field(&FibreAngles::between(incoming, outgoing), self.h, values);
        over_cosine(incoming, values);
    }

    /// Draws a channel, a path by its share Aₚ(h), an inclination from Mₚ and an azimuth about Φₚ(h).
    fn sample(&self, outgoing: &Direction, random: [f64; 3]) -> Option<Sample> {
        let (sin_theta_o, cos_theta_o) = (outgoing.x, outgoing.y.hypot(outgoing.z));
        let mut choice = Choice(random[2]);
        let viewer = viewer_angles(outgoing);
        let mut paths = None;
        let mut remaining = self.cylinder.channel_count();
        for (eta, sigma_a) in self.cylinder.channels() {
            if paths.is_none() && choice.takes(1.0 / remaining as f64) {
                paths = Some(Paths::at(&viewer, eta, sigma_a, self.h));
            }
            remaining -= 1;
        }
        // The last channel is taken with probability 1.
        let paths = paths?;
        let path = choice.index(&paths.shares);
        // The draw along the fibre takes the cosine of a turn's share random[1], which is as likely in either half of it.
        let side = if random[1] < 0.5 { 1.0 } else { -1.0 };
        let along = self.cylinder.longitudinal.draw(path.min(2), sin_theta_o, cos_theta_o, [random[0], random[1]]);
        let phi = match paths.exits.get(path) {
            Some(exit) if cos_theta_o > 0.0 => exit + side * self.around().curve(0).draw(choice.0),
            _ => side * PI * choice.0,
        };
        let incoming = direction_around(outgoing, along, phi);
        let density = self.density(&incoming, outgoing);
        // It is 0 at single points of the table, where nothing scatters.
        (density > 0.0).then(|| Sample::scattered(incoming, density))
    }

    fn density(&self, incoming: &Direction, outgoing: &Direction) -> f64 {
        let angles = FibreAngles::between(incoming, outgoing);
        let longitudinal = self.cylinder.longitudinal.evaluate(&angles);
        let around = self.around().curve(0);
        let mut sum = 0.0;
        for (eta, sigma_a) in self.cylinder.channels() {
            let paths = Paths::at(&angles, eta, sigma_a, self.h);
            sum += paths.shares[3] * longitudinal[2] * 0.5 * FRAC_1_PI;
            for ((share, exit), m) in paths.shares.iter().zip(paths.exits).zip(longitudinal) {
                // A viewer along the fibre has no azimuth to count from.
                let d = if angles.cos_theta_o > 0.0 { around.density(angles.phi - exit) } else { 0.5 * FRAC_1_PI };
                sum += share * m * d;
            }
        }
        sum / self.cylinder.channel_count() as f64
    }
}

impl NearFieldCylinder {
    /// D about its peak, to draw from.
    fn around(&self) -> &AzimuthTable {
        self.around.get_or_init(|| {
            let mut table = AzimuthTable::for_lobes_of(self.cylinder.lobe.analytic_height());
            match self.cylinder.lobe {
                Lobe::Logistic(density) => table.push(|phi| density.at(phi)),
                Lobe::Narrow(density) => table.push(|phi| density.at(phi)),
                Lobe::Gaussian(density) => table.push(|phi| density.at(phi)),
            };
            table
        })
    }
}

/// A viewer without a light.
fn viewer_angles(outgoing: &Direction) -> FibreAngles {
    FibreAngles {
        sin_theta_i: 0.0,
        cos_theta_i: 1.0,
        sin_theta_o: outgoing.x,
        cos_theta_o: outgoing.y.hypot(outgoing.z),
        phi: 0.0,
    }
}

/// What becomes of light at one position across the fibre.
struct Paths {
    /// Probabilities of R, TT, TRT and all later paths.
    shares: [f64; 4],
    /// Φₚ of the first three.
    exits: [f64; 3],
}

impl Paths {
    fn at(angles: &FibreAngles, eta: f64, sigma_a: f64, h: f64) -> Self {
        let refraction = Refraction::new(eta, angles.sin_theta_o, angles.cos_theta_o);
        let attenuation = Attenuation::at(&refraction, h, sigma_a);
        let ([a, b, c], total) = (attenuation.direct, attenuation.total());
        Self { shares: [a, b, c, attenuation.later].map(|share| share / total), exits: exits(&refraction, h) }
    }
}

/// Φₚ = 2pγt − 2γ + pπ of R, TT and TRT.
fn exits(refraction: &Refraction, h: f64) -> [f64; 3] {
    let gamma = h.clamp(-1.0, 1.0).asin();
    let gamma_t = (h * refraction.inverse_eta_prime).asin();
    std::array::from_fn(|p| {
        let p = p as f64;
        2.0 * p * gamma_t - 2.0 * gamma + p * PI
    })
}

/// Scattering function at h = sinγ, −1 to 1, in the frame of the viewer's azimuth.
pub(super) fn near_field<D: Density>(
    density: D,
    refraction: &Refraction,
    phi: f64,
    longitudinal: [f64; 3],
    h: f64,
    sigma_a: f64,
) -> f64 {
    let attenuation = Attenuation::at(refraction, h, sigma_a);
    // Paths without an own lobe leave in all azimuths alike, as wide as TRT along the fibre.
    let mut sum = longitudinal[2] * attenuation.later * 0.5 * FRAC_1_PI;
    for ((share, m), exit) in attenuation.direct.into_iter().zip(longitudinal).zip(exits(refraction, h)) {
        let difference = phi - exit;
        let distance = (difference - (difference / TAU).round() * TAU).abs();
        sum += m * share * density.at(distance.min(PI));
    }
    sum
}
