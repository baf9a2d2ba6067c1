//! glTF scenes, as text or binary.
#![no_main]

fuzz::target!(fuzz::scenes::gltf, mutated by fuzz::sealing::glb);
