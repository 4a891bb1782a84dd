//! A flat feather: its map from a JSON file, a PNG or a kept species, and what it is made of.

use std::collections::BTreeMap;
use std::path::Path;

use super::check::{length, rectangle, vector};
use super::error::SceneProblem;
use super::file::{FeatherSheetFile, MaterialFile, PatternFile, SpeciesSheetFile};
use super::inputs::Inputs;
use super::material::{Spectrum, material};
use super::paint::{Canvas, painted};
use super::paint_file::BarbsShown;
use super::species::SpeciesFile;
use crate::geometry::{Feather, FeatherMap, GeometryError, VanePlace};
use crate::render::{Blend, Pattern, Scene, Sheet, Vanes};

/// Finds a material's number by its name, for the key that names it.
type Named<'a> = dyn Fn(&str, &str) -> Result<usize, SceneProblem> + 'a;

/// A map, and where its texels lie on their vanes if that is known.
type Mapped = (FeatherMap, Vec<Option<VanePlace>>);

/// What a feather may be made of.
pub(super) struct Materials<'a> {
    pub(super) numbers: &'a Named<'a>,
    pub(super) designs: &'a BTreeMap<String, MaterialFile>,
    pub(super) spectrum: &'a Spectrum,
}

/// Adds a feather, its map and pattern read.
pub(super) fn with_feather(
    mut scene: Scene,
    key: &str,
    design: &FeatherSheetFile,
    materials: &Materials<'_>,
    inputs: &mut Inputs,
) -> Result<Scene, SceneProblem> {
    let shaft = (materials.numbers)(&format!("{key}.shaft"), &design.shaft)?;
    let vane = (materials.numbers)(&format!("{key}.vane"), &design.vane)?;
    if let Some(pixels_per_mm) = design.pixels_per_mm {
        length(&format!("{key}.pixels_per_mm"), pixels_per_mm)?;
    }
    let is_plain = design.paint.is_empty() && design.barbs == BarbsShown::Averaged;
    let (map, places) = map(&format!("{key}.file"), design, is_plain, inputs)?;
    let corner = vector(&format!("{key}.corner_mm"), design.corner_mm)?;
    let [right, up] = edges(key, design.right, design.up, &map)?;
    let rectangle = rectangle(key, corner.into(), right, up)?;
    let vanes = match &design.pattern {
        Some(_) if !is_plain => {
            let problem = "a pattern of materials cannot be painted on, nor does it tell barbs from barbules; take it out, \
                           or `paint` and `barbs`";
            return Err(SceneProblem::key(format!("{key}.pattern"), problem));
        }
        Some(pattern) => Vanes::Pattern(self::pattern(&format!("{key}.pattern"), pattern, materials.numbers, inputs)?),
        None if is_plain => Vanes::Plain(vane),
        None if places.is_empty() && design.barbs == BarbsShown::Resolved => {
            let problem = "a map alone does not tell barbs from barbules; name a feather's JSON in `file`";
            return Err(SceneProblem::key(format!("{key}.barbs"), problem));
        }
        None => {
            let canvas = Canvas { map: &map, places: &places, barbs: design.barbs, layers: &design.paint };
            let material = &materials.designs[&design.vane];
            Vanes::Pattern(painted(key, material, &canvas, materials.spectrum, &mut scene, inputs)?)
        }
    };
    Ok(scene.with_sheet(Sheet { rectangle, map, shaft, vanes }))
}

/// Adds the feather of a kept species.
pub(super) fn with_species(
    mut scene: Scene,
    key: &str,
    design: &SpeciesSheetFile,
    spectrum: &Spectrum,
    inputs: &mut Inputs,
) -> Result<Scene, SceneProblem> {
    if let Some(pixels_per_mm) = design.pixels_per_mm {
        length(&format!("{key}.pixels_per_mm"), pixels_per_mm)?;
    }
    let file_key = format!("{key}.file");
    let path = inputs.noted(&file_key, &design.file)?;
    let entry = SpeciesFile::read(&path).map_err(|problem| SceneProblem::key(&file_key, problem.to_string()))?;
    let within = |part: &str| format!("{file_key}: {}: {part}", design.file.display());
    let feather =
        Feather::new(&entry.geometry).map_err(|slip| SceneProblem::key(within("geometry"), slip.to_string()))?;
    let mapped = FeatherMap::with_places(&feather, design.pixels_per_mm);
    let (map, places) = mapped.map_err(|problem| refused(&format!("{key}.pixels_per_mm"), &problem))?;

    let [right, up] = edges(key, design.right, design.up, &map)?;
    let centre = vector(&format!("{key}.centre_mm"), design.centre_mm)?;
    let half = |k: usize| 0.5 * (right[k] + up[k]);
    let corner = [centre.x - half(0), centre.y - half(1), centre.z - half(2)];
    let rectangle = rectangle(key, corner, right, up)?;

    let shaft = scene.add_material(material(&within("shaft"), &entry.shaft, spectrum, inputs)?);
    let canvas = Canvas { map: &map, places: &places, barbs: entry.barbs, layers: &entry.paint };
    let pattern = painted(&within("feather"), &entry.vane, &canvas, spectrum, &mut scene, inputs)?;
    Ok(scene.with_sheet(Sheet { rectangle, map, shaft, vanes: Vanes::Pattern(pattern) }))
}

/// The edges of a map's rectangle, mm.
fn edges(key: &str, right: [f64; 3], up: [f64; 3], map: &FeatherMap) -> Result<[[f64; 3]; 2], SceneProblem> {
    let [width_mm, height_mm] = map.size_mm();
    let along = |name: &str, direction: [f64; 3], length_mm: f64| {
        let key = format!("{key}.{name}");
        let direction = vector(&key, direction)?.try_normalize(0.0);
        direction
            .map(|direction| (direction * length_mm).into())
            .ok_or_else(|| SceneProblem::key(key, "found [0, 0, 0]; expected a direction, of any other length"))
    };
    Ok([along("right", right, width_mm)?, along("up", up, height_mm)?])
}

fn refused(key: &str, problem: &GeometryError) -> SceneProblem {
    SceneProblem::key(key, problem.to_string())
}

fn map(key: &str, design: &FeatherSheetFile, is_plain: bool, inputs: &mut Inputs) -> Result<Mapped, SceneProblem> {
    // Its bytes decide the picture, whatever they hold.
    let path = inputs.noted(key, &design.file)?;
    let refused = |problem: GeometryError| refused(key, &problem);
    let is_map = design.file.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("png"));
    match design.pixels_per_mm {
        Some(_) if is_map => {
            let problem = "a map has its resolution; take `pixels_per_mm` out, or name a feather's JSON";
            Err(SceneProblem::key(key, problem))
        }
        None if is_map => Ok((FeatherMap::read(&path).map_err(refused)?, Vec::new())),
        pixels_per_mm => {
            let feather = Feather::read(&path).map_err(refused)?;
            if is_plain {
                Ok((FeatherMap::of(&feather, pixels_per_mm).map_err(refused)?, Vec::new()))
            } else {
                FeatherMap::with_places(&feather, pixels_per_mm).map_err(refused)
            }
        }
    }
}

fn pattern(
    key: &str,
    design: &PatternFile,
    material: &Named<'_>,
    inputs: &mut Inputs,
) -> Result<Pattern, SceneProblem> {
    let mut palette = Vec::new();
    for (colour, name) in &design.materials {
        let key = format!("{key}.materials.\"{colour}\"");
        let expected = || SceneProblem::key(&key, "this is no colour; expected `#` and six hexadecimal digits");
        palette.push((bytes_of(colour).ok_or_else(expected)?, material(&key, name)?));
    }
    if palette.is_empty() {
        return Err(SceneProblem::key(format!("{key}.materials"), "there is none; give each colour its material"));
    }
    let picture = inputs.codes(&format!("{key}.file"), Path::new(&design.file))?;
    let distance = |a: [u8; 3], b: [u8; 3]| -> u32 { (0..3).map(|k| u32::from(a[k].abs_diff(b[k])).pow(2)).sum() };
    let nearest =
        |texel: [u8; 3]| palette.iter().min_by_key(|(colour, _)| distance(*colour, texel)).map_or(0, |(_, m)| *m);
    let (width, texels) = picture;
    Pattern::new(width, texels.into_iter().map(|texel| Blend::pure(nearest(texel))).collect())
        .ok_or_else(|| SceneProblem::key(format!("{key}.file"), "it has no pixels"))
}

/// The bytes of `#rrggbb`.
fn bytes_of(colour: &str) -> Option<[u8; 3]> {
    let digits = colour.strip_prefix('#').filter(|digits| digits.len() == 6 && digits.is_ascii())?;
    let byte = |k: usize| u8::from_str_radix(&digits[2 * k..2 * k + 2], 16).ok();
    Some([byte(0)?, byte(1)?, byte(2)?])
}
