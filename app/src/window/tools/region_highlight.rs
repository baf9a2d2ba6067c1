//! Highlights the region that a click would affect.
//!
//! A grid of rays is traced once the view is still; testing them against a region is then a lookup. The outline
//! runs midway between rays inside and outside the region (marching squares).

use document::{Document, view_ray};
use egui::{Color32, Pos2, Rect, Stroke, Ui, Vec2, pos2, vec2};
use focus::{FillTarget, ViewFrame};
use glam::DVec2;
use rayon::prelude::*;

/// Spacing of the rays, points.
const RAY_SPACING_POINTS: f32 = 3.0;

/// Fill of the region, its outline, and a shadow beneath the outline, so that it is visible on white and on
/// black.
const FILL: Color32 = Color32::from_rgba_premultiplied(26, 26, 26, 26);
const OUTLINE: Stroke = Stroke { width: 1.5, color: Color32::from_rgba_premultiplied(235, 235, 235, 235) };
const SHADOW: Stroke = Stroke { width: 3.5, color: Color32::from_rgba_premultiplied(0, 0, 0, 150) };

/// The highlight of one view.
#[derive(Default)]
pub struct RegionHighlight {
    /// The view in the last frame: it is still if it has not changed.
    last_view: Option<HighlightView>,
    hit_grid: Option<HitGrid>,
    region: Option<OutlinedRegion>,
}

/// A view and its rectangle on screen.
#[derive(Clone, Copy, PartialEq)]
struct HighlightView {
    frame: ViewFrame,
    /// Screen rectangle of the view positions (0, 0) to (1, 1).
    image: Rect,
    /// The visible part of it.
    clip: Rect,
}

/// The triangles hit by a grid of rays.
struct HitGrid {
    view: HighlightView,
    columns: usize,
    /// The triangle hit by each ray, row by row.
    triangles: Vec<Option<u32>>,
}

/// The drawing of a region.
struct OutlinedRegion {
    targets: Vec<FillTarget>,
    /// The interior as runs of grid cells in rows.
    filled_runs: Vec<Rect>,
    outline: Vec<[Pos2; 2]>,
}

impl RegionHighlight {
    /// Clears the highlight, for another document.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// Draws the outline of `targets` in a view with screen rectangle `image`, of which `clip` is visible.
    pub fn paint(
        &mut self,
        ui: &Ui,
        document: &Document,
        (frame, image, clip): (ViewFrame, Rect, Rect),
        targets: &[FillTarget],
    ) {
        let view = HighlightView { frame, image, clip: clip.intersect(image) };
        let is_still = self.last_view.replace(view) == Some(view);
        if targets.is_empty() || !view.clip.is_positive() {
            return;
        }
        if self.hit_grid.as_ref().is_none_or(|grid| grid.view != view) {
            (self.hit_grid, self.region) = (None, None);
            if !is_still || ui.input(|input| input.pointer.any_down()) {
                ui.ctx().request_repaint();
                return;
            }
            self.hit_grid = Some(HitGrid::trace(document, view));
        }
        let Some(hit_grid) = &self.hit_grid else { return };
        if self.region.as_ref().is_none_or(|region| region.targets != targets) {
            self.region = Some(hit_grid.outline_region(document, targets));
        }
        let Some(region) = &self.region else { return };
        let painter = ui.painter_at(view.clip);
        region.filled_runs.iter().for_each(|rect| {
            painter.rect_filled(*rect, 0.0, FILL);
        });
        for stroke in [SHADOW, OUTLINE] {
            region.outline.iter().for_each(|line| {
                painter.line_segment(*line, stroke);
            });
        }
    }

    /// Share of the view that is highlighted, in [0, 1]; `None` without a highlight.
    pub fn share(&self) -> Option<f32> {
        let clip = self.hit_grid.as_ref()?.view.clip;
        let within = self.region.as_ref()?.filled_runs.iter().map(|rect| rect.area());
        Some(within.sum::<f32>() / clip.area())
    }
}

impl HitGrid {
    fn trace(document: &Document, view: HighlightView) -> Self {
        let size = (view.clip.size() / RAY_SPACING_POINTS).ceil();
        let (columns, rows) = (size.x as usize, size.y as usize);
        let tracer = document.stage.tracer();
        let triangle = |index: usize| {
            let at = view.cell_rect(columns, index).center();
            let share = (at - view.image.min) / view.image.size();
            let ray = view_ray(&view.frame, DVec2::new(share.x.into(), share.y.into()));
            tracer.visible_surface(&ray).map(|hit| hit.point.triangle)
        };
        Self { view, columns, triangles: (0..columns * rows).into_par_iter().map(triangle).collect() }
    }

    fn outline_region(&self, document: &Document, targets: &[FillTarget]) -> OutlinedRegion {
        let is_inside = |triangle: &Option<u32>| {
            triangle.is_some_and(|triangle| {
                targets.iter().any(|target| target_contains(document, *target, triangle))
            })
        };
        let inside: Vec<bool> = self.triangles.par_iter().map(is_inside).collect();
        let mut within: Vec<Rect> = Vec::new();
        for (index, _) in inside.iter().enumerate().filter(|(_, inside)| **inside) {
            let place = self.view.cell_rect(self.columns, index);
            match within.last_mut() {
                Some(run) if run.top() == place.top() && run.right() >= place.left() => {
                    run.max.x = place.right();
                }
                _ => within.push(place),
            }
        }
        // Grid coordinates refer to the centres of the cells.
        let first = self.view.clip.min + Vec2::splat(RAY_SPACING_POINTS / 2.0);
        let on_screen = |line: [[f32; 2]; 2]| line.map(|[x, y]| first + vec2(x, y) * RAY_SPACING_POINTS);
        let outline = outline(&inside, self.columns).into_iter().map(on_screen).collect();
        OutlinedRegion { targets: targets.to_vec(), filled_runs: within, outline }
    }
}

impl HighlightView {
    /// Screen rectangle of a ray's grid cell.
    fn cell_rect(&self, columns: usize, index: usize) -> Rect {
        let at = |k: usize, from: f32| from + RAY_SPACING_POINTS * k as f32;
        let corner: Pos2 = pos2(at(index % columns, self.clip.left()), at(index / columns, self.clip.top()));
        Rect::from_min_size(corner, vec2(RAY_SPACING_POINTS, RAY_SPACING_POINTS))
    }
}

/// Whether a target contains a triangle.
fn target_contains(document: &Document, target: FillTarget, triangle: u32) -> bool {
    let scene = document.scene();
    let part = scene.triangles[triangle as usize].part;
    match target {
        FillTarget::Node(node) => scene.parts[part as usize].node == node,
        FillTarget::Material(material) => scene.parts[part as usize].material == material,
        FillTarget::Part(target_part) => part == target_part,
        FillTarget::Chart(chart) => document.stage.atlas.chart_of[triangle as usize] == chart,
        FillTarget::Everything => true,
        FillTarget::Background => false,
    }
}

/// The boundary lines between inside and outside points of a grid, in columns and rows (marching squares).
/// Collinear neighbours are merged into one line.
fn outline(inside: &[bool], columns: usize) -> Vec<[[f32; 2]; 2]> {
    let columns = columns.max(1);
    let rows = inside.len() / columns;
    let mut lines: Vec<[[f32; 2]; 2]> = Vec::new();
    // The vertical line that ends at the row above, by column.
    let mut above: Vec<Option<usize>> = vec![None; columns];
    for y in 0..rows.saturating_sub(1) {
        // The horizontal line that continues to the right.
        let mut left: Option<usize> = None;
        for x in 0..columns - 1 {
            let at = |dx: usize, dy: usize| inside[(y + dy) * columns + x + dx];
            let [nw, ne, sw, se] = [at(0, 0), at(1, 0), at(0, 1), at(1, 1)];
            let (x0, y0) = (x as f32, y as f32);
            let [north, south] = [[x0 + 0.5, y0], [x0 + 0.5, y0 + 1.0]];
            let [west, east] = [[x0, y0 + 0.5], [x0 + 1.0, y0 + 0.5]];
            let (was_left, was_above) = (left.take(), above[x].take());
            if nw == sw && ne == se {
                // A vertical line, or none.
                if nw != ne {
                    match was_above {
                        Some(line) => lines[line][1] = south,
                        None => lines.push([north, south]),
                    }
                    above[x] = was_above.or(Some(lines.len() - 1));
                }
            } else if nw == ne && sw == se {
                match was_left {
                    Some(line) => lines[line][1] = east,
                    None => lines.push([west, east]),
                }
                left = was_left.or(Some(lines.len() - 1));
            } else {
                // A corner that differs from both neighbours is cut off.
                let corners = [
                    (nw, ne, sw, [west, north]),
                    (ne, nw, se, [north, east]),
                    (sw, nw, se, [west, south]),
                    (se, ne, sw, [south, east]),
                ];
                // At a saddle the inside corners are cut off: they are not connected.
                let is_saddle = nw == se && ne == sw;
                let cut = |&(corner, a, b, _): &(bool, bool, bool, _)| {
                    corner != a && corner != b && (!is_saddle || corner)
                };
                lines.extend(corners.iter().filter(|corner| cut(corner)).map(|(.., line)| *line));
            }
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether points of a picture in text are inside.
    fn grid(rows: &[&str]) -> (Vec<bool>, usize) {
        (rows.iter().flat_map(|row| row.bytes().map(|c| c == b'#')).collect(), rows[0].len())
    }

    #[test]
    fn an_outline_runs_midway_and_cuts_corners() {
        let (inside, columns) = grid(&["......", ".####.", ".####.", ".####.", "......"]);
        let mut lines = outline(&inside, columns);
        lines.sort_by(|a, b| a.partial_cmp(b).unwrap());
        let straight = [
            [[0.5, 1.0], [0.5, 3.0]],
            [[1.0, 0.5], [4.0, 0.5]],
            [[1.0, 3.5], [4.0, 3.5]],
            [[4.5, 1.0], [4.5, 3.0]],
        ];
        assert!(straight.iter().all(|line| lines.contains(line)), "{lines:?}");
        assert_eq!(lines.len(), 8, "and a corner each: {lines:?}");
        assert!(lines.contains(&[[0.5, 1.0], [1.0, 0.5]]), "{lines:?}");
        // At the rim of the view there is no outline: the region goes on there.
        assert_eq!(outline(&[true; 6], 3), Vec::<[[f32; 2]; 2]>::new());
        assert_eq!(outline(&[], 0), Vec::<[[f32; 2]; 2]>::new());
    }

    #[test]
    fn every_end_of_an_outline_meets_another() {
        let (inside, columns) = grid(&[
            "..........",
            ".#.##..#..",
            "..#.##.##.",
            ".##..#.#..",
            ".#####..#.",
            "...#......",
            "..........",
        ]);
        let lines = outline(&inside, columns);
        let ends: Vec<[f32; 2]> = lines.iter().flatten().copied().collect();
        for end in &ends {
            let count = ends.iter().filter(|other| *other == end).count();
            assert_eq!(count, 2, "{end:?} of {lines:?}");
        }
    }
}
