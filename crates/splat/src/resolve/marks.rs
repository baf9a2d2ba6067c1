//! What the running sums of rows are at every so many columns.
//!
//! A row of every splat sums to zero, so what changes within some columns leaves the sums before and behind them as they
//! were. From a mark on, such a window is summed without the rest of its rows, and whether a pixel of the row has wrapped is
//! known from the coverage between marks.

use crate::canvas::{Pixel, Word};
use std::ops::Range;

/// Columns in memory from one mark to the next.
pub const SPAN: usize = 128;

/// A mark, and what follows up to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mark<W> {
    /// The running sum before its first column.
    pub sum: Pixel<W>,
    /// The coverage of its columns.
    pub covered: i64,
}

/// The marks of some rows, from `first` on.
#[derive(Clone, Debug, PartialEq)]
pub struct Marks<W> {
    first: i32,
    marks_a_row: usize,
    marks: Vec<Mark<W>>,
}

impl<W: Word> Marks<W> {
    /// The marks of `rows` with `columns` columns in memory: they hold nothing.
    pub fn empty(rows: Range<i32>, columns: usize) -> Self {
        let marks_a_row = columns.div_ceil(SPAN);
        Self { first: rows.start, marks_a_row, marks: vec![Mark::default(); rows.len() * marks_a_row] }
    }

    /// The marks of a row.
    #[inline(always)]
    pub fn row(&mut self, row: i32) -> &mut [Mark<W>] {
        let at = (row - self.first) as usize * self.marks_a_row;
        &mut self.marks[at..at + self.marks_a_row]
    }

    /// The memory that they take, in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.marks)
    }
}

/// The spans that hold these columns in memory and the one behind them: beside the frame's edge that is the border, where
/// what leaves the picture goes on.
pub fn spans(columns: &Range<usize>) -> Range<usize> {
    columns.start / SPAN..(columns.end + 1).div_ceil(SPAN)
}
