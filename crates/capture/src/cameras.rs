//! The cameras of photographs, as reconstruction programs write them.

pub(crate) mod bundler;
pub(crate) mod camera_format;
pub(crate) mod colmap;
pub(crate) mod layout;
pub(crate) mod metashape;
pub(crate) mod nerfstudio;
pub(crate) mod nvm;
pub(crate) mod pose;
pub(crate) mod shot;
pub(crate) mod upright;
