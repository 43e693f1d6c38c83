//! The ideal decoder: it knows the noise, the light and the clock's rate, and tries every word at every phase.

use photinus::identity::CodeBook;

use crate::led::{Noise, bit_and_share_after};

/// Phases that are tried per bit: several in the time of an exposure.
const PHASES: usize = 64;

/// The word that explains lights at times best.
pub(crate) fn most_likely(book: &CodeBook, rate_hz: f64, noise: &Noise, seen: &[(f64, f64)]) -> usize {
    let mut best = (f64::NEG_INFINITY, 0);
    let mut logs: Vec<(usize, [[f64; 2]; 2])> = Vec::new();
    for phase in 0..PHASES {
        let at_first = (phase as f64 + 0.5) / PHASES as f64;
        logs.clear();
        logs.extend(seen.iter().map(|&(time_s, light)| {
            let (bit, after) = bit_and_share_after(at_first, rate_hz, time_s);
            let log = |on: [f64; 2]| noise.log_likelihood(light, (1.0 - after) * on[0] + after * on[1]);
            let table = [0.0, 1.0].map(|first| [0.0, 1.0].map(|second| log([first, second])));
            (bit as usize % book.length(), table)
        }));
        for (id, word) in book.words().iter().enumerate() {
            for shift in 0..book.length() {
                let on = |bit: usize| usize::from(word.bit(bit + shift));
                // logarithms are never above 0: what has fallen behind stays there
                let mut sum = 0.0;
                for (bit, table) in &logs {
                    sum += table[on(*bit)][on(bit + 1)];
                    if sum <= best.0 {
                        break;
                    }
                }
                if sum > best.0 {
                    best = (sum, id);
                }
            }
        }
    }
    best.1
}
