//! Events of a session.

use crate::reference::ReferenceKind;
use document::DepthPolarityRequest;
use jobs::JobStatus;
use std::ops::Range;
use std::path::PathBuf;

/// Something that happened since the last [`crate::Session::poll`].
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// A document was opened; everything drawn for the old one is stale.
    Opened,
    /// A capture cannot be opened until the user specifies which end of its depth map is near: see [`crate::Command::OpenCapture`].
    DepthPolarityRequired(Box<DepthPolarityRequest>),
    /// Visible faces, materials or lighting changed; what is drawn of the scene's surface is stale.
    SurfaceChanged,
    /// The camera changed (also by undo).
    CameraChanged,
    /// Texels of the focus map changed, all within these rectangles of columns and rows.
    MapChanged(Vec<[Range<u32>; 2]>),
    /// The layers or the active layer changed (also by undo).
    LayersChanged,
    /// The selection changed.
    SelectionChanged,
    /// The brush changed (by picking).
    BrushChanged,
    /// The opened scene is so bright that the display must be this many stops darker to show more than white.
    GlareDetected(f32),
    /// A new preview is ready: [`crate::Session::preview`].
    PreviewReady(u64),
    /// A reference picture is ready: [`crate::Session::reference`].
    ReferenceReady(ReferenceKind),
    /// The verification has a better estimate: [`crate::Session::verification`].
    VerificationUpdated,
    /// Background work progressed.
    Progress(JobStatus),
    /// A file was written.
    FileWritten(PathBuf),
    /// Work failed, with a message of one sentence.
    Failed(String),
    /// A notice to the user, one sentence.
    Notice(String),
}
