mod coated_base;
mod directions;
mod microfacet;
mod optics;
mod oracle;
mod rough_plastic;
