//! Time of a frame on one core, beside floors measured in the same run: `cargo bench -p photinus`.
//!
//! Times differ from machine to machine and from run to run; the ratios to the floor, a pass that only takes the maximum
//! of the frame, are what to compare. Every contender runs in turn within each round, medians are over the rounds.

mod contest;
mod frames;

use std::hint::black_box;

use contest::Contest;
use photinus::frame::FrameView;
use photinus::spots::{Brightness, Detector, Settings};

fn main() {
    detection();
}

fn detection() {
    let mut contest = Contest::new("Detection, 752x480", "maximum of the frame");
    let dark = frames::markers(0, false);
    contest.add("maximum of the frame", {
        let frames = dark.clone();
        move |i| {
            let frame = &frames[i % frames.len()];
            black_box(frame.iter().fold(0, |high: u8, &pixel| high.max(pixel)));
        }
    });
    contest.add("memcpy of the frame", {
        let frames = dark;
        let mut copy = vec![0; frames[0].len()];
        move |i| {
            copy.copy_from_slice(&frames[i % frames.len()]);
            black_box(&copy);
        }
    });
    for (rule, brightness) in [("fixed", Brightness::Threshold(200)), ("contrast", Brightness::default())] {
        for (count, sun) in [(0, false), (6, false), (30, false), (120, false), (30, true)] {
            let frames = frames::markers(count, sun);
            let mut detector = Detector::new(Settings { brightness, ..Settings::default() }).unwrap();
            let name = format!("{rule}, {count} markers{}", if sun { " and the sun" } else { "" });
            contest.add(&name, move |i| {
                let frame =
                    FrameView::packed(&frames[i % frames.len()], frames::WIDTH, frames::HEIGHT).unwrap();
                black_box(detector.detect(&frame, None).unwrap());
            });
        }
    }
    contest.run();
}
