//! Focus maps: PNG and OpenEXR.
#![no_main]

fuzz::target!(fuzz::documents::focus_map);
