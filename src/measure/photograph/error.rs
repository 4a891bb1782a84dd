//! What can be wrong with a photograph, each in a sentence that says what was found, what was expected and how to mend it.

use std::path::{Path, PathBuf};

use thiserror::Error;

/// A photograph that cannot be read.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{}: {problem}", file.display())]
pub struct PhotographError {
    /// The file.
    pub file: PathBuf,
    /// What is wrong.
    pub problem: PhotographProblem,
}

impl PhotographError {
    pub(super) fn new(file: &Path, problem: PhotographProblem) -> Self {
        Self { file: file.to_owned(), problem }
    }
}

/// What is wrong with a photograph.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum PhotographProblem {
    /// No such file.
    #[error("there is no such file; correct the path")]
    NotThere,
    /// The system would not let us read it.
    #[error("it cannot be read ({0}); check that the file may be read and its disk is there")]
    Unreadable(String),
    /// A folder or a device.
    #[error("found a folder or a device where a picture was expected; name the file in it")]
    NotAFile,
    /// Nothing in it.
    #[error("the file is empty; expected a JPEG, PNG, TIFF or EXR picture")]
    Empty,
    /// Its first bytes are those of no picture that is read.
    #[error(
        "found {found}, expected a JPEG, PNG, TIFF or EXR picture; open it in its own program and save it as a 16-bit TIFF or a PNG"
    )]
    UnknownFormat {
        /// What its first bytes say it is.
        found: String,
    },
    /// A camera's own format, whose first picture is a thumbnail.
    #[error(
        "the name says that this is a camera's raw file; develop it with a raw converter to a linear 16-bit TIFF, and read that with the encoding `linear`"
    )]
    Raw,
    /// More bytes than a photograph has.
    #[error("the file has {bytes} bytes, and at most {limit} are read; save a smaller copy")]
    TooManyBytes {
        /// Size found.
        bytes: u64,
        /// Largest size.
        limit: u64,
    },
    /// More pixels than fit in memory.
    #[error("its header says {width} × {height} pixels, and at most {limit} in all are read; scale it down or cut it")]
    TooManyPixels {
        /// Pixels a row.
        width: u32,
        /// Rows.
        height: u32,
        /// Most pixels.
        limit: u64,
    },
    /// No pixels at all.
    #[error("its header says {width} × {height} pixels, so that there is nothing to see; save it anew")]
    NoPixels {
        /// Pixels a row.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// The picture stops before its end.
    #[error("the {format} ends before its last row ({detail}); copy it anew from where it came")]
    Truncated {
        /// Format by its first bytes.
        format: &'static str,
        /// What is missing.
        detail: String,
    },
    /// Inks instead of light.
    #[error("found inks (CMYK), expected light: convert it to sRGB in a picture editor, and save it again")]
    Inks,
    /// A kind of its format that is not read.
    #[error(
        "this kind of {format} is not read ({detail}); save it with 8 or 16 bits a channel, or as 32-bit numbers, in RGB or grey"
    )]
    Unsupported {
        /// Format by its first bytes.
        format: &'static str,
        /// What the decoder said.
        detail: String,
    },
    /// Damaged.
    #[error(
        "the {format} is damaged ({detail}); copy it anew from where it came, or open it in a picture editor and save it again"
    )]
    Damaged {
        /// Format by its first bytes.
        format: &'static str,
        /// What the decoder said.
        detail: String,
    },
    /// The colour profile is of a kind that is not applied.
    #[error("its ICC profile {0}; convert the picture to sRGB in a picture editor, and save it with that profile")]
    Profile(String),
    /// A scan that does not say its resolution.
    #[error(
        "it was said to be a scan, and the file names no resolution (pixels per inch or centimetre); give the pixels per millimetre instead"
    )]
    NoResolution,
    /// A scale that is no scale.
    #[error("found {0} pixels per millimetre, expected a number above 0; measure a ruler in the picture")]
    Scale(f64),
    /// A rectangle that reaches out of the picture.
    #[error(
        "the rectangle {rectangle} reaches out of the picture, which has {width} × {height} pixels; correct it (x and y count from the upper left corner)"
    )]
    OutOfPicture {
        /// The rectangle, in words.
        rectangle: String,
        /// Pixels a row.
        width: usize,
        /// Rows.
        height: usize,
    },
    /// A reference that cannot serve.
    #[error("the reference {0}")]
    Reference(String),
    /// Exposures that cannot be told from EXIF.
    #[error(
        "its EXIF lacks {0}, so that its exposure cannot be told against the other photographs; give the exposure, or leave it free"
    )]
    Exposure(String),
}
