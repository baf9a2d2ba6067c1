//! What a click would take: outlined in the view before it is taken.
//!
//! The view is looked through by a grid of rays once it stands still; which of them meet the region is a lookup then.

use egui::{Color32, Pos2, Rect, Ui, pos2, vec2};
use focus::{FillTarget, ViewFrame};
use glam::DVec2;
use rayon::prelude::*;
use session::{Document, view_ray};

/// Distance of the rays, points.
const SPACING: f32 = 3.0;

/// What is within the region, its outline, and what lies just outside of that: so one sees it on white and on black.
const WITHIN: Color32 = Color32::from_rgba_premultiplied(26, 26, 26, 26);
const OUTLINE: Color32 = Color32::from_rgba_premultiplied(200, 200, 200, 200);
const SHADOW: Color32 = Color32::from_rgba_premultiplied(0, 0, 0, 120);

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
    marks: Vec<(Rect, Color32)>,
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
            self.marked = Some(Marked { targets: targets.to_vec(), marks: seen.marks(document, targets) });
        }
        let painter = ui.painter_at(view.clip);
        for (rect, color) in self.marked.iter().flat_map(|marked| &marked.marks) {
            painter.rect_filled(*rect, 0.0, *color);
        }
    }

    /// How much of the view is within the region, in [0, 1]; none while nothing is highlighted.
    pub fn share(&self) -> Option<f32> {
        let clip = self.seen.as_ref()?.view.clip;
        let marks = &self.marked.as_ref()?.marks;
        let within = marks.iter().filter(|(_, color)| *color != SHADOW).map(|(rect, _)| rect.area());
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

    /// Runs of a row that are drawn alike.
    fn marks(&self, document: &Document, targets: &[FillTarget]) -> Vec<(Rect, Color32)> {
        let is_in = |triangle: &Option<u32>| {
            triangle.is_some_and(|triangle| targets.iter().any(|target| covers(document, *target, triangle)))
        };
        let inside: Vec<bool> = self.triangles.par_iter().map(is_in).collect();
        let mut marks: Vec<(Rect, Color32)> = Vec::new();
        let colors = look(&inside, self.columns);
        for (index, color) in colors.into_iter().enumerate() {
            let Some(color) = color else { continue };
            let place = self.view.place(self.columns, index);
            match marks.last_mut() {
                Some((run, same))
                    if *same == color && run.top() == place.top() && run.right() >= place.left() =>
                {
                    run.max.x = place.right();
                }
                _ => marks.push((place, color)),
            }
        }
        marks
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

/// How each square of a grid is drawn: within, on the outline, or just outside.
fn look(inside: &[bool], columns: usize) -> Vec<Option<Color32>> {
    let beside = |index: usize| {
        let (x, columns) = (index % columns.max(1), columns.max(1));
        let left = (x > 0).then(|| index - 1);
        let right = (x + 1 < columns).then_some(index + 1);
        [left, right, index.checked_sub(columns), Some(index + columns)].into_iter().flatten()
    };
    let of = |index: usize| {
        let other = beside(index).filter_map(|k| inside.get(k)).any(|&is| is != inside[index]);
        match (inside[index], other) {
            (true, true) => Some(OUTLINE),
            (true, false) => Some(WITHIN),
            (false, true) => Some(SHADOW),
            (false, false) => None,
        }
    };
    (0..inside.len()).map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_region_has_an_outline_within_and_a_shadow_without() {
        let rows = ["......", ".####.", ".####.", ".####.", "......"];
        let inside: Vec<bool> = rows.iter().flat_map(|row| row.bytes().map(|c| c == b'#')).collect();
        let drawn = look(&inside, 6);
        let text: String = drawn
            .iter()
            .map(|color| match color {
                Some(color) if *color == OUTLINE => 'o',
                Some(color) if *color == WITHIN => '+',
                Some(_) => 's',
                None => '.',
            })
            .collect();
        assert_eq!(text, [".ssss.", "soooos", "so++os", "soooos", ".ssss."].concat());
        // At the rim of the view there is no outline: the region goes on there.
        assert_eq!(look(&[true; 6], 3), [Some(WITHIN); 6]);
    }
}
