//! Reading files that are not trusted: folders, text, binary data, headers of pictures.

pub(crate) mod binary;
pub(crate) mod exif;
pub(crate) mod folder;
pub(crate) mod picture_header;
pub(crate) mod text;
pub(crate) mod whole_file;
