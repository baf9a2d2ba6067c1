//! Inner loops compiled for the widest SIMD instructions of the machine, and prefetching.

/// Does `work`, compiled for any machine, for those with AVX2 and for those with AVX-512. Its inner loops, and what they call,
/// must be inlined to gain from it. Results are the same either way: they are integers, and single float operations.
#[inline(always)]
pub fn with_widest_simd<R>(work: impl FnOnce() -> R) -> R {
    #[cfg(target_arch = "x86_64")]
    {
        use std::is_x86_feature_detected as has;

        #[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
        #[inline(never)]
        fn with_avx2<R>(work: impl FnOnce() -> R) -> R {
            work()
        }
        #[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt,avx512f,avx512bw,avx512dq,avx512vl")]
        #[inline(never)]
        fn with_avx512<R>(work: impl FnOnce() -> R) -> R {
            work()
        }
        if has!("avx2") && has!("bmi1") && has!("bmi2") && has!("lzcnt") && has!("popcnt") {
            let is_wider = has!("avx512f") && has!("avx512bw") && has!("avx512dq") && has!("avx512vl");
            // SAFETY: the machine has the instructions that either is compiled for.
            #[allow(unsafe_code, reason = "calls code compiled for instructions that were detected above")]
            return unsafe { if is_wider { with_avx512(work) } else { with_avx2(work) } };
        }
    }
    work()
}

/// Asks the processor to load an item that will be read soon; never affects a result.
#[inline(always)]
pub fn prefetch<T>(item: Option<&T>) {
    #[cfg(target_arch = "x86_64")]
    if let Some(item) = item {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        let first = std::ptr::from_ref(item).cast::<i8>();
        // It may lie on two lines of the cache.
        for byte in [first, first.wrapping_add(size_of::<T>() - 1)] {
            // SAFETY: a hint about memory that may be read.
            #[allow(unsafe_code, reason = "prefetching has no safe interface")]
            unsafe {
                _mm_prefetch::<_MM_HINT_T0>(byte)
            };
        }
    }
}
