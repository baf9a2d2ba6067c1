//! What a session can be asked to do, and what it tells back.

use crate::reference::ReferenceKind;
use document::{CameraEdit, FillRegion, StrokePoint, SurfaceHit};
use focus::{Brush, CombineMode, Ease, Gradient, LayerEdit, LensMotion};
use glam::DVec2;
use jobs::JobId;
use lens::{Exposure, FocusOffset};
use project::{CaptureChoices, RecordedStep, SelectionShape};
use relief::DepthStroke;
use render::Display;
use scene::{BackFaces, World};
use splat::Tolerance;
use std::path::PathBuf;

/// A change of the document or of what is worked on. See [`crate::Session::apply`].
#[derive(Clone, Debug)]
pub enum Command {
    /// Opens a scene or a project in the background; the document that is open stays until the new one is ready.
    Open(PathBuf),
    /// Opens a project as what a new document begins with: the first save asks for a file.
    OpenTemplate(PathBuf),
    /// Opens a capture of which something was chosen, as [`Self::Open`].
    OpenCapture(PathBuf, CaptureChoices),
    /// Saves to the project's own file. An error where it has none yet.
    Save,
    /// Saves to this file and keeps it as the project's own.
    SaveAs(PathBuf),
    /// Renders the picture at full size in the background and writes it.
    ExportPicture(PathBuf),
    /// Writes the live picture as it is on screen, if it is no longer rough.
    ExportShown(PathBuf),
    /// Writes the focus map, EXR or 16-bit PNG by the file's extension.
    ExportFocusMap(PathBuf),
    /// Writes the scene as GLB with the atlas as a second UV set.
    ExportScene(PathBuf),
    /// Writes the strokes that can be undone as data that [`crate::replay`] paints again.
    ExportStrokes(PathBuf),
    /// Replaces the focus map by one that was exported for this atlas.
    ImportFocusMap(PathBuf),

    /// Takes back the last stroke, fill, selection, or change of lens or variant.
    Undo,
    /// Does again what was taken back.
    Redo,
    /// Goes to where this many steps of the history are done, by undo or redo.
    GoToHistoryStep(usize),
    /// Does a recorded step, as a step of undo. The brush stays what it is.
    ApplyRecordedStep(RecordedStep),

    /// Changes the camera. Edits of one field in a row are one step of undo until [`Command::FinishEdit`].
    EditCamera(CameraEdit),
    /// Ends a run of edits (a slider was let go): the next one is a step of undo of its own.
    FinishEdit,
    /// Shows the document at a time, s: lens and layers as their keys say. No step of undo.
    GoToTime(f64),
    /// Gives the lens other keys, as a step of undo of this name.
    SetLensMotion(&'static str, LensMotion),
    /// Has the lens go from one point of the surface to another.
    RackFocus {
        /// The points.
        points: [SurfaceHit; 2],
        /// When it leaves the first and when it is at the second, s.
        seconds: [f64; 2],
        /// How it goes.
        ease: Ease,
    },
    /// Layout and viewpoint, to be saved with the document; any JSON.
    SetView(serde_json::Value),
    /// How the sum becomes the picture.
    SetExposure(Exposure),
    /// Whether faces that are not double sided are seen from behind. Saved with the document, no step of undo.
    SetBackFaces(BackFaces),
    /// What lies beyond all surfaces; none: what suits the scene. Saved with the document, no step of undo.
    SetWorld(Option<World>),
    /// The same of an environment's file, .hdr or .exr, which is read in the background.
    LoadEnvironment(PathBuf),
    /// The scene's variant, by name; none: its own materials. The scene is read again in the background; a step of undo.
    SetVariant(Option<String>),
    /// How the screen shows any picture. No part of the document.
    SetDisplay(Display),
    /// Shows the live picture through one aperture point, in [−1, 1]² (see [`lens::Aperture::sub_aperture`]), or through
    /// all of the aperture again. No part of the document; the picture's rays are still those of the whole lens.
    SetSubAperture(Option<DVec2>),
    /// The longest side that the preview is drawn at, px; the picture's own size if that is smaller.
    SetPreviewSize(u32),
    /// How coarse the live picture may be while one works.
    SetTolerance(Tolerance),

    /// The brush of the strokes to come.
    SetBrush(Brush),
    /// Repairs the depth of a light field or picture along a stroke; the surface is made anew in the background. A step of undo.
    RepairDepth(DepthStroke),
    /// Begins a stroke, with a first dab if the point is on a surface.
    BeginStroke(StrokePoint),
    /// Moves the stroke on.
    ExtendStroke(StrokePoint),
    /// Draws a gradient, or another one in the place of the one being drawn.
    DragGradient(Gradient),
    /// Ends the stroke or gradient: one step of undo, or nothing if it changed nothing.
    CommitStroke,
    /// Takes the stroke or gradient back, leaving no trace.
    AbortStroke,
    /// Changes the layers of focus.
    EditLayers(LayerEdit),
    /// Paints on another layer from now on, counted from the bottom.
    ActivateLayer(usize),
    /// Chooses what may be painted; all else is frozen.
    Select(SelectionShape, CombineMode),
    /// Chooses a whole region to be painted.
    SelectRegion(FillRegion, CombineMode),
    /// Lets the active layer count only where it may be painted.
    MaskFromSelection,
    /// Gives a whole region a focus. What lies at the images of the brush's symmetry is filled too.
    Fill(FillRegion, FocusOffset),
    /// Returns everything to the ordinary lens.
    ResetMap,
    /// The focus of the background.
    SetBackgroundFocus(FocusOffset),
    /// Sets the focus distance to the axial depth of a surface point.
    FocusHere(SurfaceHit),
    /// Lets two eyes look at a surface point in stereo pictures: it has no disparity. None: at what the lens is focused on. No part of
    /// the document.
    Fixate(Option<SurfaceHit>),
    /// Takes the brush's focus from a surface point.
    Pick(SurfaceHit),

    /// Bakes the light field anew.
    Bake,
    /// Makes a picture to compare the live one with, in the background, at the preview's size.
    MakeReference {
        /// Which.
        kind: ReferenceKind,
        /// Rays a pixel of a ray-traced one.
        samples_per_pixel: u32,
    },
    /// Traces the rectangle between two positions of the picture ((0, 0) its upper left corner, (1, 1) its lower right),
    /// to check the live picture there: in the background, better and better.
    VerifyRegion([DVec2; 2]),
    /// Stops verifying and forgets what was found.
    EndVerification,
    /// Stops one piece of background work.
    Cancel(JobId),
    /// Stops all background work.
    CancelAll,
}
