//! A program that contains the crate calls its sines and exponentials, whatever the system's are.

use numerics as _;
use std::hint::black_box;

/// Numbers of many sizes and both signs.
fn arguments() -> impl Iterator<Item = f64> {
    (0..20_000).map(|i| {
        let size = f64::from(i % 200 - 100) * 0.05;
        let sign = if i % 3 == 0 { -1.0 } else { 1.0 };
        black_box(sign * 10f64.powf(size) * (1.0 + f64::from(i) * 1e-5))
    })
}

#[test]
fn rust_calls_these_functions() {
    for x in arguments() {
        let y = x as f32;
        let (sine, cosine) = x.sin_cos();
        let (sine_f, cosine_f) = y.sin_cos();
        let pairs = [
            (x.sin(), libm::sin(x)),
            (x.cos(), libm::cos(x)),
            (sine, libm::sin(x)),
            (cosine, libm::cos(x)),
            (x.tan(), libm::tan(x)),
            (x.asin(), libm::asin(x)),
            (x.acos(), libm::acos(x)),
            (x.atan(), libm::atan(x)),
            (x.atan2(1.5), libm::atan2(x, 1.5)),
            (x.sinh(), libm::sinh(x)),
            (x.cosh(), libm::cosh(x)),
            (x.tanh(), libm::tanh(x)),
            (x.exp(), libm::exp(x)),
            (x.exp2(), libm::exp2(x)),
            (x.exp_m1(), libm::expm1(x)),
            (x.ln(), libm::log(x)),
            (x.log2(), libm::log2(x)),
            (x.log10(), libm::log10(x)),
            (x.ln_1p(), libm::log1p(x)),
            (x.powf(0.7), libm::pow(x, 0.7)),
            (x.cbrt(), libm::cbrt(x)),
            (x.hypot(0.3), libm::hypot(x, 0.3)),
        ];
        let pairs_f = [
            (y.sin(), libm::sinf(y)),
            (y.cos(), libm::cosf(y)),
            (sine_f, libm::sinf(y)),
            (cosine_f, libm::cosf(y)),
            (y.tan(), libm::tanf(y)),
            (y.asin(), libm::asinf(y)),
            (y.acos(), libm::acosf(y)),
            (y.atan(), libm::atanf(y)),
            (y.atan2(1.5), libm::atan2f(y, 1.5)),
            (y.tanh(), libm::tanhf(y)),
            (y.exp(), libm::expf(y)),
            (y.exp2(), libm::exp2f(y)),
            (y.exp_m1(), libm::expm1f(y)),
            (y.ln(), libm::logf(y)),
            (y.log2(), libm::log2f(y)),
            (y.log10(), libm::log10f(y)),
            (y.ln_1p(), libm::log1pf(y)),
            (y.powf(0.7), libm::powf(y, 0.7)),
            (y.cbrt(), libm::cbrtf(y)),
            (y.hypot(0.3), libm::hypotf(y, 0.3)),
        ];
        for (index, (own, expected)) in pairs.into_iter().enumerate() {
            assert!(
                own.to_bits() == expected.to_bits() || own.is_nan() && expected.is_nan(),
                "{index} of {x}"
            );
        }
        for (index, (own, expected)) in pairs_f.into_iter().enumerate() {
            assert!(
                own.to_bits() == expected.to_bits() || own.is_nan() && expected.is_nan(),
                "{index} of {y}"
            );
        }
    }
}

#[test]
fn products_are_added_without_rounding_between() {
    let (x, y) = black_box((1.0 + f64::EPSILON, 1.0 - f64::EPSILON));
    // x y = 1 − ε², which alone would be rounded to 1.
    assert_eq!(x.mul_add(y, -1.0), -f64::EPSILON * f64::EPSILON);
    let (x, y) = black_box((1.0 + f32::EPSILON, 1.0 - f32::EPSILON));
    assert_eq!(x.mul_add(y, -1.0), -f32::EPSILON * f32::EPSILON);
}
