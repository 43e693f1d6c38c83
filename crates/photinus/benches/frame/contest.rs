//! Runs contenders in turn, so that all of them see the same moods of the machine, and tells medians.

use std::hint::black_box;
use std::time::Instant;

use crate::frames::{self, Look, PAPER, Scene};

const ROUNDS: usize = 100;
const CALLS_PER_ROUND: usize = 32;
/// What takes long is timed over fewer rounds of a single call each.
const LONG_ROUNDS: usize = 3;
/// Calls before those whose instructions are counted: what is learnt from frame to frame is known by then.
const WARM_UP: usize = 96;
/// What takes long is counted over so many calls, after as many.
const LONG_CALLS: usize = 2;

/// What is timed; called with the number of the round.
pub(crate) type Contender<'a> = Box<dyn FnMut(usize) + 'a>;

/// How long a call took, us.
#[derive(Clone, Copy)]
pub(crate) struct Time {
    pub(crate) median_us: f64,
    /// A tenth of the rounds took less.
    pub(crate) tenth_us: f64,
}

/// The time of each contender over `ROUNDS` rounds, in each of which all of them run `calls` times.
pub(crate) fn times(contenders: &mut [Contender<'_>], calls: usize) -> Vec<Time> {
    times_over(ROUNDS, contenders, calls)
}

/// The same over so many rounds, after a tenth of them to warm up, or one.
fn times_over(rounds: usize, contenders: &mut [Contender<'_>], calls: usize) -> Vec<Time> {
    let warm_up = (rounds / 10).max(1);
    let mut times = vec![Vec::with_capacity(rounds); contenders.len()];
    for round in 0..rounds + warm_up {
        for (call, times) in contenders.iter_mut().zip(&mut times) {
            let start = Instant::now();
            (0..calls).for_each(|_| call(round));
            if round >= warm_up {
                times.push(start.elapsed().as_secs_f64() * 1e6 / calls as f64);
            }
        }
    }
    let rank = |mut times: Vec<f64>| {
        times.sort_by(f64::total_cmp);
        Time { median_us: times[rounds / 2], tenth_us: times[rounds / 10] }
    };
    times.into_iter().map(rank).collect()
}

/// A table of contenders with their ratios to the first.
pub(crate) struct Contest<'a> {
    title: String,
    floor: String,
    /// Only contenders with this in their name run, beside the first.
    only: Option<String>,
    names: Vec<String>,
    contenders: Vec<Contender<'a>>,
}

impl<'a> Contest<'a> {
    pub(crate) fn new(title: &str, floor: &str) -> Self {
        let only = std::env::args().skip(1).filter(|argument| !argument.starts_with('-')).nth(1);
        let (title, floor) = (title.to_owned(), floor.to_owned());
        Self { title, floor, only, names: Vec::new(), contenders: Vec::new() }
    }

    /// A table whose floor is a pass over an empty frame that only takes its maximum.
    pub(crate) fn beside_maximum(title: &str) -> Self {
        let mut contest = Self::new(title, "maximum of the frame");
        let empty = frames::markers(&Scene { size: PAPER, markers: 0, look: Look::Disc, sun: false });
        contest.add("maximum of the frame", move |i| {
            let frame = &empty[i % empty.len()];
            black_box(frame.iter().fold(0, |high: u8, &pixel| high.max(pixel)));
        });
        contest
    }

    /// Calls every contender so often, after so many calls to warm up, for `valgrind --tool=callgrind --toggle-collect='*counted*'`
    /// `--dump-after='*contest::counted*'`: instructions are the same whatever else the machine does.
    fn count(&mut self, warm_up: usize, calls: usize) {
        for (name, call) in self.names.iter().zip(&mut self.contenders).skip(1) {
            println!("{name}, {calls} calls");
            (0..warm_up).for_each(&mut *call);
            counted(call, calls);
        }
    }

    /// A contender is called with the number of its call, to choose among its inputs.
    pub(crate) fn add(&mut self, name: &str, mut call: impl FnMut(usize) + 'a) {
        if !self.names.is_empty() && self.only.as_ref().is_some_and(|only| !name.contains(only.as_str())) {
            return;
        }
        self.names.push(name.to_owned());
        let mut calls = 0;
        self.contenders.push(Box::new(move |_| {
            call(calls);
            calls += 1;
        }));
    }

    pub(crate) fn run(mut self) {
        if is_counting() {
            return self.count(WARM_UP, frames::FRAMES);
        }
        let times = times(&mut self.contenders, CALLS_PER_ROUND);
        self.print_head();
        for (name, time) in self.names.iter().zip(&times) {
            print_row(name, *time, times[0]);
        }
    }

    /// For what takes milliseconds to minutes: one after the other, each told as it is done.
    pub(crate) fn run_long(mut self) {
        if is_counting() {
            return self.count(LONG_CALLS, LONG_CALLS);
        }
        self.print_head();
        let mut floor = None;
        for (name, contender) in self.names.iter().zip(&mut self.contenders) {
            let (rounds, calls) = if floor.is_none() { (ROUNDS, CALLS_PER_ROUND) } else { (LONG_ROUNDS, 1) };
            let time = times_over(rounds, std::slice::from_mut(contender), calls)[0];
            print_row(name, time, *floor.get_or_insert(time));
        }
    }

    fn print_head(&self) {
        let floor = format!("x {}", self.floor);
        println!("\n{:<34}{:>11}{:>11}{floor:>26}", self.title, "median us", "10 % us");
    }
}

/// Whether instructions are counted, not times: `--count`.
pub(crate) fn is_counting() -> bool {
    std::env::args().any(|argument| argument == "--count")
}

#[inline(never)]
fn counted(call: &mut Contender<'_>, calls: usize) {
    (0..calls).for_each(call);
}

fn print_row(name: &str, time: Time, floor: Time) {
    let ratio = time.median_us / floor.median_us;
    println!("{name:<34}{:>11.2}{:>11.2}{ratio:>26.2}", time.median_us, time.tenth_us);
}
