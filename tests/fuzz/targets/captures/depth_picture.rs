//! Pictures with depth in them.
#![no_main]

fuzz::target!(fuzz::captures::depth_picture);
