mod cylinder;
mod optics;
