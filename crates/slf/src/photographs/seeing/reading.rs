//! Photographs as they are worked with: read, with the depths of what they show and their masks.

use super::depth_picture::DepthPicture;
use super::kept_picture::KeptPicture;
use crate::photographs::error::PhotographError;
use progress::Progress;
use rayon::prelude::*;
use scene::{LoadOptions, Mask, Scene, View};
use std::sync::atomic::{AtomicUsize, Ordering};

/// How much is read and kept.
pub(crate) struct Reading<'a> {
    pub load: &'a LoadOptions,
    /// Pixels of a photograph that are joined to one, each way.
    pub reduction: u32,
    /// Photographs that are worked on at once.
    pub at_once: usize,
}

/// A photograph that was read.
pub(crate) struct ReadView {
    pub picture: KeptPicture,
    pub depth: DepthPicture,
    pub mask: Option<Mask>,
}

impl Reading<'_> {
    /// Reads views and makes something of each, in their order.
    ///
    /// # Errors
    /// The first view's, by order, whose picture or mask cannot be had; that the work was stopped.
    pub fn each<T: Send>(
        &self,
        scene: &Scene,
        views: &[View],
        progress: &dyn Progress,
        of: impl Fn(&View, ReadView) -> T + Sync,
    ) -> Result<Vec<T>, PhotographError> {
        let done = AtomicUsize::new(0);
        let one = |view: &View| {
            progress.check()?;
            let picture = KeptPicture::of(&view.photograph(self.load)?, self.reduction);
            let mask = view.mask(self.load)?;
            let depth = DepthPicture::of(scene, view, self.reduction);
            let made = of(view, ReadView { picture, depth, mask });
            let count = done.fetch_add(1, Ordering::Relaxed) + 1;
            progress.report(count as f32 / views.len() as f32);
            Ok(made)
        };
        let mut all = Vec::with_capacity(views.len());
        for chunk in views.chunks(self.at_once.max(1)) {
            all.extend(chunk.par_iter().map(one).collect::<Result<Vec<T>, PhotographError>>()?);
        }
        progress.check()?;
        Ok(all)
    }
}
