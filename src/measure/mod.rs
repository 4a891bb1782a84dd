//! Measurements: the geometry of a reading, tables of readings, the instrument that took them, and colour.

mod geometry;
mod instrument;
mod peak;
mod table;
mod thin_film_law;

pub use geometry::Geometry;
pub use instrument::{Aperture, Band, Calibration, Instrument};
pub use peak::{Peak, PeakModel, find_peaks, mirror_cosine};
pub use table::{GonioTable, PeakReading, PeakTable, Quantity, Spectrum};
pub use thin_film_law::{PhaseJumps, ThinFilmLaw, ThinFilmLawDesign};
