//! Reading files that are not trusted: folders, text, binary data.

pub(crate) mod binary;
pub(crate) mod folder;
pub(crate) mod text;
pub(crate) mod whole_file;
