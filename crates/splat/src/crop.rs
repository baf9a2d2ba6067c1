//! A picture in crops: each is summed by itself, from parts of the light field one after the other; joined, they are the whole
//! picture, bit for bit.
//!
//! ```text
//! let mut sums = CropSums::new(&options);                 // a crop of the picture
//! sums.add(&part_of_the_light_field, …)?;                 // all parts whose light may reach it, in any order
//! let picture = sums.picture(progress)?;                  // numbers, which may go to a file
//!
//! let mut joiner = CropJoiner::new(size, is_painted);     // the whole picture
//! joiner.add_knots(y, …); joiner.find_gains();            // gains are computed from knots, row by row
//! joiner.add_shared(y, &mut row); joiner.find_rest();     // of a painted picture
//! joiner.join(y, form, &mut row);                         // a row of the picture
//! ```
//!
//! Sums are integers, and nodes are drawn at their position in the whole picture. Decisions about the whole picture are left to the
//! joiner: gains, for which crops store the contribution of each of their rows to the knots ([`crate::resolve::knots`]); whether
//! anything is painted; and whether its integers are the finest that hold it ([`Integers`]).

mod integers;
mod joiner;
mod picture;
mod row;
mod sums;

pub use integers::{Integers, Kind};
pub use joiner::CropJoiner;
pub use picture::{CropFacts, CropPicture};
pub use row::{CropForm, CropRow, KNOT_NUMBERS};
pub use sums::{CropError, CropOptions, CropSums};

use crate::resolve::knots::SPACING;

/// A part of a picture, px.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crop {
    /// The first column and row: multiples of [`Self::ALIGNMENT`].
    pub corner: [u32; 2],
    /// Columns and rows: multiples of it, too, but where the picture ends.
    pub size: [u32; 2],
}

impl Crop {
    /// Crops meet at multiples of this, px: the distance of the knots of gains.
    pub const ALIGNMENT: u32 = SPACING as u32;
}

#[cfg(test)]
mod tests;
