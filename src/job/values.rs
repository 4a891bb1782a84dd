//! Parameter values by name, as a job gives them and a fit finds them.

use std::collections::BTreeMap;

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
    declared.iter().map(|parameter| values.get(&parameter.name).copied().unwrap_or(parameter.default)).collect()
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

/// Index of the declared parameter of this name, whose value this may be.
pub(super) fn checked(declared: &[Parameter], name: &str, value: f64) -> Result<usize, String> {
    let index = index_of(declared, name)?;
    check_inside(&declared[index], value)?;
    Ok(index)
}
