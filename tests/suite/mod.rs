mod colour;
mod data;
mod tables;
