//! Depths of the nearest surfaces of the pinhole picture: what may occlude a surface point from the aperture.
//!
//! In the pinhole picture a ray from a point at x with inverse depth p to the aperture point R·u passes the
//! position x + (w − p)·C·u on its way from inverse depth p to w, C = R·(H/2)/tanθ. A surface of inverse depth m
//! at y can therefore only be in the way if |y − x| ≤ (m − p)·C in each axis. Whatever hides behind the nearest
//! surface at y is further away and has a smaller reach, so the nearest surfaces decide for all.

use crate::domain::Cell;
use glam::{DVec2, IVec2};

/// The largest inverse depth of each pixel, and of ever larger squares of them.
pub struct Occluders {
    /// The upper left corner of the part of the picture that is covered, px, …
    corner: IVec2,
    /// … and its size.
    extent: IVec2,
    /// C: px of parallax for a unit of inverse depth, over half the aperture.
    parallax_px: f64,
    /// Level ℓ holds the maxima of 2^ℓ × 2^ℓ px, with its width.
    levels: Vec<(i32, Vec<f32>)>,
    /// Distance to the nearest depth discontinuity, px.
    edge_distance: Vec<f32>,
    /// Distance to the nearest step of depth, px: of less parallax than a discontinuity, of more than the surface's slant makes.
    step_distance: Vec<f32>,
}

/// The depths that the chief rays of a cell find around it.
#[derive(Clone, Copy, Debug)]
pub struct Depths {
    /// 1/z of the nearest and of the farthest of its nearest surfaces.
    pub nearest: f32,
    /// See `nearest`.
    pub farthest: f32,
    /// The change of 1/z over the cell due to the slant of its surfaces; infinite where it is unresolved.
    pub relief: f32,
}

/// A patch of surface in the pinhole picture.
pub struct Footprint {
    /// Centre, px.
    pub center: DVec2,
    /// The cell it lies in: occluders within it are ignored.
    pub cell: Cell,
    /// 1/z at the centre.
    pub inverse_depth: f64,
    /// Gradient of 1/z along its plane, per px.
    pub slope: DVec2,
}

impl Occluders {
    /// Parallax too small to separate two surfaces, px.
    pub const SAME_SURFACE_PX: f64 = 0.25;

    /// Finds the occluders from the depths of every cell of a part of the picture, its upper left corner (px) and its
    /// size.
    pub fn new(
        [corner, extent]: [IVec2; 2],
        parallax_px: f64,
        cells: impl Iterator<Item = (Cell, Depths)>,
    ) -> Self {
        let mut depths =
            vec![Depths { nearest: 0.0, farthest: 0.0, relief: 0.0 }; (extent.x * extent.y) as usize];
        for (cell, of_cell) in cells {
            let low = cell.corner - corner;
            let high = (low + cell.side).min(extent);
            for y in low.y..high.y {
                let row = (y * extent.x) as usize;
                depths[row + low.x as usize..row + high.x as usize].fill(of_cell);
            }
        }
        let [edge_distance, step_distance] = edges(extent, parallax_px, &depths).map(|mut distance| {
            spread(extent, &mut distance);
            distance
        });
        let nearest: Vec<f32> = depths.into_iter().map(|depths| depths.nearest).collect();
        let mut levels = vec![(extent.x, nearest)];
        while levels.last().is_some_and(|(_, level)| level.len() > 1) {
            let (width, fine) = levels.last().expect("just seen");
            levels.push(coarser(*width, fine));
        }
        Self { corner, extent, parallax_px, levels, edge_distance, step_distance }
    }

    /// Whether a cell whose nearest surface has `inverse_depth` may let some aperture point see what lies behind
    /// that surface: a discontinuity is closer than the surface's parallax against infinity, or a step closer than the
    /// parallax of any step.
    pub fn may_reveal(&self, cell: Cell, inverse_depth: f32) -> bool {
        let at = cell.corner - self.corner;
        let at = (at.y * self.extent.x + at.x) as usize;
        let [edge, step] = [&self.edge_distance, &self.step_distance].map(|distance| distance[at] as f64);
        let room = cell.side as f64 * 1.5;
        edge - room <= inverse_depth as f64 * self.parallax_px || step - room <= JUMP_ACROSS_PX
    }

    /// Whether any surface outside the footprint's own cell may occlude it from some aperture point.
    pub fn may_occlude(&self, footprint: &Footprint) -> bool {
        let top = self.levels.len() - 1;
        self.may_occlude_in(footprint, top, IVec2::ZERO)
    }

    fn may_occlude_in(&self, footprint: &Footprint, level: usize, node: IVec2) -> bool {
        let (width, values) = &self.levels[level];
        let nearest = values[(node.y * width + node.x) as usize] as f64;
        let ahead = nearest - footprint.inverse_depth;
        if ahead <= 0.0 {
            return false;
        }
        let side = 1 << level;
        let low = node * side + self.corner;
        let middle = low.as_dvec2() + side as f64 / 2.0;
        let gap = (middle - footprint.center).abs() - (side + footprint.cell.side) as f64 / 2.0;
        if gap.max_element() > ahead * self.parallax_px {
            return false;
        }
        if level == 0 {
            let within = low - footprint.cell.corner;
            if within.cmpge(IVec2::ZERO).all() && within.cmplt(IVec2::splat(footprint.cell.side)).all() {
                return false;
            }
            // The footprint's own plane goes on there; a pixel of it is not in the way of the plane.
            let plane = footprint.slope.dot(middle - footprint.center);
            let slack = footprint.slope.abs().element_sum() * (1.0 + footprint.cell.side as f64 / 2.0);
            return (ahead - plane - slack) * self.parallax_px > 0.02;
        }
        let (fine_width, fine) = &self.levels[level - 1];
        let fine_height = fine.len() as i32 / fine_width;
        [IVec2::ZERO, IVec2::X, IVec2::Y, IVec2::ONE].into_iter().any(|step| {
            let child = node * 2 + step;
            child.x < *fine_width && child.y < fine_height && self.may_occlude_in(footprint, level - 1, child)
        })
    }
}

/// Maxima over 2 × 2.
fn coarser(width: i32, fine: &[f32]) -> (i32, Vec<f32>) {
    let height = fine.len() as i32 / width;
    let (coarse_width, coarse_height) = ((width + 1) / 2, (height + 1) / 2);
    let mut coarse = vec![0.0f32; (coarse_width * coarse_height) as usize];
    for y in 0..height {
        for x in 0..width {
            let parent = &mut coarse[(y / 2 * coarse_width + x / 2) as usize];
            *parent = parent.max(fine[(y * width + x) as usize]);
        }
    }
    (coarse_width, coarse)
}

/// Within a cell more parallax than this, px, is a discontinuity: a facing slope makes less.
const JUMP_WITHIN_PX: f64 = 0.8;

/// Between neighbours more parallax than this, px, is a discontinuity.
const JUMP_ACROSS_PX: f64 = 1.6;

/// More parallax than this, px, beyond what slant makes, is a step. An edge whose step is missed keeps, for every pixel of its
/// length, a fifth of the step from being seen: what a disc's aperture points see of it on average.
const STEP_PX: f64 = 0.1;

/// 0 at the discontinuities and at the steps of depth, infinite elsewhere: where depth jumps within a pixel or against its right
/// or lower neighbour.
fn edges(extent: IVec2, parallax_px: f64, depths: &[Depths]) -> [Vec<f32>; 2] {
    let (width, height) = (extent.x as usize, extent.y as usize);
    let [mut edge, mut step] = [0; 2].map(|_| vec![f32::INFINITY; depths.len()]);
    let mut look = |pixels: [usize; 2], near: f32, far: f32, relief: f32, jump_px: f64| {
        let parallax = (near - far) as f64 * parallax_px;
        if parallax > jump_px {
            pixels.into_iter().for_each(|i| edge[i] = 0.0);
        }
        if parallax - relief as f64 * parallax_px > STEP_PX {
            pixels.into_iter().for_each(|i| step[i] = 0.0);
        }
    };
    for y in 0..height {
        for x in 0..width {
            let i = y * width + x;
            let here = &depths[i];
            look([i, i], here.nearest, here.farthest, here.relief, JUMP_WITHIN_PX);
            let neighbours = [(x + 1 < width).then_some(i + 1), (y + 1 < height).then_some(i + width)];
            for j in neighbours.into_iter().flatten() {
                let next = &depths[j];
                let (near, far) = (here.nearest.max(next.nearest), here.farthest.min(next.farthest));
                look([i, j], near, far, here.relief + next.relief, JUMP_ACROSS_PX);
            }
        }
    }
    [edge, step]
}

/// Spreads distances of 0: the distance of each pixel to the nearest of them (3-4 chamfer), px.
fn spread(extent: IVec2, distance: &mut [f32]) {
    let (width, height) = (extent.x as usize, extent.y as usize);
    const STRAIGHT: f32 = 1.0;
    const DIAGONAL: f32 = 4.0 / 3.0;
    let relax = |distance: &mut [f32], i: usize, j: usize, step: f32| {
        distance[i] = distance[i].min(distance[j] + step);
    };
    for y in 0..height {
        for x in 0..width {
            let i = y * width + x;
            if x > 0 {
                relax(distance, i, i - 1, STRAIGHT);
            }
            if y > 0 {
                relax(distance, i, i - width, STRAIGHT);
                if x > 0 {
                    relax(distance, i, i - width - 1, DIAGONAL);
                }
                if x + 1 < width {
                    relax(distance, i, i - width + 1, DIAGONAL);
                }
            }
        }
    }
    for y in (0..height).rev() {
        for x in (0..width).rev() {
            let i = y * width + x;
            if x + 1 < width {
                relax(distance, i, i + 1, STRAIGHT);
            }
            if y + 1 < height {
                relax(distance, i, i + width, STRAIGHT);
                if x + 1 < width {
                    relax(distance, i, i + width + 1, DIAGONAL);
                }
                if x > 0 {
                    relax(distance, i, i + width - 1, DIAGONAL);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::Domain;

    fn whole(domain: Domain) -> [IVec2; 2] {
        [IVec2::splat(-domain.margin), domain.extent()]
    }

    /// A wall of inverse depth 0.2 with a post of 1.0 at columns 20..24.
    fn post() -> (Domain, Occluders) {
        let domain = Domain::new(64, 32, 0.0);
        let cells = domain.block_rows().into_iter().flatten();
        let cells: Vec<_> = cells
            .map(|cell| {
                let depth = if (20..24).contains(&cell.corner.x) { 1.0 } else { 0.2 };
                (cell, Depths { nearest: depth, farthest: depth, relief: 0.0 })
            })
            .collect();
        (domain, Occluders::new(whole(domain), 10.0, cells.into_iter()))
    }

    fn wall(x: i32) -> Footprint {
        let cell = Cell { corner: IVec2::new(x, 9), side: 1 };
        Footprint { center: cell.part(u64::MAX).center, cell, inverse_depth: 0.2, slope: DVec2::ZERO }
    }

    #[test]
    fn reach_is_the_parallax() {
        let (_, occluders) = post();
        // Parallax between wall and post: 8 px.
        assert!(occluders.may_occlude(&wall(30)));
        assert!(occluders.may_occlude(&wall(31)));
        assert!(!occluders.may_occlude(&wall(33)));
        assert!(!occluders.may_occlude(&wall(10)));
        assert!(occluders.may_occlude(&wall(12)));
    }

    #[test]
    fn a_slope_does_not_occlude_itself() {
        let domain = Domain::new(64, 32, 0.0);
        let depth = |x: i32| 0.2 + 0.05 * x as f32;
        let depths = |x: i32| Depths { nearest: depth(x), farthest: depth(x), relief: 0.05 };
        let cells: Vec<_> =
            domain.block_rows().into_iter().flatten().map(|c| (c, depths(c.corner.x))).collect();
        let occluders = Occluders::new(whole(domain), 10.0, cells.into_iter());
        let cell = Cell { corner: IVec2::new(10, 9), side: 1 };
        let slope = DVec2::new(0.05, 0.0);
        let footprint =
            Footprint { center: cell.part(u64::MAX).center, cell, inverse_depth: depth(10) as f64, slope };
        assert!(!occluders.may_occlude(&footprint));
        assert!(!occluders.may_reveal(cell, depth(10)), "nor does it hide anything");
    }

    #[test]
    fn revealed_only_near_edges() {
        let (_, occluders) = post();
        let cell = |x| Cell { corner: IVec2::new(x, 9), side: 1 };
        assert!(occluders.may_reveal(cell(22), 1.0), "behind the post");
        assert!(!occluders.may_reveal(cell(50), 0.2), "behind the wall, far from the post");
    }

    #[test]
    fn small_steps_reveal_what_is_right_behind_them() {
        let domain = Domain::new(64, 32, 0.0);
        let revealed = |step_px: f32| {
            let depth = |x: i32| if x < 32 { 1.0 } else { 1.0 - step_px / 10.0 };
            let depths = |x: i32| Depths { nearest: depth(x), farthest: depth(x), relief: 0.0 };
            let cells: Vec<_> =
                domain.block_rows().into_iter().flatten().map(|c| (c, depths(c.corner.x))).collect();
            let occluders = Occluders::new(whole(domain), 10.0, cells.into_iter());
            [31, 24].map(|x| occluders.may_reveal(Cell { corner: IVec2::new(x, 9), side: 1 }, 1.0))
        };
        assert_eq!(revealed(0.05), [false, false]);
        assert_eq!(revealed(0.4), [true, false]);
        assert_eq!(revealed(2.0), [true, true]);
    }
}
