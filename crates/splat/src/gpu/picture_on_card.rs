//! A picture in the card's memory: shown from there, without coming back.

use graphics_card::Gpu;
use lens::Picture;
use std::ops::Range;
use wgpu::{Buffer, BufferUsages};

/// A picture in the memory of a graphics card. Copies are of the same memory.
#[derive(Clone, Debug)]
pub struct PictureOnCard {
    gpu: Gpu,
    pixels: Buffer,
    size: [u32; 2],
}

/// Bytes of a pixel.
const PIXEL_BYTES: u64 = 16;

impl PictureOnCard {
    pub(crate) fn from_buffer(gpu: &Gpu, pixels: &Buffer, size: [u32; 2]) -> Self {
        Self { gpu: gpu.clone(), pixels: pixels.clone(), size }
    }

    /// A black picture of the size of another, on its card. `None` where that is lost or has no room.
    pub fn new_like(other: &Self) -> Option<Self> {
        let usage = BufferUsages::STORAGE | BufferUsages::COPY_DST | BufferUsages::COPY_SRC;
        let pixels = other.gpu.buffer("shown", (other.pixels.size() / 4) as usize, usage).ok()?;
        Some(Self { pixels, ..other.clone() })
    }

    /// What the card's driver calls it.
    pub fn card_name(&self) -> &str {
        self.gpu.name()
    }

    /// Whether the card is lost, and the picture with it.
    pub fn is_lost(&self) -> bool {
        self.gpu.is_lost()
    }

    /// Columns and rows of the picture, px.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Of each pixel, row by row: red, green, blue and coverage as floats of 32 bits. A storage buffer, bound in whole.
    pub fn pixels(&self) -> &Buffer {
        &self.pixels
    }

    /// Whether both pictures have one size and lie on one card.
    pub fn is_like(&self, other: &Self) -> bool {
        self.size == other.size && self.gpu.is_same(&other.gpu)
    }

    /// Whether both pictures are the same memory.
    pub fn is_same(&self, other: &Self) -> bool {
        self.pixels == other.pixels
    }

    /// Makes columns and rows those of another picture, [like](Self::is_like) this one: once all is done that its card was
    /// asked for before.
    pub fn copy(&self, from: &Self, [columns, rows]: &[Range<u32>; 2]) {
        assert!(self.is_like(from), "pictures of one size on one device");
        if columns.is_empty() || rows.is_empty() {
            return;
        }
        let mut encoder =
            self.gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let width = u64::from(self.size[0]);
        let mut copy = |pixels: Range<u64>| {
            let [first, count] = [pixels.start, pixels.end - pixels.start].map(|count| count * PIXEL_BYTES);
            encoder.copy_buffer_to_buffer(&from.pixels, first, &self.pixels, first, count);
        };
        let first_of = |row: u32| u64::from(row) * width;
        if columns.len() as u64 == width {
            copy(first_of(rows.start)..first_of(rows.end));
        } else {
            for row in rows.clone().map(first_of) {
                copy(row + u64::from(columns.start)..row + u64::from(columns.end));
            }
        }
        self.gpu.queue().submit([encoder.finish()]);
    }

    /// Brings pixel rows of it back, as a picture of their own. `None` where the card is lost.
    pub fn read(&self, rows: Range<u32>) -> Option<Picture> {
        let row_bytes = u64::from(self.size[0]) * PIXEL_BYTES;
        let bytes = [rows.start, rows.end].map(|row| u64::from(row) * row_bytes);
        let words = self.gpu.read(&self.pixels, bytes[0]..bytes[1]).ok()?;
        let (pixels, _) = words.as_chunks::<4>();
        let mut picture = Picture::black(self.size[0], rows.len() as u32);
        for ((radiance, coverage), pixel) in
            picture.radiance.iter_mut().zip(&mut picture.coverage).zip(pixels)
        {
            let [r, g, b, covered] = pixel.map(f32::from_bits);
            (*radiance, *coverage) = ([r, g, b], covered);
        }
        Some(picture)
    }
}
