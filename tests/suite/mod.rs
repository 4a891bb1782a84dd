mod coated_base;
mod optics;
mod oracle;
mod rough_plastic;
