//! Runs contenders in turn and prints a table of medians and of ratios to the first.

use std::time::Instant;

const ROUNDS: usize = 100;
const CALLS_PER_ROUND: usize = 32;

type Contender<'a> = (String, Box<dyn FnMut(usize) + 'a>);

pub(crate) struct Contest<'a> {
    title: String,
    floor: String,
    contenders: Vec<Contender<'a>>,
}

impl<'a> Contest<'a> {
    pub(crate) fn new(title: &str, floor: &str) -> Self {
        Self { title: title.to_owned(), floor: floor.to_owned(), contenders: Vec::new() }
    }

    /// A contender is called with a counter, to choose among its inputs.
    pub(crate) fn add(&mut self, name: &str, call: impl FnMut(usize) + 'a) {
        self.contenders.push((name.to_owned(), Box::new(call)));
    }

    pub(crate) fn run(mut self) {
        let mut times = vec![Vec::with_capacity(ROUNDS); self.contenders.len()];
        for round in 0..ROUNDS + ROUNDS / 10 {
            for ((_, call), times) in self.contenders.iter_mut().zip(&mut times) {
                let start = Instant::now();
                for i in 0..CALLS_PER_ROUND {
                    call(round + i);
                }
                let each_us = start.elapsed().as_secs_f64() * 1e6 / CALLS_PER_ROUND as f64;
                if round >= ROUNDS / 10 {
                    times.push(each_us);
                }
            }
        }
        for times in &mut times {
            times.sort_by(f64::total_cmp);
        }
        let floor = times[0][ROUNDS / 2];
        println!(
            "\n{:<34}{:>11}{:>11}{:>26}",
            self.title,
            "median us",
            "10 % us",
            format!("x {}", self.floor)
        );
        for ((name, _), times) in self.contenders.iter().zip(&times) {
            let median = times[ROUNDS / 2];
            println!("{name:<34}{median:>11.2}{:>11.2}{:>26.2}", times[ROUNDS / 10], median / floor);
        }
    }
}
