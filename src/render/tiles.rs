//! A picture in tiles, many at a time.
//!
//! Random numbers belong to a pixel and a tile is summed by one thread in one order, so that the picture's bytes depend
//! neither on the number of threads nor on an interruption.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use super::checkpoint::{TileFile, Tiles};
use super::error::RenderError;
use super::integrator::{Integrator, Settings, Tile, Workspace};
use super::picture::Picture;
use super::ray::Colour;
use super::scene::Scene;

/// Size of a tile: one sample of each of its pixels goes step by step together, enough to fill lanes, few enough to stay
/// in a core's cache.
const TILE: [u32; 2] = [32, 16];

/// How large a picture is and how well its pixels are sampled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Resolution {
    /// Pixels a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Samples a pixel, up to 65536.
    pub samples: u32,
}

/// What the caller keeps in hand while a picture is made.
#[derive(Clone, Copy)]
pub struct Control<'a> {
    /// Set by the caller (Ctrl-C) to stop.
    pub interrupt: &'a AtomicBool,
    /// Called with the number of tiles done and their total, from any thread.
    pub progress: &'a (dyn Fn(usize, usize) + Sync),
    /// Where finished tiles are kept, and what tells this picture from any other; None to keep nothing.
    pub checkpoint: Option<&'a Checkpoint>,
}

impl std::fmt::Debug for Control<'_> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter) -> std::fmt::Result {
        let mut text = formatter.debug_struct("Control");
        text.field("interrupt", self.interrupt).field("checkpoint", &self.checkpoint).finish_non_exhaustive()
    }
}

/// A file in which a render keeps its finished tiles, and from which it goes on.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Checkpoint {
    /// The file.
    path: PathBuf,
    /// A digest of all that decides the picture.
    fingerprint: String,
}

impl Checkpoint {
    /// In this folder, which is made if it is not there, for the picture with this fingerprint: a digest of all that
    /// decides it, without blanks.
    pub fn new(folder: &Path, fingerprint: String) -> Self {
        Self { path: folder.join("render.tiles"), fingerprint }
    }

    /// Removes the file, once the picture is safe.
    ///
    /// # Errors
    /// A file that cannot be removed.
    pub fn remove(&self) -> Result<(), RenderError> {
        TileFile::remove(&self.path)
    }
}

/// Renders a scene.
///
/// # Errors
/// An interruption, a checkpoint that cannot be used, or a material that gives something that is no number.
///
/// # Panics
/// If `resolution` has no pixels or no samples, or more samples than there are.
pub fn render(
    scene: &Scene,
    resolution: Resolution,
    settings: Settings,
    control: &Control<'_>,
) -> Result<Picture, RenderError> {
    let Resolution { width, height, samples } = resolution;
    assert!(width > 0 && height > 0, "a picture has pixels");
    assert!((1..=super::MOST_SAMPLES).contains(&samples), "a pixel has 1 to 65536 samples");
    let integrator = Integrator::new(scene, settings);
    let tiles = tiles(width, height);
    let (file, mut finished) = match control.checkpoint {
        Some(checkpoint) => {
            let (file, finished) = TileFile::open(&checkpoint.path, &checkpoint.fingerprint)?;
            (Some(Mutex::new(file)), finished)
        }
        None => (None, Tiles::new()),
    };
    let done = AtomicUsize::new(finished.len());
    (control.progress)(finished.len(), tiles.len());

    let missing: Vec<(u32, Tile)> =
        (0..).zip(tiles.iter().copied()).filter(|(n, _)| !finished.contains_key(n)).collect();
    let made: Vec<Option<(u32, Vec<[f32; 3]>)>> = missing
        .into_par_iter()
        .map(|(number, tile)| {
            let Some(pixels) = render_tile(&integrator, resolution, &tile, control)? else { return Ok(None) };
            if let Some(file) = &file {
                // What a thread that panicked has left ends in a record that does not count.
                file.lock().unwrap_or_else(PoisonError::into_inner).add(number, &pixels)?;
            }
            (control.progress)(done.fetch_add(1, Ordering::Relaxed) + 1, tiles.len());
            Ok(Some((number, pixels)))
        })
        .collect::<Result<_, RenderError>>()?;
    finished.extend(made.into_iter().flatten());
    if finished.len() < tiles.len() {
        return Err(RenderError::Interrupted { done: finished.len(), total: tiles.len() });
    }
    Ok(assembled(width, height, &tiles, &finished))
}

/// Tiles in rows from the upper left corner.
fn tiles(width: u32, height: u32) -> Vec<Tile> {
    let [columns, rows] = TILE;
    let mut tiles = Vec::new();
    for y in (0..height).step_by(rows as usize) {
        for x in (0..width).step_by(columns as usize) {
            tiles.push(Tile { x, y, width: columns.min(width - x), height: rows.min(height - y) });
        }
    }
    tiles
}

/// The mean of a tile's samples; None if the caller asked to stop.
fn render_tile(
    integrator: &Integrator<'_>,
    resolution: Resolution,
    tile: &Tile,
    control: &Control<'_>,
) -> Result<Option<Vec<[f32; 3]>>, RenderError> {
    let mut workspace = Workspace::default();
    let mut sums = vec![[0.0; 3]; (tile.width * tile.height) as usize];
    let arch = pulp::Arch::new();
    for index in 0..resolution.samples {
        if control.interrupt.load(Ordering::Relaxed) {
            return Ok(None);
        }
        let size = [resolution.width, resolution.height];
        arch.dispatch(Sample { integrator, size, tile, index, workspace: &mut workspace, sums: &mut sums });
    }
    let scale = 1.0 / f64::from(resolution.samples);
    #[expect(clippy::cast_possible_truncation, reason = "a picture holds 32-bit numbers")]
    let mean = |sum: &[f64; 3]| sum.map(|channel| (channel * scale) as f32);
    let pixels: Vec<[f32; 3]> = sums.iter().map(mean).collect();
    match (0..).zip(&pixels).find(|(_, pixel)| pixel.iter().any(|channel| !channel.is_finite())) {
        Some((place, _)) => {
            let place: u32 = place;
            Err(RenderError::NotFinite { x: tile.x + place % tile.width, y: tile.y + place / tile.width })
        }
        None => Ok(Some(pixels)),
    }
}

/// One sample of each pixel of a tile, in the form in which it is compiled once for each instruction set.
struct Sample<'a> {
    integrator: &'a Integrator<'a>,
    size: [u32; 2],
    tile: &'a Tile,
    index: u32,
    workspace: &'a mut Workspace,
    sums: &'a mut [Colour],
}

impl pulp::NullaryFnOnce for Sample<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.integrator.add_sample(self.size, self.tile, self.index, self.workspace, self.sums);
    }
}

fn assembled(width: u32, height: u32, tiles: &[Tile], finished: &Tiles) -> Picture {
    let mut pixels = vec![[0.0; 3]; width as usize * height as usize];
    for (tile, made) in tiles.iter().zip(finished.values()) {
        for (row, made) in (tile.y as usize..).zip(made.chunks(tile.width as usize)) {
            let start = row * width as usize + tile.x as usize;
            pixels[start..start + made.len()].copy_from_slice(made);
        }
    }
    Picture { width, height, pixels }
}
