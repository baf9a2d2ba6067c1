//! Showing pictures on a screen: tone-mapped pixels, and which of them changed since the last frame.

mod antialiasing;
mod defocused_layer;
mod defocusing;
mod enlarging;
mod glare;
mod hole_filling;
mod layer;
mod light_ratio;
mod live_picture;
mod picture_ring;
mod screen;
mod standing;
mod thumbnails;

pub use enlarging::enlarged;
pub use live_picture::LivePicture;
pub use screen::Screen;
pub use thumbnails::{Thumbnail, ThumbnailResult, Thumbnails};

pub(crate) use antialiasing::antialiased;
pub(crate) use defocusing::Defocused;
pub(crate) use enlarging::{enlarged_part, enlarged_rectangle};
pub(crate) use glare::darkening_stops;
pub(crate) use hole_filling::filled;
pub(crate) use layer::Layer;
pub(crate) use light_ratio::LightRatio;
pub(crate) use live_picture::PictureSource;
pub(crate) use picture_ring::{PictureRing, Rectangle, whole};
pub(crate) use screen::{Content, Patch};
pub(crate) use standing::StandingPicture;
