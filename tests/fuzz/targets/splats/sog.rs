//! Splats as SOG.
#![no_main]

fuzz::target!(fuzz::splats::sog);
