mod optics;
mod oracle;
mod rough_plastic;
