//! What of a square is seen from many points of a scene, asked on a graphics card: [`CardSight`] in the place of the processor's
//! [`trace::Tracer::square_visibility`].
//!
//! The hierarchy of the tracer's triangles is uploaded once a scene (`uploaded_scene`). Each query is a thread that walks it and keeps, a bit a
//! point, what is hidden (`sight.wgsl`), in floats of 32 bits: positions are sums of two, so that differences between points that lie close
//! together have all their digits. Where rounding leaves open what is hidden, or a texture decides it, the answer is left to the processor.
//!
//! Queries are submitted in batches as large as a card answers in a moment (`pace`). A card that is lost answers nothing more.

mod formats;
mod pace;
mod queries;
#[cfg(test)]
mod tests;
mod uploaded_scene;

use graphics_card::Gpu;
use queries::Prepared;
use std::sync::{Arc, Mutex, PoisonError};
use trace::{PreparedSight, SightDevice, Square, TargetPoints, Tracer};
use uploaded_scene::UploadedScene;

/// A graphics card that is asked what is seen.
#[derive(Clone, Debug)]
pub struct CardSight {
    gpu: Gpu,
}

/// The scene that a card was asked about last: stored with it, so that the next light field of the scene finds it there.
#[derive(Default)]
struct LastScene(Mutex<Option<Arc<UploadedScene>>>);

impl CardSight {
    /// Asks this card.
    pub fn new(gpu: Gpu) -> Self {
        Self { gpu }
    }

    /// The scene of a tracer on the card; `None` where it does not fit.
    fn uploaded(&self, tracer: &Tracer) -> Option<Arc<UploadedScene>> {
        let last = self.gpu.cached(|_| LastScene::default());
        let mut scene_there = last.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(scene) = scene_there.as_ref().filter(|scene| scene.is_of(tracer)) {
            return Some(scene.clone());
        }
        // Room for the next one.
        *scene_there = None;
        let scene = Arc::new(UploadedScene::new(&self.gpu, tracer).ok()?);
        *scene_there = Some(scene.clone());
        Some(scene)
    }
}

impl SightDevice for CardSight {
    fn prepare(
        &self,
        tracer: &Tracer,
        square: &Square,
        targets: &[&TargetPoints],
    ) -> Option<Box<dyn PreparedSight>> {
        let scene = self.uploaded(tracer)?;
        let prepared = Prepared::new(&self.gpu, scene, tracer, square, targets).ok()?;
        Some(Box::new(prepared))
    }
}
