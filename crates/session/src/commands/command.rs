//! Commands to a session.

use crate::exported_picture::PictureExport;
use crate::reference::ReferenceKind;
use document::{BookmarkEdit, CameraEdit, FillRegion, StrokePoint, SurfaceHit};
use focus::{Brush, CombineMode, Ease, Gradient, LayerEdit, LensMotion, SpreadSettings};
use glam::DVec2;
use jobs::JobId;
use lens::{Exposure, FocusOffset};
use project::{CaptureChoices, RecordedStep, SelectionShape};
use relief::DepthStroke;
use render::Display;
use scene::{BackFaces, SplatEdit, World};
use splat::Tolerance;
use std::path::PathBuf;

/// A command to a session. See [`crate::Session::apply`].
#[derive(Clone, Debug)]
pub enum Command {
    /// Opens a scene or a project in the background; the document that is open stays until the new one is ready.
    Open(PathBuf),
    /// Opens a project as a template for a new document: the first save needs a file.
    OpenTemplate(PathBuf),
    /// Opens a capture with explicit choices; otherwise as [`Self::Open`].
    OpenCapture(PathBuf, CaptureChoices),
    /// Saves to the project's file. An error if it has none yet.
    Save,
    /// Saves to this file, which becomes the project's file.
    SaveAs(PathBuf),
    /// Renders the picture at full size and writes it, in the background.
    ExportPicture(PathBuf, PictureExport),
    /// Writes the live picture as it is on screen, unless it is still coarse.
    ExportShown(PathBuf),
    /// Writes a web page on which anyone can refocus the picture, in the background.
    ExportWebPage(PathBuf),
    /// Writes a web page on which anyone can choose any lens, and paint, in the background.
    ExportEnginePage(PathBuf),
    /// Writes the focus map as EXR or 16-bit PNG, by the file's extension.
    ExportFocusMap(PathBuf),
    /// Writes the scene as GLB with the atlas as a second UV set.
    ExportScene(PathBuf),
    /// Writes the strokes of the undo history, for [`document::replay`].
    ExportStrokes(PathBuf),
    /// Replaces the focus map by one that was exported for this atlas.
    ImportFocusMap(PathBuf),

    /// Undoes the last step: a stroke, fill, selection, or change of layers, lens or variant.
    Undo,
    /// Redoes the last undone step.
    Redo,
    /// Undoes or redoes until this many steps of the history are done.
    GoToHistoryStep(usize),
    /// Applies a recorded step as an undo step. The brush does not change.
    ApplyRecordedStep(RecordedStep),

    /// Changes the camera. Consecutive edits of one field are one undo step until [`Command::FinishEdit`].
    EditCamera(CameraEdit),
    /// Changes the bookmarked cameras, which are saved with the document; not an undo step.
    EditBookmarks(BookmarkEdit),
    /// Makes the shot camera that of a bookmark, by its number in [`document::Document::bookmarks`].
    GoToBookmark(usize),
    /// Ends a run of edits (a slider was released): the next edit is a separate undo step.
    FinishEdit,
    /// Shows the document at a time, s: lens and layers follow their keys. Not an undo step.
    GoToTime(f64),
    /// Replaces the keys of the lens, as an undo step of this name.
    SetLensMotion(&'static str, LensMotion),
    /// Adds keys that move the focus from one surface point to another.
    RackFocus {
        /// The points.
        points: [SurfaceHit; 2],
        /// Times at which it leaves the first point and reaches the second, s.
        seconds: [f64; 2],
        /// The interpolation.
        ease: Ease,
    },
    /// Sets layout and viewpoint, which are saved with the document: any JSON.
    SetView(serde_json::Value),
    /// Sets the exposure: how the sum becomes the picture.
    SetExposure(Exposure),
    /// Sets whether single-sided faces are visible from behind. Saved with the document; not an undo step.
    SetBackFaces(BackFaces),
    /// Sets what lies beyond all surfaces; `None`: a default for the scene. Saved with the document; not an undo step.
    SetWorld(Option<World>),
    /// Sets the world to an environment file, .hdr or .exr, which is read in the background.
    LoadEnvironment(PathBuf),
    /// Sets the scene's material variant by name; `None`: its default materials. The scene is read again in the background. An undo step.
    SetVariant(Option<String>),
    /// Moves Gaussian splats or hides some, as an undo step of this name. The scene is prepared again in the background.
    EditSplats(&'static str, Box<SplatEdit>),
    /// Puts a floor that catches shadows under the scene, or takes it away. The scene is prepared again in the background. An undo step.
    SetFloor(bool),
    /// Hides the Gaussian splats that are selected. An undo step.
    HideSelectedSplats,
    /// Sets the display settings. Not part of the document.
    SetDisplay(Display),
    /// Shows the live picture through one aperture point, in [−1, 1]² (see [`lens::Aperture::sub_aperture`]), or through the whole
    /// aperture again (`None`). Not part of the document; [`crate::Session::picture_ray`] still uses the whole lens.
    SetSubAperture(Option<DVec2>),
    /// Sets the longest side of the preview, px; at most the picture's own size.
    SetPreviewSize(u32),
    /// Sets the tolerance of the live picture while the user works.
    SetTolerance(Tolerance),

    /// Sets the brush.
    SetBrush(Brush),
    /// Repairs the depth of a light field or picture along a stroke. The surface is rebuilt in the background. An undo step.
    RepairDepth(DepthStroke),
    /// Begins a stroke, with a first dab if the point is on a surface.
    BeginStroke(StrokePoint),
    /// Extends the stroke.
    ExtendStroke(StrokePoint),
    /// Draws a gradient, replacing the one being drawn.
    DragGradient(Gradient),
    /// Ends the stroke or gradient: one undo step, or none if nothing changed.
    CommitStroke,
    /// Cancels the stroke or gradient.
    AbortStroke,
    /// Changes the layers.
    EditLayers(LayerEdit),
    /// Makes another layer active, counted from the bottom.
    ActivateLayer(usize),
    /// Selects what may be painted; everything else is frozen.
    Select(SelectionShape, CombineMode),
    /// Selects a whole region.
    SelectRegion(FillRegion, CombineMode),
    /// Spreads the strokes of the active layer, in the background if they are to be solved for first; a layer that is
    /// spread follows the settings.
    Spread(SpreadSettings),
    /// Shows the strokes of the active layer again as they were painted.
    ShowStrokes,
    /// Masks the active layer by the selection.
    MaskFromSelection,
    /// Fills a whole region, and its images under the brush's symmetry, with a focus.
    Fill(FillRegion, FocusOffset),
    /// Resets all paint to the standard focus.
    ResetMap,
    /// Sets the focus of the background.
    SetBackgroundFocus(FocusOffset),
    /// Sets the focus distance to the axial depth of a surface point.
    FocusHere(SurfaceHit),
    /// Fixates a surface point in stereo pictures: it has no disparity. `None`: what the lens is focused on. Not part of the document.
    Fixate(Option<SurfaceHit>),
    /// Sets the brush's focus to that of a surface point.
    Pick(SurfaceHit),

    /// Bakes the light field again.
    Bake,
    /// Makes a reference picture, in the background, at the preview's size.
    MakeReference {
        /// The kind.
        kind: ReferenceKind,
        /// Rays per pixel if it is ray traced.
        samples_per_pixel: u32,
    },
    /// Traces the rectangle between two positions of the picture ((0, 0) its upper left corner, (1, 1) its lower right),
    /// to verify the live picture there: in the background, with increasing quality.
    VerifyRegion([DVec2; 2]),
    /// Stops verifying and discards the result.
    EndVerification,
    /// Cancels one background job.
    Cancel(JobId),
    /// Cancels all background work.
    CancelAll,
}
