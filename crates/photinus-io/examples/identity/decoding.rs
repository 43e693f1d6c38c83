//! Decoding: what all its tables share, and which there are.

use photinus::identity::decoder::{Decoder, Settings};
use photinus::identity::{CodeBook, Word};
use photinus_io::codes::{PRESETS, parse_codes};
use rand_pcg::Pcg64Mcg;

use crate::document::Document;
use crate::led::{CAMERA_HZ, Led, Noise, Signal, uniform};
use crate::{changes, clocks, reliability, right};

/// An answer counts as a decision from this probability on.
pub(crate) const DECIDED: f64 = 0.9999;

pub(crate) const BIT_ERRORS: [f64; 3] = [0.005, 0.05, 0.2];

pub(crate) fn document() -> Document {
    Document {
        file: "identity.md",
        tables: vec![
            ("right", right::table()),
            ("reliability", reliability::tables()),
            ("clocks", clocks::table()),
            ("changes", changes::table()),
        ],
    }
}

pub(crate) fn book(name: &str) -> CodeBook {
    let preset = PRESETS.iter().find(|preset| preset.name == name).expect("it comes with Photinus");
    parse_codes(preset.text, name).expect("a book")
}

pub(crate) fn decoder(book: &CodeBook) -> Decoder {
    let mut settings = Settings::default();
    settings.bit_rate_hz = CAMERA_HZ;
    Decoder::new(book, settings).expect("settings")
}

pub(crate) fn percent(count: usize, of: usize) -> String {
    format!("{:.2}", 100.0 * count as f64 / of.max(1) as f64)
}

pub(crate) fn row<const N: usize>(cells: [&str; N]) -> Vec<String> {
    cells.map(String::from).to_vec()
}

/// A light with any phase, and a clock up to 500 ppm off.
pub(crate) fn any_led(signal: Signal, random: &mut Pcg64Mcg) -> Led {
    let rate_hz = CAMERA_HZ * (1.0 + 5e-4 * (2.0 * uniform(random) - 1.0));
    Led { signal, at_first: 100.0 * uniform(random), rate_hz }
}

/// Times and lights of so many frames.
pub(crate) fn watch(
    led: &Led,
    noise: &Noise,
    lost: f64,
    frames: usize,
    random: &mut Pcg64Mcg,
) -> Vec<(f64, f64)> {
    let mut seen = Vec::with_capacity(frames);
    for frame in 0..frames {
        let time_s = frame as f64 / CAMERA_HZ;
        if uniform(random) >= lost {
            seen.push((time_s, noise.measure(led.share(time_s), random)));
        }
    }
    seen
}

/// A word of the same length that is in no book.
pub(crate) fn stranger(book: &CodeBook, random: &mut Pcg64Mcg) -> Word {
    loop {
        let bits: Vec<bool> = (0..book.length()).map(|_| uniform(random) < 0.5).collect();
        let word = Word::new(&bits).expect("of a book's length");
        let is_steady = word.ones() == 0 || word.ones() as usize == book.length();
        if !is_steady && book.words().iter().all(|known| known.cyclic_distance(&word) != Some(0)) {
            return word;
        }
    }
}
