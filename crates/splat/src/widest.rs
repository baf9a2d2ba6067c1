//! Inner loops with the widest instructions of the machine they run on.

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
