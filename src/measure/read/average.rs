//! Repeated readings of one place on one specimen become their mean, and their scatter its σ.

use crate::measure::error::TableProblem;
use crate::measure::table::Spectrum;

/// Each `count` spectra that follow each other become one, with σ = s/√count.
///
/// s is pooled over all the means of a group (species, patch) at each wavelength, s² = Σ (y − ȳ)²/Σ (count − 1): a
/// variance from three readings alone has two degrees of freedom, and weights by it would follow chance. It takes all the
/// specimens of a group to be as repeatable as each other, and says nothing of readings that all err together.
///
/// # Errors
/// A number of spectra that is no multiple of `count`, spectra of one mean that differ in specimen, group, angles or
/// wavelengths, or readings that do not scatter at all.
pub(super) fn averaged(spectra: &[Spectrum], count: usize) -> Result<Vec<Spectrum>, TableProblem> {
    if !spectra.len().is_multiple_of(count) {
        return Err(TableProblem::AverageCount { spectra: spectra.len(), count });
    }
    let sets: Vec<&[Spectrum]> = spectra.chunks_exact(count).collect();
    for set in &sets {
        let first = &set[0];
        let alike = |other: &&Spectrum| {
            other.origin == first.origin
                && other.geometry == first.geometry
                && other.wavelengths_nm == first.wavelengths_nm
        };
        if let Some(other) = set.iter().find(|other| !alike(other)) {
            return Err(TableProblem::AverageOfUnlike { first: first.id.clone(), second: other.id.clone(), count });
        }
    }
    let means: Vec<Vec<f64>> = sets.iter().map(|set| mean(set)).collect();
    sets.iter()
        .zip(&means)
        .map(|(set, values)| {
            let first = &set[0];
            // Sets of the same group and wavelengths, in the order of the file.
            let alike = |other: &&[Spectrum]| {
                other[0].origin.group == first.origin.group && other[0].wavelengths_nm == first.wavelengths_nm
            };
            let pooled = sets.iter().zip(&means).filter(|(other, _)| alike(other));
            let (mut squares, mut freedom) = (vec![0.0; values.len()], 0.0);
            for (other, mean) in pooled {
                freedom += as_f64(count - 1);
                for spectrum in *other {
                    for (square, (y, m)) in squares.iter_mut().zip(spectrum.values.iter().zip(mean)) {
                        *square += (y - m).powi(2);
                    }
                }
            }
            let sigmas: Vec<f64> = squares.iter().map(|square| (square / freedom / as_f64(count)).sqrt()).collect();
            if let Some(index) = sigmas.iter().position(|sigma| *sigma <= 0.0) {
                let (id, wavelength_nm) = (first.id.clone(), first.wavelengths_nm[index]);
                return Err(TableProblem::NoScatter { id, wavelength_nm });
            }
            let id = format!("{} to {}", first.id, set[count - 1].id);
            Ok(Spectrum { id, values: values.clone(), sigmas: Some(sigmas), ..first.clone() })
        })
        .collect()
}

fn mean(set: &[Spectrum]) -> Vec<f64> {
    let of = |index: usize| set.iter().map(|spectrum| spectrum.values[index]).sum::<f64>() / as_f64(set.len());
    (0..set[0].values.len()).map(of).collect()
}

fn as_f64(count: usize) -> f64 {
    f64::from(u32::try_from(count).unwrap_or(u32::MAX))
}
