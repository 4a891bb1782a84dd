//! A checkpoint is right when a fit that was killed and picked up is the one that was never killed, to the last byte.
#![expect(clippy::unwrap_used, reason = "a helper of a test fails by panicking")]

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

use barbule::fit::{
    Assignment, CheckpointError, Checkpoints, Control, Fit, FitError, Prior, Residuals, Role, Settings, Solver,
    StopReason, fit,
};
use barbule::parameter::{Parameter, Spread};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Fringes gain·cos(d·k) + offset, with many minima along d, that die after so many evaluations.
struct Mortal {
    parameters: Vec<Parameter>,
    readings: Vec<f64>,
    life: u64,
    evaluations: AtomicU64,
}

impl Mortal {
    fn new(life: u64) -> Self {
        let parameter = |name: &str, scan_step| Parameter {
            name: name.to_owned(),
            symbol: name.to_owned(),
            unit: "",
            default: 0.0,
            lower: f64::NEG_INFINITY,
            upper: f64::INFINITY,
            spread: Spread::Linear,
            scan_step,
            text: String::new(),
        };
        let mut random = ChaCha8Rng::seed_from_u64(5);
        let readings = (0..24).map(|k| model([4.3, 1.4, 0.3], k) + random.random_range(-0.05..0.05));
        Self {
            parameters: vec![parameter("d", Some(0.4)), parameter("gain", None), parameter("offset", None)],
            readings: readings.collect(),
            life,
            evaluations: AtomicU64::new(0),
        }
    }

    fn evaluations(&self) -> u64 {
        self.evaluations.load(Ordering::Relaxed)
    }
}

fn model([d, gain, offset]: [f64; 3], k: usize) -> f64 {
    let x = 1.0 + 0.1 * k as f64;
    gain * (d * x).cos() + offset
}

impl Residuals for Mortal {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn count(&self) -> usize {
        self.readings.len()
    }

    fn evaluate(&self, values: &[f64], residuals: &mut [f64]) {
        assert!(self.evaluations.fetch_add(1, Ordering::Relaxed) < self.life, "killed");
        for (k, (residual, reading)) in residuals.iter_mut().zip(&self.readings).enumerate() {
            *residual = (model([values[0], values[1], values[2]], k) - reading) / 0.03;
        }
    }

    fn sigma_known(&self) -> bool {
        false
    }
}

/// The prior on the offset is weighed against an unknown σ, so that the search is repeated.
fn assignments() -> [Assignment; 3] {
    let free = |start, lower, upper| Role::Free { start, lower, upper };
    [
        Assignment { role: free(2.0, 0.5, 9.0), prior: None },
        Assignment { role: free(1.0, 0.1, 9.0), prior: None },
        Assignment { role: free(0.0, f64::NEG_INFINITY, f64::INFINITY), prior: Some(Prior { mean: 0.2, sigma: 0.5 }) },
    ]
}

fn settings(solver: Solver) -> Settings {
    Settings { solver, starts: 6, max_iterations: 60, ..Settings::default() }
}

fn solve(problem: &Mortal, settings: &Settings, checkpoint: Option<&Checkpoints>) -> Result<Fit, FitError> {
    let interrupt = AtomicBool::new(false);
    fit(problem, &assignments(), settings, &Control { interrupt: &interrupt, progress: &|_, _| {}, checkpoint })
}

/// Saved after every iteration, so that a test need not wait for the clock.
fn eager(folder: &Path) -> Checkpoints {
    Checkpoints::new(folder).every(Duration::ZERO)
}

fn bytes(fit: &Fit) -> String {
    serde_json::to_string(fit).unwrap()
}

/// Kills the fit again and again until it comes to an end; the end, and the evaluations of the last life.
fn through_deaths(folder: &Path, settings: &Settings, lives: impl Fn() -> u64, deaths: u32) -> (Fit, u64) {
    for _ in 0..deaths {
        let mortal = Mortal::new(lives());
        let run = || solve(&mortal, settings, Some(&eager(folder)));
        if let Ok(found) = catch_unwind(AssertUnwindSafe(run)) {
            return (found.unwrap(), mortal.evaluations());
        }
    }
    let immortal = Mortal::new(u64::MAX);
    let found = solve(&immortal, settings, Some(&eager(folder))).unwrap();
    (found, immortal.evaluations())
}

#[test]
fn a_fit_that_was_killed_ends_as_one_that_was_not() {
    for solver in [Solver::LeastSquares, Solver::LBfgs, Solver::NelderMead, Solver::ParticleSwarm] {
        let settings = settings(solver);
        let whole = Mortal::new(u64::MAX);
        let expected = bytes(&solve(&whole, &settings, None).unwrap());
        for threads in [1, 2] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            for seed in 0..4 {
                let random = std::sync::Mutex::new(ChaCha8Rng::seed_from_u64(seed));
                let lives = || random.lock().unwrap().random_range(1..whole.evaluations());
                let folder = tempfile::tempdir().unwrap();
                let (found, last) = pool.install(|| through_deaths(folder.path(), &settings, lives, 2));
                assert_eq!(bytes(&found), expected, "{solver:?}, {threads} threads, deaths from seed {seed}");
                assert!(last <= whole.evaluations() + 2, "{solver:?}: {last} evaluations after two deaths");
            }
        }
    }
}

#[test]
fn what_was_done_is_not_done_again() {
    let settings = settings(Solver::LeastSquares);
    let whole = Mortal::new(u64::MAX);
    solve(&whole, &settings, None).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let late = whole.evaluations() - 10;
    let (_, last) = through_deaths(folder.path(), &settings, || late, 1);
    // What is between solves, Jacobians of the minima, is done again.
    assert!(2 * last < whole.evaluations(), "{last} of {} evaluations after a late death", whole.evaluations());
}

/// One start and nothing else to save: what is left of its evaluations shows that its iterations were not repeated.
#[test]
fn a_solve_goes_on_from_its_last_iteration() {
    let settings = Settings { starts: 1, ..settings(Solver::LeastSquares) };
    let whole = Mortal::new(u64::MAX);
    let expected = bytes(&solve(&whole, &settings, None).unwrap());
    // Lives that one iteration (one evaluation a column, three or so for the step) fits into, but not the fit.
    let folder = tempfile::tempdir().unwrap();
    let life = whole.evaluations() / 2;
    let mortal = Mortal::new(life);
    assert!(catch_unwind(AssertUnwindSafe(|| solve(&mortal, &settings, Some(&eager(folder.path()))))).is_err());
    let text = fs::read_to_string(folder.path().join("fit-1.json")).unwrap();
    assert!(text.contains("\"Running\""), "the killed solve is in its file: {text}");
    let (found, last) = through_deaths(folder.path(), &settings, || u64::MAX, 1);
    assert_eq!(bytes(&found), expected);
    assert!(last < whole.evaluations(), "{last} of {}", whole.evaluations());
}

#[test]
fn an_interrupted_fit_is_picked_up_too() {
    let settings = settings(Solver::LeastSquares);
    let expected = bytes(&solve(&Mortal::new(u64::MAX), &settings, None).unwrap());
    let folder = tempfile::tempdir().unwrap();
    let interrupt = AtomicBool::new(false);
    // The time between savings never passes: the end itself saves.
    let checkpoints = Checkpoints::new(folder.path()).every(Duration::from_hours(1));
    let progress = |done: usize, _| {
        interrupt.fetch_or(done == 3, Ordering::Relaxed);
    };
    let control = Control { interrupt: &interrupt, progress: &progress, checkpoint: Some(&checkpoints) };
    let found = fit(&Mortal::new(u64::MAX), &assignments(), &settings, &control).unwrap();
    assert_eq!(found.stop, StopReason::Cancelled);
    assert!(folder.path().join("fit-1.json").exists(), "a stopped fit is saved");
    let found = solve(&Mortal::new(u64::MAX), &settings, Some(&Checkpoints::new(folder.path()))).unwrap();
    assert_eq!(bytes(&found), expected);
}

#[test]
fn another_fit_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let first = settings(Solver::LeastSquares);
    solve(&Mortal::new(u64::MAX), &first, Some(&eager(folder.path()))).unwrap();
    let mut other = Mortal::new(u64::MAX);
    other.readings[7] += 1e-9;
    let others = [
        solve(&Mortal::new(u64::MAX), &Settings { seed: 2, ..first.clone() }, Some(&eager(folder.path()))),
        solve(&other, &first, Some(&eager(folder.path()))),
    ];
    for other in others {
        let error = other.unwrap_err();
        assert!(matches!(error, FitError::Checkpoint(CheckpointError::AnotherFit { .. })), "{error:?}");
        let text = error.to_string();
        assert!(text.contains("fit-1.json is the checkpoint of another fit") && text.ends_with('.'), "{text}");
    }
}

#[test]
fn a_torn_file_is_refused() {
    let settings = settings(Solver::LeastSquares);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("fit-1.json");
    solve(&Mortal::new(u64::MAX), &settings, Some(&eager(folder.path()))).unwrap();
    let whole = fs::read(&path).unwrap();
    let garbage: [&[u8]; 4] = [&whole[..whole.len() / 2], b"", b"{}", &[0xFF; 40]];
    for bytes in garbage {
        fs::write(&path, bytes).unwrap();
        let text = solve(&Mortal::new(u64::MAX), &settings, Some(&eager(folder.path()))).unwrap_err().to_string();
        assert!(text.contains("fit-1.json is not a complete checkpoint (") && text.ends_with('.'), "{text}");
    }
}

#[test]
fn a_folder_that_cannot_be_made_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    let found = solve(&Mortal::new(u64::MAX), &settings(Solver::LeastSquares), Some(&eager(&file.join("inside"))));
    let text = found.unwrap_err().to_string();
    assert!(text.contains("inside cannot be written: ") && text.contains("give a folder"), "{text}");
}

#[test]
fn fits_in_one_folder_keep_apart_and_leave_nothing() {
    let parent = tempfile::tempdir().unwrap();
    let folder = parent.path().join("checkpoint");
    let checkpoints = eager(&folder);
    for seed in [1, 2] {
        let settings = Settings { seed, ..settings(Solver::LeastSquares) };
        solve(&Mortal::new(u64::MAX), &settings, Some(&checkpoints)).unwrap();
    }
    assert!(folder.join("fit-1.json").exists() && folder.join("fit-2.json").exists());
    checkpoints.remove().unwrap();
    assert!(!folder.exists(), "nothing is left");

    // What somebody else has put there stays.
    let checkpoints = eager(&folder);
    solve(&Mortal::new(u64::MAX), &settings(Solver::LeastSquares), Some(&checkpoints)).unwrap();
    fs::write(folder.join("notes.txt"), "mine").unwrap();
    checkpoints.remove().unwrap();
    let left: Vec<_> = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(left, ["notes.txt"]);

    // A fit that is over before the first saving has written nothing at all.
    let checkpoints = Checkpoints::new(parent.path().join("quick")).every(Duration::from_hours(1));
    let settings = Settings { starts: 1, ..settings(Solver::LeastSquares) };
    solve(&Mortal::new(u64::MAX), &settings, Some(&checkpoints)).unwrap();
    assert_eq!(fs::read_dir(parent.path().join("quick")).unwrap().count(), 0);
    checkpoints.remove().unwrap();
}

#[test]
fn the_command_writes_the_same_result_and_removes_its_checkpoint() {
    let folder = tempfile::tempdir().unwrap();
    let job = Path::new(env!("CARGO_MANIFEST_DIR")).join("fits/teal-peaks");
    let result = |out: &str, extra: &[&str]| {
        let out = folder.path().join(out);
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_barbule"));
        let end = command.arg("fit").arg(&job).arg("--out").arg(&out).args(extra).output().unwrap();
        assert!(end.status.success(), "{}", String::from_utf8_lossy(&end.stderr));
        fs::read_to_string(out.join("result.json")).unwrap()
    };
    let checkpoint = folder.path().join("checkpoint");
    let plain = result("plain", &[]);
    assert_eq!(result("saved", &["--checkpoint", checkpoint.to_str().unwrap()]), plain);
    assert!(!checkpoint.exists(), "nothing is left");
}
