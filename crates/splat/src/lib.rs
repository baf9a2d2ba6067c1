//! SALF and focus to picture: the sum of the aperture images, in integers.

mod splatter;

pub use splatter::{Splatter, SplatError};
