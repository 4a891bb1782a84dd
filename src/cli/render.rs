//! `barbule render SCENE`

use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use anyhow::{Context, Result};
use barbule::render::{self, Checkpoint, Control, RenderError};
use barbule::report::write_file;
use barbule::scene::{CheckedScene, SceneFile, SpeciesFile, View, studio};
use clap::{Args, ValueEnum};
use indicatif::{ProgressBar, ProgressStyle};

use super::Ending;
use super::output::{check_writable, print};

/// Render a scene to a picture: a PNG for screens and a linear EXR.
///
/// Ctrl-C stops; with --checkpoint the tiles that are done are kept, and the same command goes on from there.
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  barbule render fits/scene-sphere\n  barbule render my-scene.json --samples 256 --out pictures\n  barbule render steller-jay-tail --view flat"
)]
pub(super) struct Render {
    /// The scene: its JSON file, or a folder with a scene.json in it. With --view a kept species: its JSON file, or its name in
    /// fits/species.
    scene: PathBuf,
    /// Show a kept species on a table; the pictures are named after the view and after how the entry's values were found.
    #[arg(long, value_enum)]
    view: Option<SpeciesView>,
    /// Folder of render.png and render.exr [default: reports/<scene's name>].
    #[arg(long)]
    out: Option<PathBuf>,
    /// Samples a pixel, instead of the scene's.
    #[arg(long, allow_negative_numbers = true)]
    samples: Option<u32>,
    /// Seed, instead of the scene's.
    #[arg(long, allow_negative_numbers = true)]
    seed: Option<u64>,
    /// Number of threads [default: one a core]. The picture does not depend on it.
    #[arg(long, allow_negative_numbers = true, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Folder in which finished tiles are kept; a killed or interrupted render goes on from there.
    #[arg(long, value_name = "FOLDER")]
    checkpoint: Option<PathBuf>,
}

static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// The first Ctrl-C asks the render to end; the second does not wait for it.
fn interrupt() {
    if INTERRUPTED.swap(true, Ordering::Relaxed) {
        std::process::exit(130);
    }
}

/// How a kept species is looked at.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum SpeciesView {
    /// From straight above, whole.
    Flat,
    /// From the side and 30° above the table, whole.
    Angle,
    /// From straight above, each barb told apart.
    CloseUp,
}

impl Render {
    /// The scene, the file that it was made of, and the name of its pictures.
    fn file(&self) -> Result<(SceneFile, PathBuf, String)> {
        let Some(view) = self.view else {
            let (file, path) = SceneFile::read(&self.scene)?;
            return Ok((file, path, "render".to_owned()));
        };
        let path = SpeciesFile::find(&self.scene);
        let entry = SpeciesFile::read(&path)?;
        let (view, name) = match view {
            SpeciesView::Flat => (View::Flat, "flat"),
            SpeciesView::Angle => (View::Angle, "angle"),
            SpeciesView::CloseUp => (View::CloseUp, "close-up"),
        };
        let file = studio(&entry, &path, view).with_context(|| format!("{}: geometry", path.display()))?;
        let stem = format!("{}-{name}", entry.status.word());
        Ok((file, path, stem))
    }

    pub(super) fn run(self) -> Result<Ending> {
        let (mut file, path, stem) = self.file()?;
        file.image.samples = self.samples.unwrap_or(file.image.samples);
        file.image.seed = self.seed.unwrap_or(file.image.seed);
        // A feather's map is made by all threads, so that they come first.
        if let Some(threads) = self.threads {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.into()).build_global();
            pool.context("the threads cannot be started; choose a smaller --threads")?;
        }
        let checked = CheckedScene::new(&file, &path)?;
        let folder = self.out.unwrap_or_else(|| PathBuf::from("reports").join(name(&path)));
        check_writable(&folder)?;
        ctrlc::set_handler(interrupt).context("Ctrl-C cannot be caught")?;

        let bar = progress_bar();
        let progress = |done: usize, total: usize| {
            bar.set_length(total as u64);
            bar.set_position(done as u64);
        };
        let checkpoint = self.checkpoint.map(|folder| Checkpoint::new(&folder, checked.fingerprint.clone()));
        let started = Instant::now();
        let control = Control { interrupt: &INTERRUPTED, progress: &progress, checkpoint: checkpoint.as_ref() };
        let made = render::render(&checked.scene, checked.resolution, checked.settings, &control);
        bar.finish_and_clear();
        let picture = match made {
            Err(error @ RenderError::Interrupted { .. }) => {
                let kept = match checkpoint {
                    Some(_) => "they are kept, the same command goes on from there",
                    None => "nothing was written; with --checkpoint they would have been kept",
                };
                eprintln!("barbule: {error}; {kept}");
                return Ok(Ending::Interrupted);
            }
            made => made?,
        };

        let seconds = started.elapsed().as_secs_f64();
        let (png, exr) = (folder.join(format!("{stem}.png")), folder.join(format!("{stem}.exr")));
        write_file(&png, &picture.to_png(&checked.tone).context("the picture cannot be written as a PNG")?)?;
        write_file(&exr, &picture.to_exr().context("the picture cannot be written as an EXR")?)?;
        if let Some(checkpoint) = checkpoint {
            checkpoint.remove()?;
        }
        print(&format!("{}\n{}", png.display(), exr.display()))?;
        print(&format!("{}: {} samples a pixel in {seconds:.1} s", checked.title, checked.resolution.samples))?;
        Ok(Ending::Done)
    }
}

/// What the scene's folder is called where its file is only a `scene.json`, else what the file is called.
fn name(path: &Path) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default();
    let folder = path.canonicalize().ok().and_then(|path| path.parent()?.file_name().map(PathBuf::from));
    match folder {
        Some(folder) if stem == "scene" => folder,
        _ => PathBuf::from(stem),
    }
}

/// A bar on a terminal, nothing otherwise.
pub(super) fn progress_bar() -> ProgressBar {
    if !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let style = ProgressStyle::with_template("{msg} {bar:40} {pos}/{len} tiles, {elapsed}, {eta} to go");
    ProgressBar::new(1).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar())).with_message("rendering")
}
