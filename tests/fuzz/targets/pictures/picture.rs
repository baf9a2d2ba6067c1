//! Pictures: PNG, JPEG, WebP, with their colour profiles.
#![no_main]

fuzz::target!(fuzz::pictures::picture);
