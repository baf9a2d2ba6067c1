//! Meshes of captures: PLY and OBJ.
#![no_main]

fuzz::target!(fuzz::captures::mesh);
