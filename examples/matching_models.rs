//! What each film model can say of the others: fits each to tables that another simulated, and writes the best parameters
//! and the difference of colour that remains.
//!
//! ```sh
//! cargo run --release --example matching_models reports/examples/matching-models
//! ```

use std::collections::BTreeMap;
use std::error::Error;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use barbule::fit::Control;
use barbule::job::{Case, CaseData, Job, Noise, SpectrumFit, run, simulate};
use barbule::measure::colour::{Lab, Xyz};
use barbule::report::write_file;
use nalgebra::{Matrix3, Vector3};

/// A film model as a job names it.
struct FilmModel {
    name: &'static str,
    section: &'static str,
    /// What a fit moves.
    free: &'static str,
    /// Two feathers of this model, from its usual ranges: a short name, and parameter values.
    truths: [(&'static str, &'static str); 2],
}

const MODELS: [FilmModel; 3] = [
    FilmModel {
        name: "granier-heidrich",
        section: "kind = \"granier-heidrich\"\nper_channel = [\"diffuse\"]",
        free: "thickness_nm = { lower = 50, upper = 900 }\neta = { lower = 1.2, upper = 2.2 }\nspecular = {}\ndiffuse = {}\n\
               outer_exponent = { lower = 0, upper = 500 }\ninner_exponent = { lower = 0, upper = 500 }",
        truths: [
            (
                "thin",
                "thickness_nm = 220\neta = 1.56\nspecular = 0.3\ndiffuse_r = 0.02\ndiffuse_g = 0.04\ndiffuse_b = 0.06\n\
                 outer_exponent = 30\ninner_exponent = 20",
            ),
            (
                "thick",
                "thickness_nm = 480\neta = 1.56\nspecular = 0.2\ndiffuse_r = 0.06\ndiffuse_g = 0.03\ndiffuse_b = 0.02\n\
                 outer_exponent = 60\ninner_exponent = 60",
            ),
        ],
    },
    FilmModel {
        name: "iridescent-plastic",
        section: "kind = \"iridescent-plastic\"\nper_channel = [\"diffuse\"]",
        free: "thickness_nm = { lower = 50, upper = 900 }\neta = { lower = 1.2, upper = 2.2 }\nspecular = {}\ndiffuse = {}\n\
               roughness = { lower = 0.05, upper = 1 }",
        truths: [
            (
                "thin",
                "thickness_nm = 220\neta = 1.56\nspecular = 1\ndiffuse_r = 0.1\ndiffuse_g = 0.2\ndiffuse_b = 0.3\n\
                 roughness = 0.25",
            ),
            (
                "thick",
                "thickness_nm = 480\neta = 1.56\nspecular = 1\ndiffuse_r = 0.4\ndiffuse_g = 0.2\ndiffuse_b = 0.1\n\
                 roughness = 0.4",
            ),
        ],
    },
    FilmModel {
        name: "coated-base",
        section: "kind = \"coated-base\"\nlayers = [{ name = \"film\", material = { name = \"film\", index = 1.56 }, thickness_nm \
                  = 300 }]\nsubstrate = \"bird_melanin\"\nbase_knots_nm = [445, 525, 645]",
        free: "\"film.thickness_nm\" = { lower = 50, upper = 900 }\n\"film.index\" = { lower = 1.2, upper = 2.2 }\n\
               roughness = { lower = 0.05, upper = 1 }\n\"diffuse_share.445\" = {}\n\"diffuse_share.525\" = {}\n\
               \"diffuse_share.645\" = {}\n\"bird_melanin.extinction_scale\" = {}",
        truths: [
            (
                "thin",
                "\"film.thickness_nm\" = 220\nroughness = 0.25\n\"diffuse_share.445\" = 0.1\n\"diffuse_share.525\" = 0.06\n\
                 \"diffuse_share.645\" = 0.03",
            ),
            (
                "thick",
                "\"film.thickness_nm\" = 480\nroughness = 0.4\n\"diffuse_share.445\" = 0.02\n\"diffuse_share.525\" = 0.03\n\
                 \"diffuse_share.645\" = 0.08",
            ),
        ],
    },
];

/// Three inclinations of the light; viewers in the plane of incidence every 15°, and some across it and aslant.
fn directions() -> Vec<[f64; 4]> {
    let mut all = Vec::new();
    for theta_i in [10.0, 35.0, 60.0] {
        let mirror_side = (0..=5).map(|step| (15.0 * f64::from(step), 180.0));
        let light_side = (1..=5).map(|step| (15.0 * f64::from(step), 0.0));
        let across = [(15.0, 90.0), (45.0, 90.0), (70.0, 90.0), (30.0, 135.0), (60.0, 135.0)];
        let viewers = mirror_side.chain(light_side).chain(across);
        all.extend(viewers.map(|(theta_o, phi_o)| [theta_i, 0.0, theta_o, phi_o]));
    }
    all
}

fn job(model: &FilmModel, parameters: &str, table: &str, folder: &Path) -> Result<Job, Box<dyn Error>> {
    let text = format!(
        r#"title = "One film model fitted to another"
[data]
file = "{table}"
compare = "cube-roots"
[data.layout.spectra]
quantity = "brdf"
[data.layout.spectra.columns.long]
angles = {{ four = {{ theta_i = "theta_i_deg", phi_i = "phi_i_deg", theta_o = "theta_o_deg", phi_o = "phi_o_deg" }} }}
wavelength = "wavelength_nm"
value = "brdf_per_sr"
[model]
{}
[parameters]
{parameters}
[fit]
starts = 16
"#,
        model.section
    );
    Ok(Job::from_text("matching-models", &text, folder)?)
}

/// One fit of a model to another's table.
struct Match {
    truth: &'static str,
    feather: &'static str,
    model: &'static str,
    parameters: Vec<String>,
    rms_of_cube_roots: f64,
    mean_difference: f64,
    largest_difference: f64,
}

fn matched(
    truth: &FilmModel,
    (feather, values): (&'static str, &str),
    model: &FilmModel,
    folder: &Path,
) -> Result<Match, Box<dyn Error>> {
    let no_noise = Noise { share: 0.0, seed: 0 };
    let exact = simulate(&job(truth, values, "directions.csv", folder)?, &BTreeMap::new(), no_noise)?;
    std::fs::write(folder.join("made.csv"), exact)?;
    let control = Control { interrupt: &AtomicBool::new(false), progress: &|_, _| (), checkpoint: None };
    let outcome = run(&job(model, model.free, "made.csv", folder)?, &control)?;
    let case = &outcome.cases[0];
    let CaseData::Spectra { spectra, .. } = &case.data else { return Err("the table holds spectra".into()) };
    let differences = differences(spectra)?;
    let count = f64::from(u32::try_from(differences.len())?);
    Ok(Match {
        truth: truth.name,
        feather,
        model: model.name,
        parameters: parameters(case),
        rms_of_cube_roots: case.fit.minima.first().map_or(f64::NAN, |best| best.rms),
        mean_difference: differences.iter().sum::<f64>() / count,
        largest_difference: differences.iter().copied().fold(0.0, f64::max),
    })
}

/// The free parameters as `name value`, those on a bound marked.
fn parameters(case: &Case) -> Vec<String> {
    let free = case.fit.estimates.iter().filter(|estimate| estimate.role == "free");
    free.map(|estimate| {
        let mark = if estimate.at_bound.is_some() { " (bound)" } else { "" };
        format!("{} {:.3}{mark}", estimate.name, estimate.value)
    })
    .collect()
}

/// CIEDE2000 between model and table at each pair of directions. The three channels are taken as linear Rec. 709 light under
/// D65, exposed so that the brightest reading of the table has the luminance of white.
fn differences(spectra: &[SpectrumFit]) -> Result<Vec<f64>, Box<dyn Error>> {
    let unit = |x, y, z| Vector3::from(Xyz { x, y, z }.to_linear_rgb().0);
    let to_rgb = Matrix3::from_columns(&[unit(1.0, 0.0, 0.0), unit(0.0, 1.0, 0.0), unit(0.0, 0.0, 1.0)]);
    let to_xyz = to_rgb.try_inverse().ok_or("the primaries are independent")?;
    // Wavelengths rise: blue, green, red.
    let xyz = |readings: &[f64]| to_xyz * Vector3::new(readings[2], readings[1], readings[0]);
    let brightest = spectra.iter().map(|spectrum| xyz(&spectrum.measured).y).fold(0.0, f64::max);
    let lab = |readings: &[f64]| -> Lab {
        let seen = xyz(readings) / brightest;
        Xyz { x: seen.x, y: seen.y, z: seen.z }.to_lab()
    };
    Ok(spectra.iter().map(|spectrum| lab(&spectrum.measured).delta_e_2000(lab(&spectrum.model))).collect())
}

fn csv(matches: &[Match]) -> String {
    let mut text =
        "table_of,feather,fitted_model,mean_delta_e_2000,largest_delta_e_2000,rms_of_cube_roots,parameters\n"
            .to_owned();
    for m in matches {
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "{},{},{},{:.3},{:.3},{:.5},{}",
            m.truth,
            m.feather,
            m.model,
            m.mean_difference,
            m.largest_difference,
            m.rms_of_cube_roots,
            m.parameters.join("; ")
        );
    }
    text
}

const ABOUT: &str = "# Film models fitted to each other\n\n\
Each film model was fitted to tables that another one simulated, without noise: light at 10, 35 and 60°, 48 pairs of \
directions in and out of the plane of incidence, three channels (445, 525, 645 nm), cube roots compared. ΔE is CIEDE2000 \
between fit and table over the pairs, the channels taken as linear Rec. 709 light under D65 and exposed so that the brightest \
reading of the table is white. Every table is also fitted by its own model, which must give 0. Made by `cargo run --release \
--example matching_models`; parameters with all digits stand in `matching-models.csv`.\n\n\
| table of | feather | fitted | mean ΔE | largest ΔE | best parameters |\n| --- | --- | --- | --- | --- | --- |\n";

fn markdown(matches: &[Match]) -> String {
    let mut text = ABOUT.to_owned();
    for m in matches {
        let _ = writeln!(
            text,
            "| {} | {} | {} | {:.1} | {:.1} | {} |",
            m.truth,
            m.feather,
            m.model,
            m.mean_difference,
            m.largest_difference,
            m.parameters.join(", ")
        );
    }
    text + MEANING
}

const MEANING: &str = "\n\
**What matches.** Each model finds its own parameters. Between the iridescent plastic and the coated base, which share the \
lobe of a rough interface about the half-vector, the shape of the gloss carries over: roughnesses agree to a few hundredths. \
What remains is colour.\n\n\
**What cannot.** In the coated base the film's own two reflections interfere, and the base is as bright as it is. In the \
iridescent plastic the gloss interferes with the light from the base, in Granier and Heidrich's model the two surfaces of the \
film and, apart from them, the base as a whole. Fringes of the same thickness therefore differ in size, in phase and in how \
they move with the angle; albedos and indices run to their bounds to make up for it, and **a thickness found under one model is \
not the thickness of another**: take it as a parameter of its model. Granier and Heidrich's lobes are Phong's about the mirror \
direction, with Schlick's factor of the light's angle alone: they neither grow nor lean towards grazing as a rough interface's \
do, and exchanging light and viewer changes them, so that no reciprocal model can follow them everywhere. That is where the \
largest differences are.\n";

fn main() -> Result<(), Box<dyn Error>> {
    let out = PathBuf::from(std::env::args().nth(1).ok_or("usage: matching_models FOLDER")?);
    let folder = tempfile::tempdir()?;
    let mut table = "theta_i_deg,phi_i_deg,theta_o_deg,phi_o_deg,wavelength_nm,brdf_per_sr\n".to_owned();
    for [theta_i, phi_i, theta_o, phi_o] in directions() {
        for nm in [445, 525, 645] {
            writeln!(table, "{theta_i},{phi_i},{theta_o},{phi_o},{nm},0")?;
        }
    }
    std::fs::write(folder.path().join("directions.csv"), table)?;
    let mut matches = Vec::new();
    for truth in &MODELS {
        for feather in truth.truths {
            for model in &MODELS {
                matches.push(matched(truth, feather, model, folder.path())?);
            }
        }
    }
    write_file(&out.join("matching-models.csv"), csv(&matches).as_bytes())?;
    write_file(&out.join("matching-models.md"), markdown(&matches).as_bytes())?;
    print!("{}", markdown(&matches));
    Ok(())
}
