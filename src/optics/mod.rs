//! Interfaces, films, materials and microfacets. Knows nothing of what is above it.
//!
//! Conventions (all files): light has the time factor e^{−iωt}, a complex index is n + ik with k ≥ 0, angles are counted
//! from the normal, and of two roots of n cosθ the one with a positive imaginary part is taken. For a medium of index n
//! in a stack, q = n cosθ = √(n² − n₀² sin²θ₀): the product n₀ sinθ₀ is the same in every layer (Snell), so no angle is
//! ever computed inside.
//!
//! [`film`] and [`stack`] are the readable reference, with amplitudes, one wavelength at a time. [`LayeredMedium`] gives
//! the unpolarised reflectance of the same things over many channels at once, which is what a fit evaluates a million
//! times; it is tested against the reference.

pub(crate) mod elementary;
mod entering_light;
pub mod film;
mod film_kernel;
pub mod fresnel;
mod ggx;
mod layered;
mod material;
mod materials;
pub mod microfacet;
mod mirror_facets;
mod note;
mod polarised;
mod quadrature;
mod rough_interface;
mod rough_transmittance;
pub mod stack;
mod stack_kernel;
mod visible_normals;

pub use entering_light::{EnteringLight, FacetKernel};
pub use layered::{Arrangement, LayeredMedium, Permittivity, double_wavenumbers};
pub use material::{Dispersion, IndexTable, MaterialError};
pub use materials::{Certainty, KnownMaterial, known_material, known_materials};
pub use note::{MaterialNote, Reference};
pub use polarised::{Amplitudes, Polarised, Response};
pub(crate) use quadrature::gauss_legendre;
pub use rough_interface::RoughInterface;
pub use rough_transmittance::{RoughTransmittance, TransmittanceCurve, TransmittanceCurves};
