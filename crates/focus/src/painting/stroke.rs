//! A stroke: dabs along the pen's path, as one transaction.

use crate::painting::dab::Dab;
use crate::painting::stroke_painter::StrokePainter;
use crate::{Brush, Canvas, ChangedTexels, Edit, FocusError, FocusMap, PenSample, Selection, SymmetryImage};
use glam::{DVec3, Vec3};
use std::sync::Arc;

/// Where the pen touches the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceHit {
    /// World position.
    pub position: DVec3,
    /// Unit geometric normal of the triangle, as the scene has it (not turned to the viewer); `None` paints
    /// every side whatever the brush's limit.
    pub normal: Option<Vec3>,
}

/// A stroke in progress.
///
/// Begin on pen down, extend with every reported hit, commit on pen up, abort on Esc. Dabs lie at equal distances
/// (spacing · radius) along the polyline through the hits, so it does not matter how the hits are grouped into
/// events. A stroke that changed nothing commits to `None`.
#[derive(Debug)]
pub struct Stroke {
    brush: Brush,
    canvas: Arc<Canvas>,
    before: FocusMap,
    /// How strongly each texel of the canvas has been painted so far, in [0, 1].
    coverage: Vec<f32>,
    /// Which texels may be painted; `None`: all.
    selection: Option<Selection>,
    /// The symmetry's images of every dab.
    images: Vec<SymmetryImage>,
    /// The last hit; the distance from it to the next dab is `until_next_dab`.
    last: Option<(SurfaceHit, PenSample)>,
    until_next_dab: f64,
}

/// A straight segment with more dabs than this is not a movement of the pen but a jump between two surfaces.
const MAX_DABS_PER_STEP: f64 = 4096.0;

impl Stroke {
    /// Begins a stroke on `map`, which must have the canvas's size.
    ///
    /// # Errors
    /// [`FocusError::BadBrush`] if the brush is invalid, [`FocusError::SizesDiffer`] if map and canvas differ in
    /// size.
    pub fn begin(map: &FocusMap, canvas: Arc<Canvas>, brush: Brush) -> Result<Self, FocusError> {
        if let Some(problem) = brush.problem() {
            return Err(FocusError::BadBrush { problem });
        }
        if map.size() != canvas.size() {
            return Err(FocusError::SizesDiffer { map: map.size(), canvas: canvas.size() });
        }
        let coverage = vec![0.0; canvas.texels().len()];
        let images = brush.symmetry().images();
        let (before, selection) = (map.clone(), None);
        Ok(Self { brush, canvas, before, coverage, selection, images, last: None, until_next_dab: 0.0 })
    }

    /// The same stroke, restricted to the selected texels; `None` lifts the restriction.
    pub fn with_selection(self, selection: Option<Selection>) -> Self {
        Self { selection, ..self }
    }

    /// Draws on from the last hit to `hit`. Returns the texels that changed.
    pub fn extend(&mut self, map: &mut FocusMap, hit: SurfaceHit, pen: PenSample) -> ChangedTexels {
        let mut changed = Vec::new();
        if !hit.position.is_finite() {
            return ChangedTexels::default();
        }
        let from = self.last.replace((hit, pen));
        let length = from.map_or(0.0, |(last, _)| last.position.distance(hit.position));
        match from {
            Some((last, last_pen)) if length <= MAX_DABS_PER_STEP * self.dab_spacing(pen) => {
                let mut along = self.until_next_dab;
                while along <= length {
                    // A segment of length 0 has no dab of its own: the one at its start is already painted.
                    let share = if length > 0.0 { along / length } else { 1.0 };
                    let mix = |a: f64, b: f64| a + (b - a) * share;
                    let pen = PenSample { pressure: mix(last_pen.pressure, pen.pressure) };
                    let position = last.position.lerp(hit.position, share);
                    let normal = last.normal.zip(hit.normal).map(|(a, b)| a.lerp(b, share as f32));
                    let normal = normal.and_then(Vec3::try_normalize).or(hit.normal);
                    self.paint_dab(map, SurfaceHit { position, normal }, pen, &mut changed);
                    along += self.dab_spacing(pen);
                }
                self.until_next_dab = along - length;
            }
            _ => {
                self.paint_dab(map, hit, pen, &mut changed);
                self.until_next_dab = self.dab_spacing(pen);
            }
        }
        ChangedTexels::new(changed)
    }

    /// Lifts the pen off the surface: the next hit starts a new path, without a line from the last one. For a pen
    /// that leaves the object, or a surface that jumps under it.
    pub fn lift(&mut self) {
        self.last = None;
    }

    /// Ends the stroke. Returns its edit; `None` if there is nothing to undo.
    pub fn commit(self, map: &FocusMap) -> Option<Edit> {
        Edit::from_difference(self.brush.stroke_name(), &self.before, map)
    }

    /// Reverts the stroke in `map`. Returns the texels that changed.
    pub fn abort(self, map: &mut FocusMap) -> ChangedTexels {
        match Edit::from_difference(self.brush.stroke_name(), map, &self.before) {
            Some(edit) => edit.apply(map),
            None => ChangedTexels::default(),
        }
    }

    /// The brush that the stroke paints with.
    pub fn brush(&self) -> &Brush {
        &self.brush
    }

    /// Distance between consecutive dabs.
    fn dab_spacing(&self, pen: PenSample) -> f64 {
        // A radius near 0 would never advance.
        let radius = self.brush.radius_at(pen).max(self.brush.radius * MIN_RADIUS_SHARE);
        self.brush.spacing * radius
    }

    fn paint_dab(
        &mut self,
        map: &mut FocusMap,
        hit: SurfaceHit,
        pen: PenSample,
        changed: &mut Vec<[u32; 2]>,
    ) {
        for image in &self.images {
            let dab = Dab {
                center: image.point(hit.position),
                normal: hit.normal.map(|normal| image.direction(normal.as_dvec3()).as_vec3()),
                radius: self.brush.radius_at(pen),
                strength: self.brush.strength_at(pen),
            };
            let mut wash = StrokePainter {
                before: &self.before,
                coverage: &mut self.coverage,
                selection: self.selection.as_ref(),
            };
            wash.paint_dab(&dab, &self.brush, &self.canvas, map, changed);
        }
    }
}

/// The spacing of dabs is computed for at least this fraction of the brush's radius, however light the pen.
const MIN_RADIUS_SHARE: f64 = 0.05;
