//! The blocks of a light field, and which samples lie in each.

use crate::domain::Domain;
use crate::salf::Salf;
use crate::sample::Sample;
use crate::samples::Samples;
use crate::tree::BLOCK_PX;
use glam::{IVec2, Vec2};

/// The blocks of the picture and its margin.
pub struct Grid {
    domain: Domain,
    /// Blocks in a row, and rows.
    pub size: IVec2,
}

/// What lies in a block.
#[derive(Clone, Debug, Default)]
pub struct Content {
    /// Numbers of runs.
    runs: Vec<usize>,
    /// Numbers of samples that are of no block's run.
    singles: Vec<u32>,
}

impl Content {
    /// The samples of the block, with their numbers in the light field.
    pub fn samples<'a>(&'a self, samples: &'a Samples) -> impl Iterator<Item = (u32, Sample)> {
        let in_runs = self.runs.iter().flat_map(|&run| {
            let run = samples.run(run);
            run.indices.clone().zip(run.iter())
        });
        in_runs.chain(self.singles.iter().map(|&index| (index, samples.get(index))))
    }
}

impl Grid {
    /// The grid of blocks over a light field's picture and its margin.
    pub fn new(salf: &Salf) -> Self {
        let frame = IVec2::new(salf.camera.width as i32, salf.camera.height as i32);
        let domain = Domain { size: frame, margin: salf.margin_px as i32 };
        Self { domain, size: domain.blocks() }
    }

    /// The upper left pixel of the block with this number.
    pub fn corner(&self, block: usize) -> IVec2 {
        self.domain.corner_of_block(IVec2::new(block as i32 % self.size.x, block as i32 / self.size.x))
    }

    /// The pixel of the grid in which a place of the picture, px, lies, or the nearest.
    pub fn pixel(&self, center: Vec2) -> IVec2 {
        let low = IVec2::splat(-self.domain.margin);
        center.floor().as_ivec2().clamp(low, low + self.size * BLOCK_PX - 1)
    }

    /// What lies in each block: runs of samples, and single ones that are of no block's run.
    pub fn contents(&self, samples: &Samples) -> Vec<Content> {
        let mut contents = vec![Content::default(); (self.size.x * self.size.y) as usize];
        for (number, run) in samples.runs().enumerate() {
            match run.block() {
                Some(corner) => contents[self.block_around(corner)].runs.push(number),
                None => {
                    for (index, spot) in run.indices.clone().zip(run.locations()) {
                        contents[self.block_around(self.pixel(spot.center))].singles.push(index);
                    }
                }
            }
        }
        contents
    }

    /// The block that `pixel` lies in, or the nearest.
    fn block_around(&self, pixel: IVec2) -> usize {
        let block = self.domain.nearest_block(pixel);
        (block.y * self.size.x + block.x) as usize
    }

    /// The side, as a power of two in px, of the cell that was sampled around `pixel`.
    pub fn cell_level(&self, pixel: IVec2) -> u8 {
        self.domain.cell_around(pixel).side.ilog2() as u8
    }
}
