//! An open document: the scene, its focus and its camera.

use crate::adjustment_view::AdjustmentView;
use crate::error::{DocumentError, file_name};
use crate::first_view::first_view;
use crate::focus_hold::HeldCamera;
use crate::input::{CameraChoice, Input, InputKind, VariantChoice, camera_from_photograph, prefix_with_path};
use crate::paint_transfer::TransferredPaint;
use crate::picking::SurfaceHit;
use crate::scene_camera::shot_camera_from;
use crate::splat_focus::{is_focus_table, read_splat_focus};
use crate::spread_task::SolvedSpread;
use crate::stage::Stage;
use crate::undo::{HistoryStep, UndoHistory};
use atlas::UnwrapOptions;
use focus::{
    Brush, CanvasTexel, ChangedTexels, EditThumbnail, FocusMap, FocusRecipe, LayerStack, LensMotion,
    RecipeEntry, Selection, SelectionResult,
};
use lens::{Camera, Exposure, FocusOffset};
use light::{Resources, Steps};
use progress::Unwatched;
use project::{
    CaptureChoices, FocusFile, FocusHold, NamedCamera, ProjectFile, SplatsFile, TexelSet, WorldFile,
};
use relief::DepthStroke;
use scene::{Scene, SplatEdit, View};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What a new document starts with.
#[derive(Clone, Debug, Default)]
pub struct NewDocumentOptions<'a> {
    /// The camera; by default the scene's first.
    pub camera: Option<&'a CameraChoice>,
    /// A recipe or a focus map; by default the ordinary lens.
    pub focus: Option<&'a Path>,
    /// A project whose paint is transferred by surface.
    pub paint_from: Option<&'a Path>,
    /// The variant of the scene's materials.
    pub variant: VariantChoice,
    /// Gaussian splats that are added to the scene, or how those that it has are shown.
    pub splats: Option<&'a SplatsFile>,
    /// Whether a floor that catches shadows is put under the scene.
    pub floor: bool,
}

/// An open document. Focus map, camera and the scene's variant are saved, and their changes can be undone. The selection is saved and can be
/// undone, too, but changing it does not make the document unsaved. Brush, exposure and view are saved, but are not part of the history.
pub struct Document {
    /// The scene, its atlas, and what rays and dabs work on.
    pub stage: Arc<Stage>,
    /// The layers of focus.
    pub layers: LayerStack,
    /// The composite of the layers: the focus that is rendered and exported.
    pub map: FocusMap,
    /// The shot camera.
    pub camera: Camera,
    /// What its focus is held on while it moves.
    pub focus_hold: FocusHold,
    /// How the lens moves over time. The motion of layers is stored in the layers.
    pub lens_motion: LensMotion,
    /// The time shown, s: camera and layers have the values of their keys at this time. Neither saved nor undone.
    pub seconds: f64,
    /// How the rendered sum becomes the picture.
    pub exposure: Exposure,
    /// The brush of the next strokes.
    pub brush: Brush,
    /// The texels that may be painted; `None` for all.
    pub selection: Option<Selection>,
    /// The strokes that repair depth, in order. The stage may not include the latest yet.
    pub depth_strokes: Arc<Vec<DepthStroke>>,
    /// Layout and viewpoint of the window, any JSON.
    pub view: serde_json::Value,
    /// The project file; `None` before the first save.
    pub path: Option<PathBuf>,
    /// Anything unusual but harmless about its files, a sentence each.
    pub warnings: Vec<String>,
    /// How the paint was transferred to this surface, if it was painted on another. The step can be undone; the project that it comes from is
    /// not changed.
    pub paint_transfer: Option<TransferredPaint>,
    /// The strokes that were solved for last, to be spread at once. Neither saved nor undone.
    pub(crate) solved_spread: Option<SolvedSpread>,
    /// The view that the adjustment layers were evaluated for.
    pub adjustment_view: AdjustmentView,
    /// Everything saved besides the fields above.
    pub(crate) template: ProjectFile,
    /// The undo history.
    pub undo: UndoHistory,
    /// The map after the latest step, which the next thumbnail is compared with.
    thumbnail_base: FocusMap,
    /// Incremented by every change that is saved.
    pub revision: u64,
    /// The state that is in the project file.
    saved: SavedState,
    /// Number of changes that are saved and not in the undo history.
    pub(crate) unrecorded_changes: u64,
}

/// A state of a document, to be told from others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SavedState {
    /// [`Document::revision`].
    pub revision: u64,
    /// The latest step of undo, and the number of changes beside them.
    change: [u64; 2],
}

/// The name of the saved camera of a new document.
const SHOT_CAMERA_NAME: &str = "shot";

impl Document {
    /// The default memory budget of the undo history, bytes.
    pub const UNDO_BUDGET_BYTES: usize = 256 << 20;

    /// Opens a scene or a project. A scene without a camera is framed so that its depth shows. Work that was unsaved when the program last ended is restored: the document is then unsaved, and its warnings
    /// say so.
    ///
    /// # Errors
    /// The file is a light field; it, or a file that it refers to, cannot be read or used; or the work was cancelled.
    pub fn open(
        path: &Path,
        unwrap: &UnwrapOptions,
        resources: &Resources,
        steps: &dyn Steps,
    ) -> Result<Self, DocumentError> {
        let kind = InputKind::from_path(path)?;
        if kind == InputKind::LightField {
            let message =
                "a light field has no surface to paint on (open the scene or project it was baked from)";
            return Err(DocumentError::bad_file(path, message));
        }
        let is_project = kind == InputKind::Project;
        let recovery = recovery_path(path, is_project);
        let recovered = project::find_recovery(&recovery, is_project.then_some(path));
        let is_recovered = recovered.is_some();
        let input = match recovered {
            Some(project) => Input::open_project(path, project, &VariantChoice::AsSaved, resources, steps)?,
            None => Input::open(path, resources, steps)?,
        };
        let has_own_camera = input.has_own_camera();
        let mut document = Self::from_input(input, unwrap, steps)?;
        if !has_own_camera {
            let first = first_view(document.stage.tracer(), &document.camera);
            document.adjustment_view = AdjustmentView::from_camera(&first.camera);
            let (low, high) = document.stage.scene.bounds();
            document.brush.radius = brush_radius(&first.camera, (high - low).length());
            document.set_held_camera(first);
        }
        document.path = (is_project && document.paint_transfer.is_none()).then(|| path.into());
        if is_recovered {
            document.note_recovery(path);
        }
        Ok(document)
    }

    /// Opens a project as a template for a new document, which has no file until it is saved. Unsaved work on the same scene is restored as by
    /// [`Self::open`].
    ///
    /// # Errors
    /// The project, or a file that it refers to, cannot be read or used, or the work was cancelled.
    pub fn open_template(
        path: &Path,
        unwrap: &UnwrapOptions,
        resources: &Resources,
        steps: &dyn Steps,
    ) -> Result<Self, DocumentError> {
        let template = ProjectFile::load(path)?;
        let recovered = project::find_recovery(&recovery_path(&template.scene, false), None);
        let is_recovered = recovered.is_some();
        let input = Input::open_project(
            path,
            recovered.unwrap_or(template),
            &VariantChoice::AsSaved,
            resources,
            steps,
        )?;
        let mut document = Self::from_input(input, unwrap, steps)?;
        if is_recovered {
            document.note_recovery(path);
        }
        Ok(document)
    }

    /// Opens a project as it was saved, ignoring unsaved work.
    ///
    /// # Errors
    /// The project, or a file that it refers to, cannot be read or used, or the work was cancelled.
    pub fn open_saved(
        path: &Path,
        unwrap: &UnwrapOptions,
        resources: &Resources,
        steps: &dyn Steps,
    ) -> Result<Self, DocumentError> {
        let input =
            Input::open_project(path, ProjectFile::load(path)?, &VariantChoice::AsSaved, resources, steps)?;
        let document = Self::from_input(input, unwrap, steps)?;
        Ok(Self { path: document.paint_transfer.is_none().then(|| path.into()), ..document })
    }

    /// Creates a document of a scene.
    ///
    /// # Errors
    /// `scene` is not a scene; it, or a file that `options` names, cannot be read or used; or the work was cancelled.
    pub fn create(
        scene: &Path,
        options: &NewDocumentOptions<'_>,
        unwrap: &UnwrapOptions,
        resources: &Resources,
        steps: &dyn Steps,
    ) -> Result<Self, DocumentError> {
        if !matches!(InputKind::from_path(scene)?, InputKind::Scene | InputKind::Splats) {
            let what = "is not a scene (choose a .glb or .gltf file, or one of Gaussian splats)";
            return Err(DocumentError::bad_file(scene, what));
        }
        let mut input = Input::open_variant(scene, &options.variant, resources, steps)?;
        if let Some(splats) = options.splats {
            input.set_splats(splats, steps)?;
        }
        if options.floor {
            input.set_floor(true)?;
        }
        if let Some(project) = options.paint_from {
            input.import_paint_from(project, unwrap, steps)?;
        }
        Self::create_from_input(input, options, unwrap, steps)
    }

    /// Creates a document of a scene or capture that was read.
    ///
    /// # Errors
    /// Camera or focus of `options` cannot be read or used, the scene cannot be unwrapped, or the work was cancelled.
    pub fn create_from_input(
        input: Input,
        options: &NewDocumentOptions<'_>,
        unwrap: &UnwrapOptions,
        steps: &dyn Steps,
    ) -> Result<Self, DocumentError> {
        let camera = input.camera(options.camera)?;
        let mut document = Self::from_input(input, unwrap, steps)?;
        document.camera = camera;
        if let Some(focus) = options.focus {
            document.map = document.load_focus_file(focus)?;
            document.layers = LayerStack::from_map(document.map.clone());
        }
        Ok(document)
    }

    /// Reads a recipe or a focus map, as a focus map of this document.
    ///
    /// # Errors
    /// The file cannot be read, or does not fit the scene or its atlas.
    pub fn load_focus_file(&self, path: &Path) -> Result<FocusMap, DocumentError> {
        let stage = &self.stage;
        if is_focus_table(path) {
            return read_splat_focus(path, &stage.scene, &stage.atlas, &Unwatched);
        }
        let recipe = match project::read_focus(path)? {
            FocusFile::Map(map) if map.atlas_hash.is_some() => {
                return Ok(map.into_atlas_map(path, &stage.atlas)?);
            }
            FocusFile::Map(map) => FocusRecipe {
                background: map.background.map(RecipeEntry::Value),
                default: RecipeEntry::Map(Arc::new(map.image)),
                ..Default::default()
            },
            FocusFile::Recipe(recipe) => recipe,
        };
        let focus = recipe.evaluate(&stage.scene).map_err(|error| DocumentError::bad_file(path, error))?;
        Ok(focus.bake(&stage.texels))
    }

    /// Adds the warnings of another variant of the scene; returns those that are new.
    pub fn add_warnings_of(&mut self, scene: &Scene) -> Vec<String> {
        let mut new_warnings = prefix_with_path(&scene.path, &scene.warnings);
        new_warnings.retain(|warning| !self.warnings.contains(warning));
        self.warnings.extend_from_slice(&new_warnings);
        new_warnings
    }

    fn note_recovery(&mut self, path: &Path) {
        self.note_unrecorded_change();
        let message = "unsaved work from the last session was restored (save it to keep it)";
        self.warnings.push(format!("{}: {message}", path.display()));
    }

    /// The document of an input. Paint is transferred if the project's scene has changed.
    pub(crate) fn from_input(
        mut input: Input,
        unwrap: &UnwrapOptions,
        steps: &dyn Steps,
    ) -> Result<Self, DocumentError> {
        input.transfer_paint_if_changed(unwrap, steps)?;
        let (stage, map) = Stage::from_input(&input, unwrap, steps)?;
        let stored = input.project.as_ref().and_then(|project| project.layers.clone());
        let (layers, map) = match stored {
            Some(mut layers) => {
                layers.evaluate(&stage.canvas, &input.camera);
                let map = layers.composite();
                (layers, map)
            }
            None => (LayerStack::from_map(map.clone()), map),
        };
        let template = match &input.project {
            Some(project) => project.clone(),
            None => {
                let shot_camera = NamedCamera {
                    name: SHOT_CAMERA_NAME.into(),
                    camera: input.camera.clone(),
                    focus_hold: None,
                };
                let (low, high) = input.scene.bounds();
                let radius = brush_radius(&input.camera, (high - low).length());
                let mut brush = Brush { radius, ..Brush::default() };
                if input.scene.picture.is_some() {
                    // The normals of a surface made from depth are as noisy as the depth.
                    brush.normal_limit_degrees = 180.0;
                }
                let capture = input.capture.clone();
                ProjectFile { brush, capture, ..ProjectFile::new(&input.scene.path, vec![shot_camera])? }
            }
        };
        let shot = &template.cameras[template.active_camera];
        let stored_hold = shot.focus_hold.clone().filter(|_| shot.camera == input.camera);
        let selection = template.selection.as_ref().and_then(|saved| selection_from_texels(&stage, saved));
        let mut undo = UndoHistory::new(Self::UNDO_BUDGET_BYTES);
        if input.paint_transfer.is_some() {
            let [width, height] = map.size();
            let mut blank = FocusMap::new(width, height, FocusOffset::STANDARD);
            blank.background = map.background;
            undo.push_layers("Carry paint over", LayerStack::from_map(blank), layers.clone(), None);
        }
        Ok(Self {
            depth_strokes: stage.depth_strokes.clone(),
            stage: Arc::new(stage),
            layers,
            thumbnail_base: map.clone(),
            map,
            adjustment_view: AdjustmentView::from_camera(&input.camera),
            solved_spread: None,
            focus_hold: stored_hold.unwrap_or_else(|| HeldCamera::on_axis(input.camera.clone()).focus_hold),
            camera: input.camera.clone(),
            lens_motion: template.lens_motion.clone(),
            seconds: 0.0,
            exposure: input.exposure(),
            brush: template.brush.clone(),
            view: template.view.clone(),
            path: None,
            warnings: input.warnings,
            template,
            undo,
            selection,
            revision: u64::from(input.paint_transfer.is_some()),
            unrecorded_changes: u64::from(input.paint_transfer.is_some()),
            paint_transfer: input.paint_transfer,
            saved: SavedState::default(),
        })
    }

    /// The document as a project, as it would be saved now.
    pub fn to_project(&self) -> ProjectFile {
        let scene = &self.stage.scene;
        let mut project = self.template.clone();
        let shot = &mut project.cameras[project.active_camera];
        (shot.camera, shot.focus_hold) = (self.camera.clone(), Some(self.focus_hold.clone()));
        project.lens_motion = self.lens_motion.clone();
        project.exposure = self.exposure;
        project.back_faces = scene.back_faces;
        project.variant = scene.variant.clone();
        project.floor = scene.floor.map(|floor| floor.is_shown);
        project.splats = scene.splats.as_ref().and_then(|splats| SplatsFile::of_scene(splats));
        project.world = scene.world.as_ref().map(|world| WorldFile::from_world(world, scene));
        project.brush = self.brush.clone();
        project.view = self.view.clone();
        project.capture = self.capture_choices();
        // The atlas of a picture's surface is derived from it, and its depth may have been repaired since the stage was made.
        project.atlas = scene.picture.is_none().then(|| self.stage.atlas.to_bytes());
        project.surface = scene.picture.is_none().then(|| self.stage.surface_bytes().to_vec());
        project.background_focus = self.map.background;
        project.focus_map = Some(self.map.clone());
        project.selection =
            self.selection.as_ref().map(|selection| selection_to_texels(&self.stage, selection));
        project.layers = (!self.layers.is_single_painted_layer()).then(|| self.layers.clone());
        project
    }

    /// How splats are shown with those of the selection hidden, too; `None`: none of them is selected.
    pub fn splat_edit_hiding_selection(&self) -> Option<SplatEdit> {
        let (stage, selection) = (&self.stage, self.selection.as_ref()?);
        let splats = stage.scene.splats.as_ref()?;
        let selected = stage.canvas.texels().enumerate().filter(|(index, _)| selection.contains(*index));
        let splat = |texel: CanvasTexel| {
            let texel = stage.texels.texel_at(texel.x, texel.y)?;
            splats.splat_of(texel.centroid.triangle)
        };
        let mut numbers = selected.filter_map(|(_, texel)| splat(texel)).peekable();
        numbers.peek()?;
        Some(splats.edit.hiding(numbers))
    }

    /// How splats are shown with none hidden; `None`: all are shown already.
    pub fn splat_edit_showing_all(&self) -> Option<SplatEdit> {
        let edit = &self.stage.scene.splats.as_ref()?.edit;
        let shown = SplatEdit { transform: edit.transform, ..SplatEdit::default() };
        (shown != *edit).then_some(shown)
    }

    /// If the document is of a capture, the choices it was opened with, and its depth strokes.
    pub fn capture_choices(&self) -> Option<CaptureChoices> {
        let choices = self.template.capture.clone();
        choices.map(|choices| CaptureChoices { depth_strokes: (*self.depth_strokes).clone(), ..choices })
    }

    /// Replaces the stage by another surface in the same atlas, which may have more rows; paint and selections stay where they are.
    pub fn replace_surface(&mut self, stage: Stage) {
        let before = std::mem::replace(&mut self.stage, Arc::new(stage));
        let after = self.stage.clone();
        let remap_selection =
            |selection: &Selection| selection_from_texels(&after, &selection_to_texels(&before, selection));
        if after.atlas.height > self.map.height() {
            let height = after.atlas.height;
            self.map.extend_rows(height);
            self.thumbnail_base.extend_rows(height);
            self.layers.extend_rows(height);
            self.undo.extend_rows(height);
        }
        self.selection = self.selection.as_ref().and_then(remap_selection);
        self.undo.map_selections(remap_selection);
        for index in 0..self.layers.layers().len() {
            if let Some(layer) = self.layers.layer_mut(index) {
                after.canvas.dilate(&mut layer.map);
                if let Some(spread) = &mut layer.spread {
                    after.canvas.dilate(&mut spread.strokes);
                }
            }
        }
        self.evaluate_adjustments();
    }

    /// Updates the composite after the `changed` texels of any layer, or after any change (`None`). Returns what changed in the map, and whether
    /// the background's focus changed.
    pub fn recomposite(&mut self, changed: Option<&ChangedTexels>) -> (ChangedTexels, bool) {
        let background = self.map.background;
        let changed = match changed {
            Some(changed) => self.layers.recomposite(&mut self.map, changed),
            None => self.layers.recomposite_all(&mut self.map),
        };
        (changed, background != self.map.background)
    }

    /// The recovery file for unsaved work.
    pub fn recovery_path(&self) -> PathBuf {
        let file = self.path.as_deref().unwrap_or(&self.stage.scene.path);
        recovery_path(file, self.path.is_some())
    }

    /// The scene.
    pub fn scene(&self) -> &Arc<Scene> {
        &self.stage.scene
    }

    /// The focus at a surface point, as all layers together make it.
    pub fn focus_at(&self, hit: &SurfaceHit) -> FocusOffset {
        self.map.sample(self.stage.atlas.position_of(hit.point))
    }

    /// Whether the document differs from its project file, or before the first save, from the scene as it was opened.
    pub fn is_unsaved(&self) -> bool {
        self.state().change != self.saved.change
    }

    /// The state as it is now.
    pub fn state(&self) -> SavedState {
        let change = [self.undo.latest_change(), self.unrecorded_changes];
        SavedState { revision: self.revision, change }
    }

    /// Notes that a state is in the project file.
    pub fn set_saved(&mut self, state: SavedState) {
        self.saved = state;
    }

    /// The revision in the project file.
    pub fn saved_revision(&self) -> u64 {
        self.saved.revision
    }

    /// Notes a change that is saved and not in the undo history.
    pub(crate) fn note_unrecorded_change(&mut self) {
        self.revision += 1;
        self.unrecorded_changes += 1;
    }

    /// The document's name: the project's file name, or else the scene's.
    pub fn name(&self) -> String {
        file_name(self.path.as_deref().unwrap_or(&self.stage.scene.path))
    }

    /// The name of the step that undo would revert; `None` if there is none.
    pub fn undo_name(&self) -> Option<&str> {
        self.undo.undo_name()
    }

    /// The name of the step that redo would repeat; `None` if there is none.
    pub fn redo_name(&self) -> Option<&str> {
        self.undo.redo_name()
    }

    /// The history, oldest step first: the steps that are done, then those that were undone and can be redone.
    pub fn history(&self) -> impl Iterator<Item = HistoryStep<'_>> {
        self.undo.steps()
    }

    /// Adds a thumbnail of what changed in the map to the latest step.
    pub fn add_step_thumbnail(&mut self) {
        self.undo.set_thumbnail(EditThumbnail::from_difference(&self.thumbnail_base, &self.map));
        self.thumbnail_base = self.map.clone();
    }

    /// Evaluates adjustment layers for the current shot camera.
    pub fn evaluate_adjustments(&mut self) {
        self.adjustment_view = AdjustmentView::from_camera(&self.camera);
        self.layers.evaluate(&self.stage.canvas, &self.camera);
    }

    /// Compares the next thumbnail with the current map: called after undo and redo.
    pub fn reset_thumbnail_base(&mut self) {
        self.thumbnail_base = self.map.clone();
    }

    /// The names of all steps that can be undone, oldest first.
    pub fn undo_names(&self) -> impl Iterator<Item = &str> {
        self.undo.names()
    }

    /// The memory that the undo history takes, and its budget, in bytes.
    pub fn undo_bytes(&self) -> [usize; 2] {
        self.undo.bytes()
    }

    /// The cameras of the scene by name, as shot cameras with the current lens, followed by those of its photographs.
    pub fn scene_cameras(&self) -> impl Iterator<Item = (&str, Camera)> {
        let scene = &self.stage.scene;
        let cameras = scene.cameras.iter();
        let cameras = cameras.map(|camera| (camera.name.as_str(), shot_camera_from(camera, &self.camera)));
        let names = scene.all_views().map(|view| view.name.as_str());
        cameras.chain(names.zip(self.photograph_cameras()))
    }

    /// The cameras of the scene's photographs, with the current aperture: first of those that light the scene, then of those left out.
    pub fn photograph_cameras(&self) -> impl Iterator<Item = Camera> {
        let scene = &self.stage.scene;
        scene.all_views().map(|view| Camera {
            aperture_radius: self.camera.aperture_radius,
            ..camera_from_photograph(self.stage.bounds, view, &self.camera)
        })
    }

    /// The shot camera with what its focus is held on.
    pub fn held_camera(&self) -> HeldCamera {
        HeldCamera { camera: self.camera.clone(), focus_hold: self.focus_hold.clone() }
    }

    /// Sets the shot camera with what its focus is held on.
    pub fn set_held_camera(&mut self, held: HeldCamera) {
        (self.camera, self.focus_hold) = (held.camera, held.focus_hold);
    }

    /// The photograph whose pose the camera has, if any.
    pub fn photograph(&self) -> Option<&View> {
        let scene = &self.stage.scene;
        let mut views = scene.all_views();
        views.find(|view| view.camera_to_world == self.camera.camera_to_world)
    }
}

/// A selection as the atlas coordinates of its texels.
fn selection_to_texels(stage: &Stage, selection: &Selection) -> TexelSet {
    let texels = stage.canvas.texels().enumerate();
    let selected = texels.filter(|(index, _)| selection.contains(*index));
    TexelSet::new([stage.atlas.width, stage.atlas.height], selected.map(|(_, texel)| [texel.x, texel.y]))
}

/// The selection stored in a project; `None` if it contains nothing or everything.
fn selection_from_texels(stage: &Stage, saved: &TexelSet) -> Option<Selection> {
    match Selection::from_predicate(&stage.canvas, |texel| saved.contains([texel.x, texel.y])) {
        SelectionResult::Some(selection) => Some(selection),
        SelectionResult::Nothing | SelectionResult::Everything => None,
    }
}

fn recovery_path(file: &Path, is_project: bool) -> PathBuf {
    if is_project { project::recovery_path_for(file) } else { project::unsaved_recovery_path(file) }
}

/// The initial brush radius: an eighth of half the picture's height in the focus plane, but at most a twentieth of the scene's diagonal; the
/// brush's default for a scene without extent.
fn brush_radius(camera: &Camera, diagonal: f64) -> f64 {
    let half_height_share = camera.focus_distance * (camera.yfov / 2.0).tan() / 8.0;
    let radius = half_height_share.min(diagonal / 20.0);
    if radius > 0.0 && radius.is_finite() { radius } else { Brush::default().radius }
}
