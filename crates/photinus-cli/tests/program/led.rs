//! `photinus led`: a model of a board on a pseudo-terminal, and what a camera sees of LEDs in a simulation.

use std::f64::consts::TAU;
use std::os::fd::AsRawFd;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use serial2::SerialPort;

use crate::stage::Stage;

const BOOK: &str = include_str!("../../../../scenes/codes/l12-d3-r3.txt");

/// What a board was told, by the description of its protocol alone.
#[derive(Clone, Debug, Default, PartialEq)]
struct Board {
    line: Vec<u8>,
    length: usize,
    words: std::collections::BTreeMap<u8, Vec<u8>>,
    rate_hz: u16,
    selected: Vec<u8>,
    is_lit: bool,
    mode: Option<u8>,
}

impl Board {
    /// Takes bytes of the line; leaves the frames that were whole and in order.
    fn take(&mut self, bytes: &[u8]) -> Vec<Vec<u8>> {
        self.line.extend_from_slice(bytes);
        let mut frames = Vec::new();
        while self.line.len() > 2 && self.line.len() >= 3 + usize::from(self.line[1]) {
            let frame: Vec<u8> = self.line.drain(..3 + usize::from(self.line[1])).collect();
            let (sum, rest) = frame.split_last().unwrap();
            assert_eq!(
                (rest[0], rest.iter().map(|byte| u32::from(*byte)).sum::<u32>() % 256),
                (b'b', u32::from(*sum))
            );
            self.obey(&rest[2..]);
            frames.push(frame);
        }
        frames
    }

    fn obey(&mut self, payload: &[u8]) {
        match payload[0] {
            0x90 => self.is_lit = payload[1] == 1,
            0x96 => {
                self.rate_hz = u16::from(payload[1]) + 256 * u16::from(payload.get(2).copied().unwrap_or(0));
            }
            0x97 => self.length = usize::from(payload[1]),
            0x98 => self.selected = payload[1..].to_vec(),
            0x99 => drop(self.words.insert(payload[1], payload[2..].to_vec())),
            0xF0 => self.mode = Some(payload[1]),
            other => panic!("{other:#x} is no command"),
        }
    }
}

/// Runs `photinus led` on a pseudo-terminal behind which a board listens, which answers or not.
fn driven(stage: &Stage, arguments: &str, answers: bool) -> (crate::stage::Done, Board) {
    let (mut own, other) = SerialPort::pair().unwrap();
    own.set_read_timeout(Duration::from_millis(5)).unwrap();
    let name = std::fs::read_link(format!("/proc/self/fd/{}", other.as_raw_fd())).unwrap();
    let (board, over) = (Arc::new(Mutex::new(Board::default())), Arc::new(AtomicBool::new(false)));
    let (listening, is_over) = (board.clone(), over.clone());
    let thread = std::thread::spawn(move || {
        let mut room = [0; 256];
        while !is_over.load(Ordering::Relaxed) {
            let count = own.read(&mut room).unwrap_or(0);
            for frame in listening.lock().unwrap().take(&room[..count]) {
                if answers {
                    own.write_all(&frame).unwrap();
                }
            }
        }
    });
    let done = stage.run(&format!("led {} {arguments} --pause 0.01", name.display()));
    over.store(true, Ordering::Relaxed);
    thread.join().unwrap();
    drop(other);
    let board = board.lock().unwrap().clone();
    (done, board)
}

#[test]
fn a_board_is_told_what_its_vehicle_blinks_and_whether_it_answers_is_said() {
    let stage = Stage::new("led");
    stage.file("book.txt", BOOK);
    let words: Vec<Vec<u8>> = BOOK
        .lines()
        .filter(|line| line.starts_with(['0', '1']))
        .map(|line| line.split(',').map(|bit| bit.trim().parse().unwrap()).collect())
        .collect();
    let (done, board) = driven(&stage, "--book book.txt --vehicle 1 --rate 300", false);
    assert_eq!(done.code, 0, "{}", done.err);
    assert!(done.out.contains("the board answers nothing"), "{}", done.out);
    let own = (4..8_u8).map(|word| (word, words[usize::from(word)].clone())).collect();
    let wanted = Board {
        length: 12,
        words: own,
        rate_hz: 300,
        selected: vec![4, 5, 6, 7],
        is_lit: true,
        mode: Some(0),
        line: Vec::new(),
    };
    assert_eq!(board, wanted);

    let (done, board) =
        driven(&stage, "--book book.txt --vehicle 5 --signals 1 --classic --whole-book", true);
    assert!(done.code == 0 && done.out.contains("acknowledged all of it"), "{} {}", done.out, done.err);
    assert_eq!((board.selected, board.rate_hz, board.words.len()), (vec![5], 60, words.len()));

    let (done, board) = driven(&stage, "--off", false);
    assert!(done.code == 0 && !board.is_lit && board.words.is_empty(), "{}", done.err);
}

#[test]
fn what_a_board_cannot_do_is_refused_before_the_port_is_touched() {
    let stage = Stage::new("led-refused");
    stage.file("book.txt", "0,0,1\n0,1,1\n");
    let done = stage.run("led /dev/no-such-port --book book.txt --vehicle 3");
    assert!(
        done.code == 2 && done.err.contains("book.txt: the book has 2 words, and no word 12"),
        "{}",
        done.err
    );
    let done = stage.run("led /dev/no-such-port --book book.txt --vehicle 1 --signals 1");
    assert!(
        done.code == 2 && done.err.contains("/dev/no-such-port: ") && done.err.contains("check the cable"),
        "{}",
        done.err
    );
}

/// Films a quadrotor at rest, 3 m away, whose signals blink these words of the book, and looks whether they are 0 to 3.
fn verified(name: &str, words: &str, leds: &str) -> crate::stage::Done {
    let stage = Stage::new(name);
    stage.file("book.txt", BOOK);
    let scenes = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes");
    stage.file(
        "scene.toml",
        format!(
            "name = \"leds\"\nseed = 3\npreset = \"bluefox-dsl215-bp365\"\nrate_hz = 59.9\nduration_s = 2.0\nexposure_us = 1000.0\n\
             [observer]\nmotion = {{ hover = {{ position_m = [0.0, 0.0, 5.0] }} }}\n\
             [[camera]]\nname = \"front\"\nfile = \"{scenes}/cameras/bluefox-dsl215.toml\"\nposition_m = [0.0, 0.0, 0.0]\n\
             [[target]]\nid = 1\nairframe = \"{scenes}/airframes/quadrotor-pairs-0.3.toml\"\nheading_deg = 200\n\
             motion = {{ hover = {{ position_m = [3.0, 0.2, 5.0] }} }}\n\
             blink = {{ codes = \"{scenes}/codes/l12-d3-r3.txt\", words = {words}, rate_hz = 60.0, shift_s = 0.003 }}\n{leds}"
        ),
    );
    let done = stage.run("simulate scene.toml --out rec -q");
    assert_eq!(done.code, 0, "{}", done.err);
    stage.run("led --book book.txt --vehicle 0 --verify rec")
}

#[test]
fn a_camera_sees_which_words_leds_blink_and_who_blinks_those_of_another() {
    let good = verified("led-good", "[0, 1, 2, 3]", "");
    assert_eq!(good.code, 0, "{} {}", good.out, good.err);
    let is_seen = |out: &str, signal: u32| out.contains(&format!("word {signal} of signal {signal}, in "));
    let seen: Vec<u32> = (0..4).filter(|signal| is_seen(&good.out, *signal)).collect();
    assert!(seen.len() == 2 && good.out.matches("dark, or on the far side").count() == 2, "{}", good.out);

    // Two LEDs carry each signal: the first that is seen goes dark.
    let dead = format!("leds = {{ dead = [{}, {}] }}\n", 2 * seen[0], 2 * seen[0] + 1);
    let dead = verified("led-dead", "[0, 1, 2, 3]", &dead);
    assert!(!is_seen(&dead.out, seen[0]) && is_seen(&dead.out, seen[1]), "{}", dead.out);
    assert!(dead.out.contains(&format!("signal {}, word {}: not seen", seen[0], seen[0])), "{}", dead.out);

    let mut words = [0, 1, 2, 3];
    words[seen[1] as usize] = 7;
    let other = verified("led-other", &format!("{words:?}"), "");
    assert!(
        other.code == 1 && other.err.contains("word 7, which is not of this vehicle"),
        "{} {}",
        other.out,
        other.err
    );
}

/// Films a hexarotor at rest with a signal on each arm, whose signals blink these words, and looks whether LEDs are dark or swapped.
fn verified_arms(name: &str, words: &str, leds: &str) -> crate::stage::Done {
    let stage = Stage::new(name);
    stage.file("book.txt", BOOK);
    let arm = |signal: u32| {
        let (x, y) = (libm::cos(f64::from(signal) * TAU / 6.0), libm::sin(f64::from(signal) * TAU / 6.0));
        format!(
            "[[led]]\nposition_m = [{}, {}, 0.0]\naxis = [{x}, {y}, 0.0]\nlobe = \"lambertian\"\nsignal = {signal}\n",
            0.4 * x,
            0.4 * y
        )
    };
    stage.file("arms.toml", format!("name = \"arms\"\n{}", (0..6).map(arm).collect::<String>()));
    let scenes = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes");
    stage.file(
        "scene.toml",
        format!(
            "name = \"arms\"\nseed = 5\npreset = \"bluefox-dsl215-bp365\"\nrate_hz = 59.9\nduration_s = 2.0\nexposure_us = 1000.0\n\
             [observer]\nmotion = {{ hover = {{ position_m = [0.0, 0.0, 5.0] }} }}\n\
             [[camera]]\nname = \"front\"\nfile = \"{scenes}/cameras/bluefox-dsl215.toml\"\nposition_m = [0.0, 0.0, 0.0]\n\
             [[target]]\nid = 1\nairframe = \"arms.toml\"\nheading_deg = 170\n\
             motion = {{ hover = {{ position_m = [2.5, 0.2, 5.6] }} }}\n\
             blink = {{ codes = \"{scenes}/codes/l12-d3-r3.txt\", words = {words}, rate_hz = 60.0, shift_s = 0.003 }}\n{leds}"
        ),
    );
    let done = stage.run("simulate scene.toml --out rec -q");
    assert_eq!(done.code, 0, "{}", done.err);
    stage.run("led --book book.txt --vehicle 0 --signals 6 --verify rec")
}

#[test]
fn a_camera_sees_which_led_is_dark_and_which_are_swapped() {
    let good = verified_arms("led-arms", "[0, 1, 2, 3, 4, 5]", "");
    assert!(good.code == 0 && !good.out.contains("swapped"), "{} {}", good.out, good.err);
    // The nose is ahead of the camera, 10 deg to the side: arms 0, 1 and 5 face it.
    for signal in [0, 1, 5] {
        assert!(good.out.contains(&format!("word {signal} of signal {signal}")), "{}", good.out);
    }
    let dead = verified_arms("led-arms-dead", "[0, 1, 2, 3, 4, 5]", "leds = { dead = [0] }\n");
    assert!(
        dead.code == 1 && dead.err.contains("LED 0 of signal 0 is dark, though it faces the camera"),
        "{} {}",
        dead.out,
        dead.err
    );
    assert!(!dead.err.contains("swapped"), "{}", dead.err);
    let swapped = verified_arms("led-arms-swapped", "[1, 0, 2, 3, 4, 5]", "");
    for (led, other) in [(0, 1), (1, 0)] {
        let told = format!("LED {led} of signal {led} blinks signal {other}: swapped");
        assert!(swapped.code == 1 && swapped.err.contains(&told), "{told}: {} {}", swapped.out, swapped.err);
    }
    assert!(!swapped.err.contains("dark"), "{}", swapped.err);
}

#[test]
fn a_camera_sees_which_led_is_out_of_step_and_by_how_much() {
    // The LEDs of a simulated vehicle blink by one clock: two at one place stand for a board with two.
    let filmed = |name: &str, late_s: f64| {
        let stage = Stage::new(name);
        stage.file("book.txt", BOOK);
        let scenes = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes");
        let led = |y_m: f64, signal: u32| {
            format!(
                "[[led]]\nposition_m = [0.0, {y_m}, 0.0]\naxis = [1.0, 0.0, 0.0]\nlobe = \"lambertian\"\nsignal = {signal}\n"
            )
        };
        stage.file("one.toml", format!("name = \"one\"\n{}{}", led(0.3, 0), led(0.1, 1)));
        stage.file("other.toml", format!("name = \"other\"\n{}", led(-0.2, 0)));
        let target = |id: u32, airframe: &str, words: &str, shift_s: f64| {
            format!(
                "[[target]]\nid = {id}\nairframe = \"{airframe}.toml\"\nheading_deg = 180\nmotion = {{ hover = {{ position_m = [2.5, 0.0, 5.0] }} }}\n\
                 blink = {{ codes = \"{scenes}/codes/l12-d3-r3.txt\", words = {words}, rate_hz = 60.0, shift_s = {shift_s} }}\n"
            )
        };
        stage.file(
            "scene.toml",
            format!(
                "name = \"step\"\nseed = 5\npreset = \"bluefox-dsl215-bp365\"\nrate_hz = 59.9\nduration_s = 2.0\nexposure_us = 1000.0\n\
                 [observer]\nmotion = {{ hover = {{ position_m = [0.0, 0.0, 5.0] }} }}\n\
                 [[camera]]\nname = \"front\"\nfile = \"{scenes}/cameras/bluefox-dsl215.toml\"\nposition_m = [0.0, 0.0, 0.0]\n{}{}",
                target(1, "one", "[0, 1]", 0.003),
                target(2, "other", "[2]", 0.003 - late_s)
            ),
        );
        let done = stage.run("simulate scene.toml --out rec -q");
        assert_eq!(done.code, 0, "{}", done.err);
        stage.run("led --book book.txt --vehicle 0 --signals 3 --verify rec")
    };
    let good = filmed("led-in-step", 0.0);
    assert!(
        good.code == 0 && good.out.matches("in 100 % of the frames").count() == 3,
        "{} {}",
        good.out,
        good.err
    );
    let late = filmed("led-late", 2.0 / 60.0);
    let told: Vec<&str> = late.err.lines().filter(|line| line.contains("out of step")).collect();
    assert!(late.code == 1 && told.len() == 1, "{} {}", late.out, late.err);
    let by: f64 = told[0].split_whitespace().rev().nth(1).unwrap().parse().unwrap();
    assert!((by.abs() - 2.0).abs() < 0.5, "{}", late.err);
}
