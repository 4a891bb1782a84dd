mod cylinder;
mod optics;
mod pigment;
