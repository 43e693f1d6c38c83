//! Which bits an exposure falls on, and how likely the evidence is for each pair of them.

use super::super::evidence::Evidence;

/// Places in a bit that are told apart.
pub(super) const PLACES: usize = 8;

/// How wide a place is, bits.
const WIDTH: f32 = 1.0 / PLACES as f32;

/// The exposure as a signal meets it that is at one place of its bit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Window {
    /// The bit in which the exposure begins, counted from the first bit of a word whose shift is 0.
    pub(super) bit: usize,
    /// Likelihood by whether that bit and the next are on.
    pub(super) table: [[f32; 2]; 2],
}

impl Window {
    /// The exposure of this many bits (up to 1) that begins at `base` bits, from 0 to `length`, for each place in a bit. What lies
    /// within a place is as likely everywhere in it.
    pub(super) fn all(base: f64, exposure_bits: f64, length: usize, evidence: &Evidence) -> [Self; PLACES] {
        let (off, on, inverted) = (evidence.off(), evidence.on(), evidence.inverted());
        let exposure = (exposure_bits as f32).clamp(1e-3, 1.0);
        core::array::from_fn(|place| {
            let at = base + place as f64 / PLACES as f64;
            let whole = at as usize;
            let into = (at - whole as f64) as f32;
            let bit = if whole < length { whole } else { whole - length };
            let table = if into + WIDTH <= 1.0 - exposure {
                // it ends before the next bit, wherever in the place it begins
                [[off, off], [on, on]]
            } else {
                let mean = |evidence: &Evidence| mean_of_switching(into, exposure, evidence);
                [[off, mean(evidence)], [mean(&inverted), on]]
            };
            Self { bit, table }
        })
    }
}

/// The mean likelihood for a signal that is off in the bit in which the exposure may begin and on in the next, over beginnings from
/// `into` that bit on for the width of a place.
fn mean_of_switching(into: f32, exposure: f32, evidence: &Evidence) -> f32 {
    let (begin, end) = (into, into + WIDTH);
    // begins before `edge`: none of the next bit; from 1 on: all of it
    let edge = 1.0 - exposure;
    let before = (edge.min(end) - begin).max(0.0);
    let after = (end - begin.max(1.0)).max(0.0);
    let share = |at: f32| ((at - edge) / exposure).clamp(0.0, 1.0);
    let across = exposure * (evidence.up_to(share(end)) - evidence.up_to(share(begin)));
    (before * evidence.off() + across + after * evidence.on()) / WIDTH
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Against stepping through beginnings, and through the exposure for each.
        #[test]
        fn tables_are_means_over_a_place(base in 0.0..17.99_f64, exposure in 0.01..1.0_f64, p in 0.01..0.99_f64) {
            let evidence = Evidence::of_bit(true, 0.02);
            let likelihood = |share: f64| (0.02 + 0.96 * share) / 0.98;
            prop_assert!((f64::from(evidence.on()) - likelihood(1.0)).abs() < 1e-6);
            let windows = Window::all(base, exposure, 18, &evidence);
            let place = (p * PLACES as f64) as usize;
            let at = base + place as f64 / PLACES as f64;
            let mut mean = [0.0; 2];
            for step in 0..2000 {
                let begins = at + (f64::from(step) + 0.5) / 2000.0 / PLACES as f64 - at.floor();
                let next = ((begins + exposure - 1.0) / exposure).clamp(0.0, 1.0);
                mean[0] += likelihood(next) / 2000.0;
                mean[1] += likelihood(1.0 - next) / 2000.0;
            }
            let Window { bit, table } = windows[place];
            prop_assert_eq!(bit, at as usize % 18);
            prop_assert!((f64::from(table[0][1]) - mean[0]).abs() < 2e-3, "{table:?} {mean:?}");
            prop_assert!((f64::from(table[1][0]) - mean[1]).abs() < 2e-3, "{table:?} {mean:?}");
        }
    }
}
