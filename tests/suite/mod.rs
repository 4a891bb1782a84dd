//! Table of contents.

mod checkpoint;
mod coated_base;
mod colour;
mod command_line;
mod coverage;
mod cylinder;
mod data;
mod desk;
mod directions;
mod engine;
mod granier;
mod jacobian;
mod jobs;
mod microfacet;
mod nist;
mod optics;
mod oracle;
mod order;
mod paints;
mod pigment;
mod report;
mod rough_plastic;
mod schema;
mod tables;
mod twins;
