//! The blocks of a light field, and which samples lie in each.

use crate::domain::Domain;
use crate::sample::{Salf, Sample};
use crate::tree::BLOCK_PX;
use glam::IVec2;

/// The blocks of the picture and its margin.
pub struct Grid {
    domain: Domain,
    /// Blocks in a row, and rows.
    pub size: IVec2,
}

impl Grid {
    pub fn new(salf: &Salf) -> Self {
        let frame = IVec2::new(salf.camera.width as i32, salf.camera.height as i32);
        let domain = Domain { size: frame, margin: salf.margin_px as i32 };
        Self { domain, size: (domain.extent() + BLOCK_PX - 1) / BLOCK_PX }
    }

    /// The upper left pixel of a block.
    pub fn corner(&self, block: usize) -> IVec2 {
        let column_row = IVec2::new(block as i32 % self.size.x, block as i32 / self.size.x);
        column_row * BLOCK_PX - self.domain.margin
    }

    /// The pixel that a sample lies in, within the grid.
    pub fn pixel(&self, sample: &Sample) -> IVec2 {
        let low = IVec2::splat(-self.domain.margin);
        sample.center.floor().as_ivec2().clamp(low, low + self.size * BLOCK_PX - 1)
    }

    /// The samples of each block, in their order.
    pub fn samples_of_blocks(&self, samples: &[Sample]) -> Vec<Vec<u32>> {
        let mut of_block = vec![Vec::new(); (self.size.x * self.size.y) as usize];
        for (index, sample) in samples.iter().enumerate() {
            let block = (self.pixel(sample) + self.domain.margin) / BLOCK_PX;
            of_block[(block.y * self.size.x + block.x) as usize].push(index as u32);
        }
        of_block
    }

    /// The side of the cell that was sampled around `pixel`, as a power of two.
    pub fn cell_level(&self, pixel: IVec2) -> u8 {
        self.domain.cell_around(pixel).side.ilog2() as u8
    }
}
