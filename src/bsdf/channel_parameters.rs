//! Parameters that may have one value for all channels or one for each.

use crate::bsdf::ModelError;
use crate::parameter::Parameter;

/// Where the values of a parameter stand in a model's list.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ChannelParameter {
    /// One value for all channels, at this position.
    Shared(usize),
    /// One value a channel, from this position on.
    Each(usize),
}

impl ChannelParameter {
    /// The value in a channel.
    pub(super) fn value(self, values: &[f64], channel: usize) -> f64 {
        match self {
            Self::Shared(position) => values[position],
            Self::Each(first) => values[first + channel],
        }
    }
}

/// What ends the names of parameters in three channels, the longest wavelength first.
const RGB: [&str; 3] = ["r", "g", "b"];

/// The place of one of three channels in red, green, blue: the longest wavelength is red, whatever the order of the list. Equal
/// ones keep their order.
pub(super) fn place_in_rgb(wavelengths_nm: &[f64], channel: usize) -> usize {
    let own = wavelengths_nm[channel];
    let before = |(other, nm): (usize, &f64)| nm.total_cmp(&own).then(channel.cmp(&other)).is_gt();
    wavelengths_nm.iter().enumerate().filter(|&other| before(other)).count()
}

/// The end of a declared name that says its channel, `_r` or `_2`, if it is `name` in one channel.
pub(crate) fn channel_suffix<'a>(declared: &'a str, name: &str) -> Option<&'a str> {
    let suffix = declared.strip_prefix(name)?;
    let channel = suffix.strip_prefix('_')?;
    let is_number = !channel.is_empty() && channel.bytes().all(|byte| byte.is_ascii_digit());
    (is_number || RGB.contains(&channel)).then_some(suffix)
}

/// A model's list of parameters in the making.
#[derive(Debug)]
pub(super) struct Declarations<'a> {
    wavelengths_nm: &'a [f64],
    per_channel: &'a [String],
    /// Names of those that could have a value in each channel.
    spectral: Vec<String>,
    parameters: Vec<Parameter>,
}

impl<'a> Declarations<'a> {
    /// An empty list for a model of these channels, in which the parameters named in `per_channel` get one value a
    /// channel.
    pub(super) fn new(wavelengths_nm: &'a [f64], per_channel: &'a [String]) -> Result<Self, ModelError> {
        if wavelengths_nm.is_empty() {
            return Err(ModelError::NoWavelengths);
        }
        for &found in wavelengths_nm {
            if !(10.0..=1e6).contains(&found) {
                let what = "a wavelength".to_owned();
                return Err(ModelError::OutOfRange { what, found, expected: "10 to 1000000 nm" });
            }
        }
        Ok(Self { wavelengths_nm, per_channel, spectral: Vec::new(), parameters: Vec::new() })
    }

    /// Adds a parameter that knows no channels, and gives its position.
    pub(super) fn number(&mut self, parameter: Parameter) -> usize {
        self.parameters.push(parameter);
        self.parameters.len() - 1
    }

    /// Adds a parameter that may differ between channels: `eta`, or `eta_r`, `eta_g` and `eta_b` of three channels, the
    /// longest wavelength being r, or `eta_1`, `eta_2` and so on of any other number. They stand in the order of the channels.
    pub(super) fn spectral(&mut self, parameter: Parameter) -> ChannelParameter {
        let first = self.parameters.len();
        let each = self.per_channel.contains(&parameter.name);
        self.spectral.push(parameter.name.clone());
        if !each {
            self.parameters.push(parameter);
            return ChannelParameter::Shared(first);
        }
        for (channel, wavelength_nm) in self.wavelengths_nm.iter().enumerate() {
            let suffix = match self.wavelengths_nm.len() {
                3 => RGB[place_in_rgb(self.wavelengths_nm, channel)].to_owned(),
                _ => (channel + 1).to_string(),
            };
            self.parameters.push(Parameter {
                name: format!("{}_{suffix}", parameter.name),
                symbol: format!("{} {suffix}", parameter.symbol),
                text: format!("{}, at {wavelength_nm} nm", parameter.text),
                ..parameter.clone()
            });
        }
        ChannelParameter::Each(first)
    }

    /// The finished list.
    ///
    /// # Errors
    /// A name in `per_channel` that no parameter has.
    pub(super) fn finish(self) -> Result<Vec<Parameter>, ModelError> {
        match self.per_channel.iter().find(|name| !self.spectral.contains(name)) {
            Some(name) => Err(ModelError::NotPerChannel { name: name.clone(), expected: self.spectral.join(", ") }),
            None => Ok(self.parameters),
        }
    }
}
