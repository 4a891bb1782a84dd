//! The files that a scene names: pictures and meshes.

use std::fs;
use std::io::{Cursor, ErrorKind};
use std::path::{Path, PathBuf};

use image::{ColorType, DynamicImage, ImageReader};
use sha2::{Digest, Sha256};
use tobj::LoadOptions;

use super::error::SceneProblem;
use super::file::MeshFile;
use crate::measure::colour::decode;
use crate::measure::photograph::Encoding;
use crate::render::{Corner, Mesh, Texture, Vector};

/// Reads files beside a scene, and keeps a digest of all that it has read.
#[derive(Debug)]
pub(super) struct Inputs {
    folder: PathBuf,
    digest: Sha256,
}

impl Inputs {
    pub(super) fn beside(scene: &Path) -> Self {
        Self { folder: scene.parent().map(Path::to_owned).unwrap_or_default(), digest: Sha256::new() }
    }

    /// 128 bits over the contents of all files read, in their order, and over these bytes.
    pub(super) fn fingerprint(mut self, rest: &[u8]) -> String {
        self.digest.update(rest);
        self.digest.finalize().iter().take(16).map(|byte| format!("{byte:02x}")).collect()
    }

    /// Notes a file's contents, and says where it is.
    pub(super) fn noted(&mut self, key: &str, file: &Path) -> Result<PathBuf, SceneProblem> {
        self.read(key, file)?;
        Ok(self.folder.join(file))
    }

    fn read(&mut self, key: &str, file: &Path) -> Result<Vec<u8>, SceneProblem> {
        let path = self.folder.join(file);
        let bytes = fs::read(&path).map_err(|error| {
            let reason = match error.kind() {
                ErrorKind::NotFound => "there is no such file".to_owned(),
                _ => error.to_string().split(" (os error").next().unwrap_or_default().to_owned(),
            };
            SceneProblem::key(key, format!("{}: {reason}; give a path from the scene's folder", path.display()))
        })?;
        self.digest.update(Sha256::digest(&bytes));
        Ok(bytes)
    }

    /// A picture's linear values.
    pub(super) fn picture(
        &mut self,
        key: &str,
        file: &Path,
        encoding: Option<Encoding>,
    ) -> Result<Texture, SceneProblem> {
        let picture = self.decoded(key, file)?;
        let is_float = matches!(picture.color(), ColorType::Rgb32F | ColorType::Rgba32F);
        let encoding = encoding.unwrap_or(if is_float { Encoding::Linear } else { Encoding::Srgb });
        let empty = || SceneProblem::key(key, format!("{} has no pixels", file.display()));
        linear(&picture, encoding).ok_or_else(empty)
    }

    /// A picture's width and the codes of its texels, as they are.
    pub(super) fn codes(&mut self, key: &str, file: &Path) -> Result<(usize, Vec<[u8; 3]>), SceneProblem> {
        let picture = self.decoded(key, file)?.to_rgb8();
        let width = usize::try_from(picture.width()).unwrap_or(0);
        Ok((width, picture.pixels().map(|pixel| pixel.0).collect()))
    }

    fn decoded(&mut self, key: &str, file: &Path) -> Result<DynamicImage, SceneProblem> {
        let bytes = self.read(key, file)?;
        let refused = |reason: String| {
            let expected = "expected a whole PNG, JPEG, TIFF or EXR picture";
            SceneProblem::key(key, format!("{}: {reason}; {expected}", file.display()))
        };
        let reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format();
        let picture = reader.map_err(|error| refused(error.to_string()))?.decode();
        picture.map_err(|error| refused(error.to_string()))
    }

    /// A mesh, its triangles and their corners as they stand in an OBJ file.
    pub(super) fn mesh(&mut self, key: &str, design: &MeshFile) -> Result<Mesh, SceneProblem> {
        let key = format!("{key}.file");
        let bytes = self.read(&key, &design.file)?;
        let refused = |reason: &str| {
            let expected = "expected a Wavefront OBJ file with faces";
            SceneProblem::key(&key, format!("{}: {reason}; {expected}", design.file.display()))
        };
        let options =
            LoadOptions { triangulate: true, ignore_points: true, ignore_lines: true, ..LoadOptions::default() };
        let no_materials = |_: &Path| Ok((Vec::new(), Default::default()));
        let (models, _) = tobj::load_obj_buf(&mut bytes.as_slice(), &options, no_materials)
            .map_err(|error| refused(&error.to_string()))?;
        let mut triangles = Vec::new();
        for model in &models {
            let mesh = &model.mesh;
            for face in 0..mesh.indices.len() / 3 {
                triangles.push([0, 1, 2].map(|corner| corner_of(mesh, 3 * face + corner, design)));
            }
        }
        if triangles.is_empty() {
            return Err(refused("there are no faces in it"));
        }
        if triangles.iter().flatten().any(|corner| corner.position.iter().any(|x| !x.is_finite())) {
            return Err(refused("a vertex is no finite number"));
        }
        let corners: Vec<[Vector; 3]> = triangles.iter().map(|t| t.map(|corner| corner.position)).collect();
        Mesh::new(triangles).map_err(|number| {
            let [a, b, c] = corners[number].map(|p| format!("({}, {}, {})", p.x, p.y, p.z));
            refused(&format!(
                "triangle {} has no area: its corners are at {a}, {b} and {c} mm; take it out of the mesh",
                number + 1
            ))
        })
    }
}

/// One corner of a face, in the scene.
fn corner_of(mesh: &tobj::Mesh, corner: usize, design: &MeshFile) -> Corner {
    let three = |values: &[f32], index: u32| -> Option<Vector> {
        let start = 3 * index as usize;
        values.get(start..start + 3).map(|v| Vector::new(v[0].into(), v[1].into(), v[2].into()))
    };
    let position = three(&mesh.positions, mesh.indices[corner]).unwrap_or_else(|| Vector::repeat(f64::NAN));
    let normal = mesh.normal_indices.get(corner).and_then(|index| three(&mesh.normals, *index));
    let uv = mesh.texcoord_indices.get(corner).and_then(|index| {
        let start = 2 * *index as usize;
        mesh.texcoords.get(start..start + 2).map(|uv| [f64::from(uv[0]), f64::from(uv[1])])
    });
    Corner {
        position: position * design.unit_mm + Vector::from(design.position_mm),
        normal: normal.and_then(|normal| normal.try_normalize(0.0)),
        uv,
    }
}

fn linear(picture: &DynamicImage, encoding: Encoding) -> Option<Texture> {
    let pixels = picture.to_rgb32f();
    let width = usize::try_from(pixels.width()).ok()?;
    #[expect(clippy::cast_possible_truncation, reason = "a texture holds 32-bit numbers")]
    let linear = |code: f32| match encoding {
        Encoding::Srgb => decode(code.into()) as f32,
        Encoding::Linear => code,
    };
    Texture::new(width, pixels.pixels().map(|pixel| pixel.0.map(linear)).collect())
}
