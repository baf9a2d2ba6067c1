//! Lists and parameters of light fields.
#![no_main]

fuzz::target!(fuzz::captures::light_field);
