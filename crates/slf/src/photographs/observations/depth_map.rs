//! Depth map of a photograph, and the distance of each pixel from a depth edge.
//!
//! The mesh is rasterised through the actual lens. Triangles whose sides the lens bends are split until the sides are
//! straight to a quarter of a pixel. Depth is measured along the lens's axis for directions well in front of it (its
//! inverse is linear in a perspective picture), elsewhere as distance; which of the two applies depends on the
//! direction alone, so depth maps and points agree.

use glam::{DVec2, DVec3};
use scene::{Scene, View};

/// Depths of a picture's pixels.
pub(crate) struct DepthMap {
    width: usize,
    height: usize,
    /// 1/depth; 0 where there is no surface.
    inverse: Vec<f32>,
    /// Distance to the nearest edge, pixels, at most [`MAX_EDGE_DISTANCE`]; 0 next to one.
    edge_distances: Vec<u8>,
}

/// Distances from edges are measured up to this limit, pixels.
pub(crate) const MAX_EDGE_DISTANCE: u8 = 64;
/// Directions with a smaller cosine to the axis store distance instead of depth.
const MIN_AXIS_COSINE: f64 = 0.2;
/// Depth tolerance of the visibility test beyond the local slope, as a share of depth.
const DEPTH_BIAS: f32 = 2e-3;
/// Neighbours form an edge if they differ by more than this share of depth and by more than their slopes explain.
const MIN_DEPTH_JUMP: f32 = 0.01;

/// A projected corner of a triangle.
#[derive(Clone, Copy)]
struct Corner {
    place: DVec2,
    inverse: f64,
}

impl DepthMap {
    /// Rasterises a scene for a view, with `reduction` pixels of the view per pixel, each way.
    pub fn render(scene: &Scene, view: &View, reduction: u32) -> Self {
        let [width, height] = view.lens.size_px().map(|side| side.div_ceil(reduction) as usize);
        let mut picture =
            Self { width, height, inverse: vec![0.0; width * height], edge_distances: Vec::new() };
        let corner = |position: DVec3| corner(view, position, reduction);
        let vertices: Vec<Option<Corner>> = scene.positions.iter().map(|&p| corner(p)).collect();
        for triangle in 0..scene.triangles.len() as u32 {
            let indices = scene.triangles[triangle as usize].vertices;
            let corners = indices.map(|v| vertices[v as usize]);
            let positions = indices.map(|v| scene.positions[v as usize]);
            if corners.iter().all(Option::is_none) && !may_be_visible(view, &positions) {
                continue;
            }
            picture.draw(&positions, corners, &corner, 0);
        }
        picture.edge_distances = picture.distances_from_edges();
        picture.close_holes();
        picture
    }

    /// Rasterises a triangle, in parts where it is bent or partly behind the lens.
    fn draw(
        &mut self,
        positions: &[DVec3; 3],
        corners: [Option<Corner>; 3],
        corner: &impl Fn(DVec3) -> Option<Corner>,
        level: u32,
    ) {
        /// Maximum depth of subdivision.
        const LEVELS: u32 = 9;
        if corners.iter().all(Option::is_none) && level > 3 {
            return;
        }
        let middles = [0, 1, 2].map(|k| (positions[k] + positions[(k + 1) % 3]) * 0.5);
        let split = |corners: &[Option<Corner>; 3]| match corners {
            [Some(a), Some(b), Some(c)] => {
                let whole = [a, b, c];
                let low = a.place.min(b.place).min(c.place);
                let high = a.place.max(b.place).max(c.place);
                let size = DVec2::new(self.width as f64, self.height as f64);
                if high.cmplt(DVec2::ZERO).any() || low.cmpgt(size).any() {
                    // Outside the picture, unless the lens bends it in: only large triangles are examined further.
                    return (high - low).max_element() > size.max_element();
                }
                if (high - low).max_element() <= 2.0 {
                    return false;
                }
                (0..3).any(|k| {
                    let (from, to) = (whole[k].place, whole[(k + 1) % 3].place);
                    let Some(middle) = corner(middles[k]) else { return true };
                    let along = to - from;
                    let length = along.length();
                    length > 1.0 && along.perp_dot(middle.place - from).abs() > 0.25 * length
                })
            }
            _ => true,
        };
        if level < LEVELS && split(&corners) {
            let [ab, bc, ca] = middles;
            let [a, b, c] = *positions;
            let [ab_corner, bc_corner, ca_corner] = middles.map(corner);
            let [a_corner, b_corner, c_corner] = corners;
            self.draw(&[a, ab, ca], [a_corner, ab_corner, ca_corner], corner, level + 1);
            self.draw(&[ab, b, bc], [ab_corner, b_corner, bc_corner], corner, level + 1);
            self.draw(&[ca, bc, c], [ca_corner, bc_corner, c_corner], corner, level + 1);
            self.draw(&[ab, bc, ca], [ab_corner, bc_corner, ca_corner], corner, level + 1);
        } else if let [Some(a), Some(b), Some(c)] = corners {
            self.fill([a, b, c]);
        }
    }

    /// Fills the pixels whose centres lie in a straight triangle, with a depth test.
    fn fill(&mut self, [a, b, c]: [Corner; 3]) {
        let area = (b.place - a.place).perp_dot(c.place - a.place);
        if area == 0.0 || !area.is_finite() {
            return;
        }
        let low = a.place.min(b.place).min(c.place);
        let high = a.place.max(b.place).max(c.place);
        let first = |low: f64| (low - 0.5).ceil().max(0.0) as usize;
        let last = |high: f64, size: usize| ((high - 0.5).floor() + 1.0).clamp(0.0, size as f64) as usize;
        for y in first(low.y)..last(high.y, self.height) {
            for x in first(low.x)..last(high.x, self.width) {
                let at = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
                let weight_a = (b.place - at).perp_dot(c.place - at) / area;
                let weight_b = (c.place - at).perp_dot(a.place - at) / area;
                let weight_c = 1.0 - weight_a - weight_b;
                if weight_a < 0.0 || weight_b < 0.0 || weight_c < 0.0 {
                    continue;
                }
                let inverse = (weight_a * a.inverse + weight_b * b.inverse + weight_c * c.inverse) as f32;
                let pixel = &mut self.inverse[y * self.width + x];
                *pixel = pixel.max(inverse);
            }
        }
    }

    /// Distance of each pixel from an edge, up to [`MAX_EDGE_DISTANCE`], in steps to any of the eight neighbours.
    fn distances_from_edges(&self) -> Vec<u8> {
        let (width, height) = (self.width, self.height);
        let mut distance = vec![MAX_EDGE_DISTANCE; width * height];
        for y in 0..height {
            for x in 0..width {
                for [dx, dy] in [[1, 0], [0, 1]] {
                    if x + dx < width && y + dy < height && self.jumps(x, y, dx, dy) {
                        distance[y * width + x] = 0;
                        distance[(y + dy) * width + x + dx] = 0;
                    }
                }
            }
        }
        let spread = |distance: &mut Vec<u8>, x: usize, y: usize, neighbours: [(isize, isize); 4]| {
            let mut min = distance[y * width + x];
            for (dx, dy) in neighbours {
                let (Some(x), Some(y)) = (x.checked_add_signed(dx), y.checked_add_signed(dy)) else {
                    continue;
                };
                if x < width && y < height {
                    min = min.min(distance[y * width + x] + 1);
                }
            }
            distance[y * width + x] = min;
        };
        for y in 0..height {
            for x in 0..width {
                spread(&mut distance, x, y, [(-1, 0), (-1, -1), (0, -1), (1, -1)]);
            }
        }
        for y in (0..height).rev() {
            for x in (0..width).rev() {
                spread(&mut distance, x, y, [(1, 0), (1, 1), (0, 1), (-1, 1)]);
            }
        }
        distance
    }

    /// Marks background enclosed by the surface as an edge: it is more often a hole in the mesh than a view of the
    /// background.
    fn close_holes(&mut self) {
        let (width, height) = (self.width, self.height);
        let mut is_open = vec![false; width * height];
        // Flood fill from the border: sweeps right and down, then left and up, until nothing changes.
        let mut is_changed = true;
        while is_changed {
            is_changed = false;
            let mut open = |x: usize, y: usize, across: Option<usize>, along: Option<usize>| {
                let index = y * width + x;
                if is_open[index] || self.inverse[index] > 0.0 {
                    return;
                }
                // Outside the border everything is open.
                let is_reached = |neighbour: Option<usize>| neighbour.is_none_or(|index| is_open[index]);
                if is_reached(across) || is_reached(along) {
                    is_open[index] = true;
                    is_changed = true;
                }
            };
            for y in 0..height {
                for x in 0..width {
                    let index = y * width + x;
                    open(x, y, (x > 0).then(|| index - 1), (y > 0).then(|| index - width));
                }
            }
            for y in (0..height).rev() {
                for x in (0..width).rev() {
                    let index = y * width + x;
                    let (right, below) =
                        ((x + 1 < width).then(|| index + 1), (y + 1 < height).then(|| index + width));
                    open(x, y, right, below);
                }
            }
        }
        for ((edge_distance, inverse), is_open) in
            self.edge_distances.iter_mut().zip(&self.inverse).zip(is_open)
        {
            if *inverse == 0.0 && !is_open {
                *edge_distance = 0;
            }
        }
    }

    /// Whether depth jumps between a pixel and the next along (dx, dy) by more than the slope on either side explains.
    fn jumps(&self, x: usize, y: usize, dx: usize, dy: usize) -> bool {
        let at = |k: isize| {
            let x = x.checked_add_signed(k * dx as isize)?;
            let y = y.checked_add_signed(k * dy as isize)?;
            (x < self.width && y < self.height).then(|| self.inverse[y * self.width + x])
        };
        let (Some(here), Some(there)) = (at(0), at(1)) else { return false };
        if (here > 0.0) != (there > 0.0) {
            return true;
        }
        if here == 0.0 {
            return false;
        }
        let allowed = MIN_DEPTH_JUMP * here.max(there);
        let step = there - here;
        let explained = |before: Option<f32>, after: Option<f32>| match (before, after) {
            (Some(before), Some(after)) if before > 0.0 && after > 0.0 => {
                (step - (after - before)).abs() <= allowed
            }
            _ => false,
        };
        step.abs() > allowed && !explained(at(-1), Some(here)) && !explained(Some(there), at(2))
    }

    /// If a point is visible at `place` (in pixels of this map), the distance to the nearest edge in pixels, up to
    /// [`MAX_EDGE_DISTANCE`]; `None` if it is occluded.
    pub fn visible_edge_distance(&self, view: &View, point: DVec3, place: DVec2) -> Option<u8> {
        let (x, y) = (place.x as usize, place.y as usize);
        if place.x < 0.0 || place.y < 0.0 || x >= self.width || y >= self.height {
            return None;
        }
        let index = y * self.width + x;
        let here = self.inverse[index];
        if here == 0.0 {
            return None;
        }
        let slope = |step: usize, can_less: bool, can_more: bool| {
            let difference = |other: f32| if other > 0.0 { (other - here).abs() } else { f32::INFINITY };
            let less = if can_less { difference(self.inverse[index - step]) } else { f32::INFINITY };
            let more = if can_more { difference(self.inverse[index + step]) } else { f32::INFINITY };
            let min = less.min(more);
            if min.is_finite() { min } else { 0.0 }
        };
        let slopes = slope(1, x > 0, x + 1 < self.width) + slope(self.width, y > 0, y + 1 < self.height);
        let inverse = inverse_depth(view, point)? as f32;
        (inverse >= here - DEPTH_BIAS * here - slopes).then_some(self.edge_distances[index])
    }

    /// If a place shows background, the distance to the surface in pixels, up to [`MAX_EDGE_DISTANCE`], 0 in a hole of
    /// it; `None` if it shows the surface.
    pub fn background_edge_distance(&self, place: DVec2) -> Option<u8> {
        let (x, y) = (place.x as usize, place.y as usize);
        if place.x < 0.0 || place.y < 0.0 || x >= self.width || y >= self.height {
            return None;
        }
        let index = y * self.width + x;
        (self.inverse[index] == 0.0).then_some(self.edge_distances[index])
    }
}

fn corner(view: &View, position: DVec3, reduction: u32) -> Option<Corner> {
    let place = view.project(position)? / f64::from(reduction);
    let inverse = inverse_depth(view, position)?;
    place.is_finite().then_some(Corner { place, inverse })
}

/// 1/depth of a point, as defined in the module documentation; `None` at the camera itself.
fn inverse_depth(view: &View, position: DVec3) -> Option<f64> {
    let offset = position - view.position();
    let (distance, along) = (offset.length(), offset.dot(view.forward()));
    let depth = if along > MIN_AXIS_COSINE * distance { along } else { distance };
    (depth > 0.0).then(|| 1.0 / depth)
}

/// Whether a triangle whose corners all lie outside the lens's field may still be visible in its interior, that is,
/// whether it reaches in front of the camera.
fn may_be_visible(view: &View, positions: &[DVec3; 3]) -> bool {
    let middle = (positions[0] + positions[1] + positions[2]) / 3.0;
    let reach = positions.iter().map(|p| p.distance(middle)).fold(0.0, f64::max);
    let offset = middle - view.position();
    // The corners of small triangles have similar directions, so those are visible as wholes or not at all.
    offset.dot(view.forward()) + reach > 0.0 && reach > 0.2 * offset.length()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn holes_are_edges_and_bays_are_not() {
        // A ring with a hole, and a bay open to the border.
        let rows =
            ["........", ".#####..", ".#...#..", ".#.#.#..", ".#...#..", ".#####..", ".#......", "........"];
        let inverse: Vec<f32> =
            rows.iter().flat_map(|row| row.bytes().map(|b| if b == b'#' { 0.5 } else { 0.0 })).collect();
        let mut picture = DepthMap { width: 8, height: 8, inverse, edge_distances: vec![3; 64] };
        picture.close_holes();
        let at =
            |x: usize, y: usize| picture.background_edge_distance(DVec2::new(x as f64 + 0.5, y as f64 + 0.5));
        assert_eq!([at(2, 2), at(4, 4), at(1, 1)], [Some(0), Some(0), None]);
        assert_eq!([at(3, 6), at(7, 0), at(0, 7)], [Some(3); 3]);
    }
}
