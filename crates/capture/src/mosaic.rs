//! Mosaics of micro-images: a whole light field as one picture.
//!
//! Behind each micro-lens of a plenoptic camera of the first kind lie as many pixels as the light field has views: pixel (u, v) of every
//! micro-image, put together, is the view of column u and row v. Lytro's ESLF pictures are such mosaics (14 × 14 or 15 × 15), without the
//! margins and rotations of a raw one. `picture` reads views of them, `pitch` detects the width of micro-images, `micro_images` creates them.

mod micro_images;
mod picture;
mod pitch;
mod png_rows;

pub use micro_images::micro_images;
pub use picture::Mosaic;
pub(crate) use pitch::detect_pitch;
