//! Lists of a splat scene's cameras.
#![no_main]

fuzz::target!(fuzz::splats::cameras_json);
