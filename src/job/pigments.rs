//! Absorbers of a job that stand in files of their own.

use std::path::Path;

use super::case::resolve;
use super::file::ModelFile;
use super::load::input_file;
use super::{InputFile, JobError, JobFile};
use crate::bsdf::{BarbDesign, BarbuleDesign};
use crate::measure::{
    Angles, LongColumns, Negative, Quantity, Source, SpectraColumns, SpectraLayout, Table, TableLayout, TableText,
    read_table,
};
use crate::pigment::PigmentDesign;

/// Reads the absorption tables that the job's models name, and returns what was read.
pub(super) fn load_pigments(job: &mut JobFile, folder: &Path) -> Result<Vec<InputFile>, JobError> {
    let mut inputs: Vec<InputFile> = Vec::new();
    let others = job.alternative.iter_mut().filter_map(|other| other.model.as_mut());
    for pigment in std::iter::once(&mut job.model).chain(others).flat_map(pigments_of) {
        let PigmentDesign::Table { file, wavelength, absorption, rows, .. } = pigment else { continue };
        let path = resolve("model.pigments.file", file, folder)?;
        let text = TableText::load(&path)?;
        let bytes = std::fs::read(&path).map_err(|error| JobError::key("model.pigments.file", error.to_string()))?;
        let input = input_file(&path, &bytes);
        if !inputs.contains(&input) {
            inputs.push(input);
        }
        // A spectrum without angles, in a unit that does not matter: the amount is its factor.
        let columns = LongColumns {
            angles: Angles::NotRecorded,
            wavelength: Source::Column(wavelength.clone()),
            value: absorption.clone(),
            id: None,
            specimen: None,
            group: Vec::new(),
        };
        let columns = SpectraColumns::Long(columns);
        let layout = SpectraLayout { negative: Negative::Keep, ..SpectraLayout::new(Quantity::Brdf, columns) };
        if let Table::Spectra(table) = read_table(&text, &TableLayout::Spectra(layout))? {
            let spectra = table.spectra.iter();
            *rows = spectra.flat_map(|s| s.wavelengths_nm.iter().copied().zip(s.values.iter().copied())).collect();
        }
    }
    Ok(inputs)
}

/// The pigments of a model, those of its parts among them.
fn pigments_of(model: &mut ModelFile) -> Vec<&mut PigmentDesign> {
    match model {
        ModelFile::Cylinder(design) | ModelFile::SpongyBarb(design) => design.pigments.iter_mut().collect(),
        ModelFile::FilmedCylinder(design) => design.pigments.iter_mut().collect(),
        ModelFile::PigmentedBase(design) => design.pigments.iter_mut().collect(),
        ModelFile::Feather(design) => {
            let barb = match &mut design.barb {
                BarbDesign::Cylinder(design) | BarbDesign::SpongyBarb(design) => &mut design.pigments,
            };
            let barbules: &mut [PigmentDesign] = match &mut design.barbule {
                BarbuleDesign::Cylinder(design) => &mut design.pigments,
                BarbuleDesign::FilmedCylinder(design) => &mut design.pigments,
                BarbuleDesign::Lamella(_) => &mut [],
            };
            barb.iter_mut().chain(barbules).collect()
        }
        _ => Vec::new(),
    }
}
