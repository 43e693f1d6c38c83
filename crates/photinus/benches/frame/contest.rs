//! Runs contenders in turn, so that all of them see the same moods of the machine, and tells medians.

use std::time::Instant;

const ROUNDS: usize = 100;
const CALLS_PER_ROUND: usize = 32;

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
    let mut times = vec![Vec::with_capacity(ROUNDS); contenders.len()];
    for round in 0..ROUNDS + ROUNDS / 10 {
        for (call, times) in contenders.iter_mut().zip(&mut times) {
            let start = Instant::now();
            (0..calls).for_each(|_| call(round));
            if round >= ROUNDS / 10 {
                times.push(start.elapsed().as_secs_f64() * 1e6 / calls as f64);
            }
        }
    }
    let rank = |mut times: Vec<f64>| {
        times.sort_by(f64::total_cmp);
        Time { median_us: times[ROUNDS / 2], tenth_us: times[ROUNDS / 10] }
    };
    times.into_iter().map(rank).collect()
}

/// A table of contenders with their ratios to the first.
pub(crate) struct Contest<'a> {
    title: String,
    floor: String,
    names: Vec<String>,
    contenders: Vec<Contender<'a>>,
}

impl<'a> Contest<'a> {
    pub(crate) fn new(title: &str, floor: &str) -> Self {
        Self { title: title.to_owned(), floor: floor.to_owned(), names: Vec::new(), contenders: Vec::new() }
    }

    /// A contender is called with the number of its call, to choose among its inputs.
    pub(crate) fn add(&mut self, name: &str, mut call: impl FnMut(usize) + 'a) {
        self.names.push(name.to_owned());
        let mut calls = 0;
        self.contenders.push(Box::new(move |_| {
            call(calls);
            calls += 1;
        }));
    }

    pub(crate) fn run(mut self) {
        let times = times(&mut self.contenders, CALLS_PER_ROUND);
        let floor = format!("x {}", self.floor);
        println!("\n{:<34}{:>11}{:>11}{floor:>26}", self.title, "median us", "10 % us");
        for (name, time) in self.names.iter().zip(&times) {
            let ratio = time.median_us / times[0].median_us;
            println!("{name:<34}{:>11.2}{:>11.2}{ratio:>26.2}", time.median_us, time.tenth_us);
        }
    }
}
