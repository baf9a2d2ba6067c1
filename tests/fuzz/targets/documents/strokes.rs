//! Recorded strokes.
#![no_main]

fuzz::target!(fuzz::documents::strokes);
