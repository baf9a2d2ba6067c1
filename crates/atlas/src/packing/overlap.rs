//! Whether flat triangles overlap.

use glam::DVec2;

/// How deep two triangles may reach into each other, as a fraction of the mean triangle's size: rounding of f32
/// coordinates, not a second layer.
const TOLERANCE: f64 = 1e-3;

/// Pair tests per triangle before a layout counts as overlapping: sound layouts need about ten.
const TESTS_PER_TRIANGLE: usize = 400;

/// Average number of grid cells per triangle before a layout counts as overlapping.
const CELLS_PER_TRIANGLE: usize = 256;

/// Whether any two of the triangles share more than a border. May also return true for a layout so crowded that a
/// full test would take too long.
pub(crate) fn has_overlaps(triangles: &[[DVec2; 3]]) -> bool {
    if triangles.len() < 2 {
        return false;
    }
    let total: f64 = triangles.iter().map(|&t| crate::packing::unpacked_chart::signed_area(t).abs()).sum();
    let tolerance = TOLERANCE * (total / triangles.len() as f64).sqrt();
    let boxes: Vec<(DVec2, DVec2)> = triangles.iter().map(|t| bounds(t)).collect();
    let Some(grid) = Grid::new(&boxes) else { return true };
    let mut tests = 0;
    let budget = 10_000 + TESTS_PER_TRIANGLE * triangles.len();
    for cell in 0..grid.start.len() - 1 {
        let inside = &grid.triangles[grid.start[cell] as usize..grid.start[cell + 1] as usize];
        for (i, &first) in inside.iter().enumerate() {
            for &second in &inside[i + 1..] {
                let (a, b) = (boxes[first as usize], boxes[second as usize]);
                tests += 1;
                if tests > budget {
                    return true;
                }
                let (low, high) = (a.0.max(b.0), a.1.min(b.1));
                // A pair that shares several cells is tested in the one where their common box begins.
                if low.x > high.x || low.y > high.y || grid.cell_of(low) != cell {
                    continue;
                }
                if penetration_depth(&triangles[first as usize], &triangles[second as usize]) > tolerance {
                    return true;
                }
            }
        }
    }
    false
}

/// How deep two triangles reach into each other: the smallest translation that separates them, ≤ 0 if they are apart.
fn penetration_depth(a: &[DVec2; 3], b: &[DVec2; 3]) -> f64 {
    let mut least = f64::INFINITY;
    for triangle in [a, b] {
        for k in 0..3 {
            let normal = (triangle[(k + 1) % 3] - triangle[k]).perp().normalize_or_zero();
            if normal == DVec2::ZERO {
                continue;
            }
            let span = |t: &[DVec2; 3]| {
                let d = t.map(|c| c.dot(normal));
                (d[0].min(d[1]).min(d[2]), d[0].max(d[1]).max(d[2]))
            };
            let ((a0, a1), (b0, b1)) = (span(a), span(b));
            least = least.min((a1 - b0).min(b1 - a0));
            if least <= 0.0 {
                return least;
            }
        }
    }
    least
}

fn bounds(corners: &[DVec2]) -> (DVec2, DVec2) {
    let none = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    corners.iter().fold(none, |(low, high), &c| (low.min(c), high.max(c)))
}

/// The triangles whose boxes touch each cell.
struct Grid {
    low: DVec2,
    per_length: DVec2,
    side: usize,
    start: Vec<u32>,
    triangles: Vec<u32>,
}

impl Grid {
    /// `None` if the boxes touch too many cells: long needles in disorder.
    fn new(boxes: &[(DVec2, DVec2)]) -> Option<Self> {
        let (low, high) = boxes
            .iter()
            .fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), b| (low.min(b.0), high.max(b.1)));
        let side = ((boxes.len() as f64).sqrt().ceil() as usize).clamp(1, 1024);
        let size = high - low;
        let per = |length: f64| if length > 0.0 { side as f64 / length } else { 0.0 };
        let per_length = DVec2::new(per(size.x), per(size.y));
        let mut grid = Self { low, per_length, side, start: vec![0; side * side + 1], triangles: Vec::new() };
        let mut room = 10_000 + CELLS_PER_TRIANGLE * boxes.len();
        for b in boxes {
            let ((x0, y0), (x1, y1)) = (grid.column_and_row(b.0), grid.column_and_row(b.1));
            room = room.checked_sub((x1 - x0 + 1) * (y1 - y0 + 1))?;
            grid.cells(b).for_each(|cell| grid.start[cell + 1] += 1);
        }
        for cell in 0..side * side {
            grid.start[cell + 1] += grid.start[cell];
        }
        let mut next = grid.start.clone();
        grid.triangles = vec![0; grid.start[side * side] as usize];
        for (triangle, b) in boxes.iter().enumerate() {
            for cell in grid.cells(b) {
                grid.triangles[next[cell] as usize] = triangle as u32;
                next[cell] += 1;
            }
        }
        Some(grid)
    }

    fn column_and_row(&self, p: DVec2) -> (usize, usize) {
        let at = (p - self.low) * self.per_length;
        ((at.x as usize).min(self.side - 1), (at.y as usize).min(self.side - 1))
    }

    fn cell_of(&self, p: DVec2) -> usize {
        let (column, row) = self.column_and_row(p);
        row * self.side + column
    }

    fn cells(&self, b: &(DVec2, DVec2)) -> impl Iterator<Item = usize> + use<> {
        let ((x0, y0), (x1, y1)) = (self.column_and_row(b.0), self.column_and_row(b.1));
        let side = self.side;
        (y0..=y1).flat_map(move |y| (x0..=x1).map(move |x| y * side + x))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn v(x: f64, y: f64) -> DVec2 {
        DVec2::new(x, y)
    }

    #[test]
    fn neighbours_do_not_overlap_and_a_shifted_copy_does() {
        let n = 12;
        let mut triangles = Vec::new();
        for (x, y) in (0..n * n).map(|i| ((i % n) as f64, (i / n) as f64)) {
            triangles.push([v(x, y), v(x + 1.0, y), v(x, y + 1.0)]);
            triangles.push([v(x + 1.0, y), v(x + 1.0, y + 1.0), v(x, y + 1.0)]);
        }
        assert!(!has_overlaps(&triangles));
        let copy = triangles[77].map(|c| c + v(0.05, 0.03));
        triangles.push(copy);
        assert!(has_overlaps(&triangles));
    }

    #[test]
    fn two_triangles_that_cross_without_corners_inside_overlap() {
        assert!(has_overlaps(&[
            [v(0.0, 0.0), v(9.0, 0.0), v(4.0, 1.0)],
            [v(4.0, -4.0), v(5.0, 4.0), v(4.0, 4.0)]
        ]));
    }
}
