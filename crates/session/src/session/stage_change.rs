//! What of a stage is to be different, and the stage that came of it.

use crate::error::SessionError;
use crate::job_steps::JobSteps;
use document::Stage;
use jobs::JobProgress;
use project::{CaptureChoices, WorldFile};
use scene::{BackFaces, SplatEdit, World};
use std::path::PathBuf;
use std::sync::Arc;

/// What is to be different.
#[derive(Clone, Debug)]
pub(super) enum StageChange {
    /// Whether faces that are not double sided are seen from behind.
    BackFaces(BackFaces),
    /// What lies beyond all surfaces; none: what suits the scene.
    World(Option<World>),
    /// The same of an environment's file, seen as it is; turn, strength and bounces stay.
    Environment(PathBuf),
    /// The scene's variant; none: its own materials.
    Variant { name: Option<String>, cause: ChangeCause },
    /// Where splats stand, and which are hidden; the name of the step of undo.
    Splats { name: &'static str, edit: Box<SplatEdit>, cause: ChangeCause },
    /// Whether a floor catches shadows.
    Floor { is_shown: bool, cause: ChangeCause },
    /// The depth of a picture: what was chosen of it, and the strokes that repair it.
    Depth(CaptureChoices),
}

/// Why it is to be different.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum ChangeCause {
    /// It was asked for: a step of undo.
    Command,
    /// A step was taken back, or done again.
    History,
}

/// A stage that was prepared.
pub(super) struct RebuiltStage {
    pub change: StageChange,
    /// The stage that it was made from, in the document of this generation.
    pub base: Arc<Stage>,
    pub generation: u64,
    pub stage: Stage,
    /// What is wrong with the file of its environment.
    pub warnings: Vec<String>,
}

impl StageChange {
    /// Whether it makes another surface, and not only another appearance of the same.
    pub fn makes_surface(&self) -> bool {
        matches!(self, Self::Depth(_) | Self::Splats { .. } | Self::Floor { .. })
    }

    /// The name of the job that makes the change; a later job of the same name replaces it.
    pub fn job_label(&self) -> &'static str {
        match self {
            Self::BackFaces(_) => "looking at other faces",
            Self::World(_) | Self::Environment(_) => "changing the world",
            Self::Variant { .. } => "changing the variant",
            Self::Splats { .. } => "placing splats",
            Self::Floor { .. } => "changing the floor",
            Self::Depth(_) => "repairing depth",
        }
    }

    /// Whether the stage is not as the change would make it.
    pub fn differs_from(&self, stage: &Stage) -> bool {
        let scene = &stage.scene;
        match self {
            Self::BackFaces(back_faces) => scene.back_faces != *back_faces,
            Self::World(world) => scene.world != *world,
            Self::Environment(_) => true,
            Self::Variant { name, .. } => scene.variant != *name,
            Self::Splats { edit, .. } => scene.splats.as_ref().is_some_and(|splats| splats.edit != **edit),
            Self::Floor { is_shown, .. } => {
                scene.floor.as_ref().is_some_and(|floor| floor.is_shown) != *is_shown
            }
            Self::Depth(choices) => *stage.depth_strokes != choices.depth_strokes,
        }
    }

    /// The stage with this change made, and warnings about the environment's file.
    ///
    /// # Errors
    /// A file cannot be read, the light cannot be solved, or the work was cancelled.
    pub fn apply_to(
        &self,
        stage: &Stage,
        progress: &JobProgress,
    ) -> Result<(Stage, Vec<String>), SessionError> {
        let mut warnings = Vec::new();
        let stage = match self {
            Self::BackFaces(back_faces) => stage.with_back_faces(*back_faces, progress)?,
            Self::World(world) => stage.with_world(world.clone(), progress)?,
            Self::Environment(file) => {
                let before = stage.scene.world.as_ref();
                let file_world = WorldFile::from_environment_file(file);
                let world = WorldFile {
                    rotation: before.map_or(file_world.rotation, |world| world.rotation),
                    strength: before.map_or(file_world.strength, |world| world.strength),
                    bounces: before.and_then(|world| world.bounces),
                    ..file_world
                };
                let (world, faults) = world.load(&stage.scene)?;
                warnings = faults;
                stage.with_world(Some(world), progress)?
            }
            Self::Variant { name, .. } => stage.with_variant(name.as_deref(), progress)?,
            Self::Splats { edit, .. } => stage.with_splat_edit(edit, progress)?,
            Self::Floor { is_shown, .. } => stage.with_floor(*is_shown, progress)?,
            Self::Depth(choices) => stage.with_depth_repaired(choices, &JobSteps { progress })?,
        };
        Ok((stage, warnings))
    }
}
