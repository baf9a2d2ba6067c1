//! Cameras and lenses.
#![no_main]

fuzz::target!(fuzz::documents::camera);
