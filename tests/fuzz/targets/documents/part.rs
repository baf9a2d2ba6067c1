//! Parts of pictures, with the right seal after each change.
#![no_main]

fuzz::target!(fuzz::documents::part, mutated by fuzz::sealing::sealed);
