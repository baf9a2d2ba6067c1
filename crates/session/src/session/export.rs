//! What goes out: pictures, and web pages.

mod picture;
mod web_page;

pub use picture::FullSizeFieldState;
