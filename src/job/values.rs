//! Parameter values by name, as a job gives them and a fit finds them.

use std::collections::BTreeMap;

use crate::bsdf::channel_suffix;
use crate::fit::Fit;
use crate::nearest::suggestion;
use crate::parameter::Parameter;

/// Parameter values by name.
pub(super) type Values = BTreeMap<String, f64>;

/// Values of a fit's best minimum.
pub(super) fn values_by_name(fit: &Fit) -> Values {
    fit.estimates.iter().map(|estimate| (estimate.name.clone(), estimate.value)).collect()
}

/// One value for each declared parameter, in their order: the default of those that are not named.
pub(super) fn in_order(declared: &[Parameter], values: &Values) -> Vec<f64> {
    declared.iter().map(|parameter| *said_of(values, &parameter.name).unwrap_or(&parameter.default)).collect()
}

/// What is said of a parameter: under its own name, or once for all channels (`eta` of `eta_r`). Its own name goes first.
pub(super) fn said_of<'a, T>(said: &'a BTreeMap<String, T>, name: &str) -> Option<&'a T> {
    let shared = || said.iter().find(|(shared, _)| channel_suffix(name, shared).is_some()).map(|(_, value)| value);
    said.get(name).or_else(shared)
}

/// Indices of the declared parameters that a name stands for: the one that has it, or all channels of it.
pub(super) fn places_of(declared: &[Parameter], name: &str) -> Result<Vec<usize>, String> {
    if let Some(index) = declared.iter().position(|parameter| parameter.name == name) {
        return Ok(vec![index]);
    }
    let is_channel = |(_, parameter): &(usize, &Parameter)| channel_suffix(&parameter.name, name).is_some();
    let channels: Vec<usize> = declared.iter().enumerate().filter(is_channel).map(|(index, _)| index).collect();
    if channels.is_empty() { index_of(declared, name).map(|index| vec![index]) } else { Ok(channels) }
}

/// Index of the declared parameter of this name, or a sentence that lists those there are.
pub(super) fn index_of(declared: &[Parameter], name: &str) -> Result<usize, String> {
    declared.iter().position(|parameter| parameter.name == name).ok_or_else(|| {
        let known: Vec<&str> = declared.iter().map(|parameter| parameter.name.as_str()).collect();
        let meant = suggestion(name, known.iter().copied());
        format!("this model and instrument have no such parameter; they have {}{meant}", known.join(", "))
    })
}

/// Refuses a value that the parameter's declaration does not allow.
pub(super) fn check_inside(parameter: &Parameter, value: f64) -> Result<(), String> {
    if parameter.allows(value) {
        return Ok(());
    }
    let unit = if parameter.unit.is_empty() { String::new() } else { format!(" {}", parameter.unit) };
    Err(format!("found {value}; expected a value from {} to {}{unit}", parameter.lower, parameter.upper))
}

/// Indices of the declared parameters that this name stands for, whose value this may be.
pub(super) fn checked(declared: &[Parameter], name: &str, value: f64) -> Result<Vec<usize>, String> {
    let places = places_of(declared, name)?;
    for &index in &places {
        check_inside(&declared[index], value)?;
    }
    Ok(places)
}
