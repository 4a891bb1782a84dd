mod data;
mod tables;
