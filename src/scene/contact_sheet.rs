//! A picture of every cell of a sweep: the sweep's model lies on something in a scene, which else stays as it is.

use std::path::PathBuf;

use thiserror::Error;

use super::{CheckedScene, MaterialFile, SceneError, SceneFile};
use crate::job::{Job, JobError, RenderFile, Sweep};
use crate::nearest::suggestion;
use crate::render::{Control, Material, Picture, RenderError, ToneMapping, render};

/// The scene of a sweep that names none, and its material.
const SPHERE: (&str, &str) = (include_str!("sphere.json"), "sphere");

/// Most pixels of all pictures together, what a page can hold.
const MOST_PIXELS: usize = 1 << 24;

/// Pictures of a sweep's cells. Same inputs, same bytes.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactSheet {
    /// One a cell, in the order of [`Sweep::cells`], all of one size.
    pub pictures: Vec<Picture>,
    /// How their radiance becomes shades, the same for all.
    pub tone: ToneMapping,
    /// Wavelengths of their channels, nm.
    pub wavelengths_nm: Vec<f64>,
    /// Samples a pixel.
    pub samples: u32,
    /// The scene's title.
    pub scene: String,
    /// A digest of the scene, of the files that it names, and of the program's version.
    pub fingerprint: String,
}

/// Why there are no pictures.
#[derive(Debug, Error)]
pub enum ContactSheetError {
    /// The job asks for pictures that cannot be made.
    #[error(transparent)]
    Job(#[from] JobError),
    /// The scene.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The render.
    #[error(transparent)]
    Render(#[from] RenderError),
}

/// Makes a picture of every cell of a job's sweep; None where the job asks for none.
///
/// # Errors
/// A scene that cannot be used, a model that has no three channels, a cell whose picture is no number, or an interruption.
/// `control` is told of every picture's tiles anew.
pub fn contact_sheet(
    job: &Job,
    sweep: &Sweep,
    control: &Control<'_>,
) -> Result<Option<ContactSheet>, ContactSheetError> {
    let Some(design) = job.file.sweep.as_ref().and_then(|sweep| sweep.render.as_ref()) else { return Ok(None) };
    let refused = |key: &str, problem: String| job.placed(JobError::key(format!("sweep.render{key}"), problem), 0);
    let (mut file, path, material) = scene(job, design)?;
    file.wavelengths_nm = wavelengths_nm(sweep).unwrap_or(file.wavelengths_nm);
    let model = || job.file.model.scattering(&file.wavelengths_nm);
    let first = model().map_err(|error| job.placed(error, 0))?;
    let mut places = Vec::new();
    for parameter in first.parameters() {
        let place = sweep.own.parameters.iter().position(|(own, _)| own.name == parameter.name);
        places.push(place.ok_or_else(|| {
            let problem = format!(
                "a picture has three wavelengths, and there the model has a parameter {} that the job's data do not give \
                 it; take it from `per_channel`, or give the data three wavelengths",
                parameter.name
            );
            refused("", problem)
        })?);
    }

    let [width, height] = [file.image.width, file.image.height].map(|side| usize::try_from(side).unwrap_or(usize::MAX));
    let pixels = width.saturating_mul(height).saturating_mul(sweep.cells.len());
    if pixels > MOST_PIXELS {
        let problem = format!(
            "{} pictures of {width} × {height} make {pixels} pixels; expected at most {MOST_PIXELS}: take fewer steps, or a \
             scene with a smaller `image`",
            sweep.cells.len()
        );
        return Err(refused("", problem).into());
    }
    let stand_in = MaterialFile { model: job.file.model.clone(), parameters: Default::default(), texture: None };
    file.materials.insert(material.clone(), stand_in);
    let number = file.materials.keys().take_while(|name| **name != material).count();
    let mut checked = CheckedScene::new(&file, &path)?;
    let mut pictures = Vec::new();
    for cell in &sweep.cells {
        let values = places.iter().map(|place| cell.parameters[*place]).collect();
        let model = model().map_err(|error| job.placed(error, 0))?;
        let shade = Material::shaded(model, vec![values], checked.mix.clone());
        let made = shade.map_err(|error| job.placed(error.into(), 0))?;
        checked.scene.replace_material(number, made);
        pictures.push(render(&checked.scene, checked.resolution, checked.settings, control)?);
    }
    Ok(Some(ContactSheet {
        pictures,
        tone: checked.tone,
        wavelengths_nm: file.wavelengths_nm,
        samples: checked.resolution.samples,
        scene: checked.title,
        fingerprint: checked.fingerprint,
    }))
}

/// The scene, its file, and the name of the material that the sweep stands for.
fn scene(job: &Job, design: &RenderFile) -> Result<(SceneFile, PathBuf, String), ContactSheetError> {
    let refused = |key: &str, problem: String| job.placed(JobError::key(format!("sweep.render{key}"), problem), 0);
    match (&design.scene, &design.material) {
        (None, None) => {
            let (file, path) = (SceneFile::parse(SPHERE.0), PathBuf::from("the built-in sphere"));
            let file = file.map_err(|problem| problem.of(&path))?;
            Ok((file, path, SPHERE.1.to_owned()))
        }
        (None, Some(_)) => {
            let problem = "the built-in sphere has one material; name a `scene` too, or take this key away";
            Err(refused(".material", problem.to_owned()).into())
        }
        (Some(scene), named) => {
            let (file, path) = SceneFile::read(&job.folder.join(scene))?;
            let known: Vec<&str> = file.materials.keys().map(String::as_str).collect();
            match named {
                Some(name) if file.materials.contains_key(name) => {
                    let name = name.clone();
                    Ok((file, path, name))
                }
                found => {
                    let name = found.as_deref().unwrap_or_default();
                    let meant = suggestion(name, known.iter().copied());
                    let found =
                        found.as_ref().map_or_else(|| "none is named".to_owned(), |name| format!("found {name:?}"));
                    let problem = format!(
                        "{found}; expected the material of the scene that the model stands for, one of {}{meant}",
                        known.join(", ")
                    );
                    Err(refused(".material", problem).into())
                }
            }
        }
    }
}

/// The three wavelengths at which all of the sweep's spectra are read, the longest first; None where they are read at others.
fn wavelengths_nm(sweep: &Sweep) -> Option<Vec<f64>> {
    let mut channels: [f64; 3] = sweep.views.first()?.wavelengths_nm.as_slice().try_into().ok()?;
    channels.sort_by(|a, b| b.total_cmp(a));
    let same = |nm: &[f64]| nm.len() == 3 && nm.iter().rev().eq(&channels);
    sweep.views.iter().all(|view| same(&view.wavelengths_nm)).then(|| channels.to_vec())
}
