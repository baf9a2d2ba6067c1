//! The unit of time: copying one frame.

use rayon::prelude::*;
use std::time::Instant;

/// The median time to copy one RGB float frame of `pixels` with all threads, s.
pub fn copy_seconds(pixels: usize) -> f64 {
    let threads = rayon::current_num_threads();
    let source = vec![[0.5f32; 3]; pixels];
    let mut target = vec![[0.0f32; 3]; pixels];
    let rows = pixels.div_ceil(threads).max(1);
    let mut times: Vec<f64> = (0..41)
        .map(|_| {
            let start = Instant::now();
            target
                .par_chunks_mut(rows)
                .zip(source.par_chunks(rows))
                .for_each(|(to, from)| to.copy_from_slice(from));
            std::hint::black_box(&target);
            start.elapsed().as_secs_f64()
        })
        .collect();
    crate::stopwatch::median(&mut times)
}
