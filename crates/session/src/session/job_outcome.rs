//! What background work hands to the session.

use crate::reference::Reference;
use crate::session::stage_change::RebuiltStage;
use document::{DepthPolarityRequest, Document, SavedState, SelectionMatches, SolvedSpread};
use focus::CombineMode;
use lens::Picture;
use std::path::PathBuf;
use trace::truth::Estimate;

/// What a finished job hands to the session.
pub(super) enum JobOutcome {
    Opened(Box<Document>),
    /// The document of this generation and revision, whose scene was written again.
    SceneReloaded {
        document: Box<Document>,
        generation: u64,
        revision: u64,
    },
    /// A capture that does not open until somebody says which end of its depth map is near.
    DepthPolarityRequired(Box<DepthPolarityRequest>),
    /// What is seen of a scene before it can be painted on.
    OpeningPicture(Picture),
    /// The stage of the document, seen or lit in another way.
    StageRebuilt(Box<RebuiltStage>),
    /// A project file that holds this state of this document.
    Saved {
        path: PathBuf,
        state: SavedState,
        generation: u64,
    },
    /// A recovery file that holds this revision.
    RecoverySaved {
        path: PathBuf,
        revision: u64,
    },
    /// The strokes of a layer of the document of this generation, solved for.
    SpreadSolved {
        solved: Box<SolvedSpread>,
        generation: u64,
    },
    /// The texels of a shape, in the document of this generation.
    SelectionFound {
        matches: Box<SelectionMatches>,
        combine: CombineMode,
        generation: u64,
    },
    FileWritten(PathBuf, Vec<String>),
    Reference(Box<Reference>),
    /// What is known after another pass of the verification of this number.
    VerificationPass(u64, Box<Estimate>),
}
