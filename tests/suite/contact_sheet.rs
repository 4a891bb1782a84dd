//! Pictures of a sweep's cells.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use barbule::job::{self, Job};
use barbule::render::{Control, Picture, render};
use barbule::scene::{CheckedScene, ContactSheet, MaterialFile, SceneFile, contact_sheet};
use serde_json::{Value, json};

use super::desk::{Desk, replaced, shipped};

static INTERRUPT: AtomicBool = AtomicBool::new(false);
const CONTROL: Control<'static> = Control { interrupt: &INTERRUPT, progress: &|_, _| (), checkpoint: None };

/// A diffuse ball over its albedo, in a scene of the desk's.
const GREY: &str = r#"title = "Grey"

[data.synthetic]
quantity = "brdf"
mirror_deg = [0]
wavelengths_nm = [445, 525, 645]

[model]
kind = "lambertian"

[sweep.grid]
albedo = { values = [0.25, 0.75] }

[sweep.render]
scene = "scene.json"
material = "ball"
"#;

/// A ball that fills the picture, under the same radiance from everywhere, beside something that stays as it is.
fn scene() -> Value {
    json!({
        "title": "A ball under a clouded sky",
        "image": { "width": 24, "height": 16, "samples": 64 },
        "scatterings": 1,
        "camera": {
            "kind": "orthographic", "position_mm": [0, 0, 50], "target_mm": [0, 0, 0], "up": [0, 1, 0], "height_mm": 8
        },
        "materials": {
            "another": { "model": { "kind": "lambertian" }, "parameters": { "albedo": 0.1 } },
            "ball": { "model": { "kind": "rough-plastic" } }
        },
        "objects": [
            { "kind": "sphere", "centre_mm": [0, 0, 0], "radius_mm": 10, "material": "ball" },
            { "kind": "sphere", "centre_mm": [5, 0, 9], "radius_mm": 1, "material": "another" }
        ],
        "lights": [{ "kind": "environment", "radiance": [0.5, 1, 2] }]
    })
}

fn desk(job: &str) -> Desk {
    Desk::with("scene.json", scene().to_string()).and("job.toml", job)
}

fn sheet(desk: &Desk, name: &str) -> ContactSheet {
    let job = Job::read(&desk.path(name)).unwrap();
    let sweep = job::sweep(&job, &BTreeMap::new()).unwrap();
    contact_sheet(&job, &sweep, &CONTROL).unwrap().unwrap()
}

/// The scene on its own, with these parameters typed into it.
fn rendered(scene: &Value, material: Value) -> Picture {
    let mut scene = scene.clone();
    scene["materials"]["ball"] = material;
    let file: SceneFile = serde_json::from_value(scene).unwrap();
    let checked = CheckedScene::new(&file, Path::new("scene.json")).unwrap();
    render(&checked.scene, checked.resolution, checked.settings, &CONTROL).unwrap()
}

/// Under radiance L from everywhere a convex diffuse ball shows ρL everywhere.
#[test]
fn a_diffuse_ball_under_a_clouded_sky_shows_its_albedo() {
    let sheet = sheet(&desk(GREY), "job.toml");
    assert_eq!(sheet.pictures.len(), 2);
    for (picture, albedo) in sheet.pictures.iter().zip([0.25, 0.75]) {
        // The left third, which the other ball neither covers nor shades much.
        let left = (0..16).flat_map(|y| &picture.pixels[24 * y..24 * y + 6]);
        for (channel, radiance) in [0.5, 1.0, 2.0].into_iter().enumerate() {
            let mean = left.clone().map(|pixel| f64::from(pixel[channel])).sum::<f64>() / 96.0;
            // 6144 samples of a value that hardly varies, and a small ball that darkens by less than 1 %.
            assert!((mean / (albedo * radiance) - 1.0).abs() < 0.01, "{mean} for albedo {albedo} under {radiance}");
        }
    }
}

/// A cell is the scene with the cell's values typed into it, bit for bit, whatever channels they are of.
#[test]
fn a_cell_is_the_scene_with_its_values() {
    let of_plastic = "kind = \"iridescent-plastic\"\nper_channel = [\"eta\"]\n\n[parameters]\nroughness = 0.3\n\
                      diffuse = { start = 0.4, lower = 0, upper = 1 }\neta_b = \"1 * eta_g\"";
    let job = replaced(GREY, "kind = \"lambertian\"", of_plastic);
    let grid =
        "thickness_nm = { values = [100, 300] }\neta_r = { values = [1.5, 1.8], along = { eta_g = [1.6, 1.7] } }";
    let job = replaced(&job, "albedo = { values = [0.25, 0.75] }", grid);
    let sheet = sheet(&desk(&job), "job.toml");
    assert_eq!(sheet.pictures.len(), 4);
    let mut cells = sheet.pictures.iter();
    for (red, green) in [(1.5, 1.6), (1.8, 1.7)] {
        for thickness in [100, 300] {
            let material = json!({
                "model": { "kind": "iridescent-plastic", "per_channel": ["eta"] },
                "parameters": {
                    "roughness": 0.3, "diffuse": 0.4, "thickness_nm": thickness,
                    "eta_r": red, "eta_g": green, "eta_b": green
                }
            });
            assert!(rendered(&scene(), material) == *cells.next().unwrap(), "η {red}, d = {thickness} nm");
        }
    }
}

/// Three wavelengths of the job are those of the picture; a spectrum leaves the scene's.
#[test]
fn pictures_are_made_at_the_wavelengths_of_the_job() {
    let film = "kind = \"coated-base\"\nlayers = [{ name = \"film\", material = \"keratin\", thickness_nm = 300 }]\n\
                substrate = \"bird_melanin\"";
    let job = replaced(GREY, "kind = \"lambertian\"", film);
    let job = replaced(&job, "albedo = { values = [0.25, 0.75] }", "\"film.thickness_nm\" = { values = [300] }");
    let spectral = replaced(&job, "wavelengths_nm = [445, 525, 645]", "window_nm = [400, 700]\nstep_nm = 10");
    let job = replaced(&job, "445, 525, 645", "400, 520, 680");
    let desk = desk(&job).and("spectral.toml", spectral);
    for (name, nm) in [("job.toml", [680.0, 520.0, 400.0]), ("spectral.toml", [645.0, 525.0, 445.0])] {
        let sheet = sheet(&desk, name);
        assert!(sheet.wavelengths_nm.iter().eq(&nm), "{:?}", sheet.wavelengths_nm);
        let mut scene = scene();
        scene["wavelengths_nm"] = json!(nm);
        let material = json!({
            "model": {
                "kind": "coated-base", "substrate": "bird_melanin",
                "layers": [{ "name": "film", "material": "keratin", "thickness_nm": 300 }]
            }
        });
        assert!(rendered(&scene, material) == sheet.pictures[0], "{name}");
    }
}

/// The sheet lies in the report and on its page, the same on one thread and on two, and pictures stand where labels say.
#[test]
fn the_sheet_is_in_the_report() {
    let desk = desk(GREY);
    for (threads, out) in [(1, "one"), (2, "two")] {
        desk.barbule(&format!("sweep job.toml --threads {threads} --out {out}")).succeeds();
    }
    let bytes = fs::read(desk.path("one/contact-sheet.png")).unwrap();
    assert!(bytes == fs::read(desk.path("two/contact-sheet.png")).unwrap(), "the sheets differ");
    let page = desk.read("one/index.html");
    assert!(page.contains("data:image/png;base64,") && page.contains("A ball under a clouded sky, one picture a cell"));
    let painted = image::load_from_memory(&bytes).unwrap().to_rgb8();
    // sRGB codes of 0.75 · (0.5, 1, 2), the last cut off at white, and of 0.25 of it: 0.1250 → 99, 0.25 → 137, 0.5 → 188.
    let count = |code: [i16; 3]| {
        let near = |pixel: &&image::Rgb<u8>| (0..3).all(|k| (i16::from(pixel.0[k]) - code[k]).abs() <= 4);
        painted.pixels().filter(near).count()
    };
    // Of 384 pixels a cell the small ball covers some 14 %.
    for code in [[99, 137, 188], [165, 225, 255]] {
        assert!((250..384).contains(&count(code)), "{} pixels of {code:?}", count(code));
    }
}

#[test]
fn the_sphere_of_a_job_that_names_no_scene() {
    let job = replaced(GREY, "[0.25, 0.75]", "[0.5]");
    let job = replaced(&job, "scene = \"scene.json\"\nmaterial = \"ball\"\n", "");
    let sheet = sheet(&Desk::with("job.toml", job), "job.toml");
    assert_eq!(sheet.scene, "A sphere between a window and a lamp");
    let [picture] = sheet.pictures.as_slice() else { panic!("one cell") };
    // Behind it the sky; its left shoulder faces the window.
    assert!(picture.pixels[0].iter().all(|channel| (channel - 0.2).abs() < 1e-6), "{:?}", picture.pixels[0]);
    let at = |x: usize, y: usize| picture.pixels[picture.width as usize * y + x][1];
    assert!(at(60, 60) > 1.2 * at(80, 130), "{} against {}", at(60, 60), at(80, 130));
}

/// The scenes of the shipped sweeps are there, have the material, and show the job's model: here 12 × 9 pixels of each.
#[test]
fn every_shipped_sweep_finds_its_scene() {
    let mut found = 0;
    for folder in fs::read_dir(shipped("")).unwrap() {
        let folder = folder.unwrap().path();
        if !folder.join("job.toml").is_file() {
            continue;
        }
        let job = Job::read(&folder).unwrap();
        let Some(design) = job.file.sweep.and_then(|sweep| sweep.render) else { continue };
        let (Some(scene), Some(material)) = (design.scene, design.material) else { continue };
        let (mut file, path) = SceneFile::read(&folder.join(scene)).unwrap();
        (file.image.width, file.image.height, file.image.samples) = (12, 9, 1);
        let model = MaterialFile { model: job.file.model, parameters: BTreeMap::new(), texture: None };
        assert!(file.materials.insert(material, model).is_some(), "{}", folder.display());
        let checked = CheckedScene::new(&file, &path).unwrap_or_else(|error| panic!("{error}"));
        let picture = render(&checked.scene, checked.resolution, checked.settings, &CONTROL).unwrap();
        assert!(picture.pixels.iter().flatten().all(|channel| *channel >= 0.0));
        Desk::empty().barbule(&format!("check {}", folder.display())).succeeds().prints("a picture of each cell");
        found += 1;
    }
    assert!(found >= 10, "only {found} sweeps name a scene");
}

#[test]
fn a_mistake_in_the_pictures_is_a_sentence() {
    let section = "scene = \"scene.json\"\nmaterial = \"ball\"\n";
    for (piece, slip, parts) in [
        ("\"ball\"", "\"bal\"", &["line 16: sweep.render.material", "found \"bal\"", "did you mean `ball`"][..]),
        ("\nmaterial = \"ball\"", "", &["sweep.render.material", "none is named", "one of another, ball"]),
        ("scene = \"scene.json\"\n", "", &["sweep.render.material", "built-in sphere has one material"]),
        ("scene.json", "no-scene.json", &["no-scene.json", "there is no such file"]),
        (section, "scenes = 3", &["line 15", "scenes", "did you mean `scene`"]),
        (
            "values = [0.25, 0.75]",
            "from = 0, to = 1, steps = 50000",
            &["line 14: sweep.render", "50000 pictures of 24 × 16", "fewer steps"],
        ),
    ] {
        desk(&replaced(GREY, piece, slip)).barbule("sweep job.toml").complains(parts);
    }
    let each = replaced(GREY, "kind = \"lambertian\"", "kind = \"lambertian\"\nper_channel = [\"albedo\"]");
    let each = replaced(&each, "wavelengths_nm = [445, 525, 645]", "window_nm = [400, 700]\nstep_nm = 100");
    let each = replaced(&each, "albedo = {", "albedo_1 = {");
    desk(&each).barbule("sweep job.toml").complains(&["sweep.render", "albedo_r", "take it from `per_channel`"]);
}
