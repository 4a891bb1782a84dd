//! From a typed material to one that a picture can be made with.

use super::error::SceneProblem;
use super::file::{MaterialFile, TextureFile};
use super::inputs::Inputs;
use crate::bsdf::{ChannelMix, Direction, Model};
use crate::job::{JobError, ModelFile};
use crate::measure::colour::rgb_weights;
use crate::nearest::suggestion;
use crate::render::{Material, Texture};

/// Endings of the names of parameters that have one value in each of three channels.
const ENDINGS: [&str; 3] = ["r", "g", "b"];

/// Wavelengths of a spectrum at most: more than the eye tells apart.
const MOST_WAVELENGTHS: usize = 128;

/// The wavelengths that a scene's models are made for, and how they become a picture's channels.
#[derive(Debug)]
pub(super) struct Spectrum {
    wavelengths_nm: Vec<f64>,
    /// Absent where the three wavelengths are the channels.
    mix: Option<ChannelMix>,
}

impl Spectrum {
    /// Three wavelengths, or more that rise.
    pub(super) fn new(wavelengths_nm: &[f64]) -> Result<Self, SceneProblem> {
        let wrong = |problem: String| Err(SceneProblem::key("wavelengths_nm", problem));
        if let &[red, green, blue] = wavelengths_nm {
            if !(red > green && green > blue) {
                let expected = "expected those of red, green and blue, the longest first";
                return wrong(format!("found [{red}, {green}, {blue}]; {expected}"));
            }
            return Ok(Self { wavelengths_nm: wavelengths_nm.to_vec(), mix: None });
        }
        if !(4..=MOST_WAVELENGTHS).contains(&wavelengths_nm.len()) {
            let problem = "expected three, shown as red, green and blue, or 4 to 128 that rise, whose colour is shown";
            return wrong(format!("found {} wavelengths; {problem}", wavelengths_nm.len()));
        }
        if let Some(pair) = wavelengths_nm.windows(2).find(|pair| !(pair[0] > 0.0 && pair[0] < pair[1])) {
            return wrong(format!("found {} before {}; expected wavelengths that rise", pair[0], pair[1]));
        }
        match rgb_weights(wavelengths_nm) {
            Some(weights) if weights.iter().flatten().all(|weight| weight.is_finite()) => {
                Ok(Self { wavelengths_nm: wavelengths_nm.to_vec(), mix: Some(ChannelMix::new(weights)) })
            }
            _ => wrong("nothing of them can be seen; expected wavelengths from 380 to 780".to_owned()),
        }
    }

    pub(super) fn wavelengths_nm(&self) -> &[f64] {
        &self.wavelengths_nm
    }

    pub(super) fn mix(&self) -> Option<&ChannelMix> {
        self.mix.as_ref()
    }
}

/// Makes a material for the scene's wavelengths.
pub(super) fn material(
    key: &str,
    design: &MaterialFile,
    spectrum: &Spectrum,
    inputs: &mut Inputs,
) -> Result<Material, SceneProblem> {
    let Some(texture) = &design.texture else {
        let model = model(key, &design.model, spectrum.wavelengths_nm())?;
        let values = values(key, model.as_ref(), design)?;
        return Material::shaded(model, vec![values], spectrum.mix().cloned())
            .map_err(|problem| wrong_value(key, problem));
    };
    let &[red, green, blue] = spectrum.wavelengths_nm() else {
        let problem = "a texture gives red, green and blue their values, but this scene has a spectrum; give it three \
                       `wavelengths_nm`, or take the texture out";
        return Err(SceneProblem::key(format!("{key}.texture"), problem));
    };
    let wavelengths_nm = &[red, green, blue];
    let texture_key = format!("{key}.texture");
    let picture = inputs.picture(&format!("{texture_key}.file"), &texture.file, texture.encoding)?;
    textured(key, design, texture, picture, wavelengths_nm)
}

fn textured(
    key: &str,
    design: &MaterialFile,
    texture: &TextureFile,
    picture: Texture,
    wavelengths_nm: &[f64; 3],
) -> Result<Material, SceneProblem> {
    let name = &texture.parameter;
    let parameter_key = format!("{key}.texture.parameter");
    let expected = "expected one that may differ between channels and on which the model depends linearly, such as \
                    `albedo` of lambertian or `diffuse` of rough-plastic";
    let refused = |reason: String| SceneProblem::key(&parameter_key, format!("`{name}` {reason}; {expected}"));
    let each = each_channel(&design.model, name).ok_or_else(|| refused("cannot differ between channels".to_owned()))?;
    let three = each.scattering(wavelengths_nm).map_err(|error| refused(format!("cannot be textured ({error})")))?;
    if let Some(typed) = design.parameters.keys().find(|typed| *typed == name || base(typed) == Some(name)) {
        let both = format!("the texture gives `{name}` its value too; leave one of the two out");
        return Err(SceneProblem::key(format!("{key}.parameters.{typed}"), both));
    }
    let of_three = values(key, three.as_ref(), design)?;
    if !is_linear(three.as_ref(), &of_three, name) {
        return Err(refused("does not act linearly between 0 and 1 in this model".to_owned()));
    }
    let range = three.parameters().iter().find(|parameter| base(&parameter.name) == Some(name));
    let (lower, upper) = range.map_or((0.0, 1.0), |parameter| (parameter.lower, parameter.upper));
    let texels = picture.texels().iter().flatten().map(|texel| f64::from(*texel));
    if let Some(found) = texels.into_iter().find(|texel| !(lower..=upper).contains(texel)) {
        let file = texture.file.display();
        let problem = format!("{file} holds {found}; expected values of `{name}` from {lower} to {upper}");
        return Err(SceneProblem::key(format!("{key}.texture.file"), problem));
    }

    let twice: Vec<f64> = wavelengths_nm.iter().chain(wavelengths_nm).copied().collect();
    let six = each.scattering(&twice).map_err(|error| refused(format!("cannot be textured ({error})")))?;
    let value_of_three = |wanted: &str| {
        three.parameters().iter().zip(&of_three).find(|(parameter, _)| parameter.name == wanted).map(|(_, v)| *v)
    };
    let of_six = six.parameters().iter().map(|parameter| {
        let lane = parameter.name.rsplit_once('_').and_then(|(base, lane)| Some((base, lane.parse::<usize>().ok()?)));
        match (value_of_three(&parameter.name), lane) {
            (Some(value), _) => value,
            (None, Some((base, lane))) if base == name => f64::from(u8::from(lane > 3)),
            (None, Some((base, lane))) => {
                value_of_three(&format!("{base}_{}", ENDINGS[(lane + 2) % 3])).unwrap_or(parameter.default)
            }
            (None, None) => parameter.default,
        }
    });
    let of_six = of_six.collect();
    Material::textured(six, of_six, picture).map_err(|problem| wrong_value(key, problem))
}

pub(super) fn model(key: &str, design: &ModelFile, wavelengths_nm: &[f64]) -> Result<Box<dyn Model>, SceneProblem> {
    design.scattering(wavelengths_nm).map_err(|error| match error {
        JobError::Model(problem) => SceneProblem::Model { key: format!("{key}.model"), problem: Box::new(problem) },
        JobError::Key { problem, .. } => SceneProblem::key(format!("{key}.model"), problem),
        other => SceneProblem::key(format!("{key}.model"), other.to_string()),
    })
}

/// A value for each parameter: the typed one, or its default.
pub(super) fn values(key: &str, model: &dyn Model, design: &MaterialFile) -> Result<Vec<f64>, SceneProblem> {
    let parameters = model.parameters();
    let names = || parameters.iter().map(|parameter| parameter.name.as_str());
    if let Some(unknown) = design.parameters.keys().find(|typed| !names().any(|name| name == *typed)) {
        let known = names().collect::<Vec<_>>().join(", ");
        let problem = format!("this model has no such parameter; it has {known}{}", suggestion(unknown, names()));
        return Err(SceneProblem::key(format!("{key}.parameters.{unknown}"), problem));
    }
    Ok(parameters.iter().map(|p| design.parameters.get(&p.name).copied().unwrap_or(p.default)).collect())
}

pub(super) fn wrong_value(key: &str, problem: crate::bsdf::ModelError) -> SceneProblem {
    SceneProblem::Model { key: format!("{key}.parameters"), problem: Box::new(problem) }
}

/// The name of a parameter without the ending of its channel.
fn base(name: &str) -> Option<&str> {
    let (base, ending) = name.rsplit_once('_')?;
    ENDINGS.contains(&ending).then_some(base)
}

/// The same model with one value of a parameter in each channel; None where a model has no such list.
fn each_channel(design: &ModelFile, parameter: &str) -> Option<ModelFile> {
    let mut typed = serde_json::to_value(design).ok()?;
    let list = typed.as_object_mut()?.entry("per_channel").or_insert_with(|| serde_json::Value::Array(Vec::new()));
    let list = list.as_array_mut()?;
    let name = serde_json::Value::from(parameter);
    if !list.contains(&name) {
        list.push(name);
    }
    serde_json::from_value(typed).ok()
}

/// Whether the scattering function at ½ is the mean of those at 0 and at 1, for a few pairs of directions.
fn is_linear(model: &dyn Model, values: &[f64], name: &str) -> bool {
    let at = |value: f64| {
        let mut values = values.to_vec();
        for (parameter, slot) in model.parameters().iter().zip(&mut values) {
            if base(&parameter.name) == Some(name) {
                *slot = value;
            }
        }
        values
    };
    let ends = [0.0, 0.5, 1.0].map(at);
    if ends.iter().any(|values| model.check(values).is_err()) {
        return false;
    }
    let bound = ends.each_ref().map(|values| model.bind(values));
    let directions = [(0.0, 0.3), (0.7, 0.7), (1.2, -0.4), (0.5, 2.8)];
    let direction = |angle: f64| Direction::new(0.8 * angle.sin(), 0.6 * angle.sin(), angle.cos());
    directions.iter().all(|&(incoming, outgoing)| {
        let [zero, half, one] = bound.each_ref().map(|bsdf| {
            let mut values = [0.0; 3];
            bsdf.evaluate(&direction(incoming), &direction(outgoing), &mut values);
            values
        });
        (0..3).all(|k| {
            let mean = 0.5 * (zero[k] + one[k]);
            // Roundings of a sum of a few terms; what is not linear misses by far more.
            (half[k] - mean).abs() <= 1e-9 * mean.abs()
        })
    })
}
