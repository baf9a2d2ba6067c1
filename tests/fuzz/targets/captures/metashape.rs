//! Metashape's cameras.
#![no_main]

fuzz::target!(fuzz::captures::metashape);
