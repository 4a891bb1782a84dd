//! Scenes as files: what is said to a slip, what is written, and that neither threads nor kills change a byte.

use std::fs;

use serde_json::{Value, json};

use super::super::desk::{Desk, shipped};

/// A scene that is rendered in a moment.
fn scene() -> Value {
    json!({
        "title": "Test",
        "image": { "width": 70, "height": 40, "samples": 4, "seed": 3 },
        "camera": {
            "kind": "perspective", "position_mm": [0, -60, 30], "target_mm": [0, 0, 9], "field_of_view_deg": 30
        },
        "materials": {
            "ball": { "model": { "kind": "rough-plastic" }, "parameters": { "roughness": 0.15 } },
            "table": { "model": { "kind": "lambertian" }, "parameters": { "albedo": 0.4 } }
        },
        "objects": [
            { "kind": "sphere", "centre_mm": [0, 0, 10], "radius_mm": 10, "material": "ball" },
            {
                "kind": "rectangle", "corner_mm": [-80, -80, 0], "edge_u_mm": [160, 0, 0], "edge_v_mm": [0, 160, 0],
                "material": "table"
            }
        ],
        "lights": [
            {
                "kind": "rectangle", "corner_mm": [-40, -30, 50], "edge_u_mm": [0, 25, 0], "edge_v_mm": [25, 0, 0],
                "radiance": [12, 12, 12]
            },
            { "kind": "environment", "radiance": [0.3, 0.3, 0.3] }
        ]
    })
}

/// The scene with one of its values replaced, or taken out if the new one is null.
fn scene_with(pointer: &str, value: Value) -> Value {
    let mut scene = scene();
    let (parent, key) = pointer.rsplit_once('/').unwrap();
    let parent = scene.pointer_mut(parent).unwrap();
    match (parent, value) {
        (Value::Object(table), Value::Null) => drop(table.remove(key).unwrap()),
        (Value::Object(table), value) => drop(table.insert(key.to_owned(), value)),
        (Value::Array(list), value) => {
            let place: usize = key.parse().unwrap();
            if place == list.len() { list.push(value) } else { list[place] = value }
        }
        _ => panic!("{pointer} leads nowhere"),
    }
    scene
}

fn desk_with(scene: &Value) -> Desk {
    Desk::with("scene.json", scene.to_string())
}

/// Renders a scene with one value replaced and expects a sentence with these parts.
#[track_caller]
fn refused(pointer: &str, value: Value, parts: &[&str]) {
    let parts: Vec<&str> = ["scene.json: "].into_iter().chain(parts.iter().copied()).collect();
    desk_with(&scene_with(pointer, value)).barbule("render scene.json").complains(&parts);
}

#[test]
fn a_slip_in_a_scene_is_a_sentence() {
    for (pointer, value, parts) in [
        ("/image/width", json!(0), &["image.width: found 0", "1 to 32768 pixels"][..]),
        ("/image/width", json!(100_000), &["image.width: found 100000", "1 to 32768 pixels"]),
        ("/image/height", json!(-3), &["image.height: found -3", "a whole number"]),
        ("/image", json!({"width": 0, "height": 0}), &["image.width: found 0", "1 to 32768 pixels"]),
        ("/image", json!({"width": 100_000, "height": 100_000}), &["image.width: found 100000", "1 to 32768 pixels"]),
        ("/image", json!({"width": 30000, "height": 30000}), &["image: 30000 × 30000 are 900000000 pixels"]),
        ("/image/samples", json!(0), &["image.samples: found 0", "1 to 65536"]),
        ("/image/tone", json!({"exposure_stops": 1e9}), &["image.tone.exposure_stops", "from -50 to 50"]),
        ("/scatterings", json!(0), &["scatterings: found 0", "1 (direct light only)"]),
        ("/colour", json!(1), &["there is no key `colour` here", "known are title"]),
        ("/camera/field_of_veiw_deg", json!(1), &["camera", "no key `field_of_veiw_deg`", "mean `field_of_view_deg`"]),
        ("/camera/field_of_view_deg", json!(180), &["camera.field_of_view_deg: found 180", "between 0° and 180°"]),
        ("/camera/up", json!([0, 60, -21]), &["camera: it looks nowhere"]),
        ("/camera/target_mm", json!([0, -60, 30]), &["camera: it looks nowhere"]),
        ("/camera/position_mm", json!([0, -2, 12]), &["objects[1]: the camera is inside it", "move"]),
        ("/camera/position_mm", json!([0, 0]), &["camera.position_mm", "a list of 2", "one of 3"]),
        ("/objects/0/radius_mm", json!(0), &["objects[1].radius_mm: found 0", "a length above 0"]),
        ("/objects/0/radius_mm", json!("ten"), &["objects[1].radius_mm", "the text \"ten\"", "a number"]),
        ("/objects/0/radius", json!(3), &["objects[1].radius: there is no key `radius`", "mean `radius_mm`"]),
        ("/objects/0/kind", json!("spere"), &["objects[1].kind: found `spere`", "mean `sphere`"]),
        ("/objects/0/material", json!("bal"), &["objects[1].material: there is no material \"bal\"", "mean `ball`"]),
        ("/objects/1/edge_v_mm", json!([160, 0, 0]), &["objects[2]: the edges", "are not perpendicular"]),
        ("/objects/1/edge_v_mm", json!([0, 0, 0]), &["objects[2]: it has no area"]),
        ("/lights/0/edge_u_mm", json!([0, 0, 0]), &["lights[1]: it has no area"]),
        (
            "/lights/0",
            json!({"kind": "sphere", "centre_mm": [0, 0, 50], "radius_mm": 0, "radiance": [1, 1, 1]}),
            &["lights[1].radius_mm: found 0", "a length above 0"],
        ),
        (
            "/lights/0",
            json!({"kind": "sphere", "centre_mm": [0, -60, 30], "radius_mm": 9, "radiance": [1, 1, 1]}),
            &["lights[1]: the camera is inside it"],
        ),
        ("/lights/0/radiance", json!([0, 0, 0]), &["lights[1].radiance", "lights nothing"]),
        ("/lights/0/radiance", json!([1, -1, 0]), &["lights[1].radiance: found -1", "from 0 up"]),
        ("/lights/0/colour", json!(3), &["lights[1].colour: there is no key `colour`", "radiance"]),
        ("/lights/1/file", json!("no.exr"), &["lights[2].file", "no.exr: there is no such file"]),
        ("/lights/2", json!({"kind": "environment"}), &["lights[3]: this is a second environment"]),
        ("/lights", json!([]), &["lights: there is none"]),
        (
            "/materials/ball/model/kind",
            json!("plastic"),
            &["materials.ball.model.kind: found `plastic`", "rough-plastic"],
        ),
        ("/materials/ball/model/rougness", json!(1), &["materials.ball.model.rougness: there is no key `rougness`"]),
        ("/materials/ball/parameters/roughnes", json!(0.1), &["ball.parameters.roughnes", "mean `roughness`"]),
        ("/materials/ball/parameters/roughness", json!(7), &["materials.ball.parameters", "`roughness` is 7"]),
        ("/materials/ball/model/kind", json!("thin-film-law"), &["materials.ball.model", "peak wavelengths"]),
        ("/wavelengths_nm", json!([445, 525, 645]), &["wavelengths_nm: found [445, 525, 645]", "the longest first"]),
        ("/wavelengths_nm", json!([645, 525, -1]), &["materials.ball.model", "a wavelength is -1"]),
    ] {
        refused(pointer, value, parts);
    }
}

#[test]
fn numbers_that_are_none_are_refused_where_they_stand() {
    let text = scene().to_string().replace("[0.3,0.3,0.3]", "[NaN, 0.3, 0.3]");
    Desk::with("scene.json", text).barbule("render scene.json").complains(&["scene.json: this is no JSON", "line 1"]);
    let text = scene().to_string().replace("[0.3,0.3,0.3]", "[1e999, 0.3, 0.3]");
    Desk::with("scene.json", text).barbule("render scene.json").complains(&["scene.json: this is no JSON", "line 1"]);
    refused("/objects/0/centre_mm", json!([1e300, 0, 0]), &["objects[1].centre_mm", "up to ±1000000000000"]);
}

#[test]
fn a_scene_that_is_not_there() {
    let desk = Desk::with("text.json", "{").and("bytes.json", b"\xff\xfe");
    fs::create_dir(desk.path("folder")).unwrap();
    desk.barbule("render nosuch.json").complains(&["nosuch.json: there is no such file", "scene.json in it"]);
    desk.barbule("render folder").complains(&["folder/scene.json: there is no such file"]);
    desk.barbule("render text.json").complains(&["text.json: this is no JSON", "line 1"]);
    desk.barbule("render bytes.json").complains(&["bytes.json: it is not UTF-8"]);
}

const CUBE: &str = "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n\
                    f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

/// The scene with a mesh from this text.
fn desk_with_mesh(obj: &str, changes: &[(&str, Value)]) -> Desk {
    let mut mesh = json!({ "kind": "mesh", "file": "thing.obj", "unit_mm": 5, "material": "ball" });
    for (key, value) in changes {
        mesh[key] = value.clone();
    }
    desk_with(&scene_with("/objects/2", mesh)).and("thing.obj", obj)
}

#[test]
fn a_mesh_that_is_none_is_refused() {
    for (obj, parts) in [
        (
            "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n",
            &["triangle 1 has no area", "(0, 0, 0), (5, 0, 0) and (10, 0, 0) mm"][..],
        ),
        ("v 0 0 0\n", &["there are no faces in it"]),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", &["thing.obj", "expected a Wavefront OBJ file"]),
        ("v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", &["a vertex is no finite number"]),
        ("\u{0}\u{1}\u{2}", &["thing.obj", "expected a Wavefront OBJ file"]),
    ] {
        let parts: Vec<&str> = ["objects[3].file: thing.obj: "].into_iter().chain(parts.iter().copied()).collect();
        desk_with_mesh(obj, &[]).barbule("render scene.json").complains(&parts);
    }
    desk_with_mesh(CUBE, &[("position_mm", json!([0, -60, 30]))])
        .barbule("render scene.json")
        .complains(&["objects[3]: the camera is inside it"]);
    desk_with_mesh(CUBE, &[("file", json!("other.obj"))])
        .barbule("render scene.json")
        .complains(&["objects[3].file", "other.obj: there is no such file"]);
    // An open mesh has no inside.
    let lidless = CUBE.replace("f 5 6 7 8\n", "");
    desk_with_mesh(&lidless, &[("position_mm", json!([0, -60, 30]))]).barbule("render scene.json").succeeds();
}

#[test]
fn a_texture_that_cannot_be_laid_is_refused() {
    let texture = |parameter: &str, file: &str| json!({ "parameter": parameter, "file": file });
    for (name, parts) in [
        ("roughness", &["materials.ball.texture.parameter: `roughness`", "cannot be textured", "`diffuse`"][..]),
        ("diffus", &["materials.ball.texture.parameter: `diffus`", "`diffuse`"]),
    ] {
        let desk = desk_with(&scene_with("/materials/ball/texture", texture(name, "spot.png")));
        fs::write(desk.path("spot.png"), spot()).unwrap();
        let parts: Vec<&str> = ["scene.json: "].into_iter().chain(parts.iter().copied()).collect();
        desk.barbule("render scene.json").complains(&parts);
    }
    refused(
        "/materials/ball/texture",
        texture("diffuse", "no.png"),
        &["ball.texture.file: no.png: there is no such file"],
    );
    let desk = desk_with(&scene_with("/materials/ball/texture", texture("diffuse", "spot.png")));
    fs::write(desk.path("spot.png"), &spot()[..40]).unwrap();
    desk.barbule("render scene.json").complains(&["materials.ball.texture.file: spot.png", "expected a whole PNG"]);
    // What colours act at every bounce is no linear function of them.
    let mut scene = scene_with("/materials/ball/texture", texture("diffuse", "spot.png"));
    scene["materials"]["ball"]["model"]["internal_reflection"] = json!("nonlinear");
    let desk = desk_with(&scene);
    fs::write(desk.path("spot.png"), spot()).unwrap();
    desk.barbule("render scene.json").complains(&["`diffuse` does not act linearly"]);
}

/// A PNG of 2 × 2 pixels.
fn spot() -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let pixels = [255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255];
    image::RgbImage::from_raw(2, 2, pixels.to_vec()).unwrap().write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}

#[test]
fn a_picture_does_not_hang_on_threads() {
    let mut scene = scene_with("/materials/table/texture", json!({ "parameter": "albedo", "file": "spot.png" }));
    scene["materials"]["table"]["parameters"] = json!({});
    let desk = desk_with(&scene);
    fs::write(desk.path("spot.png"), spot()).unwrap();
    for threads in [1, 3] {
        desk.barbule(&format!("render scene.json --threads {threads} --out out-{threads}"))
            .succeeds()
            .prints("render.png");
    }
    for name in ["render.png", "render.exr"] {
        let [one, three] = [1, 3].map(|threads| fs::read(desk.path(&format!("out-{threads}/{name}"))).unwrap());
        assert!(one == three, "{name} differs");
    }
    desk.barbule("render scene.json --seed 4 --out other").succeeds();
    let [one, other] = ["out-1", "other"].map(|folder| fs::read(desk.path(&format!("{folder}/render.exr"))).unwrap());
    assert!(one != other, "another seed gives another picture");
}

/// What a kill leaves is picked up, to the same bytes: files cut anywhere stand for kills at any moment.
#[test]
fn a_killed_render_goes_on_to_the_same_bytes() {
    let desk = desk_with(&scene());
    desk.barbule("render scene.json --out whole").succeeds();
    let whole = fs::read(desk.path("whole/render.exr")).unwrap();
    let checked = {
        let (file, path) = barbule::scene::SceneFile::read(&desk.path("scene.json")).unwrap();
        barbule::scene::CheckedScene::new(&file, &path).unwrap()
    };
    // A render that stops after two of its nine tiles.
    let tiles = desk.path("half/render.tiles");
    let stop = std::sync::atomic::AtomicBool::new(false);
    let checkpoint = barbule::render::Checkpoint::new(&desk.path("half"), checked.fingerprint.clone());
    let control = barbule::render::Control {
        interrupt: &stop,
        progress: &|done, _| stop.store(done >= 2, std::sync::atomic::Ordering::Relaxed),
        checkpoint: Some(&checkpoint),
    };
    let stopped = barbule::render::render(&checked.scene, checked.resolution, checked.settings, &control);
    let sentence = stopped.unwrap_err().to_string();
    assert!(sentence.contains("of 9 tiles done"), "{sentence}");
    let kept = fs::read(&tiles).unwrap();
    for length in [0, 10, 70, kept.len() / 2, kept.len() - 5, kept.len()] {
        fs::create_dir_all(desk.path("half")).unwrap();
        fs::write(&tiles, &kept[..length]).unwrap();
        desk.barbule("render scene.json --out again --checkpoint half").succeeds();
        assert!(fs::read(desk.path("again/render.exr")).unwrap() == whole, "cut at {length} of {}", kept.len());
        assert!(!tiles.exists(), "a finished render leaves no checkpoint");
    }
    // Another picture does not take these tiles.
    fs::create_dir_all(desk.path("half")).unwrap();
    fs::write(&tiles, &kept).unwrap();
    desk.barbule("render scene.json --samples 8 --checkpoint half")
        .complains(&["half/render.tiles", "another picture"]);
}

/// How it is shown changes the PNG, by sRGB's own function, and not the EXR.
#[test]
fn exposure_changes_the_png_alone() {
    let desk = desk_with(&scene()).and(
        "brighter.json",
        scene_with("/image/tone", json!({ "exposure_stops": 1, "curve": "reinhard" })).to_string(),
    );
    desk.barbule("render scene.json --out plain").succeeds();
    desk.barbule("render brighter.json --out brighter").succeeds();
    let [plain, brighter] =
        ["plain", "brighter"].map(|folder| fs::read(desk.path(&format!("{folder}/render.exr"))).unwrap());
    assert!(plain == brighter, "the EXR holds radiance");
    let linear = image::open(desk.path("plain/render.exr")).unwrap().to_rgb32f();
    let shown = image::open(desk.path("plain/render.png")).unwrap().to_rgb8();
    let pressed = image::open(desk.path("brighter/render.png")).unwrap().to_rgb8();
    for ((linear, shown), pressed) in linear.pixels().zip(shown.pixels()).zip(pressed.pixels()) {
        let luminance = |rgb: [f64; 3]| 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
        let twice = linear.0.map(|channel| 2.0 * f64::from(channel));
        let bright = luminance(twice);
        for k in 0..3 {
            let code = |light: f64| barbule::measure::colour::encode(light.clamp(0.0, 1.0)) * 255.0;
            let curve = twice[k] * (1.0 + bright / 16.0) / (1.0 + bright);
            for (found, expected) in [(shown[k], code(linear[k].into())), (pressed[k], code(curve))] {
                // Half a step, and a rounding.
                assert!((f64::from(found) - expected).abs() < 0.5001, "byte {found} for {expected}");
            }
        }
    }
}

#[test]
fn shipped_scenes_are_sound() {
    let mut scenes = 0;
    for folder in fs::read_dir(shipped("")).unwrap() {
        let path = folder.unwrap().path().join("scene.json");
        if path.exists() {
            let (file, path) = barbule::scene::SceneFile::read(&path).unwrap();
            barbule::scene::CheckedScene::new(&file, &path).unwrap();
            scenes += 1;
        }
    }
    assert!(scenes > 0);
}

/// A scene with the tail feather lying on the table, with one of its keys changed.
fn feather_with(changes: &[(&str, Value)]) -> Value {
    let mut feather = json!({
        "kind": "feather", "file": "tail.json", "pixels_per_mm": 2, "corner_mm": [-20, -40, 25],
        "right": [1, 0, 0], "up": [0, 1, 0], "shaft": "table", "vane": "ball"
    });
    for (key, value) in changes {
        feather[key] = value.clone();
    }
    scene_with("/objects/2", feather)
}

#[test]
fn a_feather_is_laid_as_its_files_say() {
    let tail = fs::read_to_string(format!("{}/feather.json", shipped("feather-tail"))).unwrap();
    let desk = |changes: &[(&str, Value)]| {
        let desk = desk_with(&feather_with(changes)).and("tail.json", &tail);
        fs::write(desk.path("spot.png"), spot()).unwrap();
        desk
    };
    let pattern = |materials: Value| ("pattern", json!({ "file": "spot.png", "materials": materials }));
    for (changes, parts) in [
        (&[("file", json!("no.json"))][..], &["objects[3].file: no.json: there is no such file"][..]),
        (&[("file", json!("spot.png")), ("pixels_per_mm", Value::Null)], &["objects[3].file", "spot.png"]),
        (&[("file", json!("spot.png"))], &["objects[3].file: a map has its resolution"]),
        (&[("pixels_per_mm", json!(-1))], &["objects[3].pixels_per_mm: found -1"]),
        (&[("pixels_per_mm", json!(1e6))], &["objects[3].file", "texels"]),
        (&[("up", json!([1, 1, 0]))], &["objects[3]: the edges", "not perpendicular"]),
        (&[("right", json!([0, 0, 0]))], &["objects[3].right: found [0, 0, 0]"]),
        (&[("vane", json!("bal"))], &["objects[3].vane: there is no material \"bal\"", "mean `ball`"]),
        (&[("vain", json!("ball"))], &["objects[3].vain: there is no key `vain`", "vane"]),
        (&[pattern(json!({}))], &["objects[3].pattern.materials: there is none"]),
        (&[pattern(json!({ "red": "ball" }))], &["objects[3].pattern.materials.\"red\": this is no colour"]),
        (&[pattern(json!({ "#ff0000": "no" }))], &["pattern.materials.\"#ff0000\": there is no material \"no\""]),
    ] {
        desk(changes).barbule("render scene.json").complains(parts);
    }
    desk(&[pattern(json!({ "#ff0000": "ball", "#0000ff": "table" }))])
        .barbule("render scene.json --threads 2")
        .succeeds();
}
