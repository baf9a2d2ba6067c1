//! OpenEXR pictures.
#![no_main]

fuzz::target!(fuzz::pictures::openexr);
