//! From a typed scene to a checked one.

use std::collections::BTreeMap;
use std::path::Path;

use super::error::{SceneError, SceneProblem};
use super::feather::{Materials, with_feather, with_species};
use super::file::{CameraFile, ImageFile, LightFile, MaterialFile, ObjectFile, SceneFile};
use super::inputs::Inputs;
use super::material::{Spectrum, material};
use crate::bsdf::ChannelMix;
use crate::nearest::suggestion;
use crate::number::plain;
use crate::render::{
    Camera, EnvironmentMap, Light, MOST_SAMPLES, Projection, Rectangle, Resolution, Scene, Settings, Sphere,
    Strategies, Texture, ToneMapping, Vector,
};

/// Most pixels of a picture, and most in a row: what fits the memory of a desk's machine.
const MOST_PIXELS: u64 = 1 << 27;
const LONGEST_SIDE: u32 = 1 << 15;

/// Most scatterings of a path.
const MOST_SCATTERINGS: u32 = 128;

/// A scene that can be rendered.
#[derive(Debug)]
pub struct CheckedScene {
    /// One line for people.
    pub title: String,
    /// What stands in it.
    pub scene: Scene,
    /// Size and samples.
    pub resolution: Resolution,
    /// How light is followed.
    pub settings: Settings,
    /// How radiance becomes shades.
    pub tone: ToneMapping,
    /// How the models' channels become the picture's, where these are not themselves three.
    pub(super) mix: Option<ChannelMix>,
    /// A digest of all that decides the picture: the scene, the files that it names, and the program's version.
    pub fingerprint: String,
}

impl CheckedScene {
    /// Checks a scene that was read from a file at `path`, and reads what it names.
    ///
    /// # Errors
    /// The first thing that makes no sense, with its key.
    pub fn new(file: &SceneFile, path: &Path) -> Result<Self, SceneError> {
        check(file, path).map_err(|problem| problem.of(path))
    }
}

fn check(file: &SceneFile, path: &Path) -> Result<CheckedScene, SceneProblem> {
    let resolution = resolution(&file.image)?;
    if !(1..=MOST_SCATTERINGS).contains(&file.scatterings) {
        let problem = format!("found {}; expected 1 (direct light only) to {MOST_SCATTERINGS}", file.scatterings);
        return Err(SceneProblem::key("scatterings", problem));
    }
    let stops = file.image.tone.exposure_stops;
    if !(-50.0..=50.0).contains(&stops) {
        let problem = format!("found {stops}; expected a number of stops from -50 to 50");
        return Err(SceneProblem::key("image.tone.exposure_stops", problem));
    }
    let camera = camera(&file.camera)?;
    let spectrum = Spectrum::new(&file.wavelengths_nm)?;
    let mut inputs = Inputs::beside(path);
    let mut materials = Vec::new();
    let mut numbers = BTreeMap::new();
    for (name, design) in &file.materials {
        numbers.insert(name.as_str(), materials.len());
        materials.push(material(&format!("materials.{name}"), design, &spectrum, &mut inputs)?);
    }
    let mut scene = Scene::new(camera, materials);
    for (number, object) in file.objects.iter().enumerate() {
        let key = format!("objects[{}]", number + 1);
        scene = with_object(scene, &key, object, &numbers, &file.materials, &spectrum, &mut inputs)?;
    }
    let mut environments = 0;
    for (number, light) in file.lights.iter().enumerate() {
        let key = format!("lights[{}]", number + 1);
        environments += u32::from(matches!(light, LightFile::Environment(_)));
        if environments > 1 {
            return Err(SceneProblem::key(key, "this is a second environment; a scene has one at most"));
        }
        scene = with_light(scene, &key, light, &camera, &mut inputs)?;
    }
    if file.lights.is_empty() {
        return Err(SceneProblem::key("lights", "there is none, so that all would be black; add one"));
    }
    let settings = Settings {
        scatterings: file.scatterings,
        strategies: Strategies::Both,
        sampler: file.image.sampler,
        seed: file.image.seed,
    };
    // The picture's own bytes do not hang on how it is shown.
    let mut shown = file.clone();
    shown.image.tone = ToneMapping::default();
    let text = serde_json::to_vec(&(shown, env!("CARGO_PKG_VERSION"))).unwrap_or_default();
    Ok(CheckedScene {
        title: file.title.clone(),
        scene,
        resolution,
        settings,
        tone: file.image.tone,
        mix: spectrum.mix().cloned(),
        fingerprint: inputs.fingerprint(&text),
    })
}

fn resolution(image: &ImageFile) -> Result<Resolution, SceneProblem> {
    let ImageFile { width, height, samples, .. } = *image;
    for (key, side) in [("image.width", width), ("image.height", height)] {
        if !(1..=LONGEST_SIDE).contains(&side) {
            return Err(SceneProblem::key(key, format!("found {side}; expected 1 to {LONGEST_SIDE} pixels")));
        }
    }
    let pixels = u64::from(width) * u64::from(height);
    if pixels > MOST_PIXELS {
        let problem = format!("{width} × {height} are {pixels} pixels; expected at most {MOST_PIXELS}");
        return Err(SceneProblem::key("image", problem));
    }
    if !(1..=MOST_SAMPLES).contains(&samples) {
        return Err(SceneProblem::key("image.samples", format!("found {samples}; expected 1 to {MOST_SAMPLES}")));
    }
    Ok(Resolution { width, height, samples })
}

fn camera(design: &CameraFile) -> Result<Camera, SceneProblem> {
    let (position, target, up, projection) = match design {
        CameraFile::Perspective(camera) => {
            let angle = camera.field_of_view_deg;
            if !(angle > 0.0 && angle < 180.0) {
                let problem = format!("found {angle}; expected an angle between 0° and 180°");
                return Err(SceneProblem::key("camera.field_of_view_deg", problem));
            }
            let projection = Projection::Perspective { field_of_view: angle.to_radians() };
            (camera.position_mm, camera.target_mm, camera.up, projection)
        }
        CameraFile::Orthographic(camera) => {
            let height_mm = length("camera.height_mm", camera.height_mm)?;
            (camera.position_mm, camera.target_mm, camera.up, Projection::Orthographic { height_mm })
        }
    };
    let position = vector("camera.position_mm", position)?;
    let (target, up) = (vector("camera.target_mm", target)?, vector("camera.up", up)?);
    Camera::new(position, target, up, projection).ok_or_else(|| {
        let problem = "it looks nowhere: `target_mm` must differ from `position_mm`, and `up` must not lie along the line \
                       between them";
        SceneProblem::key("camera", problem)
    })
}

fn with_object(
    scene: Scene,
    key: &str,
    object: &ObjectFile,
    materials: &BTreeMap<&str, usize>,
    designs: &BTreeMap<String, MaterialFile>,
    spectrum: &Spectrum,
    inputs: &mut Inputs,
) -> Result<Scene, SceneProblem> {
    let named = |key: &str, name: &str| {
        materials.get(name).copied().ok_or_else(|| {
            let known = if materials.is_empty() {
                "the scene has none".to_owned()
            } else {
                format!("the scene has {}", materials.keys().copied().collect::<Vec<_>>().join(", "))
            };
            let meant = suggestion(name, materials.keys().copied());
            SceneProblem::key(key, format!("there is no material {name:?}; {known}{meant}"))
        })
    };
    let material = |name: &str| named(&format!("{key}.material"), name);
    let eye = scene.camera_position();
    match object {
        ObjectFile::Sphere(design) => {
            let sphere = sphere(key, design.centre_mm, design.radius_mm, &eye)?;
            Ok(scene.with_sphere(sphere, material(&design.material)?))
        }
        ObjectFile::Rectangle(design) => {
            let rectangle = rectangle(key, design.corner_mm, design.edge_u_mm, design.edge_v_mm)?;
            Ok(scene.with_rectangle(rectangle, material(&design.material)?))
        }
        ObjectFile::Mesh(design) => {
            length(&format!("{key}.unit_mm"), design.unit_mm)?;
            vector(&format!("{key}.position_mm"), design.position_mm)?;
            let material = material(&design.material)?;
            let mesh = inputs.mesh(key, design)?;
            if mesh.is_closed() && mesh.contains(&eye) {
                return Err(camera_inside(key));
            }
            Ok(scene.with_mesh(mesh, material))
        }
        ObjectFile::Feather(design) => {
            with_feather(scene, key, design, &Materials { numbers: &named, designs, spectrum }, inputs)
        }
        ObjectFile::Species(design) => with_species(scene, key, design, spectrum, inputs),
    }
}

fn with_light(
    scene: Scene,
    key: &str,
    light: &LightFile,
    camera: &Camera,
    inputs: &mut Inputs,
) -> Result<Scene, SceneProblem> {
    let light = match light {
        LightFile::Point(design) => Light::Point {
            position: vector(&format!("{key}.position_mm"), design.position_mm)?,
            intensity: power(&format!("{key}.intensity"), design.intensity)?,
        },
        LightFile::Directional(design) => {
            let key_of_direction = format!("{key}.towards_light");
            let direction = vector(&key_of_direction, design.towards_light)?.try_normalize(0.0).ok_or_else(|| {
                SceneProblem::key(key_of_direction, "found [0, 0, 0]; expected a direction, of any other length")
            })?;
            Light::Directional { direction, irradiance: power(&format!("{key}.irradiance"), design.irradiance)? }
        }
        LightFile::Rectangle(design) => Light::Rectangle {
            shape: rectangle(key, design.corner_mm, design.edge_u_mm, design.edge_v_mm)?,
            radiance: power(&format!("{key}.radiance"), design.radiance)?,
        },
        LightFile::Sphere(design) => Light::Sphere {
            shape: sphere(key, design.centre_mm, design.radius_mm, &camera.position())?,
            radiance: power(&format!("{key}.radiance"), design.radiance)?,
        },
        LightFile::Environment(design) => {
            let radiance = power(&format!("{key}.radiance"), design.radiance)?;
            let Some(file) = &design.file else { return Ok(scene.with_light(Light::Constant { radiance })) };
            if !design.azimuth_deg.is_finite() {
                let problem = format!("found {}; expected an angle", design.azimuth_deg);
                return Err(SceneProblem::key(format!("{key}.azimuth_deg"), problem));
            }
            let key = format!("{key}.file");
            let picture = inputs.picture(&key, file, None)?;
            #[expect(clippy::cast_possible_truncation, reason = "a texture holds 32-bit numbers")]
            let radiance = radiance.map(|channel| channel as f32);
            let texels = picture.texels().iter().map(|texel| std::array::from_fn(|k| texel[k] * radiance[k]));
            let texels: Vec<[f32; 3]> = texels.collect();
            let wrong = |channel: &&f32| !(channel.is_finite() && **channel >= 0.0);
            if let Some(found) = texels.iter().flatten().find(wrong) {
                let problem = format!("{} holds {found}; expected radiances from 0 up", file.display());
                return Err(SceneProblem::key(key, problem));
            }
            let map =
                Texture::new(picture.width(), texels).and_then(|map| EnvironmentMap::new(map, design.azimuth_deg));
            let black = || SceneProblem::key(&key, format!("{} is black; expected some light in it", file.display()));
            Light::Map(Box::new(map.ok_or_else(black)?))
        }
    };
    Ok(scene.with_light(light))
}

fn sphere(key: &str, centre: [f64; 3], radius_mm: f64, eye: &Vector) -> Result<Sphere, SceneProblem> {
    let centre = vector(&format!("{key}.centre_mm"), centre)?;
    let sphere = Sphere { centre, radius: length(&format!("{key}.radius_mm"), radius_mm)? };
    if sphere.contains(eye) { Err(camera_inside(key)) } else { Ok(sphere) }
}

fn camera_inside(key: &str) -> SceneProblem {
    SceneProblem::key(key, "the camera is inside it and would see nothing else; move `camera.position_mm` out of it")
}

pub(super) fn rectangle(key: &str, corner: [f64; 3], u: [f64; 3], v: [f64; 3]) -> Result<Rectangle, SceneProblem> {
    let corner = vector(&format!("{key}.corner_mm"), corner)?;
    let (u, v) = (vector(&format!("{key}.edge_u_mm"), u)?, vector(&format!("{key}.edge_v_mm"), v)?);
    let (long, wide) = (u.norm(), v.norm());
    // Edges typed with six digits are perpendicular to that many.
    if u.dot(&v).abs() > 1e-5 * long * wide {
        let problem =
            format!("the edges [{}, {}, {}] and [{}, {}, {}] are not perpendicular", u.x, u.y, u.z, v.x, v.y, v.z);
        return Err(SceneProblem::key(key, format!("{problem}; a rectangle's are, use a mesh for another shape")));
    }
    let problem = "it has no area; give `edge_u_mm` and `edge_v_mm` lengths above 0";
    Rectangle::new(corner, u, v).ok_or_else(|| SceneProblem::key(key, problem))
}

/// Coordinates beyond this are no desk's; squares of them are still numbers.
const FARTHEST_MM: f64 = 1e12;

pub(super) fn vector(key: &str, typed: [f64; 3]) -> Result<Vector, SceneProblem> {
    match typed.iter().find(|x| !(-FARTHEST_MM..=FARTHEST_MM).contains(*x)) {
        Some(found) => {
            Err(SceneProblem::key(key, format!("found {}; expected three numbers up to ±{FARTHEST_MM}", plain(*found))))
        }
        None => Ok(Vector::from(typed)),
    }
}

pub(super) fn length(key: &str, typed: f64) -> Result<f64, SceneProblem> {
    let allowed = 1e-9..=FARTHEST_MM;
    if allowed.contains(&typed) {
        return Ok(typed);
    }
    Err(SceneProblem::key(key, format!("found {typed}; expected a length above 0, in mm")))
}

fn power(key: &str, typed: [f64; 3]) -> Result<[f64; 3], SceneProblem> {
    if let Some(found) = typed.iter().find(|x| !(0.0..=1e30).contains(*x)) {
        return Err(SceneProblem::key(key, format!("found {found}; expected three numbers from 0 up")));
    }
    if typed.iter().all(|x| *x == 0.0) {
        return Err(SceneProblem::key(
            key,
            "found [0, 0, 0], which lights nothing; take the light out or give it power",
        ));
    }
    Ok(typed)
}
