//! Painted vanes: what a pixel shows is the model with the values that the paint says, told by the model itself; and the tables
//! of many shades against fibres that are evaluated one by one.

use barbule::bsdf::cylinder::{CylinderDesign, CylinderModel};
use barbule::bsdf::spongy_barb::SpongyBarbModel;
use barbule::bsdf::{ChannelMix, Direction, Model};
use barbule::geometry::{FeatherFile, FeatherMap, Side, TexelClass, VanePlace};
use barbule::measure::colour::{Xyz, rgb_weights};
use barbule::pigment::PigmentDesign;
use barbule::scene::{CheckedScene, SceneFile};
use proptest::prelude::*;
use serde_json::{Value, json};

use super::super::desk::{Desk, shipped};
use super::super::directions::{RGB_NM, any_direction, evaluate, values};
use super::picture;

/// Wavelengths of a spectrum, 20 nm apart.
fn spectrum_nm() -> Vec<f64> {
    (0..=16).map(|k| 390.0 + 20.0 * f64::from(k)).collect()
}

/// A flat tail feather seen from above, texel for pixel, its vanes fibres across which light falls at 37°.
fn scene(changes: &[(&str, Value)], vane: &Value) -> Value {
    let map = tail().0;
    let [width_mm, height_mm] = map.size_mm();
    let mut feather = json!({
        "kind": "feather", "file": "tail.json", "pixels_per_mm": 2, "corner_mm": [-0.5 * width_mm, -0.5 * height_mm, 0],
        "right": [1, 0, 0], "up": [0, 1, 0], "shaft": "black", "vane": "vane"
    });
    for (key, value) in changes {
        feather[key] = value.clone();
    }
    json!({
        "title": "Test",
        "image": { "width": map.width(), "height": map.height(), "samples": 64 },
        "scatterings": 1,
        "camera": {
            "kind": "orthographic", "position_mm": [0, 0, 100], "target_mm": [0, 0, 0], "up": [0, 1, 0],
            "height_mm": height_mm
        },
        "materials": { "black": { "model": { "kind": "lambertian" }, "parameters": { "albedo": 0 } }, "vane": vane },
        "objects": [feather],
        "lights": [{ "kind": "directional", "towards_light": LIGHT, "irradiance": [1, 1, 1] }]
    })
}

const LIGHT: [f64; 3] = [0.36, 0.48, 0.8];

fn tail() -> (FeatherMap, Vec<Option<VanePlace>>) {
    let text = std::fs::read_to_string(format!("{}/feather.json", shipped("feather-tail"))).unwrap();
    let file: FeatherFile = serde_json::from_str(&text).unwrap();
    FeatherMap::with_places(&barbule::geometry::Feather::new(&file).unwrap(), Some(2.0)).unwrap()
}

/// The pixels of a scene on a desk with the tail feather on it.
fn pixels(scene: &Value) -> Vec<[f32; 3]> {
    let text = std::fs::read_to_string(format!("{}/feather.json", shipped("feather-tail"))).unwrap();
    let desk = Desk::with("scene.json", scene.to_string()).and("tail.json", &text);
    let (file, path) = SceneFile::read(desk.path("scene.json").as_ref()).unwrap();
    let checked = CheckedScene::new(&file, &path).unwrap();
    picture(&checked.scene, checked.resolution, checked.settings).pixels
}

/// What a fibre along a texel's tangent sends to the camera.
fn expected(model: &dyn Model, values: &[f64], tangent: [f64; 2]) -> Vec<f64> {
    let ([x, y], light) = (tangent, Direction::from(LIGHT));
    let local = Direction::new(light.x * x + light.y * y, light.y * x - light.x * y, light.z);
    evaluate(model, values, &local, &Direction::z()).into_iter().map(|value| value * light.z).collect()
}

/// The amount of a pigment grows from barb to barb's end: every pixel is the fibre with its own amount.
#[test]
fn an_amount_that_changes_gradually_is_what_each_pixel_shows() {
    let design =
        CylinderDesign { pigments: vec![PigmentDesign::Eumelanin { name: None }], ..CylinderDesign::default() };
    let vane = json!({
        "model": { "kind": "cylinder", "pigments": [{ "kind": "eumelanin" }] },
        "parameters": { "eumelanin.amount": 0.05 }
    });
    let paint = json!([{ "set": { "eumelanin.amount": 3 }, "where": { "across": { "from": 0.5, "soft": 0.8 } } }]);
    let seen = pixels(&scene(&[("paint", paint)], &vane));
    let model = CylinderModel::new(&design, &RGB_NM).unwrap();
    let (map, places) = tail();
    let (mut checked, mut sum, mut worst) = (0, 0.0, 0.0f64);
    let mut brightest = 0.0f64;
    for ((pixel, place), (_, _, texel)) in seen.iter().zip(&places).zip(map.texels()) {
        let Some(place) = place else { continue };
        if texel.class != TexelClass::Barb || texel.coverage < 1.0 {
            continue;
        }
        // The layer's own rule: a cubic from 0 to 1 over `soft`.
        let x = ((f64::from(place.across) - 0.5) / 0.8 + 0.5).clamp(0.0, 1.0);
        let amount = 0.05 + (3.0 - 0.05) * x * x * (3.0 - 2.0 * x);
        let expected = expected(&model, &values(&model, &[("eumelanin.amount", amount)]), texel.tangent);
        for (found, expected) in pixel.iter().zip(&expected) {
            brightest = brightest.max(*expected);
            let error = f64::from(*found) - expected;
            // Levels: 2 % of the value and of a fifth of the brightest one; a mixture's 64 draws add a few per cent to each pixel,
            // and nothing to their mean.
            worst = worst.max(error.abs() / (expected + 0.2 * brightest));
            sum += error / expected;
        }
        checked += 1;
    }
    let mean = sum / f64::from(3 * checked);
    assert!(checked > 3000, "{checked} texels");
    assert!(worst < 0.1, "a pixel misses its own amount by {worst}");
    assert!(mean.abs() < 0.02, "pixels miss their amounts by {mean} on average");
}

/// Hard masks: each vane has its own roughness, a parameter that no texture could vary, without any error of levels.
#[test]
fn each_vane_has_the_values_that_are_painted_on_it() {
    let vane = json!({ "model": { "kind": "cylinder" }, "parameters": { "beta_m": 0.25, "sigma_a": 0.3 } });
    let paint = json!([{ "set": { "beta_m": 0.5, "beta_n": 0.6 }, "where": { "vane": "right" } }]);
    let seen = pixels(&scene(&[("paint", paint)], &vane));
    let model = CylinderModel::new(&CylinderDesign::default(), &RGB_NM).unwrap();
    let (map, places) = tail();
    for ((pixel, place), (_, _, texel)) in seen.iter().zip(&places).zip(map.texels()) {
        let Some(place) = place else { continue };
        if texel.class != TexelClass::Barb || texel.coverage < 1.0 {
            continue;
        }
        let own: &[(&str, f64)] = match place.side {
            Side::Left => &[("beta_m", 0.25), ("sigma_a", 0.3)],
            Side::Right => &[("beta_m", 0.5), ("beta_n", 0.6), ("sigma_a", 0.3)],
        };
        let expected = expected(&model, &values(&model, own), texel.tangent)[0];
        // Tables of a picture, and 32 bits.
        assert!((f64::from(pixel[0]) - expected).abs() < 1e-3 * expected + 2e-4, "{pixel:?} against {expected}");
    }
}

/// Barbs told apart from barbules: the vane's mean is that of the averaged feather with the geometry's own share.
#[test]
fn resolved_barbs_are_averaged_to_the_feathers_share() {
    let (map, places) = tail();
    let inside = |k: usize| places[k].is_some_and(|place| (0.1..0.9).contains(&place.across));
    let ramus: Vec<f64> =
        (0..places.len()).filter(|k| inside(*k)).map(|k| f64::from(places[k].unwrap().ramus)).collect();
    let share = ramus.iter().sum::<f64>() / ramus.len() as f64;
    let vane = |share: f64| {
        json!({
            "model": { "kind": "feather" },
            "parameters": { "barb_share": share, "barb.sigma_a": 0.1, "barb.beta_m": 0.6, "barbule.sigma_a": 2 }
        })
    };
    let mean = |seen: &[[f32; 3]]| {
        let sum: f64 = (0..seen.len()).filter(|k| inside(*k)).map(|k| f64::from(seen[k][1])).sum();
        sum / ramus.len() as f64
    };
    let resolved = mean(&pixels(&scene(&[("barbs", json!("resolved"))], &vane(0.3))));
    let averaged = mean(&pixels(&scene(&[], &vane(share))));
    let barbules = mean(&pixels(&scene(&[], &vane(0.0))));
    assert_eq!(map.texels().count(), places.len());
    // Texels of much barb do not all run like those of little; what is left after that is noise of 1e-3.
    assert!((resolved - averaged).abs() < 0.01 * averaged, "{resolved} resolved, {averaged} averaged");
    assert!((averaged - barbules).abs() > 0.03 * averaged, "the share hardly counts: {averaged} and {barbules}");
}

/// A place along the rachis and across the vane, for the straight feather, from its own millimetres.
#[test]
fn places_are_those_of_the_feathers_own_coordinates() {
    let (map, places) = tail();
    let mut checked = 0;
    for ((column, row, _), place) in map.texels().zip(&places) {
        let Some(place) = place else { continue };
        // The shaft runs along y from 0 to 140 mm, the rachis from 22 mm; the map's middle is the feather's.
        let y = (f64::from(map.height()) - f64::from(row) - 0.5) / map.pixels_per_mm();
        let x = (f64::from(column) + 0.5 - 0.5 * f64::from(map.width())) / map.pixels_per_mm();
        let along = (y + bottom_mm(&map) - 22.0) / 118.0;
        assert!((f64::from(place.along) - along).abs() < 2e-3, "{place:?} at {along}");
        assert!(x.abs() < 0.5 || (x < 0.0) == (place.side == Side::Left), "{place:?} at {x}");
        assert!(place.root <= place.along + 1e-3 && (0.0..=1.0).contains(&place.across));
        checked += 1;
    }
    assert!(checked > 3000);
}

/// Lower edge of the map of the tail feather: its middle is that of the feather, which reaches from the shaft's end at 0 mm to its
/// tip at 140 mm, half of the shaft's width beyond both.
fn bottom_mm(map: &FeatherMap) -> f64 {
    let (low, high) = (-1.3, 140.1);
    0.5 * (low + high) - 0.5 * map.size_mm()[1]
}

proptest! {
    // Each case makes a table of shades, some tenths of a second.
    #![proptest_config(ProptestConfig::with_cases(6))]

    /// Several shades in a picture's channels are the fibres themselves, mixed. At each wavelength a shade is right to 2e-3 of a
    /// clear fibre's largest value, and of what a clear sponge adds, which may be far more: half for its table, half for σₐ between
    /// the knots. A channel of the picture adds these with the sizes of its weights, some of which are negative.
    #[test]
    fn shades_are_the_fibres_themselves(
        amounts in proptest::collection::vec(0.0..12.0f64, 2..5),
        beta_n in 0.25..0.7f64,
        strength in 0.0..1.0f64,
        pairs in proptest::collection::vec((any_direction(), any_direction()), 60),
    ) {
        let design = CylinderDesign {
            pigments: vec![PigmentDesign::Eumelanin { name: None }],
            ..CylinderDesign::default()
        };
        let wavelengths_nm = spectrum_nm();
        let mix = ChannelMix::new(rgb_weights(&wavelengths_nm).unwrap());
        let sponge = SpongyBarbModel::new(&design, &wavelengths_nm).unwrap();
        let cylinder = CylinderModel::new(&design, &wavelengths_nm).unwrap();
        let with = |model: &dyn Model, amount: f64, own: &[(&str, f64)]| {
            let all = [&[("eumelanin.amount", amount), ("beta_n", beta_n)], own].concat();
            values(model, &all)
        };
        for (model, own) in [(&cylinder as &dyn Model, &[][..]), (&sponge, &[("strength", strength)][..])] {
            let shades: Vec<Vec<f64>> = amounts.iter().map(|amount| with(model, *amount, own)).collect();
            let tables = model.bind_for_picture(&shades, Some(&mix));
            let without_pigment = with(model, 0.0, own);
            let clear = model.bind(&without_pigment);
            for (table, shade) in tables.iter().zip(&shades) {
                let exact = model.bind(shade);
                for (incoming, outgoing) in &pairs {
                    // At the rim of the surface f has no bound; S = f |cosθ| does.
                    let cosine = incoming.z.abs();
                    let mut found = [0.0; 3];
                    table.evaluate(incoming, outgoing, &mut found);
                    let mut spectrum = vec![0.0; wavelengths_nm.len()];
                    exact.evaluate(incoming, outgoing, &mut spectrum);
                    let mut bright = vec![0.0; wavelengths_nm.len()];
                    clear.evaluate(incoming, outgoing, &mut bright);
                    let scale = largest_of_clear(&cylinder, &with(&cylinder, 0.0, &[]), incoming, outgoing);
                    for (found, weights) in found.iter().zip(mix.weights()) {
                        let exact: f64 = weights.iter().zip(&spectrum).map(|(w, v)| w * v).sum();
                        let error = (found - exact).abs() * cosine;
                        let sizes: f64 =
                            weights.iter().zip(&bright).map(|(w, v)| w.abs() * (scale + v * cosine)).sum();
                        prop_assert!(error < 2e-3 * sizes, "{found} against {exact}, times {cosine}; allowed of {sizes}");
                    }
                }
            }
        }
    }
}

/// Largest S of the clear fibre over azimuths, at these inclinations.
fn largest_of_clear(model: &CylinderModel, clear: &[f64], incoming: &Direction, outgoing: &Direction) -> f64 {
    let bound = model.bind(clear);
    let across = |direction: &Direction| direction.y.hypot(direction.z);
    let of_turn = |step: u32| {
        let turn = f64::from(step) * std::f64::consts::PI / 36.0 + 0.01;
        let incoming = Direction::new(incoming.x, across(incoming) * turn.sin(), across(incoming) * turn.cos());
        let viewer = Direction::new(outgoing.x, 0.0, across(outgoing));
        let mut values = vec![0.0; model.channel_count()];
        bound.evaluate(&incoming, &viewer, &mut values);
        values[0] * incoming.z.abs()
    };
    (0..72).map(of_turn).fold(0.0, f64::max)
}

proptest! {
    /// The weights of a picture sum to the colour that the reflectance has; white is exactly white.
    #[test]
    fn weights_give_a_spectrum_its_colour(reflectances in proptest::collection::vec(0.0..1.0f64, 17)) {
        let weights = rgb_weights(&spectrum_nm()).unwrap();
        let direct = Xyz::of_reflectance(&spectrum_nm(), &reflectances).unwrap().to_linear_rgb().0;
        for (weights, direct) in weights.iter().zip(direct) {
            let sum: f64 = weights.iter().zip(&reflectances).map(|(w, r)| w * r).sum();
            // D65 as a table of 5 nm and the white of Rec. 709 differ by 3e-4.
            prop_assert!((sum - direct).abs() < 5e-4, "{sum} against {direct}");
            prop_assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        }
    }
}

#[test]
fn a_slip_in_paint_is_a_sentence() {
    let tail = std::fs::read_to_string(format!("{}/feather.json", shipped("feather-tail"))).unwrap();
    let vane = json!({ "model": { "kind": "feather" } });
    let paint = |layer: Value| vec![("paint", json!([layer]))];
    for (changes, parts) in [
        (paint(json!({ "set": {} })), &["objects[1].paint[1].set: it sets nothing"][..]),
        (
            paint(json!({ "set": { "barb.sigma": 1 } })),
            &["paint[1].set.barb.sigma: the vane's model has no such", "mean"],
        ),
        (paint(json!({ "set": { "barb.sigma_a": -1 } })), &["objects[1].paint[1].set", "sigma_a", "-1"]),
        (
            paint(json!({ "set": { "barb.sigma_a": 1 }, "where": { "across": { "soft": -1 } } })),
            &["paint[1].where.across.soft: found -1; expected a number from 0 to 2"],
        ),
        (
            paint(json!({ "set": { "barb.sigma_a": 1 }, "where": { "bars": { "period": 0, "width": 0 } } })),
            &["paint[1].where.bars.period: found 0"],
        ),
        (
            paint(json!({ "set": { "barb.sigma_a": 1 }, "where": { "picture": "no.png" } })),
            &["paint[1].where.picture: no.png: there is no such file"],
        ),
        (paint(json!({ "put": {} })), &["objects[1].paint[1].put: there is no key `put`"]),
        (vec![("vane", json!("black")), ("barbs", json!("resolved"))], &["objects[1].barbs", "`feather` alone"]),
    ] {
        let desk = Desk::with("scene.json", scene(&changes, &vane).to_string()).and("tail.json", &tail);
        desk.barbule("render scene.json").complains(parts);
    }
    let mut few = scene(&[], &vane);
    for (wavelengths, parts) in [
        (json!([500, 600]), &["wavelengths_nm: found 2 wavelengths; expected three"][..]),
        (json!([500, 600, 550, 700]), &["wavelengths_nm: found 600 before 550; expected wavelengths that rise"]),
    ] {
        few["wavelengths_nm"] = wavelengths;
        let desk = Desk::with("scene.json", few.to_string()).and("tail.json", &tail);
        desk.barbule("render scene.json").complains(parts);
    }
}
