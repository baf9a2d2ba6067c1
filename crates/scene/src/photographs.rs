//! Photographs: views with their pixels and masks, and surfaces made from pictures.

mod linear_conversion;
mod mask;
mod photograph;
mod picture_gloss;
mod picture_texture;
mod view;

pub use mask::Mask;
pub use photograph::{Photograph, PictureError};
pub use picture_gloss::PictureGloss;
pub use picture_texture::PictureTexture;
pub use view::View;
