//! A scene as its author types it: the JSON file, before anything in it has been checked.

use std::collections::BTreeMap;
use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::paint_file::{BarbsShown, LayerFile};
use crate::job::ModelFile;
use crate::measure::photograph::Encoding;
use crate::render::{Sampler, ToneMapping};

/// A scene: what stands where, what it is made of, what lights it, and how it is looked at. Lengths are mm.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SceneFile {
    /// One line for people.
    pub title: String,
    /// Remarks and sources.
    #[serde(default)]
    pub about: String,
    /// Wavelengths for which the materials' models are made, nm. Three, the longest first, are shown
    /// as the linear red, green and blue of Rec. 709. Of four or more, which rise, the colour is shown: the spectrum that a material
    /// scatters, under CIE illuminant D65, for the CIE 1931 observer. Lights are white where their channels are equal.
    #[serde(default = "default_wavelengths_nm")]
    pub wavelengths_nm: Vec<f64>,
    /// The picture to make.
    pub image: ImageFile,
    /// From where it is seen.
    pub camera: CameraFile,
    /// Scatterings between light and camera at most: 1 is direct light only.
    #[serde(default = "default_scatterings")]
    pub scatterings: u32,
    /// What things are made of, by name.
    #[serde(default)]
    pub materials: BTreeMap<String, MaterialFile>,
    /// What stands in the scene.
    #[serde(default)]
    pub objects: Vec<ObjectFile>,
    /// What lights it.
    pub lights: Vec<LightFile>,
}

fn default_wavelengths_nm() -> Vec<f64> {
    vec![645.0, 525.0, 445.0]
}

fn default_scatterings() -> u32 {
    8
}

/// The picture to make.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ImageFile {
    /// Pixels a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Samples a pixel, 1 to 65536; powers of two serve best.
    #[serde(default = "default_samples")]
    pub samples: u32,
    /// Seed of all random numbers.
    #[serde(default)]
    pub seed: u64,
    /// How the samples of a pixel are spread.
    #[serde(default)]
    pub sampler: Sampler,
    /// How radiance becomes the shades of the PNG; the EXR stays linear.
    #[serde(default)]
    pub tone: ToneMapping,
}

fn default_samples() -> u32 {
    64
}

/// From where the picture is taken.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum CameraFile {
    /// All rays start at one point.
    Perspective(PerspectiveFile),
    /// All rays are parallel.
    Orthographic(OrthographicFile),
}

/// A camera whose rays start at one point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PerspectiveFile {
    /// Where it stands.
    pub position_mm: [f64; 3],
    /// The point in the middle of the picture.
    pub target_mm: [f64; 3],
    /// What is up in the picture.
    #[serde(default = "upwards")]
    pub up: [f64; 3],
    /// Angle under which the picture's height is seen.
    pub field_of_view_deg: f64,
}

/// A camera whose rays are parallel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OrthographicFile {
    /// Where it stands; it sees nothing behind itself.
    pub position_mm: [f64; 3],
    /// The point in the middle of the picture.
    pub target_mm: [f64; 3],
    /// What is up in the picture.
    #[serde(default = "upwards")]
    pub up: [f64; 3],
    /// What the picture's height shows.
    pub height_mm: f64,
}

fn upwards() -> [f64; 3] {
    [0.0, 0.0, 1.0]
}

/// What something is made of.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MaterialFile {
    /// The scattering model, as in a job.
    pub model: ModelFile,
    /// Values of its parameters; the rest keep their defaults.
    #[serde(default)]
    pub parameters: BTreeMap<String, f64>,
    /// A picture that gives one parameter its value from place to place.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub texture: Option<TextureFile>,
}

/// A picture that gives a parameter its value.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TextureFile {
    /// The parameter, one on which the model depends linearly and that may differ between channels: `albedo`, `diffuse`.
    pub parameter: String,
    /// PNG, JPEG, TIFF or EXR, beside the scene.
    pub file: PathBuf,
    /// What its numbers are; without this key, linear in an EXR and sRGB in all others.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub encoding: Option<Encoding>,
}

/// Something that stands in the scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum ObjectFile {
    /// A sphere.
    Sphere(SphereFile),
    /// A flat rectangle.
    Rectangle(RectangleFile),
    /// A mesh of triangles.
    Mesh(MeshFile),
    /// A flat feather.
    Feather(FeatherSheetFile),
    /// A flat feather of a kept species.
    Species(SpeciesSheetFile),
}

/// A sphere. Its tangents run along its circles of latitude about z.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SphereFile {
    /// Its centre.
    pub centre_mm: [f64; 3],
    /// Its radius.
    pub radius_mm: f64,
    /// Name of its material.
    pub material: String,
}

/// A rectangle. Its normal is `edge_u` × `edge_v`; models that only reflect are black from behind. Textures lie along
/// `edge_u` to the right and `edge_v` upwards; its tangent is `edge_u`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RectangleFile {
    /// One corner.
    pub corner_mm: [f64; 3],
    /// From it to the next.
    pub edge_u_mm: [f64; 3],
    /// From it to the one before, perpendicular to the other edge.
    pub edge_v_mm: [f64; 3],
    /// Name of its material.
    pub material: String,
}

/// A mesh from a file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MeshFile {
    /// Wavefront OBJ, beside the scene; its own materials are not read.
    pub file: PathBuf,
    /// Length of one of its units.
    #[serde(default = "default_unit_mm")]
    pub unit_mm: f64,
    /// Where its origin comes to lie.
    #[serde(default)]
    pub position_mm: [f64; 3],
    /// Name of its material.
    pub material: String,
}

/// A flat feather in the plane of `right` and `up`; `right` × `up` is its upper side.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FeatherSheetFile {
    /// A feather's JSON or a map that `barbule geometry` made, beside the scene.
    pub file: PathBuf,
    /// Resolution of the map of a feather's JSON; without this key its longer side has 2048 texels.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pixels_per_mm: Option<f64>,
    /// Where the map's lower left corner lies.
    pub corner_mm: [f64; 3],
    /// The map's right in the scene, of any length.
    pub right: [f64; 3],
    /// The map's up in the scene, perpendicular to `right`, of any length.
    pub up: [f64; 3],
    /// Name of the material of shaft and calamus.
    pub shaft: String,
    /// Name of the material of the vanes, where no pattern says otherwise.
    pub vane: String,
    /// Where the vanes are made of something else.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pattern: Option<PatternFile>,
    /// Layers of paint on the vanes, one over another: pigment that is thicker here than there, bars, bands, spots.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub paint: Vec<LayerFile>,
    /// How barbs and barbules are told apart.
    #[serde(default)]
    pub barbs: BarbsShown,
}

/// The feather of a kept species, flat in the plane of `right` and `up`; `right` × `up` is its upper side.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SpeciesSheetFile {
    /// The entry's JSON, beside the scene.
    pub file: PathBuf,
    /// Resolution of its map; without this key its longer side has 2048 texels.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pixels_per_mm: Option<f64>,
    /// Where its middle lies.
    pub centre_mm: [f64; 3],
    /// The feather's right in the scene, of any length.
    pub right: [f64; 3],
    /// The feather's up, from base to tip, in the scene, perpendicular to `right`, of any length.
    pub up: [f64; 3],
}

/// A picture over the whole map whose colours stand for materials.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PatternFile {
    /// A PNG, beside the scene.
    pub file: PathBuf,
    /// Names of materials by the colour that stands for them, `#rrggbb`. A texel of another colour takes the nearest one.
    pub materials: BTreeMap<String, String>,
}

fn default_unit_mm() -> f64 {
    1.0
}

/// A light.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum LightFile {
    /// A point that shines alike on all sides.
    Point(PointLightFile),
    /// Parallel light.
    Directional(DirectionalLightFile),
    /// A rectangle that shines on the side of its normal.
    Rectangle(RectangleLightFile),
    /// A sphere that shines outwards.
    Sphere(SphereLightFile),
    /// Light from far away on all sides: one radiance, or a picture.
    Environment(EnvironmentFile),
}

/// A point that shines alike on all sides.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PointLightFile {
    /// Where it is.
    pub position_mm: [f64; 3],
    /// Radiant intensity of the channels: what falls on a surface at 1 mm that faces it.
    pub intensity: [f64; 3],
}

/// Parallel light.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DirectionalLightFile {
    /// From the scene to the light, of any length.
    pub towards_light: [f64; 3],
    /// What falls on a surface that faces it, for each channel.
    pub irradiance: [f64; 3],
}

/// A rectangle that shines on the side of its normal, `edge_u` × `edge_v`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RectangleLightFile {
    /// One corner.
    pub corner_mm: [f64; 3],
    /// From it to the next.
    pub edge_u_mm: [f64; 3],
    /// From it to the one before, perpendicular to the other edge.
    pub edge_v_mm: [f64; 3],
    /// Radiance of the channels.
    pub radiance: [f64; 3],
}

/// A sphere that shines outwards.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SphereLightFile {
    /// Its centre.
    pub centre_mm: [f64; 3],
    /// Its radius.
    pub radius_mm: f64,
    /// Radiance of the channels.
    pub radiance: [f64; 3],
}

/// Light from far away on all sides.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct EnvironmentFile {
    /// Radiance of the channels; with a file, what its numbers are multiplied by.
    #[serde(default = "default_radiance")]
    pub radiance: [f64; 3],
    /// Equirectangular picture, beside the scene: the zenith (+z) above, once around from +x towards +y.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<PathBuf>,
    /// Azimuth of the picture's left edge from +x towards +y.
    #[serde(default)]
    pub azimuth_deg: f64,
}

fn default_radiance() -> [f64; 3] {
    [1.0; 3]
}
