//! Finished tiles on disk, so that an interrupted render can be picked up.
//!
//! The file is a line that says which picture it belongs to and then one record a tile, in the order in which tiles were
//! finished: its number, its length, its pixels, and a digest of these. A record that was cut off by a kill does not match
//! its digest; it and what follows is thrown away.

use std::collections::BTreeMap;
use std::fs::{self, File, OpenOptions};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use super::error::RenderError;

/// Bytes of a record before its pixels, and of the digest after them.
const HEAD: usize = 8;
const DIGEST: usize = 16;
const PIXEL: usize = 12;

/// Pixels of finished tiles, by their number.
pub(super) type Tiles = BTreeMap<u32, Vec<[f32; 3]>>;

/// An open file of finished tiles.
#[derive(Debug)]
pub(super) struct TileFile {
    path: PathBuf,
    file: File,
}

impl TileFile {
    /// Opens or makes the file of the picture with this fingerprint, and gives the tiles that are in it.
    pub(super) fn open(path: &Path, fingerprint: &str) -> Result<(Self, Tiles), RenderError> {
        let failed = |done, error: &io::Error| system(path, done, error);
        let title = format!("barbule render tiles 1 {fingerprint}\n");
        let bytes = match fs::read(path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == ErrorKind::NotFound => Vec::new(),
            Err(error) => return Err(failed("read", &error)),
        };
        // A file that was killed in its first line is as good as none.
        let begun = !title.as_bytes().starts_with(&bytes);
        if begun && !bytes.starts_with(title.as_bytes()) {
            return Err(RenderError::AnotherPicture { path: path.to_owned() });
        }
        let (tiles, whole) = if begun { records(&bytes, title.len()) } else { (BTreeMap::new(), 0) };
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder).map_err(|error| failed("written", &error))?;
        }
        let open = || {
            let mut file = OpenOptions::new().create(true).append(true).open(path)?;
            file.set_len(whole as u64)?;
            if !begun {
                file.write_all(title.as_bytes())?;
            }
            Ok(file)
        };
        let file = open().map_err(|error| failed("written", &error))?;
        Ok((Self { path: path.to_owned(), file }, tiles))
    }

    /// Adds a finished tile.
    pub(super) fn add(&mut self, number: u32, pixels: &[[f32; 3]]) -> Result<(), RenderError> {
        let mut record = Vec::with_capacity(HEAD + PIXEL * pixels.len() + DIGEST);
        record.extend(number.to_le_bytes());
        record.extend(u32::try_from(pixels.len()).unwrap_or(u32::MAX).to_le_bytes());
        record.extend(pixels.iter().flatten().flat_map(|channel| channel.to_le_bytes()));
        let digest = digest(&record);
        record.extend(digest);
        self.file.write_all(&record).map_err(|error| system(&self.path, "written", &error))
    }

    /// Removes the file, once the picture is safe, and its folder if nothing else is in it.
    pub(super) fn remove(path: &Path) -> Result<(), RenderError> {
        fs::remove_file(path).map_err(|error| system(path, "removed", &error))?;
        match path.parent().map(fs::remove_dir) {
            Some(Err(error)) if error.kind() != ErrorKind::DirectoryNotEmpty => Err(system(path, "removed", &error)),
            _ => Ok(()),
        }
    }
}

/// The whole records after the title, and where the last of them ends.
fn records(bytes: &[u8], start: usize) -> (Tiles, usize) {
    let (mut tiles, mut place) = (BTreeMap::new(), start);
    while let Some((number, pixels, length)) = record(&bytes[place..]) {
        tiles.insert(number, pixels);
        place += length;
    }
    (tiles, place)
}

fn record(bytes: &[u8]) -> Option<(u32, Vec<[f32; 3]>, usize)> {
    let (number, rest) = bytes.split_first_chunk()?;
    let (count, rest) = rest.split_first_chunk()?;
    let count = usize::try_from(u32::from_le_bytes(*count)).ok()?;
    let length = count.checked_mul(PIXEL)?;
    let pixels = rest.get(..length)?;
    if rest.get(length..length + DIGEST)? != digest(&bytes[..HEAD + length]) {
        return None;
    }
    let number_of = |bytes: &[u8; 4]| f32::from_le_bytes(*bytes);
    let pixels = pixels.as_chunks::<4>().0.as_chunks::<3>().0.iter().map(|pixel| pixel.each_ref().map(number_of));
    Some((u32::from_le_bytes(*number), pixels.collect(), HEAD + length + DIGEST))
}

fn digest(bytes: &[u8]) -> [u8; DIGEST] {
    let whole = Sha256::digest(bytes);
    std::array::from_fn(|byte| whole[byte])
}

fn system(path: &Path, done: &'static str, error: &io::Error) -> RenderError {
    RenderError::Checkpoint { path: path.to_owned(), done, reason: error.to_string() }
}
