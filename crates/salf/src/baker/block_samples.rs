//! The samples of blocks, block by block on the processor, or of many at once where a device answers what is visible from them.

use crate::baker::block_baker::{BlockBaker, BlockQuestions, CellSurvey};
use crate::baker::map_rows::map_rows;
use crate::baker::occluders::Occluders;
use crate::baker::outliers::Outliers;
use crate::baker::shadow_rays::visible_parts_by_device;
use crate::sample::Sample;
use crate::samples::BakedSample;
use glam::IVec2;
use progress::{Cancelled, Progress};
use rayon::prelude::*;
use std::ops::Deref;
use trace::PreparedSight;

/// Blocks whose questions a device is asked at once.
const BLOCKS_AT_ONCE: usize = 64;

/// The surveys of a block's cells.
pub enum Surveys<'a> {
    /// Those that were made before.
    Retained(&'a [CellSurvey]),
    /// Made anew.
    Made(Vec<CellSurvey>),
}

impl Deref for Surveys<'_> {
    type Target = [CellSurvey];

    fn deref(&self) -> &[CellSurvey] {
        match self {
            Self::Retained(surveys) => surveys,
            Self::Made(surveys) => surveys,
        }
    }
}

/// What blocks are sampled with.
pub struct BlockSampler<'a, F> {
    /// Samples each of them.
    pub baker: &'a BlockBaker<'a>,
    /// What may hide something from them.
    pub occluders: &'a Occluders,
    /// A device that answers what is visible, if there is one.
    pub device: Option<&'a dyn PreparedSight>,
    /// The surveys of a numbered block, and the surface patches in it.
    pub content_of: F,
}

/// The samples of a block, and how much light of outliers was spread among them.
pub type SampledBlock = (Vec<BakedSample>, Outliers);

impl<'a, F: Fn(usize, IVec2) -> (Surveys<'a>, &'a [Sample]) + Sync> BlockSampler<'a, F> {
    /// Samples numbered blocks, and makes something of each block's samples: in their order.
    ///
    /// # Errors
    /// [`Cancelled`] if `progress` is cancelled.
    pub fn sample<R: Send>(
        &self,
        blocks: &[(usize, IVec2)],
        progress: &dyn Progress,
        finish: impl Fn(IVec2, SampledBlock) -> R + Sync,
    ) -> Result<Vec<R>, Cancelled> {
        let by_processor = |&(number, block): &(usize, IVec2)| {
            let (surveys, patches) = (self.content_of)(number, block);
            finish(block, self.baker.bake_block(self.occluders, &surveys, patches))
        };
        let mut device = self.device;
        if device.is_none() {
            return map_rows(blocks, progress, by_processor);
        }
        let mut sampled = Vec::with_capacity(blocks.len());
        for some in blocks.chunks(BLOCKS_AT_ONCE) {
            progress.check()?;
            match device.and_then(|device| self.by_device(device, some, &finish)) {
                Some(made) => sampled.extend(made),
                None => {
                    device = None;
                    sampled.par_extend(some.par_iter().map(by_processor));
                }
            }
            progress.report(sampled.len() as f32 / blocks.len() as f32);
        }
        Ok(sampled)
    }

    /// The same of a few blocks, asked together; `None` if the device no longer answers.
    fn by_device<R: Send>(
        &self,
        device: &dyn PreparedSight,
        blocks: &[(usize, IVec2)],
        finish: &(impl Fn(IVec2, SampledBlock) -> R + Sync),
    ) -> Option<Vec<R>> {
        let BlockSampler { baker, occluders, .. } = *self;
        let ask = |&(number, block): &(usize, IVec2)| {
            let (surveys, patches) = (self.content_of)(number, block);
            let asked = baker.block_questions(occluders, &surveys);
            (block, surveys, patches, asked)
        };
        let asked: Vec<_> = blocks.par_iter().map(ask).collect();
        let counts = asked.iter().map(|(.., asked)| asked.requests().count());
        let counts: Vec<usize> = counts.collect();
        let requests: Vec<_> = asked.iter().flat_map(|(.., asked)| asked.requests()).collect();
        let BlockBaker { tracer, view, patterns, .. } = baker;
        let mut visible = visible_parts_by_device(tracer, view, patterns, device, &requests)?.into_iter();
        let answers: Vec<Vec<_>> =
            counts.into_iter().map(|count| visible.by_ref().take(count).collect()).collect();
        type Asked<'s> = (IVec2, Surveys<'s>, &'s [Sample], BlockQuestions);
        let sample = |((block, surveys, patches, asked), answers): (Asked, Vec<_>)| {
            finish(block, baker.bake_answered(&surveys, asked, answers, patches))
        };
        Some(asked.into_par_iter().zip(answers).map(sample).collect())
    }
}
