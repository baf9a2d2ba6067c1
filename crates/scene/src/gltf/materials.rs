//! The materials of a file: their properties, textures, images and variants.

pub(crate) mod image_file;
pub(crate) mod lenient_properties;
pub(crate) mod material_reader;
pub(crate) mod radiance_file;
pub(crate) mod texture_info;
pub(crate) mod texture_reader;
pub(crate) mod variants;
