//! Worlds.
#![no_main]

fuzz::target!(fuzz::documents::world);
