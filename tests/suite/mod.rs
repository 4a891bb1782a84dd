mod optics;
