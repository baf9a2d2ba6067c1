//! Splats as SPZ.
#![no_main]

fuzz::target!(fuzz::splats::spz, mutated by fuzz::sealing::gzip);
