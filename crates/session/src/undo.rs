//! Undo and redo of paint and lens in the order in which they happened.

use focus::{Edit, LayerStack};
use lens::Camera;
use project::RecordedStroke;
use std::collections::VecDeque;

/// Memory that the steps may keep alive; the oldest are forgotten beyond it.
const BUDGET_BYTES: usize = 256 << 20;

/// One step.
#[derive(Clone, Debug)]
enum Step {
    /// Of the map of one layer; a stroke with what was drawn.
    Paint { layer: usize, edit: Edit, stroke: Option<Box<RecordedStroke>> },
    /// Of the layers themselves.
    Layers { name: &'static str, before: Box<LayerStack>, after: Box<LayerStack> },
    /// Of the camera.
    Camera { name: &'static str, before: Box<Camera>, after: Box<Camera> },
}

impl Step {
    fn name(&self) -> &str {
        match self {
            Self::Paint { edit, .. } => edit.name(),
            Self::Layers { name, .. } | Self::Camera { name, .. } => name,
        }
    }

    fn bytes(&self) -> usize {
        match self {
            Self::Paint { edit, stroke, .. } => {
                let points = stroke.as_ref().map_or(0, |stroke| size_of_val(&*stroke.points));
                size_of::<Step>() + edit.bytes() + points
            }
            Self::Layers { before, after, .. } => {
                size_of::<Step>() + before.bytes_beside(after) + after.bytes_beside(before)
            }
            Self::Camera { .. } => size_of::<Step>() + 2 * size_of::<Camera>(),
        }
    }
}

/// What a step of undo or redo changed.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Undone {
    /// These texels of a layer, and perhaps its background.
    Paint { texels: Vec<[u32; 2]>, background: bool },
    /// The layers, in whatever way.
    Layers,
    /// The camera.
    Camera,
}

/// The steps that can be taken back, and those that can be done again.
#[derive(Clone, Debug, Default)]
pub(crate) struct Undo {
    done: VecDeque<Step>,
    undone: Vec<Step>,
    /// Whether the next edit of the same name joins the latest step.
    run: bool,
}

impl Undo {
    /// Takes up a change of the map of a layer.
    pub fn push_paint(&mut self, layer: usize, edit: Edit) {
        self.push(Step::Paint { layer, edit, stroke: None });
        self.run = false;
    }

    /// Takes up a stroke on a layer.
    pub fn push_stroke(&mut self, layer: usize, edit: Edit, stroke: Option<RecordedStroke>) {
        self.push(Step::Paint { layer, edit, stroke: stroke.map(Box::new) });
        self.run = false;
    }

    /// The strokes that can be taken back, oldest first.
    pub fn strokes(&self) -> impl Iterator<Item = &RecordedStroke> {
        self.done.iter().filter_map(|step| match step {
            Step::Paint { stroke, .. } => stroke.as_deref(),
            Step::Layers { .. } | Step::Camera { .. } => None,
        })
    }

    /// Takes up a change of the layers; edits of one name in a row are one step where `joins` says so.
    pub fn push_layers(&mut self, name: &'static str, before: LayerStack, after: LayerStack, joins: bool) {
        match self.done.back_mut() {
            Some(Step::Layers { name: last, after: end, .. }) if self.run && joins && *last == name => {
                **end = after;
                self.undone.clear();
            }
            _ => self.push(Step::Layers { name, before: before.into(), after: after.into() }),
        }
        self.run = joins;
    }

    /// Takes up a change of the camera; edits of one name in a row are one step.
    pub fn push_camera(&mut self, name: &'static str, before: Camera, after: Camera) {
        match self.done.back_mut() {
            Some(Step::Camera { name: last, after: end, .. }) if self.run && *last == name => {
                **end = after;
                self.undone.clear();
            }
            _ => self.push(Step::Camera { name, before: before.into(), after: after.into() }),
        }
        self.run = true;
    }

    /// Ends a run of edits.
    pub fn finish_run(&mut self) {
        self.run = false;
    }

    fn push(&mut self, step: Step) {
        self.undone.clear();
        self.done.push_back(step);
        self.forget_beyond(BUDGET_BYTES);
    }

    /// Forgets the oldest steps beyond a budget; the latest is kept.
    fn forget_beyond(&mut self, budget_bytes: usize) {
        while self.bytes() > budget_bytes && self.done.len() > 1 {
            self.done.pop_front();
        }
    }

    /// Takes the latest step back.
    pub fn undo(&mut self, layers: &mut LayerStack, camera: &mut Camera) -> Option<Undone> {
        let step = self.done.pop_back()?;
        self.run = false;
        let undone = match &step {
            Step::Paint { layer, edit, .. } => {
                layers.activate(*layer);
                let texels = edit.revert(&mut layers.active_mut().map).texels;
                Undone::Paint { texels, background: edit.changes_background() }
            }
            Step::Layers { before, .. } => {
                *layers = (**before).clone();
                Undone::Layers
            }
            Step::Camera { before, .. } => {
                *camera = (**before).clone();
                Undone::Camera
            }
        };
        self.undone.push(step);
        Some(undone)
    }

    /// Makes the step again that was taken back last.
    pub fn redo(&mut self, layers: &mut LayerStack, camera: &mut Camera) -> Option<Undone> {
        let step = self.undone.pop()?;
        self.run = false;
        let done = match &step {
            Step::Paint { layer, edit, .. } => {
                layers.activate(*layer);
                let texels = edit.apply(&mut layers.active_mut().map).texels;
                Undone::Paint { texels, background: edit.changes_background() }
            }
            Step::Layers { after, .. } => {
                *layers = (**after).clone();
                Undone::Layers
            }
            Step::Camera { after, .. } => {
                *camera = (**after).clone();
                Undone::Camera
            }
        };
        self.done.push_back(step);
        Some(done)
    }

    pub fn undo_name(&self) -> Option<&str> {
        self.done.back().map(Step::name)
    }

    pub fn redo_name(&self) -> Option<&str> {
        self.undone.last().map(Step::name)
    }

    /// All steps that can be taken back, oldest first.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.done.iter().map(Step::name)
    }

    pub fn bytes(&self) -> usize {
        self.done.iter().chain(&self.undone).map(Step::bytes).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use focus::{FocusLayer, FocusMap};
    use lens::FocusOffset;

    fn blank() -> LayerStack {
        LayerStack::of(FocusMap::new(4, 4, FocusOffset::STANDARD))
    }

    fn focused(at: f64) -> Camera {
        Camera { focus_distance: at, ..Camera::default() }
    }

    #[test]
    fn a_dragged_slider_is_one_step() {
        let mut undo = Undo::default();
        let mut layers = blank();
        let mut camera = focused(3.0);
        for k in 0..5 {
            undo.push_camera("Focus distance", focused(3.0 + k as f64), focused(4.0 + k as f64));
        }
        undo.finish_run();
        undo.push_camera("Focus distance", focused(8.0), focused(9.0));
        assert_eq!(undo.undo(&mut layers, &mut camera), Some(Undone::Camera));
        assert_eq!(camera.focus_distance, 8.0);
        undo.undo(&mut layers, &mut camera);
        assert_eq!(camera.focus_distance, 3.0);
        assert_eq!(undo.undo(&mut layers, &mut camera), None);
        undo.redo(&mut layers, &mut camera);
        assert_eq!(camera.focus_distance, 8.0);
    }

    #[test]
    fn the_oldest_steps_are_forgotten_first() {
        let mut undo = Undo::default();
        for k in 0..10 {
            undo.push_camera("Focus distance", focused(3.0 + k as f64), focused(4.0 + k as f64));
            undo.finish_run();
        }
        let (ten, budget) = (undo.bytes(), undo.bytes() / 2);
        undo.forget_beyond(budget);
        assert!(undo.bytes() <= budget && undo.bytes() > ten / 3);
        let (mut layers, mut camera) = (blank(), focused(13.0));
        undo.undo(&mut layers, &mut camera);
        assert_eq!(camera.focus_distance, 12.0);
        undo.forget_beyond(0);
        assert_eq!(undo.names().count(), 1, "the latest is kept");
    }

    #[test]
    fn paint_layers_and_lens_are_undone_in_order() {
        let mut undo = Undo::default();
        let mut layers = blank();
        let before = layers.clone();
        layers.active_mut().map.set(1, 2, [0.5, 1.0]);
        let edit = Edit::between("Brush stroke", &before.active().map, &layers.active().map).unwrap();
        undo.push_paint(0, edit);
        let painted = layers.clone();
        assert!(layers.insert(FocusLayer::painted("Layer 1", FocusMap::clear(4, 4))));
        undo.push_layers("Add layer", painted.clone(), layers.clone(), false);
        let two = layers.clone();
        let mut camera = focused(5.0);
        undo.push_camera("Focus distance", focused(3.0), focused(5.0));
        assert_eq!(undo.undo_name(), Some("Focus distance"));
        undo.undo(&mut layers, &mut camera);
        assert_eq!((camera.focus_distance, &layers), (3.0, &two));
        assert_eq!(undo.undo(&mut layers, &mut camera), Some(Undone::Layers));
        assert_eq!(layers, painted);
        let undone = undo.undo(&mut layers, &mut camera);
        assert_eq!(undone, Some(Undone::Paint { texels: vec![[1, 2]], background: false }));
        assert_eq!(layers, before);
        undo.redo(&mut layers, &mut camera);
        undo.redo(&mut layers, &mut camera);
        assert_eq!(layers, two);
        undo.push_camera("Focus distance", focused(3.0), focused(6.0));
        assert_eq!(undo.redo_name(), None, "a new step forgets what was undone");
    }

    #[test]
    fn a_dragged_opacity_is_one_step() {
        let mut undo = Undo::default();
        let (mut layers, mut camera) = (blank(), focused(3.0));
        let first = layers.clone();
        for k in 1..=5 {
            let before = layers.clone();
            layers.active_mut().opacity = 1.0 - 0.1 * k as f64;
            undo.push_layers("Layer opacity", before, layers.clone(), true);
        }
        undo.undo(&mut layers, &mut camera);
        assert_eq!(layers, first);
        assert_eq!(undo.undo_name(), None);
    }
}
