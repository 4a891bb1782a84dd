//! Several specimens in one table: each and together, from tables whose truth is known.

use std::fmt::Write;
use std::sync::atomic::AtomicBool;

use barbule::bsdf::{Direction, Model, PigmentedBase, PigmentedBaseDesign};
use barbule::fit::Control;
use barbule::job::{self, Job, Population};
use barbule::pigment::{BandDesign, PigmentDesign};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::desk::Desk;

/// Plumage of one band of pigment, fitted by all that made it.
const JOB: &str = r#"title = "Made birds"

[data]
file = "birds.csv"

[data.layout.spectra]
quantity = "reflectance"

[data.layout.spectra.columns.long]
angles = "not_recorded"
wavelength = "nm"
value = "R"
specimen = "bird"

[specimens]
leave_one_out = false

[model]
kind = "pigmented-base"
pigments = [{ kind = "bands", name = "dye", bands = [{ peak_nm = 480, width_nm = 40 }] }]

[parameters]
"dye.amount" = { lower = 0, upper = 50 }
"dye.shift_nm" = { lower = -60, upper = 60 }
scattering = { lower = 0.1, upper = 50 }

[fit]
starts = 2
"#;

/// A population: the mean of amount, shift and scattering, and how much each differs between birds.
const MEAN: [f64; 3] = [2.0, 10.0, 3.0];
const BETWEEN: [f64; 3] = [0.3, 5.0, 0.4];

/// Seven birds of this population as a table: 31 wavelengths, noise of 0.2 % of white, and another band of this amount,
/// the same in all, that the job knows nothing of.
fn birds(seed: u64, unknown: f64) -> String {
    let wavelengths: Vec<f64> = (0..31).map(|k| 400.0 + 10.0 * f64::from(k)).collect();
    let band = |name: &str, peak_nm, width_nm| PigmentDesign::Bands {
        name: name.into(),
        bands: vec![BandDesign { peak_nm, width_nm, height: 1.0 }],
    };
    let pigments = vec![band("dye", 480.0, 40.0), band("unknown", 600.0, 30.0)];
    let model = PigmentedBase::new(&PigmentedBaseDesign { pigments, sponge: false }, &wavelengths).unwrap();
    let mut text = "bird,nm,R\n".to_owned();
    for bird in 0..7 {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        random.set_stream(bird);
        let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
        let drawn: [f64; 3] = std::array::from_fn(|k| MEAN[k] + BETWEEN[k] * normal());
        let value = |name: &str, default: f64| match name {
            "dye.amount" => drawn[0],
            "dye.shift_nm" => drawn[1],
            "scattering" => drawn[2],
            "unknown.amount" => unknown,
            _ => default,
        };
        let values: Vec<f64> = model.parameters().iter().map(|p| value(&p.name, p.default)).collect();
        let mut brdf = vec![0.0; wavelengths.len()];
        let normal_direction = Direction::new(0.0, 0.0, 1.0);
        model.bind(&values).evaluate(&normal_direction, &normal_direction, &mut brdf);
        for (nm, brdf) in wavelengths.iter().zip(brdf) {
            let reading = std::f64::consts::PI * brdf + 0.002 * normal();
            writeln!(text, "bird{bird},{nm},{reading}").unwrap();
        }
    }
    text
}

fn population_of(job: &str, table: &str) -> Population {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("birds.csv"), table).unwrap();
    let job = Job::from_text("job.toml", job, folder.path()).unwrap();
    let control = Control { interrupt: &AtomicBool::new(false), progress: &|_, _| {}, checkpoint: None };
    let outcome = job::run(&job, &control).unwrap();
    outcome.cases[0].population.clone().expect("the job asks for it")
}

/// Fifteen populations with three parameters each: of 45 intervals of means and as many of spreads, 95 % hold their truth, 42.75
/// with a standard deviation of 1.5. Three of them below is 38; one in a thousand right programs would fail, and the seeds are
/// fixed.
#[test]
fn a_population_is_recovered() {
    let (mut means, mut spreads) = (0, 0);
    for seed in 0..15 {
        let population = population_of(JOB, &birds(seed, 0.0));
        assert_eq!(population.specimens.len(), 7);
        for (parameter, (mean, between)) in population.parameters.iter().zip(MEAN.iter().zip(BETWEEN)) {
            assert_eq!(parameter.count, 7);
            let effects = parameter.effects.as_ref().unwrap();
            let inside = |[low, high]: [f64; 2], truth: f64| i32::from(low <= truth && truth <= high);
            means += inside(effects.mean_interval_95, *mean);
            spreads += inside(effects.between_interval_95, between);
        }
    }
    assert!(means >= 38 && spreads >= 38, "{means} means and {spreads} spreads of 45");
}

/// A band that the model lacks bends all birds alike. It widens every fit's errors, but not what is known of differences:
/// the spread of the shift stays visible.
#[test]
fn misfit_that_all_share_hides_no_difference() {
    for seed in [3, 4, 5] {
        let population = population_of(JOB, &birds(seed, 0.3));
        let shift = &population.parameters[1];
        assert_eq!(shift.name, "dye.shift_nm");
        let effects = shift.effects.as_ref().unwrap();
        let [low, high] = effects.between_interval_95;
        assert!(low > 0.0 && low <= 5.0 && 5.0 <= high, "{low} to {high}");
        assert!(effects.shared > 2.0 * effects.within, "{} {}", effects.shared, effects.within);
        for specimen in &population.specimens {
            let (own, whole) = (specimen.own_errors[1].unwrap(), specimen.standard_errors[1].unwrap());
            assert!(own < whole, "{own} {whole}");
        }
    }
}

/// Birds that are copies of one another but for noise: no spread, and a bird is predicted to within the noise by the model
/// and by the others' mean alike.
#[test]
fn birds_left_out_are_predicted() {
    let wavelengths: Vec<f64> = (0..31).map(|k| 400.0 + 10.0 * f64::from(k)).collect();
    let lines = birds(8, 0.0);
    let first: Vec<f64> =
        lines.lines().skip(1).take(31).map(|l| l.rsplit(',').next().unwrap().parse().unwrap()).collect();
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut text = "bird,nm,R\n".to_owned();
    for bird in 0..6 {
        for (nm, reading) in wavelengths.iter().zip(&first) {
            let noise: f64 = StandardNormal.sample(&mut random);
            writeln!(text, "{bird},{nm},{}", reading + 0.004 * noise).unwrap();
        }
    }
    let population = population_of(&JOB.replace("leave_one_out = false", "leave_one_out = true"), &text);
    let left_out = population.left_out.as_ref().unwrap();
    // 155 degrees of freedom give a standard deviation to 5.7 %, and three times that is allowed.
    assert!((left_out.spread.unwrap() / 0.004 - 1.0).abs() < 0.17, "{left_out:?}");
    // A mean of five has a fifth of the variance: √(1 + 1/5) times the spread.
    assert!((left_out.mean.unwrap() / 0.004 - 1.2_f64.sqrt()).abs() < 0.19, "{left_out:?}");
    // The model does not know the first bird's own noise of 0.002: √(0.004² + 0.002²), as well known.
    assert!(left_out.model < 0.0052 && left_out.model > 0.0036, "{left_out:?}");
    assert_eq!((left_out.by_model.len(), left_out.by_mean.len(), left_out.sigma), (6, 6, None));
    assert!(population.absorbers[0].needed && population.absorbers[0].rms_without > 0.02, "{:?}", population.absorbers);
    assert!(population.text.contains("is a band that describes the spectra"), "{}", population.text);
}

/// A pigment that is not there is said not to be shown.
#[test]
fn a_pigment_too_many_is_noticed() {
    let job = JOB
        .replace("leave_one_out = false", "leave_one_out = true")
        .replace("pigments = [", "pigments = [{ kind = \"eumelanin\" }, ")
        .replace("[parameters]", "[parameters]\n\"eumelanin.amount\" = { lower = 0, upper = 10 }");
    let population = population_of(&job, &birds(2, 0.0));
    let test = |name: &str| population.absorbers.iter().find(|test| test.name == name).unwrap();
    assert!(test("dye").needed && !test("eumelanin").needed, "{:?}", population.absorbers);
    assert!(
        population.text.contains("Without eumelanin the specimens are predicted about as well"),
        "{}",
        population.text
    );
}

/// From a table alone: what `new` guesses is a job that `check` explains and `fit` fits, page and all.
#[test]
fn a_table_of_birds_goes_all_the_way() {
    let mut table = "species,individual,wavelength,reflectance_percent\n".to_owned();
    for (species, seed) in [("finch", 1), ("tanager", 2)] {
        for line in birds(seed, 0.0).lines().skip(1) {
            let cells: Vec<&str> = line.split(',').collect();
            writeln!(
                table,
                "{species},{species} {},{},{}",
                cells[0],
                cells[1],
                100.0 * cells[2].parse::<f64>().unwrap()
            )
            .unwrap();
        }
    }
    let desk = Desk::empty().and("birds.csv", table);
    desk.barbule("new birds.csv").succeeds();
    let job = desk.read("birds.toml");
    for part in
        ["angles = \"not_recorded\"", "specimen = \"individual\"", "group = [\"species\"]", "leave_one_out = true"]
    {
        assert!(job.contains(part), "{job}");
    }
    let desk = desk.and("quick.toml", format!("{job}\n[fit]\nstarts = 1\n"));
    desk.barbule("check quick.toml")
        .succeeds()
        .prints("Case finch")
        .prints("7 specimens, each fitted by itself too and predicted from the others");
    desk.barbule("fit quick.toml --out birds").succeeds().prints("Over 7 specimens").prints("tanager: ");
    let page = desk.read("birds/index.html");
    for part in ["The specimens", "finch bird3", "predicted from the others", "Knapp and Hartung"] {
        assert!(page.contains(part), "the page lacks {part}");
    }
    let result = desk.result("birds");
    assert_eq!(result["cases"].as_array().unwrap().len(), 2);
    assert_eq!(result["cases"][1]["group"], "tanager");
}

#[test]
fn what_needs_angles_is_refused_without_them() {
    let job = |from: &str, to: &str| {
        assert!(JOB.contains(from));
        JOB.replace(from, to)
    };
    let model = &JOB[JOB.find("[model]").unwrap()..JOB.find("[parameters]").unwrap()];
    let cases = [
        (job(model, "[model]\nkind = \"cylinder\"\n\n"), "`cylinder` depends on where light and viewer stand"),
        (job("[data]\n", "[data]\ntheta_offset_deg = 5\n"), "data.theta_offset_deg: this key speaks of angles"),
        (
            job("[model]", "[instrument]\nlight_half_angle_deg = 3\n[model]"),
            "instrument.light_half_angle_deg: this key speaks",
        ),
    ];
    for (text, message) in cases {
        let desk = Desk::with("birds.csv", birds(1, 0.0)).and("job.toml", text);
        desk.barbule("fit job.toml").complains(&["job.toml, line", message]);
    }
}

/// An absorber that stands in a file: read from where the job says, hashed with the inputs, refused in a sentence.
#[test]
fn a_pigment_in_a_file_is_read() {
    let with_table = JOB.replace(
        "pigments = [{ kind = \"bands\", name = \"dye\", bands = [{ peak_nm = 480, width_nm = 40 }] }]",
        "pigments = [{ kind = \"table\", name = \"dye\", file = \"dye.csv\", wavelength = \"nm\", absorption = \"e\" }]",
    );
    let with_table = with_table.replace("\"dye.shift_nm\" = { lower = -60, upper = 60 }\n", "");
    // The band itself, moved by the mean of the birds' shifts, every 2 nm.
    let mut dye = "nm,e\n".to_owned();
    for k in 0..161 {
        let nm = 390.0 + 2.0 * f64::from(k);
        writeln!(dye, "{nm},{}", (-0.5 * ((nm - 490.0) / 40.0_f64).powi(2)).exp()).unwrap();
    }
    let desk = Desk::empty().and("birds.csv", birds(1, 0.0)).and("dye.csv", dye).and("job.toml", with_table);
    desk.barbule("fit job.toml --out dyed").succeeds().prints("dye.amount");
    let inputs = desk.result("dyed")["inputs"].as_array().unwrap().clone();
    assert!(inputs.iter().any(|input| input["name"] == "dye.csv"), "{inputs:?}");
    let desk = desk.and("dye.csv", "nm,e\n450,1\n460,x\n");
    desk.barbule("fit job.toml").complains(&["dye.csv, line 3, column \"e\"", "\"x\""]);
}
