//! What is seen behind others, by size: in larger cells, what is farthest there.

use super::cells::{LEVELS, MAX_RADIUS_CELLS, NEARER_SHARE, Value, add_share, cells_within};

/// What is farthest in cells.
pub(super) struct Behind {
    side: usize,
    size: [usize; 2],
    cells: Vec<(Value, f32)>,
}

impl Behind {
    /// By level.
    pub fn pyramid(size: [usize; 2], values: &[Value], depths: &[f32]) -> Vec<Self> {
        let cells = std::iter::zip(values, depths).map(|(&value, &depth)| (value, depth)).collect();
        let mut pyramid = vec![Self { side: 1, size, cells }];
        while pyramid.len() < LEVELS {
            pyramid.push(pyramid[pyramid.len() - 1].halved());
        }
        pyramid
    }

    fn halved(&self) -> Self {
        let size = self.size.map(|side| side.div_ceil(2));
        let cell = |index: usize| {
            let [column, row] = [2 * (index % size[0]), 2 * (index / size[0])];
            let rows = row..(row + 2).min(self.size[1]);
            let own = || {
                let columns = column..(column + 2).min(self.size[0]);
                rows.clone().flat_map(move |row| {
                    columns.clone().map(move |column| self.cells[row * self.size[0] + column])
                })
            };
            let farthest = own().map(|(_, depth)| depth).fold(0.0, f32::max);
            let (mut sum, mut count) = ([0.0f32; 4], 0.0);
            for (value, _) in own().filter(|(_, depth)| *depth >= farthest * (1.0 - NEARER_SHARE)) {
                for c in 0..4 {
                    sum[c] += value[c];
                }
                count += 1.0;
            }
            (sum.map(|c| c / count), farthest)
        };
        Self { side: 2 * self.side, size, cells: (0..size[0] * size[1]).map(cell).collect() }
    }

    /// The sum of what is farther than a depth, within a radius (px) of a place (px).
    pub fn sum_around(&self, place: [f32; 2], radius: f32, depth: f32) -> [f32; 5] {
        let per_cell = 1.0 / self.side as f32;
        let [x, y] = [place[0] * per_cell, place[1] * per_cell];
        let radius = (radius * per_cell).min(MAX_RADIUS_CELLS);
        let mut sum = [0.0f32; 5];
        for row in cells_within(y, radius + 0.5, self.size[1]) {
            for column in cells_within(x, radius + 0.5, self.size[0]) {
                let ([r, g, b, coverage], cell_depth) = self.cells[row * self.size[0] + column];
                let (dx, dy) = (column as f32 + 0.5 - x, row as f32 + 0.5 - y);
                let share = (radius - (dx * dx + dy * dy).sqrt() + 0.5).clamp(0.0, 1.0);
                if cell_depth > depth {
                    add_share(&mut sum, &[r, g, b, coverage, 1.0], share);
                }
            }
        }
        sum
    }
}
