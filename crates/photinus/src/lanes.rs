//! Four numbers at once.
//!
//! Each lane has its own sum, so that the order of additions, and with it the last bit of a result, is written down here
//! and not left to the instruction set: only operations that IEEE 754 rounds exactly are used.

use wide::{f32x4, i32x4};

/// Four numbers.
pub(crate) type Lanes = f32x4;

/// Numbers per [`Lanes`].
pub(crate) const LANES: usize = 4;

/// `first`, `first` + 1, ...
#[inline(always)]
pub(crate) fn counting_from(first: f32) -> Lanes {
    Lanes::splat(first) + Lanes::new([0.0, 1.0, 2.0, 3.0])
}

/// Four bytes as numbers.
#[inline(always)]
pub(crate) fn of_bytes(bytes: [u8; LANES]) -> Lanes {
    Lanes::from_i32x4(i32x4::new(bytes.map(i32::from)))
}

/// The number where it is above zero, else zero.
#[inline(always)]
pub(crate) fn positive(numbers: Lanes) -> Lanes {
    numbers & Lanes::ZERO.simd_lt(numbers)
}

/// 1 where `a` is less than `b`, else 0.
#[inline(always)]
pub(crate) fn less(a: Lanes, b: Lanes) -> Lanes {
    a.simd_lt(b) & Lanes::ONE
}

/// The four added up, in a fixed order.
#[inline(always)]
pub(crate) fn sum(numbers: Lanes) -> f32 {
    let [a, b, c, d] = numbers.to_array();
    (a + b) + (c + d)
}

/// Natural logarithm of positive normal numbers, to 6e-7; some finite number for zero.
///
/// x = 2^e m with m from sqrt(1/2) to sqrt(2), ln m = 2 artanh(s) with s = (m - 1) / (m + 1) below 0.172, by its series.
#[inline(always)]
pub(crate) fn ln(numbers: Lanes) -> Lanes {
    let sqrt_half = i32x4::splat(0x3f35_04f3);
    let shifted = bits(numbers) - sqrt_half;
    let exponent = i32x4::round_float(shifted >> 23_i32);
    let m = from_bits((shifted & i32x4::splat(0x007f_ffff)) + sqrt_half);
    let s = (m - Lanes::ONE) / (m + Lanes::ONE);
    let q = s * s;
    let [a, b, c, d] = [2.0, 2.0 / 3.0, 2.0 / 5.0, 2.0 / 7.0].map(Lanes::splat);
    exponent * Lanes::splat(core::f32::consts::LN_2) + s * (a + q * (b + q * (c + q * d)))
}

/// e^x for x from -80 to 0, to 3e-7 of it; e^-80 below.
///
/// e^x = 2^n e^f with n whole and f up to ln 2 / 2 in size, e^f by its series.
#[inline(always)]
pub(crate) fn exp(numbers: Lanes) -> Lanes {
    let x = numbers.fast_max(Lanes::splat(-80.0));
    // Adding and taking away 1.5 x 2^23 rounds to the nearest whole number.
    let whole = Lanes::splat(12_582_912.0);
    let n = (x * Lanes::splat(core::f32::consts::LOG2_E) + whole) - whole;
    // ln 2 in two parts, the first of few bits: n times it is exact.
    let f = (x - n * Lanes::splat(0.693_359_4)) - n * Lanes::splat(-2.121_944_4e-4);
    let terms = [1.0 / 720.0, 1.0 / 120.0, 1.0 / 24.0, 1.0 / 6.0, 0.5, 1.0, 1.0];
    let series = terms.into_iter().fold(Lanes::ZERO, |sum, term| sum * f + Lanes::splat(term));
    series * from_bits((n.fast_trunc_int() + i32x4::splat(127)) << 23_i32)
}

#[inline(always)]
fn bits(numbers: Lanes) -> i32x4 {
    i32x4::new(numbers.to_array().map(|number| number.to_bits().cast_signed()))
}

#[inline(always)]
fn from_bits(bits: i32x4) -> Lanes {
    Lanes::new(bits.to_array().map(|bits| f32::from_bits(bits.cast_unsigned())))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_logarithm_is_that_of_the_library() {
        for step in 1..=255 * 64 {
            let x = step as f32 / 64.0;
            let [ours, ..] = ln(Lanes::splat(x)).to_array();
            let theirs = libm::log(f64::from(x));
            assert!((f64::from(ours) - theirs).abs() < 6e-7, "ln {x}: {ours}, {theirs}");
        }
        let odd = Lanes::new([0.0, -1.0, f32::MIN_POSITIVE, -0.0]);
        assert!(ln(odd).to_array().iter().all(|ln| ln.is_finite()));
    }

    #[test]
    fn the_exponential_is_that_of_the_library() {
        for step in 0..=80 * 256 {
            let x = -(step as f32) / 256.0;
            let [ours, ..] = exp(Lanes::splat(x)).to_array();
            let theirs = libm::exp(f64::from(x));
            assert!((f64::from(ours) - theirs).abs() < 3e-7 * theirs, "exp {x}: {ours}, {theirs}");
        }
        let far = Lanes::new([-1e6, f32::NEG_INFINITY, -81.0, 0.0]);
        assert!(exp(far).to_array().iter().all(|&number| number > 0.0 && number <= 1.0));
    }

    proptest! {
        #[test]
        fn lanes_do_what_numbers_do(a in prop::array::uniform4(-1e5f32..1e5), b in prop::array::uniform4(-300f32..300.0)) {
            let (x, y) = (Lanes::new(a), Lanes::new(b));
            for lane in 0..LANES {
                let (p, q) = (a[lane], b[lane]);
                let same = |lanes: Lanes, number: f32| lanes.to_array()[lane].to_bits() == number.to_bits();
                prop_assert!(same(x + y, p + q) && same(x - y, p - q) && same(x * y, p * q) && same(x / y, p / q));
                let (positive_p, p_less) = (if p > 0.0 { p } else { 0.0 }, f32::from(u8::from(p < q)));
                prop_assert!(same(positive(x), positive_p) && same(less(x, y), p_less));
                prop_assert!(same(counting_from(a[0]), a[0] + lane as f32));
            }
            prop_assert_eq!(sum(x).to_bits(), ((a[0] + a[1]) + (a[2] + a[3])).to_bits());
        }
    }
}
