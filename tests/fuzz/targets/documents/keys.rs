//! Keys of the lens.
#![no_main]

fuzz::target!(fuzz::documents::keys);
