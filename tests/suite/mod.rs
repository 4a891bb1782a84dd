mod colour;
mod data;
mod report;
mod tables;
