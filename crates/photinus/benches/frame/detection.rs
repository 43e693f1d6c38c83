//! Spots of frames beside two floors of the same run on the same frames: a pass for the maximum of the frame, compiled with
//! the same flags, and a copy of it.
//!
//! Frames in cache are one frame again and again, another in each round; out of it they follow one another through more
//! memory than the last-level cache holds, and no contender sees a frame that the one before it has just read.

use std::cell::Cell;
use std::hint::black_box;

use photinus::frame::FrameView;
use photinus::spots::{Brightness, Detector, Settings};

use crate::contest::{self, Contender, Contest};
use crate::frames::{self, Look, PAPER, Scene, Size};

/// Taken for the size of the last-level cache where the system does not tell it, bytes.
const UNTOLD_CACHE: usize = 64 << 20;
/// Pixels that a contender sees in a round, about.
const PIXELS_PER_ROUND: usize = 1 << 23;

const SCENES: [(&str, usize, Look, bool); 6] = [
    ("empty", 0, Look::Disc, false),
    ("30 markers", 30, Look::Disc, false),
    ("120 markers", 120, Look::Disc, false),
    ("30, the sun", 30, Look::Disc, true),
    ("30 points", 30, Look::Point, false),
    ("120 points", 120, Look::Point, false),
];

pub(crate) fn run() {
    if contest::is_counting() {
        return count();
    }
    for size in [Size { width: 752, height: 480 }, Size { width: 1920, height: 1200 }] {
        for (place, bytes) in [("in cache", 0), ("out of cache", last_level_cache() / 4 * 5)] {
            println!("\n{:<28}{:>20}{:>27}{:>27}", "", "floors, us", "fixed threshold", "contrast");
            println!(
                "{:<28}{:>10}{:>10}{:>9}{:>11}{:>7}{:>9}{:>11}{:>7}",
                format!("{}x{}, {place}", size.width, size.height),
                "maximum",
                "copy",
                "us",
                "x maximum",
                "x copy",
                "us",
                "x maximum",
                "x copy"
            );
            for (name, markers, look, sun) in SCENES {
                row(name, &Supply::new(frames::markers(&Scene { size, markers, look, sun }), size, bytes));
            }
        }
    }
}

/// The detectors alone, for their instructions to be counted.
fn count() {
    let mut contest = Contest::beside_maximum("Detecting, 752x480");
    for (name, markers, look, sun) in SCENES {
        let frames = frames::markers(&Scene { size: PAPER, markers, look, sun });
        for (law, mut detector) in ["fixed", "contrast"].into_iter().zip(detectors()) {
            let frames = frames.clone();
            contest.add(&format!("{name}, {law}"), move |i| {
                let frame = FrameView::packed(&frames[i % frames.len()], PAPER.width, PAPER.height);
                black_box(detector.detect(&frame.expect("a frame"), None).expect("no mask"));
            });
        }
    }
    contest.run();
}

/// By a fixed threshold and by contrast.
fn detectors() -> [Detector; 2] {
    [Brightness::Threshold(200), Brightness::default()].map(|brightness| {
        let mut settings = Settings::default();
        settings.brightness = brightness;
        Detector::new(settings).expect("settings")
    })
}

/// Times floors and detectors on the frames of one scene.
fn row(name: &str, supply: &Supply) {
    let mut copy = vec![0; supply.size.pixels()];
    let mut detectors = detectors();
    let mut contenders: Vec<Contender<'_>> = vec![
        Box::new(|round| {
            black_box(supply.next(round).iter().fold(0, |high: u8, &pixel| high.max(pixel)));
        }),
        Box::new(|round| {
            copy.copy_from_slice(supply.next(round));
            black_box(&copy);
        }),
    ];
    for detector in &mut detectors {
        contenders.push(Box::new(|round| {
            let frame = FrameView::packed(supply.next(round), supply.size.width, supply.size.height);
            black_box(detector.detect(&frame.expect("a frame"), None).expect("no mask"));
        }));
    }
    let calls = (PIXELS_PER_ROUND / supply.size.pixels()).next_multiple_of(frames::FRAMES);
    let times = contest::times(&mut contenders, calls);
    let [maximum, copy, fixed, contrast] = [0, 1, 2, 3].map(|i| times[i].median_us);
    print!("{name:<28}{maximum:>10.2}{copy:>10.2}");
    for time in [fixed, contrast] {
        print!("{time:>9.2}{:>11.2}{:>7.2}", time / maximum, time / copy);
    }
    println!();
}

/// Frames one after the other in memory.
struct Supply {
    pixels: Vec<u8>,
    size: Size,
    in_cache: bool,
    given: Cell<usize>,
}

impl Supply {
    /// The frames, or as many copies of them as fill at least so many bytes.
    fn new(frames: Vec<Vec<u8>>, size: Size, bytes: usize) -> Self {
        let pixels = frames.concat();
        let copies = bytes.div_ceil(pixels.len()).max(1);
        Self { pixels: pixels.repeat(copies), size, in_cache: bytes == 0, given: Cell::new(0) }
    }

    fn next(&self, round: usize) -> &[u8] {
        let pixels = self.size.pixels();
        let given = self.given.replace(self.given.get() + 1);
        let frame = if self.in_cache { round } else { given } % (self.pixels.len() / pixels);
        &self.pixels[frame * pixels..][..pixels]
    }
}

/// Its size in bytes, as Linux tells it.
fn last_level_cache() -> usize {
    let size = |index: usize| {
        let told = std::fs::read_to_string(format!("/sys/devices/system/cpu/cpu0/cache/index{index}/size"));
        told.ok()?.trim().strip_suffix('K')?.parse::<usize>().ok().map(|kilobytes| kilobytes << 10)
    };
    (0..8).filter_map(size).max().unwrap_or(UNTOLD_CACHE)
}
