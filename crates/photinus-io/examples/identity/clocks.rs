//! Clocks that are off, over ten minutes.

use photinus::identity::decoder::{Decoder, Listener, Who};
use photinus::identity::{Evidence, Level};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;

use crate::decoding::{DECIDED, book, decoder, percent, row, watch};
use crate::document::markdown;
use crate::led::{EXPOSURE_S, Led, Noise, Signal, uniform};

/// Ten minutes each, with a bit in 200 wrong, and the same with the light unknown beforehand and spots that are seen or not.
pub(crate) fn table() -> String {
    const FRAMES: usize = 36_000;
    let book = book("l18-d3-r2");
    let decoder = decoder(&book);
    let noise = Noise::of_bit_error(0.005);
    let mut rows = vec![row([
        "LED Hz",
        "frames lost %",
        "light",
        "decided right %",
        "decided wrong",
        "longest without, frames",
        "mean probability of the word",
        "of an unknown light",
    ])];
    for (number, (rate_hz, lost, is_known)) in [
        (59.9, 0.0, true),
        (59.99, 0.0, true),
        (60.0, 0.0, true),
        (60.1, 0.0, true),
        (59.9, 0.3, true),
        (59.9, 0.0, false),
        (60.1, 0.3, false),
        (60.6, 0.0, true),
        (63.0, 0.0, true),
        (57.0, 0.0, true),
    ]
    .into_iter()
    .enumerate()
    {
        eprintln!("{rate_hz} Hz");
        let mut random = Pcg64Mcg::seed_from_u64(77_000 + number as u64);
        let led =
            Led { signal: Signal::Word(book.words()[7]), at_first: 18.0 * uniform(&mut random), rate_hz };
        let mut listener = decoder.listener();
        let mut lamp = Lamp::new(is_known, noise);
        let (mut right, mut wrong, mut heard, mut since, mut longest) = (0, 0, 0, 0, 0);
        let (mut sum, mut unknown) = (0.0, 0.0);
        for (time_s, light) in watch(&led, &noise, lost, FRAMES, &mut random) {
            let evidence = lamp.evidence(light, time_s, &decoder, &listener);
            decoder.hear(&mut listener, time_s, EXPOSURE_S, &evidence).expect("time passes");
            if time_s < 1.0 {
                continue;
            }
            let identity = decoder.identity(&listener);
            let is_decided = identity.probability >= DECIDED;
            let is_right = is_decided && identity.who == Who::Word(7);
            heard += 1;
            right += usize::from(is_right);
            wrong += usize::from(is_decided && matches!(identity.who, Who::Word(word) if word != 7));
            since = if is_right { 0 } else { since + 1 };
            longest = longest.max(since);
            sum += decoder.probability(&listener, Who::Word(7));
            unknown += decoder.probability(&listener, Who::Unknown);
        }
        rows.push(vec![
            rate_hz.to_string(),
            format!("{:.0}", 100.0 * lost),
            if is_known { "known" } else { "followed, spots or none" }.to_owned(),
            percent(right, heard),
            wrong.to_string(),
            longest.to_string(),
            format!("{:.5}", sum / heard as f64),
            format!("{:.5}", unknown / heard as f64),
        ]);
    }
    markdown(rows)
}

/// Evidence from light: of an LED whose light is known, or from spots above a limit whose light is learnt on the way.
struct Lamp {
    is_known: bool,
    noise: Noise,
    level: Option<Level>,
    last_s: f64,
}

/// Below this share of the full light there is no spot.
const LIMIT: f64 = 0.4;

impl Lamp {
    fn new(is_known: bool, noise: Noise) -> Self {
        Self { is_known, noise, level: None, last_s: 0.0 }
    }

    fn evidence(&mut self, light: f64, time_s: f64, decoder: &Decoder, listener: &Listener) -> Evidence {
        if self.is_known {
            return self.noise.evidence(light);
        }
        let Some(level) = &mut self.level else {
            // a track begins with its first spot
            self.level = (light > LIMIT).then(|| Level::of_first(light)).flatten();
            return Evidence::NONE;
        };
        level.wait(time_s - self.last_s);
        self.last_s = time_s;
        let sigma = self.noise.sigma;
        if light < LIMIT {
            return Evidence::of_absence(LIMIT, sigma, level);
        }
        let evidence = Evidence::of_light(light, sigma, level);
        level.see(light, sigma, decoder.light_at(listener, time_s, EXPOSURE_S).unwrap_or(0.5));
        evidence
    }
}
