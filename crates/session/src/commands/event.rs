//! What a session tells back.

use crate::reference::ReferenceKind;
use document::DepthPolarityRequest;
use jobs::JobStatus;
use std::ops::Range;
use std::path::PathBuf;

/// What happened since the last [`crate::Session::poll`].
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// A document was opened; everything drawn of the old one is stale.
    Opened,
    /// A capture does not open until somebody says which end of its depth map is near: [`crate::Command::OpenCapture`].
    DepthPolarityRequired(Box<DepthPolarityRequest>),
    /// Other faces or materials are seen than before, or in another light; what is drawn of the scene's surface is stale.
    SurfaceChanged,
    /// The camera changed (also by undo).
    CameraChanged,
    /// Texels of the focus map changed: all lie in these rectangles, columns and rows.
    MapChanged(Vec<[Range<u32>; 2]>),
    /// The layers changed (also by undo), or another one is painted on.
    LayersChanged,
    /// Something else may be painted than before.
    SelectionChanged,
    /// The brush changed (by picking).
    BrushChanged,
    /// The scene that was opened is so bright that the screen must show it this many stops darker, or shows nothing but white.
    GlareDetected(f32),
    /// A new preview is ready: [`crate::Session::preview`].
    PreviewReady(u64),
    /// A picture to compare with is ready: [`crate::Session::reference`].
    ReferenceReady(ReferenceKind),
    /// More is known of the rectangle that is verified: [`crate::Session::verification`].
    VerificationUpdated,
    /// Background work went on.
    Progress(JobStatus),
    /// A file was written.
    FileWritten(PathBuf),
    /// Work failed: one sentence, what it was doing first.
    Failed(String),
    /// Something the user should know: one sentence.
    Notice(String),
}
