//! How often the decoder is right and how soon, against the ideal decoder.

use photinus::identity::CodeBook;
use photinus::identity::decoder::{Decoder, Listener, Who};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;

use crate::decoding::{BIT_ERRORS, DECIDED, any_led, book, decoder, percent, row, watch};
use crate::document::markdown;
use crate::ideal;
use crate::led::{EXPOSURE_S, Noise, Signal, below};

const BOOKS: [&str; 3] = ["l14-d3-r3", "l18-d3-r2", "l18-d5-r4"];

/// Known words, at random phases, by clocks up to 500 ppm off.
pub(crate) fn table() -> String {
    const TRIALS: usize = 10_000;
    const AGAINST_IDEAL: usize = 500;
    let mut rows = vec![row([
        "book",
        "bits wrong %",
        "after",
        "right %",
        "its best word, of the first 500",
        "ideal, of the first 500",
        "decided %",
        "decided wrong",
    ])];
    for name in BOOKS {
        let (book, mut seed) = (book(name), 100);
        let decoder = decoder(&book);
        let frames = [3 * book.length() / 2, 3 * book.length()];
        for error in BIT_ERRORS {
            eprintln!("{name}, {error}");
            let noise = Noise::of_bit_error(error);
            // right, right of the first, ideal, decided, decided wrong
            let mut counts = [[0_usize; 5]; 2];
            for trial in 0..TRIALS {
                seed += 1;
                let mut random = Pcg64Mcg::seed_from_u64(seed);
                let word = below(&mut random, book.words().len());
                let led = any_led(Signal::Word(book.words()[word]), &mut random);
                let seen = watch(&led, &noise, 0.0, frames[1], &mut random);
                let mut listener = decoder.listener();
                for (number, &(time_s, light)) in seen.iter().enumerate() {
                    decoder
                        .hear(&mut listener, time_s, EXPOSURE_S, &noise.evidence(light))
                        .expect("time passes");
                    let Some(end) = frames.iter().position(|&end| end == number + 1) else { continue };
                    let identity = decoder.identity(&listener);
                    let is_right = identity.who == Who::Word(word);
                    let is_decided = identity.probability >= DECIDED;
                    let count = &mut counts[end];
                    count[0] += usize::from(is_right);
                    count[3] += usize::from(is_decided);
                    count[4] += usize::from(is_decided && !is_right);
                    if trial < AGAINST_IDEAL {
                        count[1] += usize::from(best_word(&decoder, &listener, &book) == Some(word));
                        let ideal = ideal::most_likely(&book, led.rate_hz, &noise, &seen[..=number]);
                        count[2] += usize::from(ideal == word);
                    }
                }
            }
            for (count, after) in counts.iter().zip(["1.5 rounds", "3 rounds"]) {
                let wrong = format!("{:.1}", 100.0 * error);
                rows.push(vec![
                    name.to_owned(),
                    wrong,
                    after.to_owned(),
                    percent(count[0], TRIALS),
                    percent(count[1], AGAINST_IDEAL),
                    percent(count[2], AGAINST_IDEAL),
                    percent(count[3], TRIALS),
                    format!("{} of {}", count[4], count[3]),
                ]);
            }
        }
    }
    markdown(rows)
}

/// The most probable word, as if it were known that it is one of the book.
fn best_word(decoder: &Decoder, listener: &Listener, book: &CodeBook) -> Option<usize> {
    let probability = |word: &usize| decoder.probability(listener, Who::Word(*word));
    (0..book.words().len()).max_by(|a, b| probability(a).total_cmp(&probability(b)))
}
