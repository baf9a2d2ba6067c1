//! The displacement of a photograph: a coarse lattice over it, interpolated between nodes.

use glam::{DVec2, Vec2};
use scene::View;

/// A lattice over a photograph.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lattice {
    /// Number of nodes.
    columns: usize,
    rows: usize,
    /// Distance between nodes, px of the photograph.
    side_px: f64,
}

/// Cells along the longer side of a photograph; the effect of pose errors varies slowly over it.
const CELLS: f64 = 8.0;

/// A position within a cell of a lattice.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CellPosition {
    /// Nodes at the cell's corners: upper left and right, lower left and right.
    pub nodes: [usize; 4],
    /// Position within the cell, in [0, 1].
    pub share: DVec2,
}

/// Displacement at every position of a photograph.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Displacement {
    lattice: Lattice,
    /// By node, px of the photograph; empty for a photograph left unchanged.
    nodes: Vec<Vec2>,
}

impl Lattice {
    /// The lattice over a view's picture.
    pub fn new(view: &View) -> Self {
        let [width, height] = view.lens.size_px().map(f64::from);
        let side_px = (width.max(height) / CELLS).max(1.0);
        let [columns, rows] = [width, height].map(|side| (side / side_px).ceil() as usize + 1);
        Self { columns, rows, side_px }
    }

    /// The number of its nodes.
    pub fn nodes(&self) -> usize {
        self.columns * self.rows
    }

    /// The number of its cells.
    pub fn cells(&self) -> usize {
        (self.columns - 1) * (self.rows - 1)
    }

    /// The index of the cell that contains a pixel position, and the position within it; positions beyond the border
    /// are clamped.
    pub fn cell(&self, pixel: DVec2) -> (usize, CellPosition) {
        let place = pixel / self.side_px;
        let within = |at: f64, nodes: usize| (at.max(0.0) as usize).min(nodes - 2);
        let (column, row) = (within(place.x, self.columns), within(place.y, self.rows));
        let share = (place - DVec2::new(column as f64, row as f64)).clamp(DVec2::ZERO, DVec2::ONE);
        let first = row * self.columns + column;
        let nodes = [first, first + 1, first + self.columns, first + self.columns + 1];
        (row * (self.columns - 1) + column, CellPosition { nodes, share })
    }

    /// Pairs of neighbouring nodes, beside or above each other, by number.
    pub fn neighbours(&self) -> impl Iterator<Item = [usize; 2]> {
        let Self { columns, rows, .. } = *self;
        (0..columns * rows).flat_map(move |node| {
            let right = (node % columns + 1 < columns).then_some([node, node + 1]);
            let below = (node / columns + 1 < rows).then_some([node, node + columns]);
            [right, below].into_iter().flatten()
        })
    }
}

impl CellPosition {
    /// Bilinear weights of the cell's corners: upper left, upper right, lower left, lower right.
    pub fn shares(&self) -> [f64; 4] {
        let DVec2 { x, y } = self.share;
        [(1.0 - x) * (1.0 - y), x * (1.0 - y), (1.0 - x) * y, x * y]
    }
}

impl Displacement {
    /// No displacement of a view's picture.
    pub fn none(view: &View) -> Self {
        Self { lattice: Lattice::new(view), nodes: Vec::new() }
    }

    /// From nodes, row by row, px; `None` if their number is wrong or one is not finite. An empty list equals
    /// [`Self::none`].
    pub fn from_nodes(view: &View, nodes: Vec<Vec2>) -> Option<Self> {
        let lattice = Lattice::new(view);
        let has_valid_count = nodes.is_empty() || nodes.len() == lattice.nodes();
        (has_valid_count && nodes.iter().all(|node| node.is_finite())).then_some(Self { lattice, nodes })
    }

    /// The displacement of each node, px, row by row; empty if there is none.
    pub fn nodes(&self) -> &[Vec2] {
        &self.nodes
    }

    /// Whether nothing is displaced.
    pub fn is_none(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Displacement at a pixel position of the camera's projection, px; bilinear between nodes.
    pub fn at(&self, pixel: DVec2) -> DVec2 {
        if self.is_none() {
            return DVec2::ZERO;
        }
        let (_, cell) = self.lattice.cell(pixel);
        let corner = |(node, share): (usize, f64)| self.nodes[node].as_dvec2() * share;
        cell.nodes.into_iter().zip(cell.shares()).map(corner).sum()
    }

    /// Where the photograph shows what its camera projects to a pixel position, px.
    pub fn moved(&self, pixel: DVec2) -> DVec2 {
        pixel + self.at(pixel)
    }

    /// The length of the largest displacement, px.
    pub fn max_px(&self) -> f64 {
        self.nodes.iter().map(|node| f64::from(node.length())).fold(0.0, f64::max)
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use glam::DMat4;
    use lens::CalibratedLens;

    /// A synthetic view.
    pub fn view(size: [u32; 2]) -> View {
        View {
            name: "a".into(),
            picture: "a".into(),
            orientation: 1,
            exif_orientation: 1,
            lens: CalibratedLens::pinhole(size, 100.0).unwrap(),
            camera_to_world: DMat4::IDENTITY,
            mask: None,
            exposure_hint: None,
        }
    }

    #[test]
    fn linear_fields_are_interpolated_exactly_and_clamped_at_the_border() {
        let view = view([160, 90]);
        let lattice = Lattice::new(&view);
        assert_eq!((lattice.nodes(), lattice.cells()), (9 * 6, 8 * 5));
        let plane = |x: f64, y: f64| Vec2::new((0.1 * x - 0.03 * y) as f32, (1.0 + 0.02 * x) as f32);
        let nodes = (0..lattice.nodes()).map(|n| plane(20.0 * (n % 9) as f64, 20.0 * (n / 9) as f64));
        let displacement = Displacement::from_nodes(&view, nodes.collect()).unwrap();
        for [x, y] in [[0.0, 0.0], [33.0, 71.5], [20.0, 40.0], [159.9, 89.9]] {
            let off = displacement.at(DVec2::new(x, y)) - plane(x, y).as_dvec2();
            assert!(off.length() < 1e-5, "{x} {y}: {off}");
        }
        assert_eq!(displacement.at(DVec2::new(-9.0, 40.0)), displacement.at(DVec2::new(0.0, 40.0)));
        assert_eq!(Displacement::none(&view).at(DVec2::new(3.0, 4.0)), DVec2::ZERO);
        assert!(Displacement::from_nodes(&view, vec![Vec2::ONE; 53]).is_none());
        assert!(Displacement::from_nodes(&view, vec![Vec2::NAN; 54]).is_none());
    }
}
