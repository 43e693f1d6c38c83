//! Tracks and names on rendered frames while something is wrong, and while LEDs are dark: short runs of the example `time`, on seeds that it was developed on.

#![allow(dead_code, reason = "the example prints more than the test looks at")]
#![allow(clippy::print_stdout, reason = "the example prints its tables")]

#[path = "../examples/time/dark.rs"]
mod dark;
#[path = "../examples/time/fault.rs"]
mod fault;
#[path = "../examples/time/flight.rs"]
mod flight;
#[path = "../examples/time/scene.rs"]
mod scene;
#[path = "../examples/time/score.rs"]
mod score;

use fault::FAULTS;
use scene::{HEXAROTOR, SIGNALLED};
use score::Score;

fn fly(seed: u64, name: &str) -> Score {
    let fault = FAULTS.iter().find(|fault| fault.name == name).expect("a fault of the table");
    let score = flight::fly(seed, HEXAROTOR, fault);
    println!("{}", score.line(HEXAROTOR, name));
    score
}

/// A pose that needs a dead LED pays for it once: this flight had NEES of 22 while it paid in every frame.
#[test]
fn a_dead_led_makes_nobody_surely_wrong() {
    let [seen, predicted, velocity] = fly(2, "a dead LED each").nees();
    assert!(seen < 4.0 && predicted < 4.0 && velocity < 4.0, "{seen} {predicted} {velocity}");
}

/// Frames of a clock that was set back by less than late frames may be are no late frames: all is begun anew, and said so.
#[test]
fn a_clock_that_is_set_back_is_told() {
    let score = fly(1, "times 0.3 s back");
    assert_eq!((score.resets, score.late), (1, 0));
    assert!(score.nees().iter().all(|nees| *nees < 4.0), "{:?}", score.nees());
}

/// A hexarotor that blinks has a track in every frame after its first second, also where one LED is lit or none. The middle one of its flights is told 1.5 times as far off as with steady
/// LEDs at most, and all of them as far off as they claim: one in a hundred takes two LEDs for two others for half a second, 3 m off, and that alone would be the mean.
#[test]
fn who_blinks_is_found_in_every_frame() {
    let [steady, one, six] = [(HEXAROTOR, &[][..]), (HEXAROTOR, &[0]), (SIGNALLED, &[0, 1, 2, 3, 4, 5])].map(
        |(airframe, words)| {
            let flight = |seed| dark::of_seeds(seed..=seed, airframe, words);
            (1..=12).map(flight).collect::<Vec<_>>()
        },
    );
    let middle_m = |flights: &[dark::Rows]| {
        let mut all: Vec<_> = flights.iter().map(|rows| dark::whole(rows).rms_m()).collect();
        all.sort_by(f64::total_cmp);
        all[all.len() / 2]
    };
    for flights in [&one, &six] {
        let rows = dark::together(flights);
        let whole = dark::whole(&rows);
        assert_eq!(whole.frames, whole.tracked);
        assert_eq!(rows[0].tracked, rows[0].predicted, "who shows nothing is said to be predicted");
        assert!(middle_m(flights) < 1.5 * middle_m(&steady), "{} {}", middle_m(flights), middle_m(&steady));
        assert!(whole.nees() < 4.0, "{}", whole.nees());
    }
    assert!(dark::together(&six)[1].frames > 10, "frames with one LED");
}

/// Exposures of these two flights hold an edge of what LEDs blink in all frames. One had no track for most of the time; lights that were heard wrong began the other's 3.8 m too far,
/// and surely so.
#[test]
fn who_is_exposed_across_the_edges_of_its_bits_is_found() {
    for seed in [42, 56] {
        let all = dark::whole(&dark::of_seeds(seed..=seed, SIGNALLED, &[0, 1, 2, 3, 4, 5]));
        assert_eq!(all.tracked, all.frames, "{seed}");
        assert!(all.nees() < 4.0 && all.rms_m() < 0.1, "{seed}: {} {}", all.nees(), all.rms_m());
    }
}
