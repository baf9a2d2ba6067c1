//! The scene seen or lit in another way: other faces, another world, another variant.
//!
//! The stage is prepared anew in the background and taken up when it is ready. Of two changes of one kind the later counts; one
//! that was prepared from a stage that is no longer there, because another change came first, is prepared once more.

use super::outcome::Outcome;
use super::state::Session;
use crate::commands::Event;
use crate::document::Stage;
use crate::error::SessionError;
use crate::jobs::JobProgress;
use project::WorldFile;
use scene::{BackFaces, Scene, World};
use std::path::PathBuf;
use std::sync::Arc;

/// What is to be different.
#[derive(Clone, Debug)]
pub(super) enum Restaging {
    /// Whether faces that are not double sided are seen from behind.
    BackFaces(BackFaces),
    /// What lies beyond all surfaces; none: what suits the scene.
    World(Option<World>),
    /// The same of an environment's file, seen as it is; turn, strength and bounces stay.
    Environment(PathBuf),
    /// The scene's variant; none: its own materials.
    Variant { name: Option<String>, cause: Cause },
}

/// Why it is to be different.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Cause {
    /// It was asked for: a step of undo.
    Command,
    /// A step was taken back, or done again.
    History,
}

/// A stage that was prepared.
pub(super) struct Restaged {
    restaging: Restaging,
    /// The stage that it was made from, in the document of this generation.
    base: Arc<Stage>,
    generation: u64,
    stage: Stage,
}

impl Restaging {
    /// What the job is called; those of one name are in each other's place.
    fn label(&self) -> &'static str {
        match self {
            Self::BackFaces(_) => "looking at other faces",
            Self::World(_) | Self::Environment(_) => "changing the world",
            Self::Variant { .. } => "changing the variant",
        }
    }

    fn is_new_to(&self, scene: &Scene) -> bool {
        match self {
            Self::BackFaces(back_faces) => scene.back_faces != *back_faces,
            Self::World(world) => scene.world != *world,
            Self::Environment(_) => true,
            Self::Variant { name, .. } => scene.variant != *name,
        }
    }

    fn of(&self, stage: &Stage, progress: &JobProgress) -> Result<Stage, SessionError> {
        match self {
            Self::BackFaces(back_faces) => stage.with_back_faces(*back_faces, progress),
            Self::World(world) => stage.with_world(world.clone(), progress),
            Self::Environment(file) => {
                let before = stage.scene.world.as_ref();
                let of_file = WorldFile::of_environment(file);
                let world = WorldFile {
                    rotation: before.map_or(of_file.rotation, |world| world.rotation),
                    strength: before.map_or(of_file.strength, |world| world.strength),
                    bounces: before.and_then(|world| world.bounces),
                    ..of_file
                };
                stage.with_world(Some(world.load(&stage.scene)?), progress)
            }
            Self::Variant { name, .. } => stage.with_variant(name.as_deref(), progress),
        }
    }
}

impl Session {
    /// Prepares the stage anew in the background, in place of what goes on under the same label; not if nothing is new.
    pub(super) fn restage(&mut self, restaging: Restaging) -> Result<(), SessionError> {
        let label = restaging.label();
        self.jobs.iter().filter(|job| job.label == label).for_each(|job| job.progress.cancel());
        let generation = self.generation;
        let base = self.opened()?.stage.clone();
        if restaging.is_new_to(&base.scene) {
            self.start(label.into(), move |progress| {
                let stage = restaging.of(&base, progress)?;
                Ok(Outcome::Restaged(Box::new(Restaged { restaging, base, generation, stage })))
            })?;
        }
        Ok(())
    }

    /// Takes up a stage that was prepared.
    pub(super) fn take_restaged(&mut self, restaged: Restaged) -> Result<(), SessionError> {
        let Restaged { restaging, base, generation, stage } = restaged;
        if generation != self.generation {
            return Ok(());
        }
        self.commit_stroke()?;
        let document = self.opened()?;
        if !Arc::ptr_eq(&base, &document.stage) {
            return self.restage(restaging);
        }
        if let Restaging::Variant { name, cause: Cause::Command } = restaging {
            document.undo.push_variant(base.scene.variant.clone(), name);
        }
        let warned = document.note_warnings_of(&stage.scene);
        document.stage = Arc::new(stage);
        document.revision += 1;
        let (stage, map, shot) = (document.stage.clone(), document.map.clone(), document.camera.clone());
        let camera = self.shown_camera(&shot);
        (self.field, self.preview_camera) = (None, Some(camera.clone()));
        self.preview_thread.set_stage((stage, generation), (map, self.map_serial), camera);
        self.end_verification();
        self.events.extend(warned.into_iter().map(Event::Notice));
        self.events.push(Event::SurfaceChanged);
        Ok(())
    }
}
