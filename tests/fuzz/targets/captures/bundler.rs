//! Bundler's cameras.
#![no_main]

fuzz::target!(fuzz::captures::bundler);
