//! Files of every format, malformed ones, and pictures against another implementation's.

mod allocations;
mod comparison;
mod encode;
mod focus_tables;
mod formats;
mod malformed;
mod mutations;
mod pictures;
mod real_files;
mod sample_sum;
mod samples;
mod scene;

use gaussians::{GaussianError, ReadOptions, SplatFile, read};
use progress::Unwatched;
use std::path::Path;

#[global_allocator]
static ALLOCATOR: allocations::CountingAllocator = allocations::CountingAllocator;

/// Reads a file in memory.
fn read_bytes(bytes: &[u8], name: &str) -> Result<SplatFile, GaussianError> {
    read(bytes, Path::new(name), &ReadOptions::default(), &Unwatched)
}
