//! `focus-brush`: the window and the command line.

fn main() {}
