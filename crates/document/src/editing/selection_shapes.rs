//! The texels that a selection's shape covers.

use crate::error::DocumentError;
use crate::stage::Stage;
use focus::{Selection, SelectionResult, ViewFrame};
use glam::DVec2;
use progress::Progress;
use project::SelectionShape;
use rayon::prelude::*;
use std::sync::Arc;

/// A shape whose texels are to be selected. Those that follow the surface take a while when the first is selected; it
/// needs no document and can run in the background.
pub struct SelectionTask {
    pub(crate) stage: Arc<Stage>,
    pub(crate) shape: SelectionShape,
    /// The selection.
    pub(crate) before: Option<Selection>,
}

/// The texels of a shape.
pub struct SelectionMatches {
    pub(crate) task: SelectionTask,
    pub(crate) matches: SelectionResult,
}

impl SelectionTask {
    /// Finds the texels.
    ///
    /// # Errors
    /// Photographs that show where edges are cannot be used, or `progress` was cancelled.
    pub fn solve(self, progress: &dyn Progress) -> Result<SelectionMatches, DocumentError> {
        let matches = select_texels(&self.stage, &self.shape, self.before.as_ref(), progress)?;
        Ok(SelectionMatches { task: self, matches })
    }
}

/// The texels of a shape; `before` is the current selection.
fn select_texels(
    stage: &Stage,
    shape: &SelectionShape,
    before: Option<&Selection>,
    progress: &dyn Progress,
) -> Result<SelectionResult, DocumentError> {
    let canvas = &*stage.canvas;
    Ok(match shape {
        SelectionShape::Everything => SelectionResult::Everything,
        SelectionShape::Inverse => before.map_or(SelectionResult::Nothing, Selection::inverted),
        SelectionShape::Targets(targets) => Selection::from_predicate(canvas, |texel| {
            targets.iter().any(|target| target.contains(canvas, texel))
        }),
        SelectionShape::Depth { origin, axis, range: [near, far] } => {
            Selection::from_predicate(canvas, |texel| {
                (*near..=*far).contains(&axis.dot(texel.position - *origin))
            })
        }
        SelectionShape::Normal { normal, degrees } => {
            let min_cosine = degrees.to_radians().cos();
            Selection::from_predicate(canvas, |texel| normal.dot(texel.normal.as_dvec3()) >= min_cosine)
        }
        SelectionShape::Similar { position, likeness, tolerance } => {
            let Some(start) = canvas.nearest(*position, |_| true) else {
                return Ok(SelectionResult::Nothing);
            };
            let tolerances = stage.surface_graph(progress)?.tolerances(canvas, start, *likeness);
            let is_alike = |index: usize| f64::from(tolerances[index]) <= *tolerance;
            Selection::from_indices(canvas, is_alike)
        }
        SelectionShape::Refined { width } => match before {
            Some(before) => before.refined(&*stage.surface_graph(progress)?, canvas, *width)?,
            None => SelectionResult::Everything,
        },
        SelectionShape::Outline { view, points, through } => {
            let width = stage.atlas.width as usize;
            let mut is_texel_inside = vec![false; width * stage.atlas.height as usize];
            let inside_indices = stage.texels.texels.par_iter().filter_map(|texel| {
                let position = texel.centroid.position(&stage.scene);
                let is_inside = is_inside_outline(points, view.position(position)?)
                    && (*through || !stage.tracer().is_hidden_from(texel.centroid, view.eye()));
                is_inside.then_some(texel.y as usize * width + texel.x as usize)
            });
            for index in inside_indices.collect::<Vec<_>>() {
                is_texel_inside[index] = true;
            }
            Selection::from_predicate(canvas, |texel| {
                is_texel_inside[texel.y as usize * width + texel.x as usize]
            })
        }
    })
}

/// The outline of the rectangle with two opposite corners in a view. `through` also selects hidden surfaces.
pub fn rectangle_outline(view: ViewFrame, [a, b]: [DVec2; 2], through: bool) -> SelectionShape {
    let points = vec![a, DVec2::new(b.x, a.y), b, DVec2::new(a.x, b.y)];
    SelectionShape::Outline { view, points, through }
}

/// Whether a point lies within a closed outline: a ray to the right crosses it an odd number of times.
fn is_inside_outline(outline: &[DVec2], position: DVec2) -> bool {
    let mut is_inside = false;
    for (k, &a) in outline.iter().enumerate() {
        let b = outline[(k + 1) % outline.len()];
        if (a.y > position.y) != (b.y > position.y)
            && position.x < a.x + (position.y - a.y) / (b.y - a.y) * (b.x - a.x)
        {
            is_inside = !is_inside;
        }
    }
    is_inside
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_inside_concave_outlines() {
        let arrow = [[0.0, 0.0], [1.0, 0.5], [0.0, 1.0], [0.3, 0.5]].map(DVec2::from_array);
        assert!(is_inside_outline(&arrow, DVec2::new(0.5, 0.5)));
        assert!(is_inside_outline(&arrow, DVec2::new(0.1, 0.1)));
        assert!(!is_inside_outline(&arrow, DVec2::new(0.1, 0.5)), "in the notch");
        assert!(!is_inside_outline(&arrow, DVec2::new(1.1, 0.5)));
    }
}
