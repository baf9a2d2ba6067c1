//! The readers as fuzz targets: bytes in, nothing but `Ok` or an error of one line out.
//!
//! A target (`targets/FOLDER/NAME.rs`) is one function of the modules here. What a reader opens by its path is written to a folder in
//! `$TMPDIR`, which should be in memory. Files with checksums are changed by [`sealing`], so that changes are not refused for their
//! checksum alone.

pub mod captures;
pub mod documents;
mod folder;
mod outcome;
pub mod pictures;
pub mod scenes;
pub mod sealing;
pub mod splats;

pub use libfuzzer_sys;
pub use outcome::report_own_panics;

/// The entry points of a target: the function that reads, and one of [`sealing`] that changes what has a checksum.
#[macro_export]
macro_rules! target {
    ($read:path) => {
        $crate::libfuzzer_sys::fuzz_target!(init: $crate::report_own_panics(), |bytes: &[u8]| {
            $read(bytes)
        });
    };
    ($read:path, mutated by $mutate:path) => {
        $crate::target!($read);
        $crate::libfuzzer_sys::fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
            $crate::sealing::mutated(data, size, max_size, seed, $mutate)
        });
    };
}
