//! Splats as PLY, standard and compressed.
#![no_main]

fuzz::target!(fuzz::splats::splat_ply);
