mod coated_base;
mod optics;
