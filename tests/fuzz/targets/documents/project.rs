//! Projects, with right checksums after each change.
#![no_main]

fuzz::target!(fuzz::documents::project, mutated by fuzz::sealing::project);
