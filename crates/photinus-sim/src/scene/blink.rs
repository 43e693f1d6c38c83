//! What targets blink, and by which clock.

use photinus::airframe::Airframe;
use photinus_io::codes::read_codes;
use photinus_io::{Result, physics};

use super::read::Reader;
use super::table::BlinkTable;
use super::{BlinkPlan, Scene};
use crate::clock::Clock;

/// More bits than this in an exposure are a slip: no LED blinks faster than any camera can tell.
const MOST_BITS: f64 = 1e4;

/// Edges that stray farther than this share of a bit would change places.
const MOST_JITTER: f64 = 0.1;

impl Reader<'_> {
    /// Refuses an LED that switches without end while a camera looks.
    pub(super) fn bits_in_an_exposure(&self, scene: &Scene) -> Result<()> {
        let own_us = scene.cameras.iter().filter_map(|camera| camera.exposure_us);
        let exposure_s = own_us.fold(scene.exposure_us, f64::max) * 1e-6;
        for (index, target) in scene.targets.iter().enumerate() {
            let bits = target.blink.as_ref().map_or(0.0, |blink| blink.rate_hz * exposure_s);
            if bits > MOST_BITS {
                let reason = format!("an exposure of {exposure_s} s holds {bits:.0} bits");
                return Err(self
                    .check
                    .refuse(&format!("target[{index}].blink.rate_hz"), reason)
                    .advise(format!("let it hold up to {MOST_BITS}")));
            }
        }
        Ok(())
    }

    pub(super) fn blink(&self, key: &str, table: BlinkTable, airframe: &Airframe) -> Result<BlinkPlan> {
        let check = &self.check;
        let key = |name: &str| format!("{key}.{name}");
        let codes = read_codes(self.named(&key("codes"), &table.codes)?)?;
        let last = airframe.leds().iter().filter_map(|led| led.signal).max().unwrap_or(0) as usize;
        let (name, words) = match (table.words, table.first_word) {
            (Some(_), Some(_)) => {
                return Err(check
                    .refuse(&key("first_word"), "words are given, too")
                    .advise("keep one of them"));
            }
            (Some(words), None) => ("words", words),
            // an LED of signal s sends word first_word + s; a word past the end of any book is refused below
            (None, first) => {
                let first = first.unwrap_or(0);
                ("first_word", (0..=last).map(|signal| first.saturating_add(signal)).collect())
            }
        };
        if words.len() != last + 1 {
            let reason = format!("{} words for {} signals", words.len(), last + 1);
            return Err(check
                .refuse(&key(name), reason)
                .advise("say a word for each signal of the airframe"));
        }
        if let Some(word) = words.iter().find(|word| **word >= codes.words().len()) {
            let reason = format!("word {word} of {} words", codes.words().len());
            return Err(check
                .refuse(&key(name), reason)
                .advise("words are counted from 0; an LED of signal s sends word first_word + s"));
        }
        let rate_hz = check.rate(&key("rate_hz"), table.rate_hz)?;
        Ok(BlinkPlan {
            codes,
            words,
            rate_hz,
            clock: Clock {
                offset_s: check.within(&key("shift_s"), table.shift_s, (-1e3, 1e3))?,
                ppm: physics::within(check.path, &key("ppm"), table.ppm, &physics::CLOCK_PPM)?,
            },
            jitter_s: check.within(&key("jitter_s"), table.jitter_s, (0.0, MOST_JITTER / rate_hz))?,
        })
    }
}
