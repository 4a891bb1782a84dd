//! From a model's channels to a picture's: each of red, green and blue is a weighted sum of the spectrum.
//!
//! Light that is scattered once and whose source has the spectrum that the weights were made for gets the colour of its own
//! spectrum so. After each further scattering it is multiplied channel by channel, as every renderer of three channels does.

use std::sync::Arc;

use super::{Bsdf, Direction, Sample};

/// Channels of a picture.
pub(crate) const PICTURE_CHANNELS: usize = 3;

/// Weights by which a model's channels make up those of a picture.
///
/// A colour that no screen can show has a channel below 0; the sum of all three must not be, for it is what light is drawn by.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelMix {
    weights: [Vec<f64>; PICTURE_CHANNELS],
}

impl ChannelMix {
    /// For red, green and blue one weight for each channel of the model.
    ///
    /// # Panics
    /// If the three lists are not of one length.
    pub fn new(weights: [Vec<f64>; PICTURE_CHANNELS]) -> Self {
        assert!(weights.iter().all(|list| list.len() == weights[0].len()), "one weight a channel");
        Self { weights }
    }

    /// Number of channels that are mixed.
    pub fn channel_count(&self) -> usize {
        self.weights[0].len()
    }

    /// The weights of red, green and blue.
    pub fn weights(&self) -> &[Vec<f64>; PICTURE_CHANNELS] {
        &self.weights
    }

    fn mix(&self, spectrum: &[f64], values: &mut [f64]) {
        for (value, weights) in values.iter_mut().zip(&self.weights) {
            *value = weights.iter().zip(spectrum).map(|(weight, value)| weight * value).sum();
        }
    }
}

/// A scattering function as the picture shows it: mixed, where there is a mix.
pub(super) fn mixed<'a>(bsdf: Box<dyn Bsdf + 'a>, mix: Option<&ChannelMix>) -> Box<dyn Bsdf + 'a> {
    match mix {
        Some(mix) => Box::new(Mixed { bsdf, mix: mix.clone() }),
        None => bsdf,
    }
}

/// A scattering function with its channels mixed.
struct Mixed<'a> {
    bsdf: Box<dyn Bsdf + 'a>,
    mix: ChannelMix,
}

impl Bsdf for Mixed<'_> {
    fn evaluate(&self, incoming: &Direction, outgoing: &Direction, values: &mut [f64]) {
        let mut spectrum = vec![0.0; self.mix.channel_count()];
        self.bsdf.evaluate(incoming, outgoing, &mut spectrum);
        self.mix.mix(&spectrum, values);
    }

    fn evaluate_many(&self, incoming: &[Direction], outgoing: &[Direction], values: &mut [f64]) {
        let count = self.mix.channel_count();
        let mut spectra = vec![0.0; incoming.len() * count];
        self.bsdf.evaluate_many(incoming, outgoing, &mut spectra);
        for (spectrum, values) in spectra.chunks_exact(count).zip(values.chunks_exact_mut(PICTURE_CHANNELS)) {
            self.mix.mix(spectrum, values);
        }
    }

    fn straight_through(&self, incoming: &Direction) -> f64 {
        self.bsdf.straight_through(incoming)
    }

    fn sample(&self, outgoing: &Direction, random: [f64; 3]) -> Option<Sample> {
        self.bsdf.sample(outgoing, random)
    }

    fn sample_many(&self, outgoing: &[Direction], random: &[[f64; 3]], samples: &mut [Option<Sample>]) {
        self.bsdf.sample_many(outgoing, random, samples);
    }

    fn density(&self, incoming: &Direction, outgoing: &Direction) -> f64 {
        self.bsdf.density(incoming, outgoing)
    }

    fn density_many(&self, incoming: &[Direction], outgoing: &[Direction], densities: &mut [f64]) {
        self.bsdf.density_many(incoming, outgoing, densities);
    }
}

/// A scattering function that several shades of a material share.
impl<B: Bsdf + ?Sized> Bsdf for Arc<B> {
    fn evaluate(&self, incoming: &Direction, outgoing: &Direction, values: &mut [f64]) {
        self.as_ref().evaluate(incoming, outgoing, values);
    }

    fn evaluate_many(&self, incoming: &[Direction], outgoing: &[Direction], values: &mut [f64]) {
        self.as_ref().evaluate_many(incoming, outgoing, values);
    }

    fn straight_through(&self, incoming: &Direction) -> f64 {
        self.as_ref().straight_through(incoming)
    }

    fn sample(&self, outgoing: &Direction, random: [f64; 3]) -> Option<Sample> {
        self.as_ref().sample(outgoing, random)
    }

    fn sample_many(&self, outgoing: &[Direction], random: &[[f64; 3]], samples: &mut [Option<Sample>]) {
        self.as_ref().sample_many(outgoing, random, samples);
    }

    fn density(&self, incoming: &Direction, outgoing: &Direction) -> f64 {
        self.as_ref().density(incoming, outgoing)
    }

    fn density_many(&self, incoming: &[Direction], outgoing: &[Direction], densities: &mut [f64]) {
        self.as_ref().density_many(incoming, outgoing, densities);
    }
}
