//! Light fields, with the right checksum after each change.
#![no_main]

fuzz::target!(fuzz::documents::salf, mutated by fuzz::sealing::sealed);
