//! From a shape to the texels that may be painted.

use crate::document::Stage;
use focus::{Selection, SelectionResult, ViewFrame};
use glam::DVec2;
use project::SelectionShape;
use rayon::prelude::*;

/// The texels of a shape; `before` is what is selected now.
pub(crate) fn selected(stage: &Stage, shape: &SelectionShape, before: Option<&Selection>) -> SelectionResult {
    let canvas = &*stage.canvas;
    match shape {
        SelectionShape::Everything => SelectionResult::Everything,
        SelectionShape::Inverse => before.map_or(SelectionResult::Nothing, Selection::inverted),
        SelectionShape::Targets(targets) => {
            Selection::of(canvas, |texel| targets.iter().any(|target| target.contains(canvas, texel)))
        }
        SelectionShape::Depth { origin, axis, range: [near, far] } => {
            Selection::of(canvas, |texel| (*near..=*far).contains(&axis.dot(texel.position - *origin)))
        }
        SelectionShape::Normal { normal, degrees } => {
            let least = degrees.to_radians().cos();
            Selection::of(canvas, |texel| normal.dot(texel.normal.as_dvec3()) >= least)
        }
        SelectionShape::Outline { view, points, through } => {
            let width = stage.atlas.width as usize;
            let mut inside = vec![false; width * stage.atlas.height as usize];
            let places = stage.texels.texels.par_iter().filter_map(|texel| {
                let position = texel.centroid.position(&stage.scene);
                let is_inside = contains(points, view.position(position)?)
                    && (*through || !stage.tracer.hidden(texel.centroid, view.eye()));
                is_inside.then_some(texel.y as usize * width + texel.x as usize)
            });
            for place in places.collect::<Vec<_>>() {
                inside[place] = true;
            }
            Selection::of(canvas, |texel| inside[texel.y as usize * width + texel.x as usize])
        }
    }
}

/// The outline of the rectangle between two positions of a view.
pub fn rectangle(view: ViewFrame, [a, b]: [DVec2; 2], through: bool) -> SelectionShape {
    let points = vec![a, DVec2::new(b.x, a.y), b, DVec2::new(a.x, b.y)];
    SelectionShape::Outline { view, points, through }
}

/// Whether a point lies within a closed outline: a ray to the right crosses it an odd number of times.
fn contains(outline: &[DVec2], at: DVec2) -> bool {
    let mut is_inside = false;
    for (k, &a) in outline.iter().enumerate() {
        let b = outline[(k + 1) % outline.len()];
        if (a.y > at.y) != (b.y > at.y) && at.x < a.x + (at.y - a.y) / (b.y - a.y) * (b.x - a.x) {
            is_inside = !is_inside;
        }
    }
    is_inside
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inside_is_inside_also_of_what_is_not_convex() {
        let arrow = [[0.0, 0.0], [1.0, 0.5], [0.0, 1.0], [0.3, 0.5]].map(DVec2::from_array);
        assert!(contains(&arrow, DVec2::new(0.5, 0.5)));
        assert!(contains(&arrow, DVec2::new(0.1, 0.1)));
        assert!(!contains(&arrow, DVec2::new(0.1, 0.5)), "in the notch");
        assert!(!contains(&arrow, DVec2::new(1.1, 0.5)));
    }
}
