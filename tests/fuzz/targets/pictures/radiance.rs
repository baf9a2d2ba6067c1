//! Radiance HDR pictures.
#![no_main]

fuzz::target!(fuzz::pictures::radiance);
