//! Inner loops with the widest instructions of the machine they run on, and memory asked for ahead of them.

/// Does `work`, compiled once for any machine and once for those with AVX2. Its inner loops, and what they call, must be
/// inlined to gain from it. Results are the same either way: they are integers, and single float operations.
#[inline(always)]
pub fn with_widest_instructions<R>(work: impl FnOnce() -> R) -> R {
    #[cfg(target_arch = "x86_64")]
    {
        #[target_feature(enable = "avx2,bmi1,bmi2,lzcnt")]
        #[inline(never)]
        fn wide<R>(work: impl FnOnce() -> R) -> R {
            work()
        }
        if std::is_x86_feature_detected!("avx2")
            && std::is_x86_feature_detected!("bmi1")
            && std::is_x86_feature_detected!("bmi2")
            && std::is_x86_feature_detected!("lzcnt")
        {
            // SAFETY: the machine has what `wide` is compiled for.
            return unsafe { wide(work) };
        }
    }
    work()
}

/// Asks for the memory of an item that will be read soon.
#[inline(always)]
pub fn ask_for<T>(item: Option<&T>) {
    #[cfg(target_arch = "x86_64")]
    if let Some(item) = item {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        let first = std::ptr::from_ref(item).cast::<i8>();
        // It may lie on two lines of the cache.
        for byte in [first, first.wrapping_add(size_of::<T>() - 1)] {
            // SAFETY: a hint about memory that may be read.
            unsafe { _mm_prefetch::<_MM_HINT_T0>(byte) };
        }
    }
}
