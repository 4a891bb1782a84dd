//! A painted vane: which values its model's parameters have where, and the few shades that stand for all of them.
//!
//! Every texel has a share of each layer. Shares are told apart in levels, chosen for each layer so that half-way between
//! two of them the scattering function is their mean to [`LEVEL_TOLERANCE`]; between two levels a texel is a mixture of
//! both, in the proportion of its own share. So the picture is that of the scattering function interpolated between
//! levels: continuous, with that error. Of several layers that lie between levels at one texel, the one farthest from its
//! nearer level is mixed so, and the others fall to one of their levels at random, in proportion.

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::error::SceneProblem;
use super::file::MaterialFile;
use super::inputs::Inputs;
use super::mask::Mask;
use super::material::{Spectrum, model, values, wrong_value};
use super::paint_file::{BarbsShown, LayerFile};
use crate::bsdf::{BarbDesign, BarbuleDesign, Direction, FeatherDesign, Model};
use crate::geometry::{FeatherMap, VanePlace};
use crate::job::ModelFile;
use crate::nearest::suggestion;
use crate::render::{Blend, Material, Pattern, Scene, mixed, unit};

/// Largest difference between the scattering function half-way between two levels and the mean of both, as a share of itself and
/// a fifth of the brightest level: two steps of an 8-bit screen in the middle of its scale. Between two levels the mixture is
/// too bright by that at most, two thirds of it on average.
const LEVEL_TOLERANCE: f64 = 0.02;

/// A level's number in a key of shades has 8 bits, and a key 8 levels.
const MOST_LAYERS: usize = 8;
const MOST_HALVINGS: u32 = 6;

/// Shades of barbs or of barbules at most: their tables take some hundred megabytes.
const MOST_SHADES: usize = 1024;

/// What is to be painted.
pub(super) struct Canvas<'a> {
    pub(super) map: &'a FeatherMap,
    /// Where each texel lies, in rows from the top; empty where the map came without the feather.
    pub(super) places: &'a [Option<VanePlace>],
    pub(super) barbs: BarbsShown,
    pub(super) layers: &'a [LayerFile],
}

/// A layer, checked against the vane's model.
struct Layer {
    mask: Mask,
    /// Positions of parameters and their values.
    targets: Vec<(usize, f64)>,
    /// Shares from 0 to 1.
    levels: Vec<f64>,
}

/// What lies at a texel: levels of all layers, twice, and the share of the second.
#[derive(Debug, Clone, Copy)]
struct Spot {
    keys: [u64; 2],
    second: f32,
    ramus: f32,
}

/// Paints a vane, adding its shades to the scene's materials.
pub(super) fn painted(
    key: &str,
    material: &MaterialFile,
    canvas: &Canvas<'_>,
    spectrum: &Spectrum,
    scene: &mut Scene,
    inputs: &mut Inputs,
) -> Result<Pattern, SceneProblem> {
    if canvas.layers.len() > MOST_LAYERS {
        let problem = format!("found {} layers; expected at most {MOST_LAYERS}", canvas.layers.len());
        return Err(SceneProblem::key(format!("{key}.paint"), problem));
    }
    if material.texture.is_some() {
        let problem = "the vane's material has a texture, which cannot be painted on; take one of the two out";
        return Err(SceneProblem::key(format!("{key}.paint"), problem));
    }
    let vane = model(&format!("{key}.vane"), &material.model, spectrum.wavelengths_nm())?;
    let base = values(&format!("{key}.vane"), vane.as_ref(), material)?;
    let mut layers = Vec::new();
    for (number, plan) in (1..).zip(canvas.layers) {
        layers.push(layer(&format!("{key}.paint[{number}]"), number, plan, vane.as_ref(), &base, canvas, inputs)?);
    }
    let spots = spots(canvas, &layers);
    let mut shades: BTreeMap<u64, Vec<f64>> = BTreeMap::new();
    for spot in spots.iter().flatten() {
        for key in spot.keys {
            shades.entry(key).or_insert_with(|| shade(&base, &layers, key));
        }
    }

    let parts = match canvas.barbs {
        BarbsShown::Averaged => vec![Part::whole(vane)],
        BarbsShown::Resolved => resolved(key, material, vane.as_ref(), spectrum)?,
    };
    // For each part its number in the scene, shade by shade.
    let mut numbers: Vec<BTreeMap<u64, u16>> = Vec::new();
    for part in parts {
        let (distinct, of_key) = part.shades(&shades);
        if distinct.len() > MOST_SHADES {
            let problem = format!(
                "the layers make {} different shades; expected at most {MOST_SHADES}: use fewer layers, or fewer that \
                 change gradually at one place",
                distinct.len()
            );
            return Err(SceneProblem::key(format!("{key}.paint"), problem));
        }
        let made = Material::shaded(part.model, distinct, spectrum.mix().cloned());
        let first = scene.add_material(made.map_err(|problem| wrong_value(&format!("{key}.vane"), problem))?);
        let number = |shade: usize| u16::try_from(first + shade).unwrap_or(u16::MAX);
        numbers.push(of_key.into_iter().map(|(key, shade)| (key, number(shade))).collect());
    }
    let blend = |spot: &Option<Spot>| match spot {
        None => Blend::pure(0),
        Some(spot) => {
            let [first, second] = [1.0 - spot.second, spot.second];
            let of = |part: usize, which: usize| numbers[part][&spot.keys[which]];
            match canvas.barbs {
                BarbsShown::Averaged => Blend::new([(of(0, 0), first), (of(0, 1), second), (0, 0.0), (0, 0.0)]),
                BarbsShown::Resolved => {
                    let (barb, barbules) = (spot.ramus, 1.0 - spot.ramus);
                    let barb = [(of(0, 0), barb * first), (of(0, 1), barb * second)];
                    let barbules = [(of(1, 0), barbules * first), (of(1, 1), barbules * second)];
                    Blend::new([barb[0], barb[1], barbules[0], barbules[1]])
                }
            }
        }
    };
    let width = canvas.map.width() as usize;
    let blends = spots.par_iter().map(blend).collect();
    Pattern::new(width, blends).ok_or_else(|| SceneProblem::key(key, "its map has no texels"))
}

fn layer(
    key: &str,
    number: u64,
    plan: &LayerFile,
    vane: &dyn Model,
    base: &[f64],
    canvas: &Canvas<'_>,
    inputs: &mut Inputs,
) -> Result<Layer, SceneProblem> {
    let mask = Mask::new(&format!("{key}.where"), &plan.mask, number, inputs)?;
    if mask.needs_places() && canvas.places.is_empty() {
        let problem = "a map alone does not tell where its texels lie on their vane; name a feather's JSON in `file`, or \
                       paint by a `picture`";
        return Err(SceneProblem::key(format!("{key}.where"), problem));
    }
    let names = || vane.parameters().iter().map(|parameter| parameter.name.as_str());
    let mut targets = Vec::new();
    for (name, value) in &plan.set {
        let position = names().position(|known| known == name).ok_or_else(|| {
            let known = names().collect::<Vec<_>>().join(", ");
            let problem =
                format!("the vane's model has no such parameter; it has {known}{}", suggestion(name, names()));
            SceneProblem::key(format!("{key}.set.{name}"), problem)
        })?;
        targets.push((position, *value));
    }
    if targets.is_empty() {
        return Err(SceneProblem::key(format!("{key}.set"), "it sets nothing; give a parameter and its value"));
    }
    let wholly = moved(base, &targets, 1.0);
    vane.check(&wholly).map_err(|problem| wrong_value(&format!("{key}.set"), problem))?;
    let levels = levels(vane, base, &targets, canvas.barbs);
    Ok(Layer { mask, targets, levels })
}

/// These values moved towards the targets by a share of the way.
fn moved(values: &[f64], targets: &[(usize, f64)], share: f64) -> Vec<f64> {
    let mut values = values.to_vec();
    for &(position, target) in targets {
        values[position] += share * (target - values[position]);
    }
    values
}

/// The shares at which a layer is told apart.
fn levels(vane: &dyn Model, base: &[f64], targets: &[(usize, f64)], barbs: BarbsShown) -> Vec<f64> {
    let mut base = base.to_vec();
    // Where barbs are told apart from barbules, both must count.
    if let (BarbsShown::Resolved, Some(share)) = (barbs, vane.parameters().iter().position(|p| p.name == "barb_share"))
    {
        base[share] = vane.parameters()[share].upper;
    }
    let response = |share: f64| responses(vane, &moved(&base, targets, share));
    let (none, all) = (response(0.0), response(1.0));
    let brightest: Vec<f64> = none.iter().zip(&all).map(|(a, b)| a.max(*b)).collect();
    let mut levels = vec![0.0];
    divide([0.0, 1.0], [&none, &all], &brightest, &response, MOST_HALVINGS, &mut levels);
    levels
}

/// Appends the levels after the first end of an interval, the other end last.
fn divide(
    ends: [f64; 2],
    values: [&[f64]; 2],
    brightest: &[f64],
    response: &impl Fn(f64) -> Vec<f64>,
    halvings: u32,
    levels: &mut Vec<f64>,
) {
    let middle = 0.5 * (ends[0] + ends[1]);
    let found = response(middle);
    let is_mean = (0..found.len()).all(|k| {
        let mean = 0.5 * (values[0][k] + values[1][k]);
        (found[k] - mean).abs() <= LEVEL_TOLERANCE * (found[k] + 0.2 * brightest[k])
    });
    if is_mean || halvings == 0 {
        levels.push(ends[1]);
        return;
    }
    divide([ends[0], middle], [values[0], &found], brightest, response, halvings - 1, levels);
    divide([middle, ends[1]], [&found, values[1]], brightest, response, halvings - 1, levels);
}

/// The scattering function for a few pairs of directions, all channels.
fn responses(vane: &dyn Model, values: &[f64]) -> Vec<f64> {
    let bound = vane.bind(values);
    let direction = |x: f64, y: f64| Direction::new(x, y, (1.0 - x * x - y * y).sqrt());
    let pairs = [
        (direction(0.0, 0.0), direction(0.0, 0.0)),
        (direction(0.1, 0.6), direction(0.0, 0.1)),
        (direction(0.2, -0.4), direction(-0.1, 0.7)),
        (-direction(0.0, 0.3), direction(0.1, 0.2)),
    ];
    let mut all = Vec::new();
    for (incoming, outgoing) in pairs {
        let mut channels = vec![0.0; vane.channel_count()];
        bound.evaluate(&incoming, &outgoing, &mut channels);
        all.extend(channels);
    }
    all
}

/// The values of a shade: the base with each layer at its level.
fn shade(base: &[f64], layers: &[Layer], key: u64) -> Vec<f64> {
    let mut values = base.to_vec();
    for (number, layer) in layers.iter().enumerate() {
        let level = (key >> (8 * number)) & 0xFF;
        let share = layer.levels[level as usize];
        values = moved(&values, &layer.targets, share);
    }
    values
}

/// What lies at each texel of a barb or its barbules.
fn spots(canvas: &Canvas<'_>, layers: &[Layer]) -> Vec<Option<Spot>> {
    let (width, height) = (canvas.map.width(), canvas.map.height());
    let spot = |index: usize| {
        let place = match canvas.places.get(index) {
            Some(None) => return None,
            Some(place) => place.as_ref(),
            None => None,
        };
        let (column, row) = (index % width as usize, index / width as usize);
        let uv = [(column as f64 + 0.5) / f64::from(width), 1.0 - (row as f64 + 0.5) / f64::from(height)];
        Some(spot(index as u64, uv, place, layers))
    };
    (0..width as usize * height as usize).into_par_iter().map(spot).collect()
}

fn spot(index: u64, uv: [f64; 2], place: Option<&VanePlace>, layers: &[Layer]) -> Spot {
    // Level below, and the place between it and the next.
    let mut between = [(0usize, 0.0f64); MOST_LAYERS];
    for (layer, between) in layers.iter().zip(&mut between) {
        let share = layer.mask.at(uv, place);
        let below = (layer.levels.partition_point(|level| *level <= share).max(1) - 1).min(layer.levels.len() - 2);
        let (from, to) = (layer.levels[below], layer.levels[below + 1]);
        *between = (below, ((share - from) / (to - from)).clamp(0.0, 1.0));
    }
    let farness = |number: &usize| (0.5 - (between[*number].1 - 0.5).abs()).max(0.0);
    let mixed_one = (0..layers.len()).max_by(|a, b| farness(a).total_cmp(&farness(b)));
    let mut keys = [0u64; 2];
    let mut second = 0.0;
    for (number, &(below, share)) in between.iter().enumerate().take(layers.len()) {
        let levels = if Some(number) == mixed_one {
            second = share;
            [below, below + 1]
        } else {
            let random = unit(mixed(mixed(index) ^ number as u64));
            [below + usize::from(random < share); 2]
        };
        for (key, level) in keys.iter_mut().zip(levels) {
            *key |= (level as u64) << (8 * number);
        }
    }
    // A level that has no share is not asked for.
    if second <= 0.0 {
        keys[1] = keys[0];
    } else if second >= 1.0 {
        keys[0] = keys[1];
    }
    #[expect(clippy::cast_possible_truncation, reason = "a share needs no more than f32")]
    Spot { keys, second: second as f32, ramus: place.map_or(0.0, |place| place.ramus) }
}

/// A material that takes its values from those of the vane's model.
struct Part {
    model: Box<dyn Model>,
    /// For each of its parameters the position among the vane's, or a value of its own.
    sources: Vec<Source>,
}

enum Source {
    Vane(usize),
    Own(f64),
}

impl Part {
    /// The vane's model itself.
    fn whole(model: Box<dyn Model>) -> Self {
        let sources = (0..model.parameters().len()).map(Source::Vane).collect();
        Self { model, sources }
    }

    /// Its distinct shades, and which one each key has.
    fn shades(&self, all: &BTreeMap<u64, Vec<f64>>) -> (Vec<Vec<f64>>, BTreeMap<u64, usize>) {
        let (mut distinct, mut of_key) = (Vec::new(), BTreeMap::new());
        let mut known: BTreeMap<Vec<u64>, usize> = BTreeMap::new();
        for (key, values) in all {
            let value = |source: &Source| match source {
                Source::Vane(position) => values[*position],
                Source::Own(value) => *value,
            };
            let own: Vec<f64> = self.sources.iter().map(value).collect();
            let bits = own.iter().map(|value| value.to_bits()).collect();
            let number = *known.entry(bits).or_insert(distinct.len());
            if number == distinct.len() {
                distinct.push(own);
            }
            of_key.insert(*key, number);
        }
        (distinct, of_key)
    }
}

/// The barb and the barbules of a feather, each by itself.
fn resolved(
    key: &str,
    material: &MaterialFile,
    vane: &dyn Model,
    spectrum: &Spectrum,
) -> Result<Vec<Part>, SceneProblem> {
    let ModelFile::Feather(design) = &material.model else {
        let problem = "barbs are told from barbules by the model `feather` alone; give the vane that model, or take \
                       `barbs` out";
        return Err(SceneProblem::key(format!("{key}.barbs"), problem));
    };
    let barb = match &design.barb {
        BarbDesign::Cylinder(design) => ModelFile::Cylinder(design.clone()),
        BarbDesign::SpongyBarb(design) => ModelFile::SpongyBarb(design.clone()),
    };
    let barbule: BarbuleDesign = design.barbule.clone();
    let barbules = ModelFile::Feather(FeatherDesign { species: None, barb: BarbDesign::default(), barbule });
    let position = |name: &str| vane.parameters().iter().position(|parameter| parameter.name == name);
    let part = |design: &ModelFile, source: &dyn Fn(&str) -> Option<usize>| -> Result<Part, SceneProblem> {
        let model = model(&format!("{key}.vane"), design, spectrum.wavelengths_nm())?;
        let source = |name: &str, default: f64| source(name).map_or(Source::Own(default), Source::Vane);
        let sources = model.parameters().iter().map(|parameter| match parameter.name.as_str() {
            "barb_share" => Source::Own(0.0),
            name => source(name, parameter.default),
        });
        let sources = sources.collect();
        Ok(Part { model, sources })
    };
    let of_barb = |name: &str| match name {
        "tangent_deg" => position(name),
        _ => position(&format!("barb.{name}")),
    };
    let of_barbules = |name: &str| if name.starts_with("barb.") { None } else { position(name) };
    Ok(vec![part(&barb, &of_barb)?, part(&barbules, &of_barbules)?])
}
