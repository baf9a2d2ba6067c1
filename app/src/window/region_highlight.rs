//! What a click would take: outlined in the view before it is taken.
//!
//! The view is looked through by a grid of rays once it stands still; which of them meet the region is a lookup then, and
//! its outline runs midway between rays that meet it and rays that do not (marching squares).

use egui::{Color32, Pos2, Rect, Stroke, Ui, Vec2, pos2, vec2};
use focus::{FillTarget, ViewFrame};
use glam::DVec2;
use rayon::prelude::*;
use session::{Document, view_ray};

/// Distance of the rays, points.
const SPACING: f32 = 3.0;

/// What is within the region, its outline, and what lies beneath the outline: so one sees it on white and on black.
const WITHIN: Color32 = Color32::from_rgba_premultiplied(26, 26, 26, 26);
const OUTLINE: Stroke = Stroke { width: 1.5, color: Color32::from_rgba_premultiplied(235, 235, 235, 235) };
const SHADOW: Stroke = Stroke { width: 3.5, color: Color32::from_rgba_premultiplied(0, 0, 0, 150) };

/// The highlight of one view.
#[derive(Default)]
pub struct RegionHighlight {
    /// The view in the last frame: it stands still once it is the same again.
    last: Option<View>,
    seen: Option<Seen>,
    marked: Option<Marked>,
}

/// What is looked through, and where its whole is on screen.
#[derive(Clone, Copy, PartialEq)]
struct View {
    frame: ViewFrame,
    /// Of (0, 0) to (1, 1).
    image: Rect,
    /// What of it is to be seen.
    clip: Rect,
}

/// What the rays met.
struct Seen {
    view: View,
    columns: usize,
    /// Row by row: the triangle.
    triangles: Vec<Option<u32>>,
}

/// What is drawn of a region.
struct Marked {
    targets: Vec<FillTarget>,
    /// What lies within: runs of a row.
    within: Vec<Rect>,
    outline: Vec<[Pos2; 2]>,
}

impl RegionHighlight {
    /// Another document.
    pub fn forget(&mut self) {
        *self = Self::default();
    }

    /// Draws the outline of `targets` in a view whose whole is `image` on screen, of which `clip` is to be seen.
    pub fn paint(
        &mut self,
        ui: &Ui,
        document: &Document,
        (frame, image, clip): (ViewFrame, Rect, Rect),
        targets: &[FillTarget],
    ) {
        let view = View { frame, image, clip: clip.intersect(image) };
        let stands = self.last.replace(view) == Some(view);
        if targets.is_empty() || !view.clip.is_positive() {
            return;
        }
        if self.seen.as_ref().is_none_or(|seen| seen.view != view) {
            (self.seen, self.marked) = (None, None);
            if !stands || ui.input(|input| input.pointer.any_down()) {
                ui.ctx().request_repaint();
                return;
            }
            self.seen = Some(Seen::of(document, view));
        }
        let Some(seen) = &self.seen else { return };
        if self.marked.as_ref().is_none_or(|marked| marked.targets != targets) {
            self.marked = Some(seen.marked(document, targets));
        }
        let Some(marked) = &self.marked else { return };
        let painter = ui.painter_at(view.clip);
        marked.within.iter().for_each(|rect| {
            painter.rect_filled(*rect, 0.0, WITHIN);
        });
        for stroke in [SHADOW, OUTLINE] {
            marked.outline.iter().for_each(|line| {
                painter.line_segment(*line, stroke);
            });
        }
    }

    /// How much of the view is within the region, in [0, 1]; none while nothing is highlighted.
    pub fn share(&self) -> Option<f32> {
        let clip = self.seen.as_ref()?.view.clip;
        let within = self.marked.as_ref()?.within.iter().map(|rect| rect.area());
        Some(within.sum::<f32>() / clip.area())
    }
}

impl Seen {
    fn of(document: &Document, view: View) -> Self {
        let size = (view.clip.size() / SPACING).ceil();
        let (columns, rows) = (size.x as usize, size.y as usize);
        let tracer = &document.stage.tracer;
        let triangle = |index: usize| {
            let at = view.place(columns, index).center();
            let share = (at - view.image.min) / view.image.size();
            let ray = view_ray(&view.frame, DVec2::new(share.x.into(), share.y.into()));
            tracer.first_hit(&ray).map(|hit| hit.point.triangle)
        };
        Self { view, columns, triangles: (0..columns * rows).into_par_iter().map(triangle).collect() }
    }

    fn marked(&self, document: &Document, targets: &[FillTarget]) -> Marked {
        let is_in = |triangle: &Option<u32>| {
            triangle.is_some_and(|triangle| targets.iter().any(|target| covers(document, *target, triangle)))
        };
        let inside: Vec<bool> = self.triangles.par_iter().map(is_in).collect();
        let mut within: Vec<Rect> = Vec::new();
        for (index, _) in inside.iter().enumerate().filter(|(_, inside)| **inside) {
            let place = self.view.place(self.columns, index);
            match within.last_mut() {
                Some(run) if run.top() == place.top() && run.right() >= place.left() => {
                    run.max.x = place.right();
                }
                _ => within.push(place),
            }
        }
        // From the middle of one ray's square to that of the next.
        let first = self.view.clip.min + Vec2::splat(SPACING / 2.0);
        let on_screen = |line: [[f32; 2]; 2]| line.map(|[x, y]| first + vec2(x, y) * SPACING);
        let outline = outline(&inside, self.columns).into_iter().map(on_screen).collect();
        Marked { targets: targets.to_vec(), within, outline }
    }
}

impl View {
    /// The square of a ray on screen.
    fn place(&self, columns: usize, index: usize) -> Rect {
        let at = |k: usize, from: f32| from + SPACING * k as f32;
        let corner: Pos2 = pos2(at(index % columns, self.clip.left()), at(index / columns, self.clip.top()));
        Rect::from_min_size(corner, vec2(SPACING, SPACING))
    }
}

/// Whether a triangle belongs to a target.
fn covers(document: &Document, target: FillTarget, triangle: u32) -> bool {
    let scene = document.scene();
    let part = scene.triangles[triangle as usize].part;
    match target {
        FillTarget::Node(node) => scene.parts[part as usize].node == node,
        FillTarget::Material(material) => scene.parts[part as usize].material == material,
        FillTarget::Part(wanted) => part == wanted,
        FillTarget::Chart(chart) => document.stage.atlas.chart_of[triangle as usize] == chart,
        FillTarget::Everything => true,
        FillTarget::Background => false,
    }
}

/// The lines between what is inside and what is not, of points in a grid, in its columns and rows. What lies straight on is
/// one line.
fn outline(inside: &[bool], columns: usize) -> Vec<[[f32; 2]; 2]> {
    let columns = columns.max(1);
    let rows = inside.len() / columns;
    let mut lines: Vec<[[f32; 2]; 2]> = Vec::new();
    // Where the level lines of the row above end in each column.
    let mut above: Vec<Option<usize>> = vec![None; columns];
    for y in 0..rows.saturating_sub(1) {
        // A horizontal line that goes on to the right.
        let mut left: Option<usize> = None;
        for x in 0..columns - 1 {
            let at = |dx: usize, dy: usize| inside[(y + dy) * columns + x + dx];
            let [nw, ne, sw, se] = [at(0, 0), at(1, 0), at(0, 1), at(1, 1)];
            let (x0, y0) = (x as f32, y as f32);
            let [north, south] = [[x0 + 0.5, y0], [x0 + 0.5, y0 + 1.0]];
            let [west, east] = [[x0, y0 + 0.5], [x0 + 1.0, y0 + 0.5]];
            let (was_left, was_above) = (left.take(), above[x].take());
            if nw == sw && ne == se {
                // Straight down, or nothing.
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
                // A corner is cut off where one differs from its two neighbours.
                let corners = [
                    (nw, ne, sw, [west, north]),
                    (ne, nw, se, [north, east]),
                    (sw, nw, se, [west, south]),
                    (se, ne, sw, [south, east]),
                ];
                // Of two that lie across from each other, those inside: they do not touch.
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
