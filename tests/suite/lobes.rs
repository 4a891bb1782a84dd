//! Lobes that a person looks at: the numbers behind them against closed forms, the files, and slips on the command line.

use std::f64::consts::{FRAC_1_PI, PI};

use barbule::job::{Lobes, model_lobes};

use super::desk::{Desk, FILM};

fn lobes_of(kind: &str, set: &[(String, Vec<f64>)], lights_deg: &[f64]) -> Vec<(String, Lobes)> {
    model_lobes(Some(kind), set, lights_deg).unwrap().remove(0).settings
}

fn set(name: &str, values: &[f64]) -> Vec<(String, Vec<f64>)> {
    vec![(name.to_owned(), values.to_vec())]
}

/// f = ρ/π from everywhere, in the plane and over the hemisphere; five digits are kept.
#[test]
fn a_lambertian_surface_is_a_half_circle() {
    let settings = lobes_of("lambertian", &set("albedo", &[0.25, 0.5]), &[0.0, 60.0]);
    for ((words, lobes), albedo) in settings.iter().zip([0.25, 0.5]) {
        assert_eq!(words, &format!("albedo = {albedo}"));
        assert_eq!((lobes.angles_deg.len(), lobes.angles_deg[0], lobes.lights.len()), (180, -89.5, 2), "nothing below");
        let values = lobes.lights.iter().flat_map(|light| light.in_plane.iter().chain(&light.hemisphere)).flatten();
        for value in values {
            assert!((value / (albedo * FRAC_1_PI) - 1.0).abs() < 1e-4, "{value}");
        }
    }
}

/// The gloss of a plastic is brightest beyond the mirror direction, never on the light's side; more roughness lowers it.
#[test]
fn a_gloss_points_to_the_mirror_side() {
    let settings = lobes_of("rough-plastic", &set("roughness", &[0.1, 0.3]), &[45.0]);
    let peak = |lobes: &Lobes| {
        let curve = lobes.angles_deg.iter().zip(&lobes.lights[0].in_plane[1]);
        curve.map(|(angle, value)| (*angle, *value)).max_by(|a, b| a.1.total_cmp(&b.1)).unwrap()
    };
    let [narrow, wide] = [&settings[0].1, &settings[1].1].map(peak);
    // At this roughness the lobe has drawn towards grazing by a degree or two, not by ten.
    assert!((45.0..55.0).contains(&narrow.0), "{narrow:?}");
    assert!(wide.0 > narrow.0 && wide.1 < narrow.1, "{narrow:?} {wide:?}");
    // On the hemisphere it lies at azimuth 180°, where the plane of incidence leaves it: several times the diffuse part.
    let rings = &settings[0].1.lights[0].hemisphere;
    let column = |azimuth: usize| rings.iter().map(|ring| ring[azimuth]).fold(0.0, f64::max);
    assert!(column(30) > 3.0 * column(0), "{} {}", column(30), column(0));
}

/// A fibre sends light below the surface as well; ∫ f |n·ωo| over the upper hemisphere, summed from the map's cells, is the
/// share that comes back up, between nothing and all. The map of a Lambertian surface sums to its albedo: 20 rings hold
/// ∫ cosθ to 2e-3 by the midpoint rule.
#[test]
fn maps_sum_to_albedos() {
    let albedo = |kind: &str| {
        let lobes = &lobes_of(kind, &[], &[30.0])[0].1;
        let rings = &lobes.lights[0].hemisphere;
        let ring_rad = 0.5 * PI / rings.len() as f64;
        let sum: f64 = rings
            .iter()
            .enumerate()
            .map(|(index, ring)| {
                let theta = ring_rad * (index as f64 + 0.5);
                let cell = theta.sin() * theta.cos() * ring_rad * 2.0 * PI / ring.len() as f64;
                ring.iter().sum::<f64>() * cell
            })
            .sum();
        (sum, lobes.angles_deg.iter().any(|angle| *angle > 90.0))
    };
    let (lambertian, below) = albedo("lambertian");
    assert!((lambertian - 0.5).abs() < 2e-3 && !below, "{lambertian}");
    let (fibre, below) = albedo("cylinder");
    assert!((0.05..1.0).contains(&fibre) && below, "{fibre}");
}

#[test]
fn every_model_is_drawn_and_its_numbers_kept() {
    let desk = Desk::empty();
    let run = desk.barbule("models --plot lobes").succeeds().prints("rough-plastic-hemisphere.png");
    assert_eq!(run.out.lines().count(), 2 * 13, "thirteen models scatter:\n{}", run.out);
    for line in run.out.lines() {
        let name = line.strip_prefix("lobes/plots/").and_then(|name| name.strip_suffix(".png")).unwrap();
        let numbers = desk.read(&format!("lobes/curves/{name}.csv"));
        assert!(numbers.lines().count() > 500 && numbers.starts_with("panel,"), "{name}");
        let svg = desk.read(&format!("lobes/plots/{name}.svg"));
        assert!(svg.contains("light at 45°") && !svg.contains("NaN"), "{name}");
    }
    desk.barbule("models lambertian").succeeds().prints("albedo");
}

#[test]
fn slips_in_what_is_to_be_drawn_get_a_sentence() {
    let desk = Desk::empty();
    for (words, parts) in [
        ("models lambertain", ["MODEL", "found `lambertain`", "mean `lambertian`"]),
        ("models thin-film-law --plot out", ["MODEL", "peak wavelengths", "another model"]),
        ("models lambertian --plot out --set albedo=2", ["--set", "found 2", "from 0 to 1"]),
        ("models lambertian --plot out --set albedo=x", ["--set", "`x` is not a number", ""]),
        ("models lambertian --plot out --set gloss=1", ["--set", "gloss", "no such parameter"]),
        ("models lambertian --plot out --light 95", ["--light", "found 95", "below 90"]),
        ("models lambertian --plot out --set albedo=0,.1,.2,.3,.4,.5,.6", ["--set", "7 combinations", "at most 6"]),
        ("models lambertian --set albedo=0.1", ["--plot", "", ""]),
    ] {
        desk.barbule(words).complains(&parts);
    }
}

/// The report draws the fitted model, at the lowest, a middle and the highest incidence that was fitted.
#[test]
fn a_report_shows_the_fitted_lobes() {
    let desk = Desk::with("film.toml", FILM);
    desk.barbule("fit film.toml --out film").succeeds();
    let lights = desk.result("film")["cases"][0]["lobes"]["lights"].clone();
    let shown: Vec<f64> =
        lights.as_array().unwrap().iter().map(|light| light["theta_i_deg"].as_f64().unwrap()).collect();
    assert_eq!(shown, [15.0, 45.0, 70.0]);
    let page = desk.read("film/index.html");
    assert!(page.contains("plots/lobes.svg") && page.contains("curves/hemisphere.csv"));
}
