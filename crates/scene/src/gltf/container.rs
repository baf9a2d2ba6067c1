//! The outer layers of a file: GLB chunks, JSON text, the files and data it refers to.

pub(crate) mod attribute_name;
pub(crate) mod data_uri;
pub(crate) mod file_reference;
pub(crate) mod glb_chunks;
pub(crate) mod json_object;
pub(crate) mod json_text;
pub(crate) mod percent_encoding;
