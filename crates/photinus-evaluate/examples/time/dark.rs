//! A hexarotor that blinks, by how many of its LEDs shine in a frame, beside the same flight with LEDs that shine all the time.

use std::ops::RangeInclusive;

use rand_pcg::Pcg64;

use crate::flight::fly_well;
use crate::scene::{Airframe, HEXAROTOR, RATE_HZ, SIGNALLED, between, blink, head, parse, target};
use crate::score::{self, DISHONEST, nees, pair};

/// Frames count after a vehicle's first second, s.
const FROM_S: f64 = 1.0;
/// More LEDs than this never shine towards a camera at once.
const MOST: usize = 4;

/// Frames by how many LEDs shine.
#[derive(Clone, Copy, Default)]
pub(crate) struct Row {
    pub(crate) frames: usize,
    pub(crate) tracked: usize,
    pub(crate) predicted: usize,
    square_m2: f64,
    squares: f64,
}

/// By how many LEDs shine.
pub(crate) type Rows = [Row; MOST + 1];

pub(crate) fn table(seeds: RangeInclusive<u64>) {
    println!(
        "| LEDs | shine in the frame | frames | with a track % | said to be predicted % | distance, rms m | of steady ones |\n|---|---|---|---|---|---|---|"
    );
    let mut steady_m = f64::NAN;
    let all: [(&str, Airframe, &[usize]); 3] = [
        ("steady", HEXAROTOR, &[]),
        ("one word", HEXAROTOR, &[0]),
        ("six words", SIGNALLED, &[0, 1, 2, 3, 4, 5]),
    ];
    for (name, airframe, words) in all {
        let rows = of_seeds(seeds.clone(), airframe, words);
        let whole = whole(&rows);
        if words.is_empty() {
            steady_m = whole.rms_m();
        }
        for (shine, row) in rows.iter().enumerate().filter(|row| row.1.frames > 0) {
            println!("{}", row.line(name, &shine.to_string(), steady_m));
        }
        println!("{}", whole.line(name, "all", steady_m));
    }
}

impl Row {
    fn with(self, other: &Self) -> Self {
        Self {
            frames: self.frames + other.frames,
            tracked: self.tracked + other.tracked,
            predicted: self.predicted + other.predicted,
            square_m2: self.square_m2 + other.square_m2,
            squares: self.squares + other.squares,
        }
    }

    fn of_words(&self, seed: &str) -> String {
        let Self { frames, tracked, .. } = self;
        format!("| {seed} | {frames} | {tracked} | {:.3} | {:.2} |", self.rms_m(), self.nees())
    }

    /// Squared errors of the position over its covariance.
    pub(crate) fn nees(&self) -> f64 {
        self.squares / self.tracked as f64
    }

    pub(crate) fn rms_m(&self) -> f64 {
        libm::sqrt(self.square_m2 / self.tracked as f64)
    }

    fn line(&self, name: &str, shine: &str, steady_m: f64) -> String {
        let percent = |count: usize, of: usize| 100.0 * count as f64 / of as f64;
        format!(
            "| {name} | {shine} | {} | {:.2} | {:.1} | {:.3} | {:.2} |",
            self.frames,
            percent(self.tracked, self.frames),
            percent(self.predicted, self.tracked),
            self.rms_m(),
            self.rms_m() / steady_m
        )
    }
}

/// All frames.
pub(crate) fn whole(rows: &Rows) -> Row {
    rows.iter().fold(Row::default(), Row::with)
}

/// The flights of these seeds, each signal of the vehicle with a word.
pub(crate) fn of_seeds(seeds: RangeInclusive<u64>, airframe: Airframe, words: &[usize]) -> Rows {
    together(&seeds.map(|seed| fly(seed, airframe, words)).collect::<Vec<_>>())
}

/// All frames of several flights.
pub(crate) fn together(flights: &[Rows]) -> Rows {
    flights.iter().fold(Rows::default(), |mut all, own| {
        all.iter_mut().zip(own).for_each(|(row, own)| *row = row.with(own));
        all
    })
}

/// The flight of a seed.
fn fly(seed: u64, airframe: Airframe, words: &[usize]) -> Rows {
    let mut rows = Rows::default();
    let mut random = Pcg64::new(u128::from(seed), 0xda2c);
    let mut between = |low: f64, high: f64| between(&mut random, low, high);
    let centre_m = [between(4.5, 8.0), between(-2.0, 2.0), between(4.6, 5.4)];
    let motion = format!(
        "circle = {{ centre_m = {centre_m:?}, radius_m = 1.0, speed_m_s = 1.0, phase_deg = {:?} }}",
        between(0.0, 360.0)
    );
    let mut rest = format!("heading_deg = {:?}\nwind_m_s = 2.0\n", between(0.0, 360.0));
    let (shift_s, ppm) = (between(0.001, 0.3), between(-30.0, 30.0));
    if !words.is_empty() {
        rest += &blink(words, RATE_HZ, shift_s, ppm);
    }
    let scene = parse(&(head(seed, 6.0) + &target(1, airframe, &motion, "", &rest)));
    fly_well(&scene, |lookout, truth| {
        if truth.time_s < FROM_S {
            return;
        }
        let row = &mut rows[truth.neighbours[0].leds.len().min(MOST)];
        row.frames += 1;
        for (track, there) in pair(&lookout.tracked().tracks, &truth.neighbours) {
            let off_m = track.position_m.norm() - there.distance_m;
            row.tracked += 1;
            row.predicted += usize::from(track.is_predicted);
            row.square_m2 += off_m * off_m;
            row.squares += nees(&score::off_m(track, there), &track.position_covariance_m2);
        }
    });
    rows
}

/// Flights with a word for each arm: those that have no track in some frame, or are more sure than they may be, and all together.
pub(crate) fn words(seeds: RangeInclusive<u64>) {
    println!("| seed | frames | with a track | distance, rms m | NEES |\n|---|---|---|---|---|");
    let mut all = Row::default();
    for seed in seeds {
        let own = whole(&fly(seed, SIGNALLED, &[0, 1, 2, 3, 4, 5]));
        all = all.with(&own);
        if own.tracked < own.frames || own.nees() > DISHONEST {
            println!("{}", own.of_words(&seed.to_string()));
        }
    }
    println!("{}", all.of_words("all"));
}
