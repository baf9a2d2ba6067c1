//! Edits other than strokes: fills, gradients, selections and layers. Each is an undo step with a record for replay, unless it changes
//! nothing.

use crate::adjustment_view::AdjustmentView;
use crate::editing::paintable::paintable_channels;
use crate::editing::selection_shapes::{SelectionMatches, SelectionTask};
use crate::editing::stroke_point::FillRegion;
use crate::error::DocumentError;
use crate::open_document::Document;
use focus::{
    ChangedTexels, Channels, CombineMode, Edit, FillTarget, FocusError, FocusMap, Gradient, LayerEdit,
    LayerStack, SelectionResult, draw_gradient, fill_selected,
};
use lens::FocusOffset;
use progress::Unwatched;
use project::{RecordedFill, RecordedGradient, RecordedSelection, RecordedStep, SelectionShape};
use std::sync::Arc;

impl From<FocusError> for DocumentError {
    fn from(error: FocusError) -> Self {
        Self::BadInput(error.to_string())
    }
}

impl Document {
    /// The targets that a region covers, including those at its mirror images under the brush's symmetry.
    pub fn fill_targets(&self, region: FillRegion) -> Vec<FillTarget> {
        let hit = match region {
            FillRegion::Node(hit)
            | FillRegion::Part(hit)
            | FillRegion::Material(hit)
            | FillRegion::Chart(hit) => hit,
            FillRegion::All => return vec![FillTarget::Everything],
        };
        let stage = &self.stage;
        let target = |part: u32, chart: u32| match region {
            // A picture is a single node: regions that are connected in depth serve as its objects.
            FillRegion::Node(_) if stage.scene.picture.is_some() => FillTarget::Chart(chart),
            FillRegion::Node(_) => FillTarget::Node(stage.scene.parts[part as usize].node),
            FillRegion::Material(_) => FillTarget::Material(stage.scene.parts[part as usize].material),
            FillRegion::Chart(_) => FillTarget::Chart(chart),
            FillRegion::Part(_) | FillRegion::All => FillTarget::Part(part),
        };
        let (triangle, images) = (hit.point.triangle as usize, self.symmetry_at(Some(&hit)).images());
        let hit_target = target(stage.scene.triangles[triangle].part, stage.atlas.chart_of[triangle]);
        let mirrored_targets = images[1..].iter().filter_map(|image| {
            let index = stage.canvas.nearest(image.point(hit.position), |_| true)?;
            let texel = stage.canvas.texel(index);
            Some(target(texel.part, texel.chart))
        });
        let mut targets: Vec<_> = std::iter::once(hit_target).chain(mirrored_targets).collect();
        targets.sort_unstable();
        targets.dedup();
        targets
    }

    /// Fills targets of the active layer with a focus offset. Returns what changed in the layer.
    ///
    /// # Errors
    /// The layer cannot be painted on, or the focus offset is invalid.
    pub fn fill(
        &mut self,
        targets: Vec<FillTarget>,
        focus: FocusOffset,
    ) -> Result<ChangedTexels, DocumentError> {
        let name = match targets.first() {
            Some(FillTarget::Node(_)) => "Fill object",
            Some(FillTarget::Part(_)) => "Fill part",
            Some(FillTarget::Material(_)) => "Fill material",
            Some(FillTarget::Chart(_)) if self.stage.scene.picture.is_some() => "Fill region",
            Some(FillTarget::Chart(_)) => "Fill chart",
            Some(FillTarget::Background) => "Background focus",
            Some(FillTarget::Everything) | None => "Fill everything",
        };
        let channels = paintable_channels(self.layers.active(), Channels::All)?;
        let (canvas, selection) = (self.stage.canvas.clone(), self.selection.clone());
        let layer = self.layers.active_mut();
        let before = layer.map.clone();
        let changed =
            fill_selected(&mut layer.map, &canvas, &targets, (focus, channels), selection.as_ref())?;
        let record = RecordedFill { layer: layer.name.clone(), targets, focus };
        self.push_paint(name, &before, RecordedStep::Fill(record));
        Ok(changed)
    }

    /// Draws a gradient in progress over `before`, the active layer's original map.
    ///
    /// # Errors
    /// The layer cannot be painted on, or the gradient is invalid.
    pub fn draw_gradient(&mut self, before: &FocusMap, gradient: &Gradient) -> Result<(), DocumentError> {
        let channels = paintable_channels(self.layers.active(), self.brush.channels)?;
        let (canvas, selection) = (self.stage.canvas.clone(), self.selection.clone());
        let map = &mut self.layers.active_mut().map;
        *map = before.clone();
        draw_gradient(map, &canvas, gradient, channels, selection.as_ref())?;
        Ok(())
    }

    /// Ends a gradient as an undo step. Returns whether it changed anything.
    pub(crate) fn finish_gradient(&mut self, before: &FocusMap, gradient: Gradient) -> bool {
        let layer = self.layers.active().name.clone();
        let record = RecordedGradient { layer, gradient };
        self.push_paint("Gradient", before, RecordedStep::Gradient(record))
    }

    /// Adds a change of the active layer's map to the history, if there is one. Returns whether there is.
    fn push_paint(&mut self, name: &str, before: &FocusMap, record: RecordedStep) -> bool {
        let index = self.layers.active_index();
        let Some(edit) = Edit::from_difference(name, before, &self.layers.active().map) else { return false };
        self.undo.push_paint(index, edit, Some(record));
        self.revision += 1;
        true
    }

    /// Changes the selection: the texels that may be painted. Returns whether it changed.
    ///
    /// # Errors
    /// The shape is invalid, or nothing would be selected.
    pub fn select(&mut self, shape: SelectionShape, combine: CombineMode) -> Result<bool, DocumentError> {
        let matches = self.selection_task(shape)?.solve(&Unwatched)?;
        self.select_matches(matches, combine)
    }

    /// What a shape covers, to be solved for in the background.
    ///
    /// # Errors
    /// The shape is invalid.
    pub fn selection_task(&self, shape: SelectionShape) -> Result<SelectionTask, DocumentError> {
        if !shape.is_valid() {
            return Err(DocumentError::BadInput("selection: the shape is invalid (choose another)".into()));
        }
        Ok(SelectionTask { stage: self.stage.clone(), shape, before: self.selection.clone() })
    }

    /// Combines what a shape covers, on this document's surface, with the selection. Returns whether that changed.
    ///
    /// # Errors
    /// Nothing would be selected, or the surface has changed since.
    pub fn select_matches(
        &mut self,
        SelectionMatches { task, matches }: SelectionMatches,
        combine: CombineMode,
    ) -> Result<bool, DocumentError> {
        if !Arc::ptr_eq(&task.stage.canvas, &self.stage.canvas) {
            let message = "selection: the surface has changed meanwhile (select once more)";
            return Err(DocumentError::BadInput(message.into()));
        }
        let (before, shape) = (self.selection.as_ref(), task.shape);
        let after = match matches.combine_with(before, combine, self.stage.canvas.texels().len()) {
            SelectionResult::Nothing => {
                let message = "selection: nothing would be selected (choose another shape)";
                return Err(DocumentError::BadInput(message.into()));
            }
            SelectionResult::Everything => None,
            SelectionResult::Some(selection) => Some(selection),
        };
        if after == self.selection {
            return Ok(false);
        }
        let before = std::mem::replace(&mut self.selection, after.clone());
        let name = if after.is_none() { "Select everything" } else { "Select" };
        let record = RecordedStep::Select(RecordedSelection { shape, combine });
        self.undo.push_selection(name, before, after, Some(record));
        Ok(true)
    }

    /// Edits the layers. Returns whether anything changed.
    ///
    /// # Errors
    /// The edit does not apply to these layers.
    pub fn edit_layers(&mut self, edit: LayerEdit) -> Result<bool, DocumentError> {
        let (name, record) = (edit.name(), RecordedStep::Layers(edit.clone()));
        self.change_layers(name, Some(record), |layers, document| {
            Ok(edit.apply(layers, &document.stage.canvas, &document.camera)?)
        })
    }

    /// Sets the active layer's mask from the selection. Returns whether anything changed.
    ///
    /// # Errors
    /// There is no selection.
    pub fn mask_selected(&mut self) -> Result<bool, DocumentError> {
        let Some(selection) = self.selection.clone() else {
            let message = "selection: everything is selected (select what the mask is to cover first)";
            return Err(DocumentError::BadInput(message.into()));
        };
        self.change_layers("Mask from selection", Some(RecordedStep::Mask), |layers, document| {
            layers.active_mut().map.set_mask_from_selection(&document.stage.canvas, &selection);
            Ok(())
        })
    }

    /// Removes all paint and all layers. Returns whether anything changed.
    ///
    /// # Errors
    /// None in practice; the result is that of [`Self::change_layers`].
    pub fn reset_map(&mut self) -> Result<bool, DocumentError> {
        let [width, height] = self.map.size();
        let blank = LayerStack::from_map(FocusMap::new(width, height, FocusOffset::STANDARD));
        self.change_layers("Reset all paint", Some(RecordedStep::Reset), |layers, _| {
            *layers = blank;
            Ok(())
        })
    }

    /// Changes the layers as one undo step. If `change` fails or changes nothing, the document is unaffected. Returns whether anything changed.
    ///
    /// # Errors
    /// Those of `change`.
    pub fn change_layers(
        &mut self,
        name: &str,
        record: Option<RecordedStep>,
        change: impl FnOnce(&mut LayerStack, &Document) -> Result<(), DocumentError>,
    ) -> Result<bool, DocumentError> {
        let before = self.layers.clone();
        let mut after = before.clone();
        change(&mut after, self)?;
        if after == before {
            return Ok(false);
        }
        self.layers = after.clone();
        self.adjustment_view = AdjustmentView::from_camera(&self.camera);
        self.undo.push_layers(name, before, after, record);
        self.revision += 1;
        Ok(true)
    }
}
