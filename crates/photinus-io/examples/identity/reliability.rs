//! Whether probabilities keep their word.

use photinus::identity::CodeBook;
use photinus::identity::decoder::{Decoder, Listener, Who};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;

use crate::decoding::{BIT_ERRORS, DECIDED, any_led, book, decoder, row, stranger, watch};
use crate::document::markdown;
use crate::led::{EXPOSURE_S, Led, Noise, Signal, below, uniform};

/// What the answer should be, and the light that gives it: half of them are words of the book, the others are not.
fn anybody(book: &CodeBook, random: &mut Pcg64Mcg) -> (Who, Led) {
    let kind = uniform(random);
    let (who, signal) = if kind < 0.5 {
        let word = below(random, book.words().len());
        (Who::Word(word), Signal::Word(book.words()[word]))
    } else if kind < 0.6 {
        (Who::Steady, Signal::Steady)
    } else if kind < 0.9 {
        (Who::Unknown, Signal::Word(stranger(book, random)))
    } else {
        (Who::Unknown, Signal::Random((uniform(random) * 1e15) as u64))
    };
    (who, any_led(signal, random))
}

/// Probabilities against how often they are right, frame by frame from the first on.
pub(crate) fn tables() -> String {
    const TRIALS: usize = 6_000;
    const EDGES: [f64; 8] = [0.0, 0.5, 0.8, 0.9, 0.99, 0.999, 0.9999, 1.1];
    let mut rows = vec![row(["bits wrong %", "probability", "answers", "mean probability %", "right %"])];
    let book = book("l18-d3-r2");
    let decoder = decoder(&book);
    let mut scores = vec![row([
        "bits wrong %",
        "Brier score",
        "of not answering",
        "decided to be a word, markers",
        "of them wrong at first",
        "frames decided to be a word",
        "of them wrong",
    ])];
    for (number, error) in BIT_ERRORS.into_iter().enumerate() {
        eprintln!("reliability, {error}");
        let noise = Noise::of_bit_error(error);
        let mut bins = [(0_usize, 0.0, 0_usize); 7];
        let (mut brier, mut frames, mut prior) = (0.0, 0, 0.0);
        let (mut markers, mut first_wrong, mut decisions, mut wrong) = (0, 0, 0, 0);
        for trial in 0..TRIALS {
            let mut random = Pcg64Mcg::seed_from_u64((1_000_000 * (number + 1) + trial) as u64);
            let (who, led) = anybody(&book, &mut random);
            let mut listener = decoder.listener();
            let mut is_decided = false;
            for (time_s, light) in watch(&led, &noise, 0.05, 5 * book.length(), &mut random) {
                let before = score(&decoder, &listener, &book, who);
                decoder.hear(&mut listener, time_s, EXPOSURE_S, &noise.evidence(light)).expect("time passes");
                let identity = decoder.identity(&listener);
                let is_right = identity.who == who;
                let bin = EDGES.iter().rposition(|&edge| edge <= identity.probability).unwrap_or(0).min(6);
                bins[bin].0 += 1;
                bins[bin].1 += identity.probability;
                bins[bin].2 += usize::from(is_right);
                brier += score(&decoder, &listener, &book, who);
                if frames == 0 {
                    prior = before;
                }
                frames += 1;
                if matches!(identity.who, Who::Word(_)) && identity.probability >= DECIDED {
                    markers += usize::from(!is_decided);
                    first_wrong += usize::from(!is_decided && !is_right);
                    is_decided = true;
                    decisions += 1;
                    wrong += usize::from(!is_right);
                }
            }
        }
        let percent_wrong = format!("{:.1}", 100.0 * error);
        for (bin, &(count, sum, right)) in bins.iter().enumerate().filter(|(_, bin)| bin.0 > 0) {
            rows.push(vec![
                percent_wrong.clone(),
                format!("{} to {}", EDGES[bin], EDGES[bin + 1].min(1.0)),
                count.to_string(),
                format!("{:.3}", 100.0 * sum / count as f64),
                format!("{:.3}", 100.0 * right as f64 / count as f64),
            ]);
        }
        scores.push(vec![
            percent_wrong,
            format!("{:.4}", brier / f64::from(frames)),
            format!("{prior:.3}"),
            markers.to_string(),
            first_wrong.to_string(),
            decisions.to_string(),
            wrong.to_string(),
        ]);
    }
    markdown(rows) + "\n" + &markdown(scores)
}

/// The Brier score of all answers together: squared distance of their probabilities from 1 for what is true and 0 else.
fn score(decoder: &Decoder, listener: &Listener, book: &CodeBook, who: Who) -> f64 {
    let words = (0..book.words().len()).map(Who::Word);
    let answers = words.chain([Who::Unknown, Who::Steady, Who::Dark]);
    let off = |answer: Who| decoder.probability(listener, answer) - f64::from(u8::from(answer == who));
    answers.map(|answer| off(answer) * off(answer)).sum()
}
