//! The picture with a margin around it.

use crate::mesh::cells::Grid;

/// A grid with the picture in its middle.
pub(crate) struct Frame {
    pub grid: Grid,
    /// Cells of the margin on each side.
    pub margin: usize,
}

impl Frame {
    /// The frame of a picture of `width` × `height` px, with `margin` pixels on every side.
    pub fn new([width, height]: [usize; 2], margin: usize) -> Self {
        Self { grid: Grid { width: width + 2 * margin, height: height + 2 * margin }, margin }
    }

    /// Columns and rows of the picture, without margin.
    pub fn picture(&self) -> [usize; 2] {
        [self.grid.width - 2 * self.margin, self.grid.height - 2 * self.margin]
    }

    /// One value for each cell: the picture's, and in the margin those at its border.
    pub fn continued<T: Copy>(&self, values: &[T]) -> Vec<T> {
        (0..self.grid.count()).map(|cell| values[self.pixel(cell)]).collect()
    }

    /// The index of the picture's pixel at a cell; in the margin, of the nearest one.
    pub fn pixel(&self, cell: usize) -> usize {
        let [width, height] = self.picture();
        let x = (cell % self.grid.width).clamp(self.margin, self.margin + width - 1) - self.margin;
        let y = (cell / self.grid.width).clamp(self.margin, self.margin + height - 1) - self.margin;
        y * width + x
    }

    /// Whether a cell is one of the picture's pixels, not in the margin.
    pub fn is_in_picture(&self, cell: usize) -> bool {
        let [width, height] = self.picture();
        let (x, y) = (cell % self.grid.width, cell / self.grid.width);
        (self.margin..self.margin + width).contains(&x) && (self.margin..self.margin + height).contains(&y)
    }
}
