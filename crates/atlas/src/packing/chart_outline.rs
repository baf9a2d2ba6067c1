//! The outline of a chart in texels, as the packer uses it.

use glam::DVec2;

/// For each column of a chart, the lowest and highest row that it touches, as a half-open range, without its gutter.
#[derive(Clone, Debug)]
pub(crate) struct ChartOutline {
    /// Touched rows of each column.
    pub columns: Vec<(u32, u32)>,
    /// Rows in all.
    pub height: u32,
}

impl ChartOutline {
    /// The outline of triangles, in texels; their coordinates start at 0.
    pub fn new(triangles: impl Iterator<Item = [DVec2; 3]> + Clone) -> Self {
        let high = triangles.clone().flatten().fold(DVec2::ZERO, DVec2::max);
        let (width, height) = (texel_extent(high.x), texel_extent(high.y));
        let mut columns = vec![(u32::MAX, 0); width as usize];
        for triangle in triangles {
            for k in 0..3 {
                add_edge(&mut columns, triangle[k], triangle[(k + 1) % 3], height);
            }
        }
        Self { columns, height }
    }

    /// The number of columns of texels.
    pub fn width(&self) -> u32 {
        self.columns.len() as u32
    }

    /// The outline with a gutter of `margin` texels all round; it starts `margin` left of and above the chart.
    pub fn grown(&self, margin: u32) -> ChartOutline {
        let m = margin as usize;
        let columns = (0..self.columns.len() + 2 * m).map(|column| {
            let from = column.saturating_sub(2 * m);
            let to = (column + 1).min(self.columns.len());
            let touched = self.columns[from..to].iter().filter(|(low, high)| low < high);
            let none = (u32::MAX, 0);
            let (low, high) = touched.fold(none, |(low, high), c| (low.min(c.0), high.max(c.1)));
            // Chart row r is grown row r + margin, and its gutter extends margin further both ways.
            if low < high { (low, high + 2 * margin) } else { none }
        });
        ChartOutline { columns: columns.collect(), height: self.height + 2 * margin }
    }
}

/// Number of texels that an interval from 0 of this length touches, at least one.
pub(crate) fn texel_extent(length: f64) -> u32 {
    (length.ceil() as u32).max(1)
}

fn add_edge(columns: &mut [(u32, u32)], from: DVec2, to: DVec2, height: u32) {
    let (left, right) = if from.x <= to.x { (from, to) } else { (to, from) };
    let last = columns.len() - 1;
    let first = (left.x as usize).min(last);
    let slope = if right.x > left.x { (right.y - left.y) / (right.x - left.x) } else { 0.0 };
    let touched = &mut columns[first..=(right.x as usize).min(last)];
    for (column, range) in (first..).zip(touched) {
        let y_at = |x: f64| {
            let between = left.y + slope * (x - left.x);
            if x <= left.x {
                left.y
            } else if x >= right.x {
                right.y
            } else {
                between
            }
        };
        let upright = left.x == right.x;
        let (y0, y1) =
            if upright { (left.y, right.y) } else { (y_at(column as f64), y_at(column as f64 + 1.0)) };
        let low = (y0.min(y1) as u32).min(height - 1);
        let high = (y0.max(y1).ceil() as u32).clamp(low + 1, height);
        *range = (range.0.min(low), range.1.max(high));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_triangle_has_a_sloped_outline() {
        let triangle = [DVec2::ZERO, DVec2::new(3.0, 0.0), DVec2::new(0.0, 2.9)];
        let shape = ChartOutline::new(std::iter::once(triangle));
        assert_eq!((shape.columns.as_slice(), shape.height), ([(0, 3), (0, 2), (0, 1)].as_slice(), 3));
        let grown = shape.grown(1);
        assert_eq!(grown.columns, [(0, 5), (0, 5), (0, 5), (0, 4), (0, 3)]);
    }
}
