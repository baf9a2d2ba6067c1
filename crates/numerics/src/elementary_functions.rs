//! Sine, exponential and their kin, the same on every system.
//!
//! Rust's `f64::sin` and its like call the C library of the system. Those differ by a last place in up to a tenth of all values: GNU's from
//! Windows', and GNU's on a processor with fused multiply-add from GNU's on one without. Pictures, light fields and files of projects are to
//! have the same bytes everywhere. So this module defines the functions that they call, under the names by which they are
//! called: the linker takes these, for Rust code, for its libraries, and for C++. They are those of the crate `libm`, a translation of
//! musl's, which uses no operations but those of IEEE 754. Square roots, remainders and roundings are exact everywhere and stay as they are.
//!
//! Measured (processor samples of whole renderings, nothing cached): a hundredth faster than GNU's for the demo and for a room lit by the
//! evening sky.
#![allow(unsafe_code, reason = "a name without decoration is what makes the linker take a function")]

/// Functions of one number, of both widths.
macro_rules! of_one {
    ($($double:ident $single:ident)*) => {$(
        #[unsafe(no_mangle)]
        extern "C" fn $double(x: f64) -> f64 {
            libm::$double(x)
        }
        #[unsafe(no_mangle)]
        extern "C" fn $single(x: f32) -> f32 {
            libm::$single(x)
        }
    )*};
}

/// Functions of two numbers, of both widths.
macro_rules! of_two {
    ($($double:ident $single:ident)*) => {$(
        #[unsafe(no_mangle)]
        extern "C" fn $double(x: f64, y: f64) -> f64 {
            libm::$double(x, y)
        }
        #[unsafe(no_mangle)]
        extern "C" fn $single(x: f32, y: f32) -> f32 {
            libm::$single(x, y)
        }
    )*};
}

of_one! {
    sin sinf cos cosf tan tanf asin asinf acos acosf atan atanf
    sinh sinhf cosh coshf tanh tanhf asinh asinhf acosh acoshf atanh atanhf
    exp expf exp2 exp2f expm1 expm1f log logf log2 log2f log10 log10f log1p log1pf
    cbrt cbrtf
}

of_two! { atan2 atan2f pow powf hypot hypotf }

/// Where compilers for Linux and GNU's for Windows find both functions of one number needed.
#[cfg(any(target_os = "linux", windows))]
mod together {
    /// The sine and the cosine of `x`.
    #[unsafe(no_mangle)]
    unsafe extern "C" fn sincos(x: f64, sine: *mut f64, cosine: *mut f64) {
        let (s, c) = libm::sincos(x);
        // SAFETY: the caller gives two places for numbers, as in the C library.
        unsafe {
            *sine = s;
            *cosine = c;
        }
    }

    /// The same of the other width.
    #[unsafe(no_mangle)]
    unsafe extern "C" fn sincosf(x: f32, sine: *mut f32, cosine: *mut f32) {
        let (s, c) = libm::sincosf(x);
        // SAFETY: as above.
        unsafe {
            *sine = s;
            *cosine = c;
        }
    }
}

/// Windows' C library rounds twice where GNU's rounds once, as `mul_add` promises.
#[cfg(windows)]
mod fused {
    #[unsafe(no_mangle)]
    extern "C" fn fma(x: f64, y: f64, z: f64) -> f64 {
        libm::fma(x, y, z)
    }
    #[unsafe(no_mangle)]
    extern "C" fn fmaf(x: f32, y: f32, z: f32) -> f32 {
        libm::fmaf(x, y, z)
    }
}
