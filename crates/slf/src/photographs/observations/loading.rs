//! Loading of photographs with depth maps and masks.

use super::depth_map::DepthMap;
use super::packed_picture::PackedPicture;
use crate::photographs::error::PhotographError;
use progress::Progress;
use rayon::prelude::*;
use scene::{LoadOptions, Mask, Scene, View};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Loads photographs in batches.
pub(crate) struct ViewLoader<'a> {
    pub load: &'a LoadOptions,
    /// Pixels of the file per stored pixel, each way.
    pub reduction: u32,
    /// Number of photographs processed at once.
    pub at_once: usize,
}

/// A loaded photograph.
pub(crate) struct LoadedView {
    pub picture: PackedPicture,
    pub depth: DepthMap,
    pub mask: Option<Mask>,
}

impl ViewLoader<'_> {
    /// Loads views and processes each; results are in the order of the views.
    ///
    /// # Errors
    /// The error of the first view, by order, whose picture or mask cannot be read; [`PhotographError::Cancelled`] if
    /// `progress` asks to stop.
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
