mod coated_base;
mod directions;
mod granier;
mod microfacet;
mod optics;
mod oracle;
mod rough_plastic;
