//! What is drawn on.

use crate::canvas::{Rows, Word};
use crate::draw::sized_box::{UnsizedBox, too_blurred};
use crate::draw::small::SmallBoxes;
use crate::draw::visible_runs::VisibleRun;
use numerics::with_widest_simd;

/// Some rows of a level, and what waits to be drawn on them.
pub struct Paper<'a, W> {
    /// The rows that are drawn on.
    pub rows: Rows<'a, W>,
    small: SmallBoxes,
    /// See [`too_blurred`].
    too_blurred: u32,
    /// Room to work in.
    pub runs: Vec<VisibleRun>,
}

impl<'a, W: Word> Paper<'a, W> {
    /// A paper on which nothing waits to be drawn; `rows` are those of level `level`.
    pub fn new(rows: Rows<'a, W>, level: u8) -> Self {
        Self { rows, small: SmallBoxes::default(), too_blurred: too_blurred(level), runs: Vec::new() }
    }

    /// Adds a small box (`sign` 1) or takes one away (−1). It waits until it is drawn with others.
    #[inline(always)]
    pub fn add(&mut self, unsized_box: &UnsizedBox, sign: i32) {
        self.small.add(unsized_box);
        if self.small.is_full() {
            self.finish(sign);
        }
    }

    /// Draws the boxes that wait, with this sign.
    pub fn finish(&mut self, sign: i32) {
        if self.small.is_empty() {
            return;
        }
        // Compiled for either sign.
        if sign > 0 {
            with_widest_simd(
                #[inline(always)]
                || self.small.draw(&mut self.rows, self.too_blurred, 1),
            );
        } else {
            with_widest_simd(
                #[inline(always)]
                || self.small.draw(&mut self.rows, self.too_blurred, -1),
            );
        }
    }
}
