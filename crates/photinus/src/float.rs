//! What the standard library adds to the numbers of `core`, by the `libm` crate: the core does without an operating system.
//!
//! Every one of these is exact or rounded as IEEE 754 says, so that the same bits come out whichever of the two is linked; powers
//! are by squaring, in this order everywhere.

/// Methods of numbers that `core` lacks, by the names of the standard library's.
pub(crate) trait Float: Sized {
    /// The square root.
    fn sqrt(self) -> Self;
    /// The largest whole number that is no larger.
    fn floor(self) -> Self;
    /// The smallest whole number that is no smaller.
    fn ceil(self) -> Self;
    /// The nearest whole number, halves away from 0.
    fn round(self) -> Self;
    /// A whole power.
    fn powi(self, power: i32) -> Self;
}

impl Float for f64 {
    #[inline]
    fn sqrt(self) -> Self {
        libm::sqrt(self)
    }

    #[inline]
    fn floor(self) -> Self {
        libm::floor(self)
    }

    #[inline]
    fn ceil(self) -> Self {
        libm::ceil(self)
    }

    #[inline]
    fn round(self) -> Self {
        libm::round(self)
    }

    #[inline]
    fn powi(self, power: i32) -> Self {
        let (mut product, mut square, mut left) = (1.0, self, power.unsigned_abs());
        while left > 0 {
            if left & 1 == 1 {
                product *= square;
            }
            square *= square;
            left >>= 1;
        }
        if power < 0 { 1.0 / product } else { product }
    }
}

/// Only what the method does in single precision.
impl Float for f32 {
    #[inline]
    fn sqrt(self) -> Self {
        libm::sqrtf(self)
    }

    #[inline]
    fn floor(self) -> Self {
        libm::floorf(self)
    }

    #[inline]
    fn ceil(self) -> Self {
        libm::ceilf(self)
    }

    #[inline]
    fn round(self) -> Self {
        libm::roundf(self)
    }

    #[inline]
    fn powi(self, power: i32) -> Self {
        Float::powi(f64::from(self), power) as Self
    }
}
