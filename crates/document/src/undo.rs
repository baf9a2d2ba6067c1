//! Undo and redo of paint, selection, lens, depth repair, splats and the scene's variant, in chronological order.

use crate::focus_hold::HeldCamera;
use focus::{Edit, EditThumbnail, LayerStack, LensMotion, Selection};
use lens::Camera;
use project::{FocusHold, RecordedSpread, RecordedStep};
use relief::DepthStroke;
use scene::SplatEdit;
use std::collections::VecDeque;
use std::sync::Arc;

/// What a step changed, before and after.
#[derive(Clone, Debug)]
enum Change {
    /// The map of one layer.
    Paint { layer: usize, edit: Edit },
    /// The stack of layers.
    Layers { before: Box<LayerStack>, after: Box<LayerStack> },
    /// The camera, and what its focus is held on.
    Camera { before: Box<HeldCamera>, after: Box<HeldCamera> },
    /// The keys of the lens, at a time in seconds.
    LensMotion { seconds: f64, before: Box<KeyedLens>, after: Box<KeyedLens> },
    /// The selection.
    Selection { before: Option<Selection>, after: Option<Selection> },
    /// The scene's variant, by name. Undoing it requires the caller to read the scene again.
    Variant { before: Option<String>, after: Option<String> },
    /// How splats are placed, and which are hidden. Undoing it requires the caller to show them so.
    Splats { before: Box<SplatEdit>, after: Box<SplatEdit> },
    /// Whether there is a floor. Undoing it requires the caller to show it or not.
    Floor { before: bool, after: bool },
    /// The strokes that repair depth. Undoing it requires the caller to make the surface anew.
    Depth { before: Arc<Vec<DepthStroke>>, after: Arc<Vec<DepthStroke>> },
}

impl Change {
    fn bytes(&self) -> usize {
        let selection_bytes = |selection: &Option<Selection>| selection.as_ref().map_or(0, Selection::bytes);
        match self {
            Self::Paint { edit, .. } => edit.bytes(),
            Self::Layers { before, after } => before.unshared_bytes(after) + after.unshared_bytes(before),
            Self::Camera { .. } => 2 * size_of::<HeldCamera>(),
            Self::LensMotion { before, after, .. } => {
                [before, after].into_iter().map(|lens| size_of::<Camera>() + lens.motion.bytes()).sum()
            }
            Self::Selection { before, after } => selection_bytes(before) + selection_bytes(after),
            // Each list has one stroke more than the previous, so that only `after` is counted.
            Self::Depth { after, .. } => after.iter().map(depth_stroke_bytes).sum(),
            Self::Splats { before, after } => [before, after]
                .into_iter()
                .map(|edit| size_of::<SplatEdit>() + size_of_val(&edit.hidden[..]))
                .sum(),
            Self::Floor { .. } => 0,
            Self::Variant { before, after } => [before, after].into_iter().flatten().map(String::len).sum(),
        }
    }
}

fn depth_stroke_bytes(stroke: &DepthStroke) -> usize {
    size_of::<DepthStroke>() + size_of_val(&*stroke.path)
}

/// An undo step.
#[derive(Clone, Debug)]
struct Step {
    name: String,
    change: Change,
    /// The step as data, if it can be recorded and replayed.
    record: Option<Box<RecordedStep>>,
    /// What it changed in the map, if anything.
    thumbnail: Option<EditThumbnail>,
    /// Memory used.
    bytes: usize,
    /// Its number in the order in which steps were made.
    number: u64,
}

impl Step {
    /// Whether it makes the document unsaved.
    fn is_change(&self) -> bool {
        !matches!(self.change, Change::Selection { .. })
    }

    fn new(name: String, change: Change, record: Option<RecordedStep>) -> Self {
        let record_bytes = record.as_ref().map_or(0, RecordedStep::bytes);
        let bytes = size_of::<Self>() + name.len() + change.bytes() + record_bytes;
        Self { name, change, record: record.map(Box::new), thumbnail: None, bytes, number: 0 }
    }
}

/// What an undo or redo changed.
#[derive(Clone, Debug, PartialEq)]
pub enum StepEffect {
    /// The map of a layer.
    Paint {
        /// The atlas coordinates of the changed texels.
        texels: Vec<[u32; 2]>,
        /// Whether the background's focus changed, too.
        changes_background: bool,
    },
    /// The layers, in any way.
    Layers,
    /// The camera.
    Camera,
    /// The keys of the lens, and the camera as it was with them at a time.
    LensMotion {
        /// The time, s.
        seconds: f64,
    },
    /// The selection.
    Selection,
    /// The variant that the scene must have now, by name.
    Variant(Option<String>),
    /// How the splats must be shown now.
    Splats(Box<SplatEdit>),
    /// Whether there must be a floor now.
    Floor(bool),
    /// The strokes that repair depth.
    Depth,
}

/// A step of the history, as shown in a list.
#[derive(Clone, Copy, Debug)]
pub struct HistoryStep<'a> {
    /// Its name.
    pub name: &'a str,
    /// What it changed in the focus map, if anything.
    pub thumbnail: Option<&'a EditThumbnail>,
    /// Whether it is done; otherwise it was undone and can be redone.
    pub is_done: bool,
}

impl<'a> HistoryStep<'a> {
    fn from_step(step: &'a Step, is_done: bool) -> Self {
        Self { name: &step.name, thumbnail: step.thumbnail.as_ref(), is_done }
    }
}

/// The state that undo and redo change.
pub struct UndoState<'a> {
    /// The layers of focus.
    pub layers: &'a mut LayerStack,
    /// The shot camera.
    pub camera: &'a mut Camera,
    /// What its focus is held on.
    pub focus_hold: &'a mut FocusHold,
    /// The keys of the lens.
    pub lens_motion: &'a mut LensMotion,
    /// The texels that may be painted; `None` for all.
    pub selection: &'a mut Option<Selection>,
    /// The strokes that repair depth.
    pub depth_strokes: &'a mut Arc<Vec<DepthStroke>>,
}

/// The keys of the lens, and the camera beside them: a lens without keys has no other record of its focus.
#[derive(Clone, Debug)]
pub struct KeyedLens {
    /// The keys.
    pub motion: LensMotion,
    /// The camera.
    pub camera: Camera,
}

impl KeyedLens {
    fn restore(&self, state: UndoState<'_>) {
        state.lens_motion.clone_from(&self.motion);
        state.camera.clone_from(&self.camera);
    }
}

impl HeldCamera {
    fn restore(&self, state: UndoState<'_>) {
        state.camera.clone_from(&self.camera);
        state.focus_hold.clone_from(&self.focus_hold);
    }
}

/// The undo history: steps that can be undone, and those that can be redone.
#[derive(Clone, Debug)]
pub struct UndoHistory {
    done: VecDeque<Step>,
    undone: Vec<Step>,
    /// Whether the next edit of the same kind joins the latest step.
    is_run_open: bool,
    /// Memory that the steps may use; beyond it, the oldest are dropped.
    budget_bytes: usize,
    bytes: usize,
    /// Number of steps that were ever made.
    made: u64,
    /// Number of the last change among the steps that were dropped; 0 for none.
    dropped_change: u64,
}

impl UndoHistory {
    /// A history without steps.
    pub(crate) fn new(budget_bytes: usize) -> Self {
        Self {
            done: VecDeque::new(),
            undone: Vec::new(),
            is_run_open: false,
            budget_bytes,
            bytes: 0,
            made: 0,
            dropped_change: 0,
        }
    }

    /// Sets the memory budget, bytes; the oldest steps beyond it are dropped.
    pub fn set_budget(&mut self, budget_bytes: usize) {
        self.budget_bytes = budget_bytes;
        self.forget_beyond_budget();
    }

    /// Adds a change of the map of a layer.
    pub(crate) fn push_paint(&mut self, layer: usize, edit: Edit, record: Option<RecordedStep>) {
        self.push(Step::new(edit.name().into(), Change::Paint { layer, edit }, record));
        self.is_run_open = false;
    }

    /// Adds a change of the selection.
    pub(crate) fn push_selection(
        &mut self,
        name: &str,
        before: Option<Selection>,
        after: Option<Selection>,
        record: Option<RecordedStep>,
    ) {
        self.push(Step::new(name.into(), Change::Selection { before, after }, record));
        self.is_run_open = false;
    }

    /// Adds a change of the keys of the lens, which was made at a time, s.
    pub fn push_lens_motion(&mut self, name: &str, seconds: f64, before: KeyedLens, after: KeyedLens) {
        let change = Change::LensMotion { seconds, before: before.into(), after: after.into() };
        self.push(Step::new(name.into(), change, None));
        self.is_run_open = false;
    }

    /// Adds a change of the scene's variant.
    pub fn push_variant(&mut self, before: Option<String>, after: Option<String>) {
        self.push(Step::new("Variant".into(), Change::Variant { before, after }, None));
        self.is_run_open = false;
    }

    /// Adds a change of how splats are shown, as a step of this name.
    pub fn push_splats(&mut self, name: &str, before: SplatEdit, after: SplatEdit) {
        let change = Change::Splats { before: before.into(), after: after.into() };
        self.push(Step::new(name.into(), change, None));
        self.is_run_open = false;
    }

    /// Adds a floor's coming or going.
    pub fn push_floor(&mut self, name: &str, before: bool, after: bool) {
        self.push(Step::new(name.into(), Change::Floor { before, after }, None));
        self.is_run_open = false;
    }

    /// Adds a change of the strokes that repair depth.
    pub fn push_depth(&mut self, name: &str, before: Arc<Vec<DepthStroke>>, after: Arc<Vec<DepthStroke>>) {
        self.push(Step::new(name.into(), Change::Depth { before, after }, None));
        self.is_run_open = false;
    }

    /// Adds rows at the bottom of all maps in the history.
    pub(crate) fn extend_rows(&mut self, height: u32) {
        for step in self.done.iter_mut().chain(&mut self.undone) {
            if let Change::Layers { before, after } = &mut step.change {
                before.extend_rows(height);
                after.extend_rows(height);
            }
        }
    }

    /// Replaces all selections in the history, after the texels of the canvas have changed.
    pub(crate) fn map_selections(&mut self, remap: impl Fn(&Selection) -> Option<Selection>) {
        for step in self.done.iter_mut().chain(&mut self.undone) {
            if let Change::Selection { before, after } = &mut step.change {
                *before = before.as_ref().and_then(&remap);
                *after = after.as_ref().and_then(&remap);
            }
        }
    }

    /// The records of the steps that can be undone, oldest first.
    pub fn records(&self) -> impl Iterator<Item = &RecordedStep> {
        self.done.iter().filter_map(|step| step.record.as_deref())
    }

    /// Adds a change of the layers. Consecutive edits of one property, as when a slider is dragged, are one step. The values of adjustment layers
    /// are not stored: after an undo, the caller evaluates them again.
    pub(crate) fn push_layers(
        &mut self,
        name: &str,
        before: LayerStack,
        after: LayerStack,
        record: Option<RecordedStep>,
    ) {
        let drag_target = |record: Option<&RecordedStep>| match record {
            Some(RecordedStep::Layers(edit)) => {
                edit.drag_target().map(|(name, layer)| (name, layer.to_string()))
            }
            Some(RecordedStep::Spread(RecordedSpread { layer, settings: Some(_) })) => {
                Some(("Spread", layer.clone()))
            }
            _ => None,
        };
        let dragged = drag_target(record.as_ref());
        let continues_run = |last: &Step| dragged.is_some() && drag_target(last.record.as_deref()) == dragged;
        let before = match self.pop_if_continued(continues_run) {
            Some(Step { change: Change::Layers { before, .. }, .. }) => before,
            _ => before.without_adjusted_values().into(),
        };
        let after = after.without_adjusted_values().into();
        self.push(Step::new(name.into(), Change::Layers { before, after }, record));
        self.is_run_open = dragged.is_some();
    }

    /// Adds a change of the camera; consecutive edits of one name are one step.
    pub fn push_camera(&mut self, name: &str, before: HeldCamera, after: HeldCamera) {
        let before = match self.pop_if_continued(|last| last.name == name) {
            Some(Step { change: Change::Camera { before, .. }, .. }) => before,
            _ => before.into(),
        };
        self.push(Step::new(name.into(), Change::Camera { before, after: after.into() }, None));
        self.is_run_open = true;
    }

    /// Removes the latest step, if the run of edits that it belongs to continues.
    fn pop_if_continued(&mut self, continues_run: impl Fn(&Step) -> bool) -> Option<Step> {
        let is_run_open = self.is_run_open;
        let last = self.done.pop_back_if(|last| is_run_open && continues_run(last))?;
        self.bytes -= last.bytes;
        Some(last)
    }

    /// Ends a run of edits: the next edit is a step of its own.
    pub fn finish_run(&mut self) {
        self.is_run_open = false;
    }

    /// The number of the latest step that is done and changes more than the selection; 0 if there never was one. Equal numbers mean equal
    /// documents, apart from what the history does not hold.
    pub(crate) fn latest_change(&self) -> u64 {
        let latest = self.done.iter().rev().find(|step| step.is_change());
        latest.map_or(self.dropped_change, |step| step.number)
    }

    fn push(&mut self, step: Step) {
        self.made += 1;
        let step = Step { number: self.made, ..step };
        self.bytes -= self.undone.drain(..).map(|step| step.bytes).sum::<usize>();
        self.bytes += step.bytes;
        self.done.push_back(step);
        self.forget_beyond_budget();
    }

    fn forget_beyond_budget(&mut self) {
        while self.bytes > self.budget_bytes && self.done.len() > 1 {
            let Some(dropped) = self.done.pop_front() else { return };
            self.bytes -= dropped.bytes;
            if dropped.is_change() {
                self.dropped_change = dropped.number;
            }
        }
    }

    /// Adds a thumbnail to the latest step.
    pub(crate) fn set_thumbnail(&mut self, thumbnail: EditThumbnail) {
        if let Some(step) = self.done.back_mut() {
            let before = step.thumbnail.as_ref().map_or(0, EditThumbnail::bytes);
            step.bytes = step.bytes - before + thumbnail.bytes();
            self.bytes = self.bytes - before + thumbnail.bytes();
            step.thumbnail = Some(thumbnail);
            self.forget_beyond_budget();
        }
    }

    /// Undoes the latest step in `state`, and returns what that affects; `None` if there is none.
    pub fn undo(&mut self, state: UndoState<'_>) -> Option<StepEffect> {
        let step = self.done.pop_back()?;
        self.is_run_open = false;
        let effect = match &step.change {
            Change::Paint { layer, edit } => {
                state.layers.activate(*layer);
                let texels = edit.revert(&mut state.layers.active_mut().map).texels;
                StepEffect::Paint { texels, changes_background: edit.changes_background() }
            }
            Change::Layers { before, .. } => {
                *state.layers = (**before).clone();
                StepEffect::Layers
            }
            Change::Camera { before, .. } => {
                before.restore(state);
                StepEffect::Camera
            }
            Change::LensMotion { seconds, before, .. } => {
                before.restore(state);
                StepEffect::LensMotion { seconds: *seconds }
            }
            Change::Selection { before, .. } => {
                *state.selection = before.clone();
                StepEffect::Selection
            }
            Change::Variant { before, .. } => StepEffect::Variant(before.clone()),
            Change::Splats { before, .. } => StepEffect::Splats(before.clone()),
            Change::Floor { before, .. } => StepEffect::Floor(*before),
            Change::Depth { before, .. } => {
                *state.depth_strokes = before.clone();
                StepEffect::Depth
            }
        };
        self.undone.push(step);
        Some(effect)
    }

    /// Redoes the step that was undone last; `None` if there is none.
    pub fn redo(&mut self, state: UndoState<'_>) -> Option<StepEffect> {
        let step = self.undone.pop()?;
        self.is_run_open = false;
        let effect = match &step.change {
            Change::Paint { layer, edit } => {
                state.layers.activate(*layer);
                let texels = edit.apply(&mut state.layers.active_mut().map).texels;
                StepEffect::Paint { texels, changes_background: edit.changes_background() }
            }
            Change::Layers { after, .. } => {
                *state.layers = (**after).clone();
                StepEffect::Layers
            }
            Change::Camera { after, .. } => {
                after.restore(state);
                StepEffect::Camera
            }
            Change::LensMotion { seconds, after, .. } => {
                after.restore(state);
                StepEffect::LensMotion { seconds: *seconds }
            }
            Change::Selection { after, .. } => {
                *state.selection = after.clone();
                StepEffect::Selection
            }
            Change::Variant { after, .. } => StepEffect::Variant(after.clone()),
            Change::Splats { after, .. } => StepEffect::Splats(after.clone()),
            Change::Floor { after, .. } => StepEffect::Floor(*after),
            Change::Depth { after, .. } => {
                *state.depth_strokes = after.clone();
                StepEffect::Depth
            }
        };
        self.done.push_back(step);
        Some(effect)
    }

    /// The name of the step that undo would revert.
    pub(crate) fn undo_name(&self) -> Option<&str> {
        self.done.back().map(|step| &*step.name)
    }

    /// The name of the step that redo would repeat.
    pub(crate) fn redo_name(&self) -> Option<&str> {
        self.undone.last().map(|step| &*step.name)
    }

    /// The names of the steps that can be undone, oldest first.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.done.iter().map(|step| &*step.name)
    }

    /// All steps, oldest first, the undone ones last.
    pub(crate) fn steps(&self) -> impl Iterator<Item = HistoryStep<'_>> {
        let done = self.done.iter().map(|step| HistoryStep::from_step(step, true));
        done.chain(self.undone.iter().rev().map(|step| HistoryStep::from_step(step, false)))
    }

    /// Memory used by the steps, and the budget, bytes.
    pub(crate) fn bytes(&self) -> [usize; 2] {
        [self.bytes, self.budget_bytes]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use focus::{Ease, FocusLayer, FocusMap, FocusTarget, Key, LayerEdit};
    use lens::FocusOffset;

    /// The state of a document that can be undone.
    struct State {
        undo: UndoHistory,
        layers: LayerStack,
        camera: Camera,
        focus_hold: FocusHold,
        lens_motion: LensMotion,
        selection: Option<Selection>,
        depth_strokes: Arc<Vec<DepthStroke>>,
    }

    impl State {
        fn new() -> Self {
            let layers = LayerStack::from_map(FocusMap::new(4, 4, FocusOffset::STANDARD));
            let (lens_motion, selection, depth_strokes) = (LensMotion::default(), None, Arc::default());
            Self {
                undo: UndoHistory::new(1 << 20),
                layers,
                camera: camera_focused_at(3.0),
                focus_hold: FocusHold::Distance,
                lens_motion,
                selection,
                depth_strokes,
            }
        }

        fn undo(&mut self) -> Option<StepEffect> {
            let Self { undo, layers, camera, focus_hold, lens_motion, selection, depth_strokes } = self;
            undo.undo(UndoState { layers, camera, focus_hold, lens_motion, selection, depth_strokes })
        }

        fn redo(&mut self) -> Option<StepEffect> {
            let Self { undo, layers, camera, focus_hold, lens_motion, selection, depth_strokes } = self;
            undo.redo(UndoState { layers, camera, focus_hold, lens_motion, selection, depth_strokes })
        }

        fn set_focus(&mut self, at: f64) {
            let held =
                |camera: &Camera| HeldCamera { camera: camera.clone(), focus_hold: FocusHold::Distance };
            let before = std::mem::replace(&mut self.camera, camera_focused_at(at));
            self.undo.push_camera("Focus distance", held(&before), held(&self.camera));
        }
    }

    fn camera_focused_at(at: f64) -> Camera {
        Camera { focus_distance: at, ..Camera::default() }
    }

    #[test]
    fn a_dragged_slider_is_one_step() {
        let mut state = State::new();
        (4..9).for_each(|at| state.set_focus(at as f64));
        state.undo.finish_run();
        state.set_focus(9.0);
        assert_eq!(state.undo(), Some(StepEffect::Camera));
        assert_eq!(state.camera.focus_distance, 8.0);
        state.undo();
        assert_eq!(state.camera.focus_distance, 3.0);
        assert_eq!(state.undo(), None);
        state.redo();
        assert_eq!(state.camera.focus_distance, 8.0);
    }

    #[test]
    fn keys_that_are_taken_back_bring_the_camera_back() {
        let mut state = State::new();
        let without_keys = KeyedLens { motion: LensMotion::default(), camera: state.camera.clone() };
        let mut motion = LensMotion::default();
        let value = FocusTarget::Distance(5.0);
        assert!(motion.focus.insert(Key { seconds: 0.0, value, ease: Ease::default() }));
        (state.lens_motion, state.camera) = (motion.clone(), camera_focused_at(5.0));
        let keyed = KeyedLens { motion: motion.clone(), camera: state.camera.clone() };
        state.undo.push_lens_motion("Key lens", 2.0, without_keys, keyed);
        assert_eq!(state.undo(), Some(StepEffect::LensMotion { seconds: 2.0 }));
        assert_eq!((state.camera.focus_distance, state.lens_motion.is_empty()), (3.0, true));
        state.redo();
        assert_eq!((state.camera.focus_distance, &state.lens_motion), (5.0, &motion));
    }

    #[test]
    fn the_oldest_steps_are_dropped_first() {
        let mut state = State::new();
        state.set_focus(4.0);
        let [one, _] = state.undo.bytes();
        state.undo = UndoHistory::new(5 * one + one / 2);
        for at in 5..15 {
            state.set_focus(at as f64);
            state.undo.finish_run();
        }
        assert_eq!(state.undo.bytes(), [5 * one, 5 * one + one / 2]);
        state.undo();
        assert_eq!(state.undo.bytes()[0], 5 * one, "steps that can be redone count, too");
        state.set_focus(20.0);
        assert_eq!(state.undo.bytes()[0], 5 * one);
        while state.undo().is_some() {}
        assert_eq!(state.camera.focus_distance, 9.0, "the first five are forgotten");
        state.undo = UndoHistory::new(0);
        state.set_focus(1.0);
        assert_eq!(state.undo.names().count(), 1, "the latest is kept");
    }

    #[test]
    fn paint_layers_and_lens_are_undone_in_order() {
        let mut state = State::new();
        let before = state.layers.clone();
        state.layers.active_mut().map.set(1, 2, [0.5, 1.0]);
        let map = &state.layers.active().map;
        let edit = Edit::from_difference("Brush stroke", &before.active().map, map).unwrap();
        state.undo.push_paint(0, edit, None);
        let painted = state.layers.clone();
        assert!(state.layers.insert(FocusLayer::from_map("Layer 1", FocusMap::transparent(4, 4))));
        state.undo.push_layers("Add layer", painted.clone(), state.layers.clone(), None);
        let two = state.layers.clone();
        state.set_focus(5.0);
        assert_eq!(state.undo.undo_name(), Some("Focus distance"));
        state.undo();
        assert_eq!((state.camera.focus_distance, &state.layers), (3.0, &two));
        assert_eq!(state.undo(), Some(StepEffect::Layers));
        assert_eq!(state.layers, painted);
        assert_eq!(state.undo(), Some(StepEffect::Paint { texels: vec![[1, 2]], changes_background: false }));
        assert_eq!(state.layers, before);
        state.redo();
        state.redo();
        assert_eq!(state.layers, two);
        state.set_focus(6.0);
        assert_eq!(state.undo.redo_name(), None, "a new step drops the undone ones");
    }

    #[test]
    fn a_dragged_opacity_is_one_step_per_layer() {
        let mut state = State::new();
        assert!(state.layers.insert(FocusLayer::from_map("Layer 1", FocusMap::transparent(4, 4))));
        let first = state.layers.clone();
        for (layer, opacity) in [(0, 0.9), (0, 0.8), (0, 0.7), (1, 0.6), (1, 0.5)] {
            let before = state.layers.clone();
            state.layers.layer_mut(layer).unwrap().opacity = opacity;
            let edit = RecordedStep::Layers(LayerEdit::Opacity(layer, opacity));
            state.undo.push_layers("Layer opacity", before, state.layers.clone(), Some(edit));
        }
        let records: Vec<_> = state.undo.records().cloned().collect();
        assert_eq!(
            records,
            [(0, 0.7), (1, 0.5)].map(|(k, o)| RecordedStep::Layers(LayerEdit::Opacity(k, o)))
        );
        state.undo();
        assert_eq!(state.layers.layers()[0].opacity, 0.7);
        state.undo();
        assert_eq!(state.layers, first);
        assert_eq!(state.undo.undo_name(), None);
    }
}
