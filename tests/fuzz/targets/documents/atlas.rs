//! Cached atlases.
#![no_main]

fuzz::target!(fuzz::documents::atlas);
