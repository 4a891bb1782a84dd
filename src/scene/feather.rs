//! A flat feather: its map from a JSON file or a PNG, and what it is made of.

use std::path::Path;

use super::check::{length, rectangle, vector};
use super::error::SceneProblem;
use super::file::{FeatherSheetFile, PatternFile};
use super::inputs::Inputs;
use crate::geometry::{Feather, FeatherMap};
use crate::render::{Pattern, Sheet, Vanes};

/// Finds a material's number by its name, for the key that names it.
type Named<'a> = dyn Fn(&str, &str) -> Result<usize, SceneProblem> + 'a;

/// Checks a feather and reads its map and pattern.
pub(super) fn sheet(
    key: &str,
    design: &FeatherSheetFile,
    material: &Named<'_>,
    inputs: &mut Inputs,
) -> Result<Sheet, SceneProblem> {
    let shaft = material(&format!("{key}.shaft"), &design.shaft)?;
    let vane = material(&format!("{key}.vane"), &design.vane)?;
    if let Some(pixels_per_mm) = design.pixels_per_mm {
        length(&format!("{key}.pixels_per_mm"), pixels_per_mm)?;
    }
    let map = map(&format!("{key}.file"), design, inputs)?;
    let [width_mm, height_mm] = map.size_mm();
    let along = |name: &str, direction: [f64; 3], length_mm: f64| {
        let key = format!("{key}.{name}");
        let direction = vector(&key, direction)?.try_normalize(0.0);
        direction
            .map(|direction| (direction * length_mm).into())
            .ok_or_else(|| SceneProblem::key(key, "found [0, 0, 0]; expected a direction, of any other length"))
    };
    let edges = (along("right", design.right, width_mm)?, along("up", design.up, height_mm)?);
    let rectangle = rectangle(key, design.corner_mm, edges.0, edges.1)?;
    let vanes = match &design.pattern {
        Some(pattern) => Vanes::Pattern(self::pattern(&format!("{key}.pattern"), pattern, material, inputs)?),
        None => Vanes::Plain(vane),
    };
    Ok(Sheet { rectangle, map, shaft, vanes })
}

fn map(key: &str, design: &FeatherSheetFile, inputs: &mut Inputs) -> Result<FeatherMap, SceneProblem> {
    // Its bytes decide the picture, whatever they hold.
    let path = inputs.noted(key, &design.file)?;
    let refused = |problem: crate::geometry::GeometryError| SceneProblem::key(key, problem.to_string());
    let is_map = design.file.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("png"));
    match design.pixels_per_mm {
        Some(_) if is_map => {
            let problem = "a map has its resolution; take `pixels_per_mm` out, or name a feather's JSON";
            Err(SceneProblem::key(key, problem))
        }
        None if is_map => FeatherMap::read(&path).map_err(refused),
        pixels_per_mm => FeatherMap::of(&Feather::read(&path).map_err(refused)?, pixels_per_mm).map_err(refused),
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
    Pattern::new(width, texels.into_iter().map(nearest).collect())
        .ok_or_else(|| SceneProblem::key(format!("{key}.file"), "it has no pixels"))
}

/// The bytes of `#rrggbb`.
fn bytes_of(colour: &str) -> Option<[u8; 3]> {
    let digits = colour.strip_prefix('#').filter(|digits| digits.len() == 6 && digits.is_ascii())?;
    let byte = |k: usize| u8::from_str_radix(&digits[2 * k..2 * k + 2], 16).ok();
    Some([byte(0)?, byte(1)?, byte(2)?])
}
