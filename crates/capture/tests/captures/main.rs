//! Captures as people have them, and as nobody should: opened by what the crate shows of itself.

mod formats;
mod hostile;
mod made;
mod meshes;
mod mutants;
#[path = "../../../scene/tests/mutation/mod.rs"]
mod mutation;
mod skull;
mod traps;
