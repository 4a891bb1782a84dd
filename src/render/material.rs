//! What lies on a surface: a scattering model with its parameters, which may differ from place to place.

use super::ray::Colour;
use super::texture::Texture;
use crate::bsdf::{Bsdf, ChannelMix, Direction, Model, ModelError, PICTURE_CHANNELS};

/// Channels of a picture.
pub(super) const CHANNELS: usize = PICTURE_CHANNELS;

/// A model with the values of its parameters.
///
/// Of the parameters on which a scattering function depends linearly (a diffuse weight, an albedo) one may be textured.
/// Channels are lanes of one evaluation, so the model is made for six of them, the picture's three twice: first with the
/// parameter at 0, then at 1. What lies between is a mean of the two, and nothing is bound anew for a texel.
///
/// Any parameters may differ between *shades*, each a list of values. What lies between two shades is a mixture of both: a
/// [`Blend`](super::Blend).
#[derive(Debug)]
pub struct Material {
    model: Box<dyn Model>,
    shades: Vec<Vec<f64>>,
    mix: Option<ChannelMix>,
    texture: Option<Texture>,
}

impl Material {
    /// A material that is the same everywhere: a model of three channels.
    ///
    /// # Errors
    /// A value outside its parameter's bounds.
    pub fn plain(model: Box<dyn Model>, values: Vec<f64>) -> Result<Self, ModelError> {
        Self::shaded(model, vec![values], None)
    }

    /// A material of one or more shades: a model of three channels, or of as many as the mix makes three of.
    ///
    /// # Errors
    /// A value outside its parameter's bounds.
    pub fn shaded(model: Box<dyn Model>, shades: Vec<Vec<f64>>, mix: Option<ChannelMix>) -> Result<Self, ModelError> {
        let channels = mix.as_ref().map_or(CHANNELS, ChannelMix::channel_count);
        assert_eq!(model.channel_count(), channels, "a picture has three channels");
        assert!(!shades.is_empty(), "a material has a shade");
        for values in &shades {
            model.check(values)?;
        }
        Ok(Self { model, shades, mix, texture: None })
    }

    /// A material with a texture: a model of six channels, the last three those of the first with a parameter at 1 that
    /// is 0 in the first.
    ///
    /// # Errors
    /// A value outside its parameter's bounds.
    pub fn textured(model: Box<dyn Model>, values: Vec<f64>, texture: Texture) -> Result<Self, ModelError> {
        assert_eq!(model.channel_count(), 2 * CHANNELS, "a textured model has each channel twice");
        model.check(&values)?;
        Ok(Self { model, shades: vec![values], mix: None, texture: Some(texture) })
    }

    /// Number of its shades.
    pub fn shade_count(&self) -> usize {
        self.shades.len()
    }

    /// Each shade, bound.
    pub(super) fn bind(&self) -> impl Iterator<Item = BoundMaterial<'_>> {
        let channels = if self.texture.is_some() { 2 * CHANNELS } else { CHANNELS };
        self.model.bind_for_picture(&self.shades, self.mix.as_ref()).into_iter().map(move |bsdf| {
            // Where light passes for any direction it passes for the normal or for a slanting one.
            let directions = [Direction::z(), -Direction::z(), Direction::new(0.6, 0.0, 0.8)];
            let passes = directions.iter().any(|direction| bsdf.straight_through(direction) > 0.0);
            BoundMaterial { bsdf, texture: self.texture.as_ref(), channels, passes }
        })
    }
}

/// A material ready to be evaluated.
pub(super) struct BoundMaterial<'a> {
    pub(super) bsdf: Box<dyn Bsdf + 'a>,
    texture: Option<&'a Texture>,
    /// Channels that an evaluation fills.
    pub(super) channels: usize,
    /// Whether some light goes straight through.
    pub(super) passes: bool,
}

impl BoundMaterial<'_> {
    /// The texture's value at a place; 0 without one.
    #[inline]
    pub(super) fn texel(&self, uv: [f64; 2]) -> Colour {
        self.texture.map_or([0.0; 3], |texture| texture.at(uv))
    }

    /// The scattering function from what an evaluation has filled, at a place with this texel.
    #[inline]
    pub(super) fn mix(&self, values: &[f64], texel: &Colour) -> Colour {
        match values {
            [r, g, b] => [*r, *g, *b],
            [r0, g0, b0, r1, g1, b1] => {
                [r0 + texel[0] * (r1 - r0), g0 + texel[1] * (g1 - g0), b0 + texel[2] * (b1 - b0)]
            }
            _ => unreachable!("a material has three channels or six"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::{RoughPlastic, RoughPlasticDesign};

    /// A textured material at any texel is the plain one with that parameter.
    #[test]
    fn a_texel_is_the_parameter() {
        let design = RoughPlasticDesign { per_channel: vec!["diffuse".to_owned()], ..RoughPlasticDesign::default() };
        let (rgb, twice) = ([645.0, 525.0, 445.0], [645.0, 525.0, 445.0, 645.0, 525.0, 445.0]);
        let coat = [0.3, 1.5, 0.8];
        let texel = [0.2f32, 0.5, 0.9];
        let plain = |albedo: &[f64], wavelengths: &[f64]| {
            (Box::new(RoughPlastic::new(&design, wavelengths).unwrap()), [&coat, albedo].concat())
        };
        let (model, values) = plain(&[0.0, 0.0, 0.0, 1.0, 1.0, 1.0], &twice);
        let textured = Material::textured(model, values, Texture::new(1, vec![texel]).unwrap()).unwrap();
        let textured = textured.bind().next().unwrap();
        let (model, values) = plain(&texel.map(f64::from), &rgb);
        let plain = Material::plain(model, values).unwrap();
        let plain = plain.bind().next().unwrap();

        let (incoming, outgoing) = (Direction::new(0.6, 0.0, 0.8), Direction::new(0.0, -0.28, 0.96));
        let (mut six, mut three) = ([0.0; 6], [0.0; 3]);
        textured.bsdf.evaluate(&incoming, &outgoing, &mut six);
        plain.bsdf.evaluate(&incoming, &outgoing, &mut three);
        let mixed = textured.mix(&six, &textured.texel([0.4, 0.7]));
        for (mixed, direct) in mixed.into_iter().zip(three) {
            // A few roundings.
            assert!((mixed - direct).abs() < 1e-14 * direct, "{mixed} against {direct}");
        }
    }
}
