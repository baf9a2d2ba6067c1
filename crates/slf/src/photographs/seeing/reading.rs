//! Photographs as they are worked with: read, with the depths of what they show and their masks.

use super::depth_picture::DepthMap;
use super::kept_picture::PackedPicture;
use crate::photographs::error::PhotographError;
use progress::Progress;
use rayon::prelude::*;
use scene::{LoadOptions, Mask, Scene, View};
use std::sync::atomic::{AtomicUsize, Ordering};

/// How much is read and kept.
pub(crate) struct ViewLoader<'a> {
    pub load: &'a LoadOptions,
    /// Pixels of a photograph that are joined to one, each way.
    pub reduction: u32,
    /// Photographs that are worked on at once.
    pub at_once: usize,
}

/// A photograph that was read.
pub(crate) struct LoadedView {
    pub picture: PackedPicture,
    pub depth: DepthMap,
    pub mask: Option<Mask>,
}

impl ViewLoader<'_> {
    /// Reads views and makes something of each, in their order.
    ///
    /// # Errors
    /// The first view's, by order, whose picture or mask cannot be had; that the work was stopped.
    pub fn load_each<T: Send>(
        &self,
        scene: &Scene,
        views: &[View],
        progress: &dyn Progress,
        process: impl Fn(&View, LoadedView) -> T + Sync,
    ) -> Result<Vec<T>, PhotographError> {
        let done = AtomicUsize::new(0);
        let load_one = |view: &View| {
            progress.check()?;
            let picture = PackedPicture::new(&view.read_photograph(self.load)?, self.reduction);
            let mask = view.read_mask(self.load)?;
            let depth = DepthMap::render(scene, view, self.reduction);
            let processed = process(view, LoadedView { picture, depth, mask });
            let count = done.fetch_add(1, Ordering::Relaxed) + 1;
            progress.report(count as f32 / views.len() as f32);
            Ok(processed)
        };
        let mut all = Vec::with_capacity(views.len());
        for chunk in views.chunks(self.at_once.max(1)) {
            all.extend(chunk.par_iter().map(load_one).collect::<Result<Vec<T>, PhotographError>>()?);
        }
        progress.check()?;
        Ok(all)
    }
}
