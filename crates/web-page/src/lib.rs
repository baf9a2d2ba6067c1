//! A picture that anyone can refocus in a browser: one HTML file that needs no server and no network.
//!
//! ```text
//! focus distances ─▶ slices (WebP, placed where the error is) ─▶ stacks ─┐
//! first surfaces ─▶ pixel maps (which distance is sharp, what is painted) ├─▶ template ─▶ page.html
//! title, author, licence ──────────────────────────────────────────────────┘        (with the viewer)
//! ```
//!
//! A *slice* is the picture at one focus distance; a *stack* holds the slices of one aperture, painted or not. Distances are handled as
//! their reciprocals 1/s, in which equal steps change the blur equally. [`place_slices`] draws a stack and measures it: each slice at
//! rest against the picture that it shows, and the cross-fade half way between two slices against the picture there. [`WebPage`] writes
//! the page. The viewer is plain JavaScript (`src/viewer`), joined to one classic inline script, so that the page works from a disk and in a
//! sandboxed frame.
//!
//! The crate draws nothing itself: pictures come from a function, already encoded for the screen.

mod base122;
mod deflate;
mod encoding;
mod engine_page;
mod error;
mod escaping;
mod page;
mod page_frame;
mod pixel_map;
mod placement;
mod screen_picture;
mod slice_spacing;
mod template;

pub use encoding::{EncodedPicture, USUAL_QUALITY, encode_picture};
pub use engine_page::EnginePage;
pub use error::WebPageError;
pub use page::{OpeningSlice, PaintMaps, Slice, SliceStack, WebPage};
pub use page_frame::{Caption, PublicAddress};
pub use pixel_map::{DistanceRange, PixelMap};
pub use placement::{PlacedSlices, PlacementOptions, PsnrSummary, place_slices};
pub use screen_picture::ScreenPicture;
pub use slice_spacing::SliceSpacing;
