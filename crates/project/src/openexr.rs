//! OpenEXR files: images as named channels, their headers and windows, and how they are written.

pub(crate) mod bands;
pub(crate) mod header;
pub(crate) mod image;
pub(crate) mod options;
pub(crate) mod window;

pub use options::Compression;
