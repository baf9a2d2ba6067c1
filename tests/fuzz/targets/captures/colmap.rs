//! COLMAP's models, as text and binary.
#![no_main]

fuzz::target!(fuzz::captures::colmap);
