//! A feather as shape: shaft, vanes and barbs from a JSON file, and the texture that a scattering model is laid on.
//!
//! ```text
//! FeatherFile ──► Feather ──► FeatherMap     a 16-bit PNG: class, tangent, coverage
//!  as typed        as checked ├─► an SVG     for people
//!                             ├─► a CSV      the barbs as polylines
//!                             └─► a summary  lengths, counts, area shares
//! ```
//!
//! The construction is that of the first thesis (Romeo Arroyo 2021, chapter 4): shaft and outlines are Bézier curves, each
//! barb a cubic from the rachis to the outline. Where the thesis samples curves and draws into a JPEG, this intersects them
//! exactly, spaces roots by arc length, and keeps the tangent of the curve itself at each texel's centre.
//!
//! **What it leaves out.** A feather is flat here. Barbs of a vane have one width and, but for random variation, one angle.
//! Barbules are the scattering model's business. Down is not drawn.

mod arc_length;
mod barb;
mod bezier;
mod check;
mod coverage;
mod crossing;
mod error;
mod feather;
mod file;
mod grid;
mod map;
mod nearest_strand;
mod place;
mod polygon;
mod polylines;
mod preview;
mod raster;
mod schema;
mod summary;
mod variation;

pub use barb::{Barb, Side};
pub use bezier::Bezier;
pub use error::{FeatherMistake, GeometryError};
pub use feather::{Feather, Shaft, Vane};
pub use file::{BarbsFile, BetweenBarbs, FeatherFile, ShaftFile, VaneFile, VariationFile};
pub use map::{FeatherMap, Texel, TexelClass};
pub use place::VanePlace;
pub use preview::Preview;
pub use schema::schemas;
pub use summary::{GeometrySummary, MapSummary, VaneSummary};
