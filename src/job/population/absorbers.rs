//! Whether the spectra need each of the pigments that the job puts into the model.

use statrs::distribution::{ContinuousCDF, StudentsT};

use super::{AbsorberTest, Specimen, as_f64, left_out};
use crate::fit::Control;
use crate::job::file::ParameterFile;
use crate::job::{JobError, JobFile};
use crate::measure::GonioTable;

/// Predicts every specimen from the others without each pigment whose amount is free.
///
/// Any pigment lowers the misfit of what was fitted, and residuals of spectra are too correlated along wavelength for an
/// information criterion. A specimen that the fit did not see is a better judge.
pub(super) fn absorber_tests(
    file: &JobFile,
    seen: &GonioTable,
    specimens: &[Specimen],
    with: &[f64],
    free: &[&String],
    control: &Control,
) -> Result<Vec<AbsorberTest>, JobError> {
    // Few specimens know the error of their mean badly.
    let student = StudentsT::new(0.0, 1.0, as_f64(specimens.len()) - 1.0);
    let quantile = student.map_or(f64::INFINITY, |student| student.inverse_cdf(0.975));
    let mut tests = Vec::new();
    for name in free.iter().filter_map(|name| name.strip_suffix(".amount")) {
        let mut changed = file.clone();
        changed.parameters.retain(|parameter, _| !parameter.starts_with(&format!("{name}.")));
        changed.parameters.insert(format!("{name}.amount"), ParameterFile::Fixed(0.0));
        let mut without = Vec::new();
        for specimen in specimens {
            without.push(left_out::predict_one(&changed, seen, &specimen.name, control)?.1);
        }
        let gains: Vec<f64> = without.iter().zip(with).map(|(without, with)| without.powi(2) - with.powi(2)).collect();
        let count = as_f64(gains.len());
        let gain = gains.iter().sum::<f64>() / count;
        let variance = gains.iter().map(|one| (one - gain).powi(2)).sum::<f64>() / (count - 1.0);
        let gain_standard_error = (variance / count).sqrt();
        let rms = |errors: &[f64]| (errors.iter().map(|error| error * error).sum::<f64>() / count).sqrt();
        tests.push(AbsorberTest {
            name: name.to_owned(),
            rms_with: rms(with),
            rms_without: rms(&without),
            gain,
            gain_standard_error,
            needed: gain > quantile * gain_standard_error,
        });
    }
    Ok(tests)
}
