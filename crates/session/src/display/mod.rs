//! How linear light is shown on a screen.
//!
//! Tone, the pixels as the screen has them, and what of them changed since somebody looked.

mod enlarging;
mod glare;
mod live_picture;
mod ocio_views;
mod picture_ring;
mod screen;
mod thumbnails;
mod tone;
mod tone_curve;

pub use enlarging::enlarged;
pub use live_picture::LivePicture;
pub use ocio_views::OcioViews;
pub use screen::Screen;
pub use thumbnails::{Thumbnail, ThumbnailResult, Thumbnails};
pub use tone::{Display, ScreenPixel, Tone, to_screen};
pub use tone_curve::ToneCurve;

pub(crate) use enlarging::{enlarged_part, enlarged_rectangle};
pub(crate) use glare::darkening_stops;
pub(crate) use live_picture::PictureSource;
pub(crate) use picture_ring::{PictureRing, Rectangle, whole};
pub(crate) use screen::{Content, Patch};
pub(crate) use tone::rectangle_to_screen;
