//! Tracks that pass on to another light.

use photinus::identity::decoder::Who;
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;

use crate::decoding::{DECIDED, any_led, book, decoder, row, stranger};
use crate::document::markdown;
use crate::led::{CAMERA_HZ, EXPOSURE_S, Noise, Signal, below};

/// A track passes on to another light after ten seconds.
pub(crate) fn table() -> String {
    const TRIALS: usize = 500;
    const BEFORE: usize = 600;
    let book = book("l18-d3-r2");
    let decoder = decoder(&book);
    let mut rows = vec![row([
        "bits wrong %",
        "then comes",
        "frames until the old word is less than even: median",
        "longest",
        "frames until the new answer is decided: median",
        "longest",
        "decided to be another word",
    ])];
    for (number, error) in [0.005, 0.05].into_iter().enumerate() {
        for (kind, what) in ["another word", "a steady light", "an unknown word"].into_iter().enumerate() {
            eprintln!("changes, {error}, {what}");
            let noise = Noise::of_bit_error(error);
            let (mut forgot, mut found, mut wrong) = (Vec::new(), Vec::new(), 0);
            for trial in 0..TRIALS {
                let mut random =
                    Pcg64Mcg::seed_from_u64((9_000_000 + 10_000 * (3 * number + kind) + trial) as u64);
                let old = below(&mut random, book.words().len());
                let new = (old + 1 + below(&mut random, book.words().len() - 1)) % book.words().len();
                let (who, signal) = match kind {
                    0 => (Who::Word(new), Signal::Word(book.words()[new])),
                    1 => (Who::Steady, Signal::Steady),
                    _ => (Who::Unknown, Signal::Word(stranger(&book, &mut random))),
                };
                let leds =
                    [any_led(Signal::Word(book.words()[old]), &mut random), any_led(signal, &mut random)];
                let mut listener = decoder.listener();
                let (mut forgotten, mut decided) = (None, None);
                for frame in 0..BEFORE + 300 {
                    let time_s = frame as f64 / CAMERA_HZ;
                    let light = noise.measure(leds[usize::from(frame >= BEFORE)].share(time_s), &mut random);
                    decoder
                        .hear(&mut listener, time_s, EXPOSURE_S, &noise.evidence(light))
                        .expect("time passes");
                    if frame < BEFORE {
                        continue;
                    }
                    let after = frame - BEFORE + 1;
                    if decoder.probability(&listener, Who::Word(old)) < 0.5 {
                        forgotten = forgotten.or(Some(after));
                    }
                    let identity = decoder.identity(&listener);
                    if forgotten.is_some() && identity.probability >= DECIDED {
                        decided = decided.or((identity.who == who).then_some(after));
                        let is_false = matches!(identity.who, Who::Word(_)) && identity.who != who;
                        wrong += usize::from(is_false);
                    }
                }
                forgot.push(forgotten.unwrap_or(usize::MAX));
                found.push(decided.unwrap_or(usize::MAX));
            }
            let told = |frames: usize| match frames {
                usize::MAX => "not in 300".to_owned(),
                frames => frames.to_string(),
            };
            forgot.sort_unstable();
            found.sort_unstable();
            rows.push(vec![
                format!("{:.1}", 100.0 * error),
                what.to_owned(),
                told(forgot[TRIALS / 2]),
                told(forgot[TRIALS - 1]),
                told(found[TRIALS / 2]),
                told(found[TRIALS - 1]),
                wrong.to_string(),
            ]);
        }
    }
    markdown(rows)
}
