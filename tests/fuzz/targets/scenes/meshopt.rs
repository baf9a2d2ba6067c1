//! meshopt's buffers in glTF.
#![no_main]

fuzz::target!(fuzz::scenes::gltf, mutated by fuzz::sealing::glb_buffer);
