//! Presets of brushes, lenses and bokeh.
#![no_main]

fuzz::target!(fuzz::documents::preset);
