//! VisualSFM's cameras.
#![no_main]

fuzz::target!(fuzz::captures::visualsfm);
