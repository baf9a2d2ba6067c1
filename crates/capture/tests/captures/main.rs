//! Captures as people have them, and malicious ones, opened through the public interface of the crate.

mod depth_pictures;
mod formats;
mod hostile;
mod light_fields;
mod light_mutants;
mod made;
mod made_light;
mod mesh_fits;
mod meshes;
mod mosaics;
mod mutants;
#[path = "../../../scene/tests/mutation/mod.rs"]
mod mutation;
mod rigs;
mod skull;
mod traps;
