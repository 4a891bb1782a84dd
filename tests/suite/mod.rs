//! Table of contents.

mod checkpoint;
mod coated_base;
mod colour;
mod coverage;
mod cylinder;
mod data;
mod directions;
mod engine;
mod granier;
mod jacobian;
mod microfacet;
mod nist;
mod optics;
mod oracle;
mod order;
mod paints;
mod pigment;
mod report;
mod rough_plastic;
mod tables;
mod twins;
