//! Splats as KSPLAT and as plain records.
#![no_main]

fuzz::target!(fuzz::splats::ksplat);
