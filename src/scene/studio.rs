//! The pictures of a kept feather: the same table, light and three views for every species.

use std::path::Path;

use super::file::{
    CameraFile, DirectionalLightFile, EnvironmentFile, ImageFile, LightFile, MaterialFile, ObjectFile,
    OrthographicFile, PerspectiveFile, RectangleFile, SceneFile, SpeciesSheetFile,
};
use super::species::SpeciesFile;
use crate::bsdf::LambertianDesign;
use crate::geometry::{Feather, FeatherMistake, Side};
use crate::job::ModelFile;

/// How a kept feather is looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum View {
    /// From straight above, whole.
    Flat,
    /// From the side and from 30° above the table, whole.
    Angle,
    /// From straight above, so near that each barb has [`PIXELS_PER_BARB`] pixels.
    CloseUp,
}

/// Pixels from one barb to the next in the closest view.
pub const PIXELS_PER_BARB: f64 = 8.0;

/// Wavelengths of the pictures, nm. With steps of 20 nm the feathers that are kept have the colours of steps of 5 nm to ΔE2000
/// 0.4, with the usual three wavelengths they miss them by up to 3.2 for a blue barb: a test measures both.
pub fn picture_wavelengths_nm() -> Vec<f64> {
    (0..=16).map(|k| 390.0 + 20.0 * f64::from(k)).collect()
}

/// Height of the feather above the table, mm: it lies on it.
const ABOVE_TABLE_MM: f64 = 0.6;

/// What the table reflects: dark, since a bird's feathers lie on others and let little light through.
const TABLE_ALBEDO: f64 = 0.08;

/// The scene that shows the entry that was read from this file.
///
/// # Errors
/// A geometry that makes no sense.
pub fn studio(entry: &SpeciesFile, path: &Path, view: View) -> Result<SceneFile, FeatherMistake> {
    let feather = Feather::new(&entry.geometry)?;
    let bounds = feather.bounds_mm();
    let (length_mm, width_mm) = (bounds.height(), bounds.width());
    let image = |width: u32, height: u32| ImageFile {
        width,
        height,
        samples: 64,
        seed: 0,
        sampler: Default::default(),
        tone: Default::default(),
    };
    let above = |target_mm: [f64; 2], height_mm: f64| {
        let [x, y] = target_mm;
        CameraFile::Orthographic(OrthographicFile {
            position_mm: [x, y, 300.0],
            target_mm: [x, y, 0.0],
            up: [0.0, 1.0, 0.0],
            height_mm,
        })
    };
    let (image, camera, pixels_per_mm) = match view {
        View::Flat => {
            let picture_mm = 1.08 * length_mm;
            let scale = 720.0 / picture_mm;
            let height = rounded(1.3 * width_mm * scale);
            (image(720, height), above([0.0, 0.0], f64::from(height) / scale), 2.0 * scale)
        }
        View::Angle => {
            // From behind the base, so that the tip points away to the right.
            let distance_mm = 2.3 * length_mm;
            let (elevation, azimuth) = (30f64.to_radians(), (-55f64).to_radians());
            let flat = distance_mm * elevation.cos();
            let camera = CameraFile::Perspective(PerspectiveFile {
                position_mm: [-flat * azimuth.cos(), flat * azimuth.sin(), distance_mm * elevation.sin()],
                target_mm: [0.0, 0.0, 0.0],
                up: [0.0, 0.0, 1.0],
                field_of_view_deg: 13.0,
            });
            (image(720, 360), camera, 2.0 * 720.0 / length_mm)
        }
        View::CloseUp => {
            let pitch_mm = feather.vanes.iter().map(|vane| feather.barb_pitch_mm(vane)).fold(f64::INFINITY, f64::min);
            let scale = PIXELS_PER_BARB / pitch_mm;
            let (width, height) = (480, 320);
            // Beside the rachis, on the wider vane, at six tenths of its length.
            let shaft = feather.shaft.curve.point(feather.shaft.at_rachis_mm(0.6 * feather.shaft.rachis_length_mm()));
            let [left, right] = feather.vanes.each_ref().map(|vane| vane.mean_barb_length_mm());
            let side = if left > right { Side::Left } else { Side::Right };
            let height_mm = f64::from(height) / scale;
            let aside_mm = if side == Side::Left { -0.3 } else { 0.3 } * height_mm;
            let middle = bounds.center();
            // The feather's up is the scene's x, and its right the scene's −y.
            let target = [shaft.y - middle.y, -(shaft.x + aside_mm - middle.x)];
            (image(width, height), above(target, height_mm), scale)
        }
    };
    let table = MaterialFile {
        model: ModelFile::Lambertian(LambertianDesign::default()),
        parameters: [("albedo".to_owned(), TABLE_ALBEDO)].into(),
        texture: None,
    };
    let half_mm = 40.0 * length_mm;
    Ok(SceneFile {
        title: format!("{} ({}): {}, not fitted", entry.title, entry.species, entry.status.word()),
        about: entry.about.clone(),
        wavelengths_nm: picture_wavelengths_nm(),
        image,
        camera,
        // Light goes through the vane to the table and back.
        scatterings: 4,
        materials: [("table".to_owned(), table)].into(),
        objects: vec![
            ObjectFile::Species(SpeciesSheetFile {
                file: path.file_name().map(Into::into).unwrap_or_default(),
                pixels_per_mm: Some(pixels_per_mm),
                centre_mm: [0.0, 0.0, ABOVE_TABLE_MM],
                right: [0.0, -1.0, 0.0],
                up: [1.0, 0.0, 0.0],
            }),
            ObjectFile::Rectangle(RectangleFile {
                corner_mm: [-half_mm, -half_mm, 0.0],
                edge_u_mm: [2.0 * half_mm, 0.0, 0.0],
                edge_v_mm: [0.0, 2.0 * half_mm, 0.0],
                material: "table".to_owned(),
            }),
        ],
        lights: vec![
            LightFile::Directional(DirectionalLightFile { towards_light: [-0.35, 0.55, 0.75], irradiance: [4.2; 3] }),
            LightFile::Environment(EnvironmentFile { radiance: [0.8; 3], file: None, azimuth_deg: 0.0 }),
        ],
    })
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a picture's side")]
fn rounded(pixels: f64) -> u32 {
    pixels.round() as u32
}
