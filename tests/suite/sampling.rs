//! What every model draws: that directions come as its density says, that nothing is missing, and that what is drawn adds up
//! to what is evaluated.
//!
//! For a model and a viewer the sphere is cut into cells. Over each the density is integrated by Gauss's rule; the draws
//! that fell into it are counted. χ² compares the two. The integrals, the rejected share and the straight-through share sum to
//! 1. The mean of f |n·ωi| over density is the directional albedo, which the same rule gives without any draw.

use std::f64::consts::{PI, TAU};

use barbule::bsdf::cylinder::{
    AzimuthalLobe, Cylinder, CylinderDesign, CylinderModel, CylinderParameters, FilmedCylinderDesign,
    FilmedCylinderModel, LongitudinalMapping, NearFieldCylinderModel,
};
use barbule::bsdf::spongy_barb::SpongyBarbModel;
use barbule::bsdf::{
    BarbDesign, BarbuleDesign, Bsdf, CoatedBase, Design, Direction, Distribution, Feather, FeatherDesign,
    FilmAtUnknownAngle, FilmAtUnknownAngleDesign, GranierHeidrich, GranierHeidrichDesign, IridescentPlastic,
    IridescentPlasticDesign, Lambertian, LambertianDesign, MicrofacetDesign, MicrofacetInterface, Model, NormalSource,
    Oriented, PigmentedBase, PigmentedBaseDesign, RoughPlastic, RoughPlasticDesign,
};
use proptest::prelude::*;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use statrs::distribution::{ChiSquared, ContinuousCDF, Normal};

use super::directions::{RGB_NM, any_direction, spherical, values};

/// How finely a viewer is looked at.
#[derive(Clone, Copy)]
pub(super) struct Effort {
    /// Cells between the poles; around there are twice as many.
    polar: usize,
    /// Cells between the poles for the albedo, where a point costs an evaluation.
    albedo_polar: usize,
    /// How often a cell of the albedo may be cut in four.
    albedo_depth: usize,
    draws: usize,
}

/// Cells of 4.5°, a third of the width of the lobes that are tested with it.
pub(super) const QUICK: Effort = Effort { polar: 40, albedo_polar: 30, albedo_depth: 0, draws: 30_000 };

/// Cells of 2°. The narrowest lobes that are looked at, mirrored at 88° by a roughness of 0.05, are narrower around the
/// normal; their middle lies on a cell's edge, where the cell's points see them and cut it up.
const LONG: Effort = Effort { polar: 90, albedo_polar: 90, albedo_depth: 5, draws: 300_000 };

/// Nodes and weights of Gauss's rule of four points on [−1, 1] (Abramowitz and Stegun 1964, table 25.4).
const GAUSS: [(f64, f64); 4] = [
    (-0.861_136_311_594_053, 0.347_854_845_137_454),
    (-0.339_981_043_584_856, 0.652_145_154_862_546),
    (0.339_981_043_584_856, 0.652_145_154_862_546),
    (0.861_136_311_594_053, 0.347_854_845_137_454),
];

/// What was found for one viewer.
#[derive(Debug)]
struct Finding {
    name: String,
    /// ∫ density + rejected share + straight-through share.
    total: f64,
    /// Probability of so large a χ² or a larger one.
    p: f64,
    /// For each channel mean of weights, its standard error, and the albedo.
    albedos: Vec<[f64; 3]>,
    largest_weight: f64,
    rejected: f64,
}

fn look(name: String, bsdf: &dyn Bsdf, channels: usize, outgoing: &Direction, effort: Effort) -> Finding {
    let cells = integrate_density(bsdf, outgoing, effort);
    let albedos = integrate_albedo(bsdf, channels, outgoing, effort);
    let through = bsdf.straight_through(outgoing);

    let mut random = ChaCha8Rng::seed_from_u64(20_251);
    let mut counts = vec![0.0; cells.len()];
    let (mut sums, mut squares) = (vec![0.0; channels], vec![0.0; channels]);
    let mut values = vec![0.0; channels];
    let mut largest_weight: f64 = 0.0;
    for _ in 0..effort.draws {
        let Some(sample) = bsdf.sample(outgoing, random.random()) else { continue };
        assert!((sample.incoming.norm() - 1.0).abs() < 1e-9, "{name}: drew {}", sample.incoming);
        if sample.straight_through {
            assert_eq!(sample.incoming, -outgoing);
            // Drawn with its share, it counts as 1.
            sums.iter_mut().chain(&mut squares).for_each(|sum| *sum += 1.0);
            continue;
        }
        let density = bsdf.density(&sample.incoming, outgoing);
        assert!(sample.density > 0.0 && (sample.density / density - 1.0).abs() < 1e-9, "{name}: {sample:?}, {density}");
        counts[cell_of(&sample.incoming, effort.polar)] += 1.0;
        bsdf.evaluate(&sample.incoming, outgoing, &mut values);
        for ((value, sum), square) in values.iter().zip(&mut sums).zip(&mut squares) {
            let weight = value * sample.incoming.z.abs() / sample.density;
            assert!(weight.is_finite(), "{name}: weight {weight} at {}", sample.incoming);
            largest_weight = largest_weight.max(weight);
            *sum += weight;
            *square += weight * weight;
        }
    }
    let draws = effort.draws as f64;
    let albedos = sums.iter().zip(&squares).zip(albedos).map(|((sum, square), albedo)| {
        let mean = sum / draws;
        [mean, ((square / draws - mean * mean).max(0.0) / draws).sqrt(), albedo + through]
    });
    let rejected = rejected_share(bsdf, outgoing);
    Finding {
        total: cells.iter().sum::<f64>() + rejected + through,
        p: chi_squared(&cells, &counts, draws),
        albedos: albedos.collect(),
        largest_weight,
        rejected,
        name,
    }
}

/// Corners of the cells, ring by ring.
fn corners(polar: usize) -> impl Iterator<Item = (f64, f64)> {
    let size = PI / polar as f64;
    (0..polar).flat_map(move |ring| (0..2 * polar).map(move |segment| (ring as f64 * size, segment as f64 * size)))
}

/// The integral of the density over each cell.
fn integrate_density(bsdf: &dyn Bsdf, outgoing: &Direction, effort: Effort) -> Vec<f64> {
    let density = |incoming: &Direction, values: &mut [f64]| values[0] = bsdf.density(incoming, outgoing);
    let size = PI / effort.polar as f64;
    let tolerance = tolerance(effort.polar);
    corners(effort.polar).map(|corner| refined(&density, 1, corner, size, tolerance, 5)[0]).collect()
}

/// ∫ f |n·ωi| dωi of each channel.
pub(super) fn integrate_albedo(bsdf: &dyn Bsdf, channels: usize, outgoing: &Direction, effort: Effort) -> Vec<f64> {
    let scattered = |incoming: &Direction, values: &mut [f64]| {
        bsdf.evaluate(incoming, outgoing, values);
        values.iter_mut().for_each(|value| *value *= incoming.z.abs());
    };
    let size = PI / effort.albedo_polar as f64;
    let tolerance = tolerance(effort.albedo_polar);
    let mut albedos = vec![0.0; channels];
    for corner in corners(effort.albedo_polar) {
        for (albedo, cell) in
            albedos.iter_mut().zip(refined(&scattered, channels, corner, size, tolerance, effort.albedo_depth))
        {
            *albedo += cell;
        }
    }
    albedos
}

/// Error of one cell that leaves 1e-3 of the sphere at worst, were all of one sign.
fn tolerance(polar: usize) -> f64 {
    1e-3 / (2 * polar * polar) as f64
}

/// An integrand with a value for each channel.
type Integrand<'a> = dyn Fn(&Direction, &mut [f64]) + 'a;

/// Cuts a cell in four until that changes nothing, or `depth` times. There are steps: a GGX surface has vertical microfacets, and
/// beyond what these refract there is nothing. Where a step lies between a cell's edge and the first points of the rule, only
/// the corners see it.
fn refined(
    value: &Integrand<'_>,
    channels: usize,
    corner: (f64, f64),
    size: f64,
    tolerance: f64,
    depth: usize,
) -> Vec<f64> {
    let whole = gauss(value, channels, corner, size);
    let small = whole.iter().all(|cell| *cell < tolerance);
    let hidden = small && largest_at_corners(value, channels, corner, size) * size * size >= tolerance;
    if depth == 0 || small && !hidden {
        return whole;
    }
    let half = 0.5 * size;
    let quarters = [(0.0, 0.0), (0.0, half), (half, 0.0), (half, half)].map(|(a, b)| (corner.0 + a, corner.1 + b));
    let sum = |parts: [Vec<f64>; 4]| -> Vec<f64> {
        (0..channels).map(|channel| parts.iter().map(|part| part[channel]).sum()).collect()
    };
    let finer = sum(quarters.map(|quarter| gauss(value, channels, quarter, half)));
    if !hidden && finer.iter().zip(&whole).all(|(finer, whole)| (finer - whole).abs() < tolerance) {
        return finer;
    }
    sum(quarters.map(|quarter| refined(value, channels, quarter, half, tolerance, depth - 1)))
}

fn largest_at_corners(value: &Integrand<'_>, channels: usize, (theta, phi): (f64, f64), size: f64) -> f64 {
    let mut values = vec![0.0; channels];
    let corners = [(0.0, 0.0), (0.0, size), (size, 0.0), (size, size)];
    let at_corners = corners.map(|(a, b)| {
        value(&spherical(theta + a, phi + b), &mut values);
        (theta + a).sin() * values.iter().fold(0.0, |largest: f64, value| largest.max(*value))
    });
    at_corners.into_iter().fold(0.0, f64::max)
}

/// Gauss's rule of 4 × 4 points over a cell.
fn gauss(value: &Integrand<'_>, channels: usize, (theta, phi): (f64, f64), size: f64) -> Vec<f64> {
    let (mut sums, mut values) = (vec![0.0; channels], vec![0.0; channels]);
    for (x, weight_x) in GAUSS {
        let theta = theta + 0.5 * (1.0 + x) * size;
        for (y, weight_y) in GAUSS {
            value(&spherical(theta, phi + 0.5 * (1.0 + y) * size), &mut values);
            let solid_angle = 0.25 * size * size * weight_x * weight_y * theta.sin();
            for (sum, value) in sums.iter_mut().zip(&values) {
                *sum += solid_angle * value;
            }
        }
    }
    sums
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "angles are positive, cells few")]
fn cell_of(direction: &Direction, polar: usize) -> usize {
    let size = PI / polar as f64;
    let ring = ((direction.z.clamp(-1.0, 1.0).acos() / size) as usize).min(polar - 1);
    let azimuth = direction.y.atan2(direction.x).rem_euclid(TAU);
    ring * 2 * polar + ((azimuth / size) as usize).min(2 * polar - 1)
}

/// Share of draws that are rejected, by a scrambled Sobol sequence: its error falls nearly as one over the number of points,
/// where independent draws would need millions for 1e-3.
fn rejected_share(bsdf: &dyn Bsdf, outgoing: &Direction) -> f64 {
    let count = 1 << 16;
    let rejected = (0..count).filter(|&index| {
        let random = [0, 1, 2].map(|dimension| f64::from(sobol_burley::sample(index, dimension, 7)));
        bsdf.sample(outgoing, random).is_none()
    });
    rejected.count() as f64 / f64::from(count)
}

/// Probability of so large a Σ (counted − expected)²/expected, over cells joined until each expects ten, the least for which the
/// sum is distributed as χ² to the accuracy that is asked here, and over all that fell into no cell.
fn chi_squared(cells: &[f64], counts: &[f64], draws: f64) -> f64 {
    let mut order: Vec<usize> = (0..cells.len()).collect();
    order.sort_by(|&a, &b| cells[a].total_cmp(&cells[b]));
    let (mut sum, mut groups) = (0.0, 0_u32);
    let (mut expected, mut counted) = (0.0, 0.0);
    for cell in order {
        expected += cells[cell] * draws;
        counted += counts[cell];
        if expected >= 10.0 {
            sum += (counted - expected) * (counted - expected) / expected;
            groups += 1;
            (expected, counted) = (0.0, 0.0);
        }
    }
    // The rest: rejected draws, straight-through ones, and the cells that were left over.
    let (expected, counted) =
        (expected + (1.0 - cells.iter().sum::<f64>()) * draws, counted + draws - counts.iter().sum::<f64>());
    if expected >= 10.0 {
        sum += (counted - expected) * (counted - expected) / expected;
        groups += 1;
    }
    assert!(groups > 1, "one cell holds all draws");
    ChiSquared::new(f64::from(groups - 1)).unwrap().sf(sum)
}

/// A model with values for its parameters, and the viewers from whom it is looked at.
pub(super) struct Subject {
    pub(super) name: String,
    pub(super) model: Box<dyn Model>,
    pub(super) values: Vec<f64>,
    /// Inclination and azimuth, degrees.
    pub(super) viewers: Vec<(f64, f64)>,
}

fn subject(name: &str, model: impl Model + 'static, changes: &[(&str, f64)], viewers: &[(f64, f64)]) -> Subject {
    let values = values(&model, changes);
    let name = format!("{name} {changes:?}");
    Subject { name, model: Box::new(model), values, viewers: viewers.to_vec() }
}

fn look_at_all(subjects: &[Subject], effort: Effort) -> Vec<Finding> {
    let viewers = subjects
        .iter()
        .flat_map(|subject| subject.viewers.iter().map(move |&(theta_deg, phi_deg)| (subject, theta_deg, phi_deg)));
    let viewers: Vec<_> = viewers.collect();
    let look_at = |(subject, theta_deg, phi_deg): (&Subject, f64, f64)| {
        let outgoing = spherical(theta_deg.to_radians(), phi_deg.to_radians());
        let name = format!("{}, viewer at {theta_deg}°, {phi_deg}°", subject.name);
        look(name, subject.model.bind(&subject.values).as_ref(), subject.model.channel_count(), &outgoing, effort)
    };
    viewers.into_par_iter().map(look_at).collect()
}

/// Allowed error of an albedo by Gauss's rule, as a share of it: what halving the cells changes at most.
pub(super) const QUADRATURE: f64 = 1e-3;

/// The probability at which each of so many tests must be held for that of all.
fn of_one(of_all: f64, count: usize) -> f64 {
    1.0 - (1.0 - of_all).powf(1.0 / count as f64)
}

/// How many standard errors of each of so many numbers leave as much outside as three of a single one, 0.0027.
pub(super) fn standard_errors(count: usize) -> f64 {
    Normal::standard().inverse_cdf(1.0 - 0.5 * of_one(0.0027, count))
}

/// All that is asked of the findings; for so many of them at once each probability is one over their number (Šidák 1967).
fn judge(findings: &[Finding]) {
    let least_p = of_one(1e-3, findings.len());
    let errors = standard_errors(findings.iter().map(|finding| finding.albedos.len()).sum());
    let mut wrong = Vec::new();
    for finding in findings {
        let mut problems = Vec::new();
        if (finding.total - 1.0).abs() > 1e-3 {
            problems.push(format!("all shares sum to {}", finding.total));
        }
        if finding.p <= least_p {
            problems.push(format!("χ² has p = {:e}, below {least_p:e}", finding.p));
        }
        for [mean, error, albedo] in &finding.albedos {
            let difference = (mean - albedo).abs();
            if difference > errors * error + QUADRATURE * albedo {
                problems.push(format!("mean weight {mean} ± {error}, albedo {albedo}"));
            }
        }
        let [mean, error, albedo] = finding.albedos[0];
        println!(
            "{}: total {:.5}, p {:.4}, weights {mean:.5} ± {error:.5}, at most {:.2}, albedo {albedo:.5}, rejected {:.4}",
            finding.name, finding.total, finding.p, finding.largest_weight, finding.rejected,
        );
        if !problems.is_empty() {
            wrong.push(format!("{}: {}", finding.name, problems.join("; ")));
        }
    }
    println!("{} viewers; p at least {least_p:e}; {errors:.2} standard errors", findings.len());
    assert!(wrong.is_empty(), "{} of {} viewers:\n{}", wrong.len(), findings.len(), wrong.join("\n"));
}

fn per_channel(names: &[&str]) -> Vec<String> {
    names.iter().map(|&name| name.to_owned()).collect()
}

fn microfacet(distribution: Distribution) -> MicrofacetInterface {
    MicrofacetInterface::new(&MicrofacetDesign { distribution, per_channel: per_channel(&["eta"]) }, &RGB_NM).unwrap()
}

fn design<D: serde::de::DeserializeOwned>(text: &str) -> D {
    toml::from_str(text).unwrap()
}

const LAMELLA: &str =
    "layers = [{ name = \"cortex\", material = \"keratin\", thickness_nm = 330 }]\nsubstrate = \"bird_melanin\"";

/// Each model once or more, with lobes wide enough for quick cells.
pub(super) fn subjects() -> Vec<Subject> {
    let lambertian = Lambertian::new(&LambertianDesign::default(), &RGB_NM).unwrap();
    let pigmented = PigmentedBase::new(&PigmentedBaseDesign::default(), &RGB_NM).unwrap();
    let unknown_angle: FilmAtUnknownAngleDesign =
        toml::from_str("film = \"keratin\"\nsubstrate = \"bird_melanin\"").unwrap();
    let unknown_angle = FilmAtUnknownAngle::new(&unknown_angle, &RGB_NM).unwrap();
    let plastic = || {
        RoughPlastic::new(&RoughPlasticDesign { per_channel: per_channel(&["diffuse"]), ..Default::default() }, &RGB_NM)
            .unwrap()
    };
    let iridescent = IridescentPlastic::new(
        &IridescentPlasticDesign { per_channel: per_channel(&["eta"]), ..Default::default() },
        &RGB_NM,
    );
    let granier = |design| GranierHeidrich::new(&design, &RGB_NM).unwrap();
    let tilted = GranierHeidrichDesign {
        outer_normal: NormalSource::Fixed([0.2, 0.0, 1.0]),
        inner_normal: NormalSource::Fixed([0.0, -0.3, 1.0]),
        normalised: true,
        per_channel: per_channel(&["eta"]),
        ..Default::default()
    };
    let coated = |text: &str| CoatedBase::new(&design(text), &RGB_NM).unwrap();
    let cylinder = |text: &str| CylinderModel::new(&design(text), &RGB_NM).unwrap();
    let filmed = FilmedCylinderModel::new(
        &design::<FilmedCylinderDesign>("layers = [{ name = \"cortex\", material = \"keratin\", thickness_nm = 400 }]"),
        &RGB_NM,
    );
    let feather = |design| Feather::new(&design, &RGB_NM).unwrap();
    let lamella = FeatherDesign {
        barb: BarbDesign::SpongyBarb(CylinderDesign::default()),
        barbule: BarbuleDesign::Lamella(Box::new(design::<Design>(LAMELLA))),
        ..Default::default()
    };
    let across = [(20.0, 90.0), (70.0, 30.0), (150.0, 80.0)];
    let beckmann = || microfacet(Distribution::Beckmann);
    let eta = [("eta_r", 1.4), ("eta_g", 1.6), ("eta_b", 1.6)];
    let with = |changes: &[(&'static str, f64)]| [&eta[..], changes].concat();
    vec![
        subject("Lambertian", lambertian, &[], &[(30.0, 10.0)]),
        subject("pigmented base", pigmented, &[], &[(30.0, 10.0)]),
        subject("film at unknown angle", unknown_angle, &[], &[(30.0, 10.0)]),
        subject("Beckmann", beckmann(), &with(&[("roughness", 0.2)]), &[(15.0, 40.0), (140.0, 0.0)]),
        subject("Beckmann", beckmann(), &with(&[("roughness", 0.6)]), &[(0.0, 0.0), (85.0, 200.0), (100.0, 70.0)]),
        subject(
            "GGX",
            microfacet(Distribution::Ggx),
            &with(&[("roughness", 0.4)]),
            &[(40.0, 300.0), (80.0, 0.0), (120.0, 0.0)],
        ),
        subject("rough plastic", plastic(), &[("roughness", 0.2), ("diffuse_r", 0.9)], &[(10.0, 0.0), (75.0, 60.0)]),
        subject("rough plastic", plastic(), &[("roughness", 0.7)], &[(60.0, 60.0)]),
        subject("iridescent plastic", iridescent.unwrap(), &with(&[("roughness", 0.3)]), &[(30.0, 0.0), (65.0, 0.0)]),
        subject(
            "Granier",
            granier(GranierHeidrichDesign::default()),
            &[("outer_exponent", 20.0), ("inner_exponent", 8.0)],
            &[(35.0, 20.0), (80.0, 0.0)],
        ),
        subject(
            "Granier",
            granier(tilted),
            &with(&[("outer_exponent", 0.0), ("inner_exponent", 40.0)]),
            &[(40.0, 250.0), (85.0, 180.0)],
        ),
        subject(
            "coated base",
            coated(LAMELLA),
            &[("roughness", 0.2), ("diffuse_share", 0.1)],
            &[(20.0, 0.0), (70.0, 50.0)],
        ),
        subject(
            "coated base over a diffuse base",
            coated("substrate = \"keratin\"\nlayers = [{ name = \"f\", material = \"chitin\", thickness_nm = 300 }]"),
            &[("roughness", 0.3), ("diffuse_albedo", 0.8)],
            &[(40.0, 0.0)],
        ),
        subject(
            "coated base under a clear coat",
            coated(&format!("clear_coat = 1.5\n{LAMELLA}")),
            &[("roughness", 0.2)],
            &[(50.0, 0.0)],
        ),
        subject(
            "cylinder",
            cylinder(""),
            &[("sigma_a", 0.0)],
            &[(20.0, 90.0), (70.0, 30.0), (150.0, 80.0), (90.0, 6.0)],
        ),
        subject(
            "cylinder",
            cylinder("per_channel = [\"eta\", \"sigma_a\"]"),
            &with(&[("beta_n", 0.12), ("sigma_a_b", 3.0)]),
            &across[..2],
        ),
        subject(
            "wrapped Gaussian",
            cylinder("lobe = \"wrapped_gaussian\"\nmapping = \"plain\""),
            &[("beta_n", 0.9)],
            &across[1..2],
        ),
        subject(
            "near-field cylinder",
            NearFieldCylinderModel::new(&design("per_channel = [\"eta\", \"sigma_a\"]"), &RGB_NM).unwrap(),
            &with(&[("h", 0.6), ("sigma_a_b", 3.0)]),
            &across[..2],
        ),
        subject("filmed cylinder", filmed.unwrap(), &[], &across[..2]),
        subject(
            "spongy barb",
            SpongyBarbModel::new(&CylinderDesign::default(), &RGB_NM).unwrap(),
            &[("strength", 0.8)],
            &across[1..],
        ),
        subject("feather", feather(FeatherDesign::default()), &[("through_share", 0.2)], &across[..1]),
        subject(
            "feather of lamellae",
            feather(lamella),
            &[("through_share", 0.1), ("barb_share", 0.4), ("barbule.roughness", 0.2)],
            &across[1..],
        ),
        subject("oriented cylinder", Oriented::new(Box::new(cylinder(""))), &[("tangent_deg", 40.0)], &across[1..2]),
    ]
}

#[test]
fn every_model_draws_what_its_density_says() {
    judge(&look_at_all(&subjects(), QUICK));
}

/// The same with ten times the draws, and narrow lobes besides. Some minutes.
#[test]
#[ignore = "long: run by .ci/long"]
fn every_model_draws_what_its_density_says_with_many_draws() {
    let mut subjects = subjects();
    let viewers = [(5.0, 0.0), (45.0, 100.0), (75.0, 20.0), (88.0, 250.0)];
    for roughness in [0.05, 0.1, 1.0] {
        for distribution in [Distribution::Beckmann, Distribution::Ggx] {
            let below = viewers.map(|(theta_deg, phi_deg)| (180.0 - theta_deg, phi_deg));
            let changes = [("roughness", roughness), ("eta_b", 2.5)];
            subjects.push(subject("microfacet", microfacet(distribution), &changes, &[viewers, below].concat()));
        }
        let plastic = RoughPlastic::new(&RoughPlasticDesign::default(), &RGB_NM).unwrap();
        subjects.push(subject("rough plastic", plastic, &[("roughness", roughness)], &viewers));
        let coated = CoatedBase::new(&design(LAMELLA), &RGB_NM).unwrap();
        subjects.push(subject("coated base", coated, &[("roughness", roughness)], &viewers));
    }
    for exponent in [0.0, 130.0, 1000.0] {
        let granier = GranierHeidrich::new(&GranierHeidrichDesign::default(), &RGB_NM).unwrap();
        let changes = [("outer_exponent", exponent), ("inner_exponent", exponent)];
        subjects.push(subject("Granier", granier, &changes, &viewers));
    }
    for (beta_m, beta_n) in [(0.1, 0.1), (0.3, 0.05), (0.9, 0.9)] {
        let cylinder = CylinderModel::new(&CylinderDesign::default(), &RGB_NM).unwrap();
        subjects.push(subject("cylinder", cylinder, &[("beta_m", beta_m), ("beta_n", beta_n)], &viewers));
    }
    judge(&look_at_all(&subjects, LONG));
}

fn fibre(beta_n: f64) -> Cylinder {
    Cylinder::new(&CylinderParameters {
        eta: vec![1.55; 3],
        sigma_a: vec![0.1, 0.2, 0.4],
        beta_m: 0.3,
        beta_n,
        mapping: LongitudinalMapping::Chiang,
        lobe: AzimuthalLobe::TrimmedLogistic,
    })
    .unwrap()
}

/// A table of lobes is drawn from as its fibre is.
#[test]
fn a_tabulated_fibre_draws_too() {
    let table = fibre(0.3).tabulate(1e-3);
    judge(&[look("tabulated cylinder".to_owned(), &table, 3, &spherical(0.6, 1.0), QUICK)]);
}

/// A fibre without absorption sends all light on: each weight is nearly 1, so that a single draw all but tells the albedo.
#[test]
fn a_white_fibre_draws_weights_near_one() {
    let model = CylinderModel::new(&CylinderDesign::default(), &[550.0]).unwrap();
    for (beta_m, beta_n) in [(0.3, 0.3), (0.1, 0.6), (0.6, 0.1)] {
        let bound = model.bind(&values(&model, &[("sigma_a", 0.0), ("beta_m", beta_m), ("beta_n", beta_n)]));
        let mut random = ChaCha8Rng::seed_from_u64(3);
        let (mut sum, mut square) = (0.0, 0.0);
        let draws = 4000;
        for _ in 0..draws {
            let outgoing = spherical(PI * random.random::<f64>(), TAU * random.random::<f64>());
            let sample = bound.sample(&outgoing, random.random()).expect("a fibre rejects nothing");
            let mut value = [0.0];
            bound.evaluate(&sample.incoming, &outgoing, &mut value);
            let weight = value[0] * sample.incoming.z.abs() / sample.density;
            sum += weight;
            square += weight * weight;
        }
        let mean = sum / f64::from(draws);
        let spread = (square / f64::from(draws) - mean * mean).sqrt();
        println!("β_m {beta_m}, β_n {beta_n}: {mean} ± {spread}");
        // The table's rows and points leave a few per cent; 3.5 standard errors of the mean.
        assert!(spread < 0.1, "weights spread by {spread}");
        assert!((mean - 1.0).abs() < 3.5 * spread / f64::from(draws).sqrt(), "mean weight {mean}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// Whatever the parameters and the viewer: draws are directions, their weights are numbers, and nothing that scatters
    /// has the density 0. Fibres are few, since each makes a table.
    #[test]
    fn surfaces_draw_directions(
        which in 0usize..7,
        shares in proptest::collection::vec(0.0..=1.0f64, 16),
        (incoming, outgoing) in (any_direction(), any_direction()),
        random in proptest::array::uniform3(0.0..1.0f64),
    ) {
        let model: Box<dyn Model> = match which {
            0 => Box::new(Lambertian::new(&LambertianDesign::default(), &RGB_NM).unwrap()),
            1 => Box::new(microfacet(Distribution::Beckmann)),
            2 => Box::new(microfacet(Distribution::Ggx)),
            3 => Box::new(RoughPlastic::new(&RoughPlasticDesign::default(), &RGB_NM).unwrap()),
            4 => Box::new(IridescentPlastic::new(&IridescentPlasticDesign::default(), &RGB_NM).unwrap()),
            5 => Box::new(CoatedBase::new(&design(LAMELLA), &RGB_NM).unwrap()),
            _ => Box::new(GranierHeidrich::new(
                &GranierHeidrichDesign {
                    outer_normal: NormalSource::Spherical,
                    inner_normal: NormalSource::Spherical,
                    ..Default::default()
                },
                &RGB_NM,
            ).unwrap()),
        };
        draws_directions(model.as_ref(), &shares, &incoming, &outgoing, random)?;
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn fibres_draw_directions(
        which in 0usize..4,
        shares in proptest::collection::vec(0.0..=1.0f64, 16),
        (incoming, outgoing) in (any_direction(), any_direction()),
        random in proptest::array::uniform3(0.0..1.0f64),
    ) {
        let model: Box<dyn Model> = match which {
            0 => Box::new(CylinderModel::new(&CylinderDesign::default(), &RGB_NM).unwrap()),
            1 => Box::new(SpongyBarbModel::new(&CylinderDesign::default(), &RGB_NM).unwrap()),
            2 => Box::new(FilmedCylinderModel::new(&design("layers = []"), &RGB_NM).unwrap()),
            _ => Box::new(Feather::new(&FeatherDesign::default(), &RGB_NM).unwrap()),
        };
        draws_directions(model.as_ref(), &shares, &incoming, &outgoing, random)?;
    }
}

fn draws_directions(
    model: &dyn Model,
    shares: &[f64],
    incoming: &Direction,
    outgoing: &Direction,
    random: [f64; 3],
) -> Result<(), TestCaseError> {
    let parameters = model.parameters().iter().zip(shares.iter().cycle());
    let values: Vec<f64> =
        parameters.map(|(parameter, share)| parameter.lower + share * (parameter.upper - parameter.lower)).collect();
    let bound = model.bind(&values);
    let mut found = [0.0; 3];
    if let Some(sample) = bound.sample(outgoing, random) {
        prop_assert!((sample.incoming.norm() - 1.0).abs() < 1e-9, "drew {}", sample.incoming);
        if !sample.straight_through {
            prop_assert!(sample.density > 0.0 && sample.density.is_finite(), "{sample:?}");
            bound.evaluate(&sample.incoming, outgoing, &mut found);
            let weights = found.map(|value| value * sample.incoming.z.abs() / sample.density);
            prop_assert!(weights.iter().all(|weight| weight.is_finite()), "{weights:?} at {sample:?}");
        }
    }
    let density = bound.density(incoming, outgoing);
    bound.evaluate(incoming, outgoing, &mut found);
    prop_assert!(density >= 0.0 && density.is_finite(), "density {density}");
    // What is so small that it is rounded away in the product of many factors does not count.
    prop_assert!(density > 0.0 || found.iter().all(|value| *value < 1e-100), "density 0 where f is {found:?}");
    Ok(())
}
