//! Measurements: the geometry of a reading, tables of readings, the instrument that took them, and colour.

mod geometry;
mod table;

pub use geometry::Geometry;
pub use table::{GonioTable, PeakReading, PeakTable, Quantity, Spectrum};
