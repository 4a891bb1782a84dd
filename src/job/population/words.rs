//! What the specimens tell, in a few sentences.

use super::{Effects, LeftOut, ParameterSpread, Population, Specimen};
use crate::job::JobFile;
use crate::measure::{GonioTable, Quantity};
use crate::number::{beside_error, significant, with_error};

/// Most parameters that a sentence can carry.
const MOST_NAMED: usize = 4;

/// The sentences.
pub(super) fn text(population: &Population, file: &JobFile, table: &GonioTable) -> String {
    let mut sentences = Vec::new();
    let named: Vec<String> = population.parameters.iter().take(MOST_NAMED).filter_map(spread).collect();
    let count = population.specimens.len();
    if named.is_empty() {
        sentences
            .push(format!("None of the {count} specimens' spectra determine a parameter well enough to compare them."));
    } else {
        sentences.push(format!(
            "Over {count} specimens, mean ± its error and standard deviation between individuals: {}.",
            named.join("; ")
        ));
    }
    let own: Vec<f64> = population.specimens.iter().map(|specimen| specimen.rms).collect();
    let unit = Unit::of(table.quantity);
    sentences.push(format!("Each specimen's own fit misses its readings by {} (rms).", unit.range(&own)));
    sentences.extend(population.left_out.as_ref().map(|left_out| prediction(left_out, unit)));
    sentences.extend(branches(population));
    for test in population.absorbers.iter().filter(|test| !test.needed) {
        sentences.push(format!(
            "Without {} the specimens are predicted about as well ({} instead of {}): their spectra do not show that it is \
             there.",
            test.name,
            unit.text(test.rms_without),
            unit.text(test.rms_with),
        ));
    }
    let bands = file.model.band_names();
    if !bands.is_empty() {
        let verb = if bands.len() == 1 { "is a band that describes" } else { "are bands that describe" };
        sentences.push(format!(
            "{} {verb} the spectra; that they fit does not say which substance absorbs.",
            bands.join(" and ")
        ));
    }
    sentences.join(" ")
}

/// What a line of [`brief`] holds, in words.
pub(in super::super) const BRIEF: &str = "Mean over the specimens ± its error, where larger ± the error of the misfit that all \
                                        share; in brackets the standard deviation between specimens";

/// The same in a line, for tables of many groups.
pub(in super::super) fn brief(population: &Population) -> String {
    let named: Vec<String> = population.parameters.iter().take(MOST_NAMED).filter_map(brief_spread).collect();
    let count = population.specimens.len();
    let values = if named.is_empty() { "nothing determined".to_owned() } else { named.join(", ") };
    let undecided = population.specimens.iter().filter(|one| !one.rivals.is_empty()).count();
    if undecided == 0 {
        format!("{values}.")
    } else {
        format!("{values}; {undecided} of {count} specimens allow other minima.")
    }
}

fn brief_spread(parameter: &ParameterSpread) -> Option<String> {
    let Effects { mean, mean_standard_error, between, shared, .. } = parameter.effects.as_ref()?;
    let unit = if parameter.unit.is_empty() { String::new() } else { format!(" {}", parameter.unit) };
    let common = if shared > mean_standard_error { format!(" ± {}", significant(*shared, 2)) } else { String::new() };
    Some(format!(
        "{} {}{common}{unit} ({})",
        parameter.symbol,
        with_error(*mean, Some(*mean_standard_error)),
        beside_error(*between, Some(*mean_standard_error)),
    ))
}

fn spread(parameter: &ParameterSpread) -> Option<String> {
    let effects = parameter.effects.as_ref()?;
    let Effects { mean, mean_standard_error, between, between_interval_95: [low, high], within, shared, .. } = effects;
    let unit = if parameter.unit.is_empty() { String::new() } else { format!(" {}", parameter.unit) };
    let beside = |value: f64| beside_error(value, Some(*mean_standard_error));
    let difference = if *high > 0.0 {
        format!("differing by {}{unit} (95 %: {} to {})", beside(*between), beside(*low), beside(*high))
    } else {
        "differing no more than their own errors make them".to_owned()
    };
    // An error that all share matters where it is not small beside that of the mean.
    let common = if shared > mean_standard_error {
        format!(", and ± {}{unit} for the misfit that all share", significant(*shared, 2))
    } else {
        String::new()
    };
    Some(format!(
        "{} ({}) {}{unit}{common}, {difference}, each known to {}{unit}",
        parameter.symbol,
        parameter.name,
        with_error(*mean, Some(*mean_standard_error)),
        significant(*within, 2),
    ))
}

fn prediction(left_out: &LeftOut, unit: Unit) -> String {
    let mut text = format!("Predicted from the others, a specimen is missed by {} (rms)", unit.text(left_out.model));
    if let Some(mean) = left_out.mean {
        text += &format!("; the mean spectrum of the others misses it by {}", unit.text(mean));
    }
    if let Some(spread) = left_out.spread {
        text += &format!(", and the specimens differ by {} (standard deviation)", unit.text(spread));
    }
    if let Some(sigma) = left_out.sigma {
        text += &format!("; the readings' own error is {}", unit.text(sigma));
    }
    text + "."
}

/// On specimens whose own best minimum is another than the common one, or that allow others.
fn branches(population: &Population) -> Option<String> {
    let names = |pick: &dyn Fn(&Specimen) -> bool| {
        population.specimens.iter().filter(|one| pick(one)).map(|one| one.name.as_str()).collect::<Vec<_>>()
    };
    let (elsewhere, undecided) = (names(&|one| !one.own_best), names(&|one| !one.rivals.is_empty()));
    let mut sentences = Vec::new();
    if !elsewhere.is_empty() {
        let list = elsewhere.join(", ");
        sentences.push(format!(
            "Values are of the minimum nearest to the common one; by themselves {list} would have another."
        ));
    }
    if !undecided.is_empty() {
        let (count, all) = (undecided.len(), population.specimens.len());
        sentences.push(format!(
            "Taken alone, {count} of {all} specimens do not rule out other minima, which the report lists."
        ));
    }
    (!sentences.is_empty()).then(|| sentences.join(" "))
}

/// Unit of a misfit.
#[derive(Clone, Copy)]
enum Unit {
    /// Percent of the white standard.
    Percent,
    /// 1/sr.
    PerSteradian,
}

impl Unit {
    fn of(quantity: Quantity) -> Self {
        match quantity {
            Quantity::Reflectance => Self::Percent,
            Quantity::Brdf | Quantity::BsdfCos => Self::PerSteradian,
        }
    }

    fn text(self, value: f64) -> String {
        match self {
            Self::Percent => format!("{} % of white", significant(100.0 * value, 2)),
            Self::PerSteradian => format!("{} /sr", significant(value, 2)),
        }
    }

    /// From the smallest to the largest.
    fn range(self, values: &[f64]) -> String {
        let (low, high) =
            values.iter().fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), v| (low.min(*v), high.max(*v)));
        match self {
            Self::Percent => format!("{} to {}", significant(100.0 * low, 2), self.text(high)),
            Self::PerSteradian => format!("{} to {}", significant(low, 2), self.text(high)),
        }
    }
}
