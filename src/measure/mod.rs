//! Measurements: the geometry of a reading, tables of readings, the instrument that took them, colour, and
//! photographs.

pub mod colour;
mod compared;
mod error;
mod geometry;
mod guess;
mod instrument;
mod layout;
mod peak;
pub mod photograph;
mod read;
mod table;
mod text;
mod thin_film_law;

pub use compared::Compared;
pub use error::{Place, TableError, TableProblem};
pub use geometry::Geometry;
pub use guess::{Certainty, Guess, GuessNote, guess_layout};
pub use instrument::{Aperture, Band, Calibration, Instrument};
pub use layout::{
    AngleUnit, Angles, Cell, Delimiter, FourAngles, LongColumns, Negative, PeaksLayout, PerColumn, SigmaLayout, Source,
    SpectraColumns, SpectraLayout, TableLayout, TextFormat, WavelengthUnit, WideAngles, WideColumns,
};
pub use peak::{Peak, PeakModel, find_peaks, mirror_cosine};
pub use read::read_table;
pub use table::{GonioTable, Origin, PeakReading, PeakTable, Quantity, Spectrum, Table};
pub use text::TableText;
pub use thin_film_law::{PhaseJumps, ThinFilmLaw, ThinFilmLawDesign};
