//! When a light was lit -> which word of a book it blinks, and where in its words the board was. The board's clock is its own: its rate is
//! searched around the one that it was told.

use photinus::identity::CodeBook;

/// How far the rate of a board is off, share: oscillators without a crystal.
const OFF: f64 = 0.01;
/// Steps of the search within a bit.
const STEPS: f64 = 16.0;
/// So much of a bit at either end of it may show the bit beside.
const EDGE: f64 = 0.1;
/// Of fewer frames than one in so many nothing is read: a clock that puts all others at the edges of bits agrees with anything.
const LEAST_OF: u32 = 3;
/// A word is read where so many of the frames say it ...
const LEAST_AGREED: f64 = 0.95;
/// ... and at most so many say any other.
const MOST_OTHER: f64 = 0.9;

/// What a light does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Reading {
    /// It blinks this word of the book; so many of the frames say so.
    Word(usize, f64),
    /// It is lit in (nearly) every frame.
    Steady,
    /// It blinks what no word is, or two words alike.
    Unknown,
}

/// A light, by what was seen of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen<'a> {
    /// Whether it was lit, of each frame.
    pub(super) lit: &'a [bool],
    /// The word that it blinks.
    pub(super) word: usize,
}

/// A board's clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct BoardClock {
    /// Bits a second.
    pub(super) rate_hz: f64,
    /// How far into its words it was at time 0, bits.
    pub(super) shift: f64,
    /// Share of the frames that agree with it, the mean over the lights.
    pub(super) agreed: f64,
}

/// Frames, and what is blinked in them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Film<'a> {
    /// When each frame was, s, from any beginning.
    pub(super) times_s: &'a [f64],
    /// The words.
    pub(super) book: &'a CodeBook,
    /// Bits a second that the board was told.
    pub(super) rate_hz: f64,
}

impl Film<'_> {
    /// Reads a light.
    pub(super) fn read(&self, lit: &[bool]) -> Reading {
        let share = lit.iter().filter(|lit| **lit).count() as f64 / lit.len() as f64;
        if share > 0.98 {
            return Reading::Steady;
        }
        let words = 0..self.book.words().len();
        let mut agreed: Vec<(usize, f64)> =
            words.map(|word| (word, self.clock(&[Seen { lit, word }]).agreed)).collect();
        agreed.sort_by(|a, b| b.1.total_cmp(&a.1));
        let other = agreed.get(1).map_or(0.0, |other| other.1);
        match agreed.first() {
            Some((word, agreed)) if *agreed >= LEAST_AGREED && other <= MOST_OTHER => {
                Reading::Word(*word, *agreed)
            }
            _ => Reading::Unknown,
        }
    }

    /// The clock that these lights agree with best; of those that agree alike the one whose rate is nearest to the told one.
    pub(super) fn clock(&self, lights: &[Seen<'_>]) -> BoardClock {
        let span_s = self.times_s.last().zip(self.times_s.first()).map_or(0.0, |(last, first)| last - first);
        // A step of the rate moves the end of the frames by a step of the shift.
        let steps = (OFF * self.rate_hz * span_s * STEPS).ceil().max(1.0) as i32;
        let mut rates: Vec<f64> =
            (-steps..=steps).map(|step| OFF * f64::from(step) / f64::from(steps)).collect();
        rates.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
        let mut best = BoardClock { rate_hz: self.rate_hz, shift: 0.0, agreed: -1.0 };
        for rate_hz in rates.into_iter().map(|off| self.rate_hz * (1.0 + off)) {
            let now = self.shift(lights, rate_hz);
            if now.agreed > best.agreed {
                best = now;
            }
        }
        best
    }

    /// The same at a rate that is known.
    pub(super) fn shift(&self, lights: &[Seen<'_>], rate_hz: f64) -> BoardClock {
        let shifts = (0..self.book.length() * STEPS as usize).map(|step| step as f64 / STEPS);
        let at = |shift: f64| {
            let clock = BoardClock { rate_hz, shift, agreed: 0.0 };
            let agreed: f64 = lights.iter().map(|light| self.agreed(light, &clock)).sum();
            BoardClock { agreed: agreed / lights.len() as f64, ..clock }
        };
        let all: Vec<BoardClock> = shifts.map(at).collect();
        let most = all.iter().map(|clock| clock.agreed).fold(0.0, f64::max);
        // Shifts that agree alike lie side by side: the middle of the first such run.
        let first = all.iter().position(|clock| clock.agreed >= most).unwrap_or(0);
        let run = all[first..].iter().take_while(|clock| clock.agreed >= most).count();
        all[first + run / 2]
    }

    /// Share of the frames in which a light was as this clock says. Frames near the edge of a bit say nothing, and there must be others.
    pub(super) fn agreed(&self, light: &Seen<'_>, clock: &BoardClock) -> f64 {
        let word = &self.book.words()[light.word];
        let (mut same, mut all) = (0_u32, 0_u32);
        for (lit, time_s) in light.lit.iter().zip(self.times_s) {
            let place = time_s * clock.rate_hz + clock.shift;
            let bit = place.floor();
            if (EDGE..=1.0 - EDGE).contains(&(place - bit)) {
                all += 1;
                same +=
                    u32::from(word.bit((bit as i64).rem_euclid(self.book.length() as i64) as usize) == *lit);
            }
        }
        f64::from(same) / f64::from(all.max(light.lit.len() as u32 / LEAST_OF).max(1))
    }
}

#[cfg(test)]
mod tests {
    use photinus_io::codes::{PRESETS, parse_codes};

    use super::*;

    #[test]
    fn every_word_is_read_at_any_shift_and_rate_with_some_frames_wrong() {
        let book = parse_codes(PRESETS[1].text, PRESETS[1].name).unwrap();
        let times_s: Vec<f64> = (0..120).map(|frame| f64::from(frame) / 59.9).collect();
        let film = Film { times_s: &times_s, book: &book, rate_hz: 60.0 };
        for (case, (word, bits)) in book.words().iter().enumerate().enumerate() {
            let (rate_hz, shift) = (60.0 * (1.0 + 0.002 * (case as f64 % 5.0 - 2.0)), 0.37 * case as f64);
            let lit = |(frame, time_s): (usize, &f64)| {
                let bit = (time_s * rate_hz + shift).floor() as usize % book.length();
                // Two frames of a hundred are wrong.
                bits.bit(bit) != (frame % 50 == case % 50)
            };
            let lit: Vec<bool> = times_s.iter().enumerate().map(lit).collect();
            let Reading::Word(read, agreed) = film.read(&lit) else { panic!("word {word} is not read") };
            assert!(read == word && agreed > 0.95, "{word}: {read}, {agreed}");
            let clock = film.clock(&[Seen { lit: &lit, word }]);
            // In the middle of the frames it is within half a bit, as far as the word goes round.
            let at_s = 1.0;
            let off =
                (at_s * (clock.rate_hz - rate_hz) + clock.shift - shift).rem_euclid(book.length() as f64);
            assert!(off.min(book.length() as f64 - off) < 0.5, "{word}: {off} bits off, {clock:?}");
        }
    }

    #[test]
    fn what_is_no_word_is_not_read() {
        let book = parse_codes("0,0,1,0,1,1\n0,1,0,1,1,1\n", "t").unwrap();
        let times_s: Vec<f64> = (0..90).map(|frame| f64::from(frame) / 60.0).collect();
        let film = Film { times_s: &times_s, book: &book, rate_hz: 60.0 };
        assert_eq!(film.read(&[true; 90]), Reading::Steady);
        let chaos: Vec<bool> =
            (0..90_u32).map(|frame| frame.wrapping_mul(2_654_435_761) >> 31 == 1).collect();
        assert_eq!(film.read(&chaos), Reading::Unknown);
    }
}
