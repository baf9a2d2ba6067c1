//! The floating-point types that the routines are for.

use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Sub};

mod sealed {
    pub trait Sealed {}
    impl Sealed for f32 {}
    impl Sealed for f64 {}
}

/// `f32` or `f64`. Computations stay in the type of their arguments.
pub trait Real:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + sealed::Sealed
    + 'static
{
    /// The nearest number of this type.
    fn from_f64(value: f64) -> Self;

    /// The nearest number in \[0, 1\]; NaN of NaN.
    fn clamped_to_unit(self) -> Self;

    /// IEEE 754's total order: −NaN < −∞ < … < −0 < +0 < … < ∞ < NaN.
    fn total_order(&self, other: &Self) -> Ordering;
}

impl Real for f32 {
    #[inline]
    fn from_f64(value: f64) -> Self {
        value as f32
    }

    #[inline]
    fn clamped_to_unit(self) -> Self {
        self.clamp(0.0, 1.0)
    }

    #[inline]
    fn total_order(&self, other: &Self) -> Ordering {
        self.total_cmp(other)
    }
}

impl Real for f64 {
    #[inline]
    fn from_f64(value: f64) -> Self {
        value
    }

    #[inline]
    fn clamped_to_unit(self) -> Self {
        self.clamp(0.0, 1.0)
    }

    #[inline]
    fn total_order(&self, other: &Self) -> Ordering {
        self.total_cmp(other)
    }
}
