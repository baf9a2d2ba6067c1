//! The windows of OpenEXR: rectangles of pixels in one plane.
//!
//! The *display window* is the picture; the *data window* is the region that a file has pixels of. Compositors write
//! more than the picture (overscan), or only the bounding box of what is not empty.

use exr::meta::attribute::IntegerBounds;

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Window {
    /// Column and row of its upper left pixel.
    pub corner: [i32; 2],
    /// Columns and rows.
    pub size: [usize; 2],
}

impl Window {
    /// The window with a decoder's bounds.
    pub fn from_bounds(bounds: IntegerBounds) -> Self {
        Self {
            corner: [bounds.position.x(), bounds.position.y()],
            size: [bounds.size.width(), bounds.size.height()],
        }
    }

    /// The number of pixels.
    pub fn area(&self) -> usize {
        self.size[0] * self.size[1]
    }

    /// The number of pixels that are also in another window.
    pub fn shared_area(&self, other: Self) -> usize {
        (0..2).map(|axis| self.shared_span(other, axis).1).product()
    }

    /// The values of this window's pixels, row by row: from `values` of `data_window`, and `absent` outside it.
    pub fn crop(&self, data_window: Self, values: Vec<f32>, absent: f32) -> Vec<f32> {
        if *self == data_window {
            return values;
        }
        let [(columns, width), (rows, height)] = [0, 1].map(|axis| self.shared_span(data_window, axis));
        let mut cut = vec![absent; self.area()];
        for row in 0..height {
            let from = (rows[1] + row) * data_window.size[0] + columns[1];
            let to = (rows[0] + row) * self.size[0] + columns[0];
            cut[to..to + width].copy_from_slice(&values[from..from + width]);
        }
        cut
    }

    /// The overlap with another window along an axis: where it begins in each, and its length.
    fn shared_span(&self, other: Self, axis: usize) -> ([usize; 2], usize) {
        let [[start, end], [other_start, other_end]] = [*self, other].map(|window| {
            let start = i64::from(window.corner[axis]);
            [start, start + window.size[axis] as i64]
        });
        let first = start.max(other_start);
        let length = end.min(other_end) - first;
        if length <= 0 {
            return ([0; 2], 0);
        }
        ([start, other_start].map(|start| (first - start) as usize), length as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values that encode their position in the plane.
    fn values(window: Window) -> Vec<f32> {
        let pixel = |n: usize| {
            let (x, y) = (n % window.size[0], n / window.size[0]);
            (window.corner[0] as f32 + x as f32) * 1000.0 + window.corner[1] as f32 + y as f32
        };
        (0..window.area()).map(pixel).collect()
    }

    #[test]
    fn every_pixel_is_where_it_lies_in_the_plane() {
        let display = Window { corner: [-2, 3], size: [5, 4] };
        for corner in [[-2, 3], [-9, -9], [0, 4], [-4, 5], [2, 6], [3, 3], [-2, 7], [i32::MAX / 4, 0]] {
            for size in [[5, 4], [1, 1], [2, 9], [30, 30]] {
                let data = Window { corner, size };
                let cut = display.crop(data, values(data), -1.0);
                let mut shared = 0;
                for (n, (cropped, all)) in cut.iter().zip(values(display)).enumerate() {
                    let place = [n % 5, n / 5].map(|n| n as i64);
                    let is_in = (0..2).all(|k| {
                        let from_corner = i64::from(display.corner[k]) + place[k] - i64::from(data.corner[k]);
                        (0..data.size[k] as i64).contains(&from_corner)
                    });
                    shared += usize::from(is_in);
                    assert_eq!(*cropped, if is_in { all } else { -1.0 }, "{data:?} {n}");
                }
                assert_eq!(display.shared_area(data), shared);
            }
        }
    }
}
