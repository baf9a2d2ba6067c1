//! Splats as SOG.
#![no_main]

fuzz::target!(fuzz::splats::sog, mutated by fuzz::sealing::zip);
