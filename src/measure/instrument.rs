//! What turns a scattering function into a reading: two cones, a bandwidth, a gain and an offset.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Geometry, Quantity};
use crate::bsdf::{Bsdf, Direction};
use crate::optics::gauss_legendre;

/// The instrument as a job describes it.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Instrument {
    /// Half-angle of the cone of light, degrees; 0 is a parallel beam.
    pub light_half_angle_deg: f64,
    /// Half-angle of the cone that the viewer collects, degrees; 0 is a single direction.
    pub viewer_half_angle_deg: f64,
    /// Full width at half maximum of the (Gaussian) spectral response, nm; 0 is a single wavelength.
    pub bandwidth_nm: f64,
    /// Factor between the model's reading and the table's.
    pub gain: Calibration,
    /// Constant added to the model's reading: stray light, a diffuse background.
    pub offset: Calibration,
}

/// How a gain or an offset is shared between spectra.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Calibration {
    /// Known: gain 1, offset 0, or what the job's parameters say.
    #[default]
    Fixed,
    /// One for the whole table.
    Shared,
    /// One for each spectrum.
    PerSpectrum,
}

/// Abscissae and weights of the Gauss–Hermite rule with five nodes for a standard normal density (Abramowitz & Stegun
/// 1964, Table 25.10, abscissae times √2, weights over √π): exact for polynomials up to degree 9.
const NORMAL_NODES: [(f64, f64); 5] = [
    (-2.856_970_013_872_805_6, 0.011_257_411_327_720_69),
    (-1.355_626_179_974_265_7, 0.222_075_922_005_612_6),
    (0.0, 0.533_333_333_333_333_4),
    (1.355_626_179_974_265_7, 0.222_075_922_005_612_6),
    (2.856_970_013_872_805_6, 0.011_257_411_327_720_69),
];

/// Full width at half maximum of a normal density over its standard deviation, 2√(2 ln 2).
const FWHM_PER_SIGMA: f64 = 2.354_820_045_030_949;

/// A band of wavelengths seen by one reading: the model's channels it needs and their weights.
#[derive(Debug, Clone, PartialEq)]
pub struct Band {
    /// Wavelengths at which the model is evaluated, grouped by reading: nodes of the first, of the second…
    pub wavelengths_nm: Vec<f64>,
    /// Weight of each node, the same for every reading; one node where the bandwidth is zero.
    weights: Vec<f64>,
}

impl Band {
    /// Channels that the readings at these wavelengths need, for a bandwidth (full width at half maximum) in nm.
    pub fn new(wavelengths_nm: &[f64], bandwidth_nm: f64) -> Self {
        if bandwidth_nm <= 0.0 {
            return Self { wavelengths_nm: wavelengths_nm.to_vec(), weights: vec![1.0] };
        }
        let sigma_nm = bandwidth_nm / FWHM_PER_SIGMA;
        let nodes =
            wavelengths_nm.iter().flat_map(|centre| NORMAL_NODES.iter().map(move |(x, _)| centre + sigma_nm * x));
        Self { wavelengths_nm: nodes.collect(), weights: NORMAL_NODES.iter().map(|(_, weight)| *weight).collect() }
    }

    /// Whether each reading needs only its own wavelength.
    pub fn is_sharp(&self) -> bool {
        self.weights.len() == 1
    }

    /// Averages the model's channels into one value a reading.
    pub fn average(&self, channels: &[f64], readings: &mut [f64]) {
        for (reading, nodes) in readings.iter_mut().zip(channels.chunks_exact(self.weights.len())) {
            *reading = nodes.iter().zip(&self.weights).map(|(value, weight)| value * weight).sum();
        }
    }
}

/// One geometry as an instrument with given cones sees it: pairs of directions with weights that sum to one for a
/// Lambertian surface of the table's unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Aperture {
    pairs: Vec<(Direction, Direction, f64)>,
}

impl Aperture {
    /// Pairs of directions for this geometry, with `rings` Gauss rings of directions in each cone that is open.
    ///
    /// A reading is ∫∫ f cosθi cosθo dωi dωo over both cones, divided by the same integral of the reading's unit: of 1
    /// for [`Quantity::Brdf`], of 1/π (the white standard) for [`Quantity::Reflectance`]; for [`Quantity::BsdfCos`] the
    /// viewer's cosine stays in, and the light's irradiance and the viewer's solid angle are divided out.
    pub fn new(geometry: &Geometry, instrument: &Instrument, quantity: Quantity, rings: usize) -> Self {
        let light = cone(&geometry.incoming(), instrument.light_half_angle_deg, rings);
        let viewer = cone(&geometry.outgoing(), instrument.viewer_half_angle_deg, rings);
        let irradiance: f64 = light.iter().map(|(direction, weight)| weight * direction.z.max(0.0)).sum();
        let projected: f64 = viewer.iter().map(|(direction, weight)| weight * direction.z.max(0.0)).sum();
        let unit = match quantity {
            Quantity::Brdf => 1.0 / (irradiance * projected),
            Quantity::Reflectance => std::f64::consts::PI / (irradiance * projected),
            Quantity::BsdfCos => 1.0 / irradiance,
        };
        let mut pairs = Vec::with_capacity(light.len() * viewer.len());
        for (incoming, light_weight) in &light {
            for (outgoing, viewer_weight) in &viewer {
                let weight = unit * light_weight * viewer_weight * incoming.z.max(0.0) * outgoing.z.max(0.0);
                if weight > 0.0 {
                    pairs.push((*incoming, *outgoing, weight));
                }
            }
        }
        Self { pairs }
    }

    /// Writes the reading in each channel; `scratch` is as long as `readings`.
    pub fn read(&self, bsdf: &dyn Bsdf, scratch: &mut [f64], readings: &mut [f64]) {
        // Zero cones are the usual case, and need no sum.
        let [(incoming, outgoing, weight)] = self.pairs[..] else { return self.read_cones(bsdf, scratch, readings) };
        bsdf.evaluate(&incoming, &outgoing, readings);
        for reading in readings {
            *reading *= weight;
        }
    }

    fn read_cones(&self, bsdf: &dyn Bsdf, scratch: &mut [f64], readings: &mut [f64]) {
        readings.fill(0.0);
        for (incoming, outgoing, weight) in &self.pairs {
            bsdf.evaluate(incoming, outgoing, scratch);
            for (reading, value) in readings.iter_mut().zip(&*scratch) {
                *reading += weight * value;
            }
        }
    }
}

/// Directions in a cone around an axis with weights that sum to one: Gauss–Legendre in the cosine, so that each ring
/// stands for its share of the solid angle, and twice as many azimuths as a ring's rank in the rule needs.
fn cone(axis: &Direction, half_angle_deg: f64, rings: usize) -> Vec<(Direction, f64)> {
    if half_angle_deg <= 0.0 {
        return vec![(*axis, 1.0)];
    }
    let cos_edge = half_angle_deg.to_radians().cos();
    let azimuths = 4 * rings;
    let (side, up) = perpendicular(axis);
    let mut directions = Vec::with_capacity(rings * azimuths);
    for (node, weight) in gauss_legendre(rings) {
        let cos_theta = 1.0 - (1.0 - cos_edge) * node;
        let sin_theta = (1.0 - cos_theta * cos_theta).max(0.0).sqrt();
        for step in 0..azimuths {
            let phi = std::f64::consts::TAU * (as_f64(step) + 0.5) / as_f64(azimuths);
            let direction = axis * cos_theta + (side * phi.cos() + up * phi.sin()) * sin_theta;
            directions.push((direction, weight / as_f64(azimuths)));
        }
    }
    directions
}

/// Two unit vectors that complete a unit vector to a right-handed frame.
fn perpendicular(axis: &Direction) -> (Direction, Direction) {
    let helper = if axis.x.abs() < 0.9 { Direction::x() } else { Direction::y() };
    let side = axis.cross(&helper).normalize();
    (side, axis.cross(&side))
}

#[expect(clippy::cast_precision_loss, reason = "counts of rings and azimuths are far below 2^53")]
fn as_f64(count: usize) -> f64 {
    count as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::Sample;

    struct Lambertian;

    impl Bsdf for Lambertian {
        fn evaluate(&self, _: &Direction, _: &Direction, values: &mut [f64]) {
            values.fill(std::f64::consts::FRAC_1_PI);
        }

        fn sample(&self, _: &Direction, _: [f64; 3]) -> Option<Sample> {
            unreachable!("an instrument evaluates and never draws")
        }

        fn density(&self, _: &Direction, _: &Direction) -> f64 {
            unreachable!("an instrument evaluates and never draws")
        }
    }

    /// A white Lambertian surface reads as the standard in any geometry and any cones, by definition of the reading.
    #[test]
    fn white_standard_reads_one() {
        let instrument = Instrument { light_half_angle_deg: 4.0, viewer_half_angle_deg: 12.0, ..Instrument::default() };
        for theta_deg in [0.0, 30.0, 85.0] {
            let aperture = Aperture::new(&Geometry::mirror(theta_deg), &instrument, Quantity::Reflectance, 3);
            let (mut scratch, mut reading) = ([0.0], [0.0]);
            aperture.read(&Lambertian, &mut scratch, &mut reading);
            approx::assert_relative_eq!(reading[0], 1.0, max_relative = 1e-13); // rounding of a few hundred terms
        }
    }

    /// Mean of cosθ over a cone around the normal has the closed form (1 + cos a)/2.
    #[test]
    fn cone_mean_of_cosine() {
        let cone = cone(&Direction::z(), 35.0, 2);
        let mean: f64 = cone.iter().map(|(direction, weight)| weight * direction.z).sum();
        approx::assert_relative_eq!(mean, 0.5 * (1.0 + 35f64.to_radians().cos()), max_relative = 1e-14);
    }

    /// A Gaussian band damps cos(kλ) by exp(−k²σ²/2); five nodes hold that to 1e-4 up to kσ = 1, where a fringe has
    /// all but lost a third of its contrast.
    #[test]
    fn band_damps_a_fringe() {
        let (centre_nm, bandwidth_nm) = (500.0, 10.0);
        let sigma_nm = bandwidth_nm / FWHM_PER_SIGMA;
        let wavenumber = 1.0 / sigma_nm;
        let band = Band::new(&[centre_nm], bandwidth_nm);
        let channels: Vec<f64> = band.wavelengths_nm.iter().map(|nm| ((nm - centre_nm) * wavenumber).cos()).collect();
        let mut reading = [0.0];
        band.average(&channels, &mut reading);
        approx::assert_abs_diff_eq!(reading[0], (-0.5f64).exp(), epsilon = 1e-4);
    }
}
