//! Numbers, directions and lists of any kind.

use nalgebra::{Unit, Vector3};
use photinus::camera::Bearing;
use proptest::prelude::*;
use proptest::sample::Index;

/// Any finite number: ordinary, tiny, huge, zero.
pub(crate) fn finite() -> impl Strategy<Value = f64> {
    use prop::num::f64::{NEGATIVE, NORMAL, POSITIVE, SUBNORMAL, ZERO};
    prop_oneof![3 => -3.0f64..3.0, 1 => NORMAL | SUBNORMAL | ZERO | POSITIVE | NEGATIVE]
        .prop_filter("finite", |number| number.is_finite())
}

pub(crate) fn finite_vector() -> impl Strategy<Value = Vector3<f64>> {
    prop::array::uniform3(finite()).prop_map(Vector3::from)
}

/// A length of ordinary to absurd size, in powers of ten.
pub(crate) fn scale(powers: std::ops::Range<f64>) -> impl Strategy<Value = f64> {
    powers.prop_map(|power| libm::pow(10.0, power))
}

pub(crate) fn direction() -> impl Strategy<Value = Bearing> {
    finite_vector().prop_filter_map("a direction", Bearing::new)
}

pub(crate) fn up() -> impl Strategy<Value = Option<Unit<Vector3<f64>>>> {
    let any = direction().prop_map(|bearing| Unit::new_normalize(*bearing.vector()));
    prop::option::of(prop_oneof![Just(Vector3::y_axis()), any])
}

pub(crate) fn signal() -> impl Strategy<Value = Option<u32>> {
    prop::option::weighted(0.3, prop_oneof![0u32..4, any::<u32>()])
}

/// Some things near each other or anywhere, some of them twice.
pub(crate) fn with_twins<T: Clone + std::fmt::Debug>(
    one: impl Strategy<Value = T>,
    most: usize,
) -> impl Strategy<Value = Vec<T>> {
    (prop::collection::vec(one, 1..=most), prop::collection::vec(any::<Index>(), 0..3)).prop_map(
        move |(mut all, twins)| {
            let twins: Vec<T> = twins.iter().map(|twin| twin.get(&all).clone()).collect();
            all.extend(twins);
            all.truncate(most);
            all
        },
    )
}
